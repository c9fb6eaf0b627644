//! The source of the gaze: which one suits the headset, and which one running applications have.

use super::configuration::in_force;
use super::layers::Layers;
use super::manifests::advise_install;
use super::{Finding, Surroundings};
use crate::config::Config;
use crate::json::{EYE_GAZE_EXTENSION, Half};
use crate::options::{GazeSource, ListenAddress};
use crate::status::{Status, read_all};
use std::fs;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::time::SystemTime;

/// Lists of the system's UDP sockets (proc(5), `/proc/net/udp`).
const SOCKETS: [&str; 2] = ["/proc/net/udp", "/proc/net/udp6"];

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let found = read_all(&surroundings.environment, SystemTime::now()).found;
    let running: Vec<Status> =
        found.into_iter().map(|found| found.status).filter(|status| status.inert.is_empty()).collect();
    let mut findings: Vec<Finding> = running
        .iter()
        .map(|status| {
            Finding::good("gaze-in-use", format!("gaze of {}: {}", status.application, status.gaze))
        })
        .collect();
    if let Some(config) = in_force(surroundings).1 {
        findings.extend(suitable(surroundings, &config));
        findings.extend(packets(surroundings, &config, &running));
        findings.extend(offered(surroundings, layers, &config));
    }
    findings
}

/// Whether the runtime has an eye tracker at this moment; `None` if it did not answer, or has no headset.
fn tracks_eyes(surroundings: &Surroundings) -> Option<bool> {
    let runtime = surroundings.probed.openxr.as_ref().ok().filter(|runtime| !runtime.name.is_empty())?;
    let is_listed = runtime.extensions.iter().any(|extension| extension == "XR_EXT_eye_gaze_interaction");
    if is_listed { runtime.tracks_eyes } else { Some(false) }
}

/// An eye tracker that the configuration does not use.
fn suitable(surroundings: &Surroundings, config: &Config) -> Option<Finding> {
    let is_unused = matches!(config.gaze.source, GazeSource::Centre | GazeSource::Osc);
    (is_unused && tracks_eyes(surroundings) == Some(true)).then(|| {
        Finding::warning(
            "eye-tracker-unused",
            format!(
                "the headset tracks eyes, but gaze.source = \"{}\" does not use its eye tracker",
                config.gaze.source.name()
            ),
            "Shading rates follow OSC packets (\"osc\"), or stay around the axis of each lens (\"centre\").",
        )
        .advise("set gaze.source = \"auto\", which uses the best available source")
    })
}

/// The gaze that the user gives to applications.
fn offered(surroundings: &Surroundings, layers: &Layers, config: &Config) -> Option<Finding> {
    if !config.gaze.offer {
        return None;
    }
    let source = config.gaze.source;
    if matches!(source, GazeSource::Eyes | GazeSource::Centre) {
        return Some(
            Finding::warning(
                "gaze-not-offered",
                format!("gaze.offer = true, but gaze.source = \"{}\" has no gaze for games", source.name()),
                "Games get the gaze of the OpenXR runtime, or none.",
            )
            .advise("set gaze.source = \"osc\", or remove gaze.offer"),
        );
    }
    if tracks_eyes(surroundings) == Some(true) {
        let found = "games get the gaze of the headset's own eye tracker: gaze.offer = true has no effect";
        return Some(Finding::good("gaze-of-runtime", found));
    }
    // The manifest of the user or of the system. A missing one has a finding of its own.
    let text = fs::read_to_string(&layers.ours(Half::OpenXr).next()?.path).ok()?;
    if Half::OpenXr.lists_eye_gaze(&text) {
        let found = "games that ask for the gaze get it, and may store or send it (gaze.offer = true)";
        return Some(Finding::good("gaze-offered", found));
    }
    Some(advise_install(
        Finding::warning(
            "gaze-not-listed",
            format!("gaze.offer = true, but the installed layer does not list {EYE_GAZE_EXTENSION}"),
            "Games cannot ask for the gaze.",
        ),
        surroundings,
        layers,
    ))
}

/// The port for OSC packets.
fn packets(surroundings: &Surroundings, config: &Config, running: &[Status]) -> Vec<Finding> {
    let is_needed = match config.gaze.source {
        GazeSource::Osc => true,
        GazeSource::Auto => tracks_eyes(surroundings) == Some(false),
        GazeSource::Eyes | GazeSource::Centre | GazeSource::File => false,
    };
    if !is_needed {
        return Vec::new();
    }
    let address = config.gaze.osc_listen;
    let mut findings = Vec::new();
    if !address.is_loopback() {
        findings.push(
            Finding::warning(
                "osc-from-network",
                format!("gaze.osc_listen = \"{}\" receives packets from other computers", address.socket()),
                "Any computer in the network can send a wrong gaze.",
            )
            .advise(
                "unless the eye tracker is on another computer, set gaze.osc_listen = \"127.0.0.1:9020\"",
            ),
        );
    }
    let is_ours = |status: &Status| {
        status.gaze.osc.address == address.socket().to_string() && status.gaze.osc.failure.is_empty()
    };
    if !running.iter().any(is_ours) && is_taken(surroundings, address) {
        let found = format!("another program already receives at {} (gaze.osc_listen)", address.socket());
        let means = "Games cannot receive OSC packets of an eye tracker.";
        let advice =
            "set gaze.osc_listen to a free port, and let the eye tracker's program send OSC packets there";
        let finding = match config.gaze.source {
            GazeSource::Osc => Finding::problem("osc-port-taken", found, means),
            _ => Finding::warning("osc-port-taken", found, means),
        };
        findings.push(finding.advise(advice));
    } else {
        findings.push(Finding::good(
            "osc-port",
            format!("OSC packets of eye trackers can be received at {}", address.socket()),
        ));
    }
    findings
}

/// Whether a socket has the address, or its port at all addresses, by the system's lists.
fn is_taken(surroundings: &Surroundings, wanted: ListenAddress) -> bool {
    let wanted = wanted.socket();
    let lists = SOCKETS.iter().filter_map(|list| fs::read_to_string(surroundings.system(list)).ok());
    lists.flat_map(|list| list.lines().filter_map(local_address).collect::<Vec<_>>()).any(|bound| {
        let is_same =
            bound.ip() == wanted.ip() || bound.ip().is_unspecified() || wanted.ip().is_unspecified();
        bound.port() == wanted.port() && is_same
    })
}

/// The second column of a line: an address, in words of the machine's byte order, and a port, in hexadecimal digits.
fn local_address(line: &str) -> Option<SocketAddr> {
    let (ip, port) = line.split_whitespace().nth(1)?.split_once(':')?;
    let port = u16::from_str_radix(port, 16).ok()?;
    let mut octets = [0; 16];
    for (index, octet) in octets.iter_mut().enumerate().take(ip.len() / 2) {
        *octet = u8::from_str_radix(ip.get(2 * index..2 * index + 2)?, 16).ok()?;
    }
    // Digits show a word as a number: its bytes are in order on big-endian machines alone.
    let words: Vec<[u8; 4]> = octets
        .chunks_exact(4)
        .filter_map(|word| Some(u32::from_be_bytes(word.try_into().ok()?).to_ne_bytes()))
        .collect();
    let ip: IpAddr = match ip.len() {
        8 => Ipv4Addr::from(*words.first()?).into(),
        32 => Ipv6Addr::from(<[u8; 16]>::try_from(words.concat()).ok()?).to_canonical(),
        _ => return None,
    };
    Some(SocketAddr::new(ip, port))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_the_system_s_list_are_read() {
        let line = |address: &str| format!("  123: {address} 00000000:0000 07 00000000:00000000 00:00000000");
        #[cfg(target_endian = "little")]
        for (digits, address) in [
            ("0100007F:233C", "127.0.0.1:9020"),
            ("00000000:0035", "0.0.0.0:53"),
            ("00000000000000000000000001000000:233C", "[::1]:9020"),
            ("0000000000000000FFFF00000100007F:233C", "127.0.0.1:9020"),
        ] {
            assert_eq!(local_address(&line(digits)), address.parse().ok(), "{digits}");
        }
        for other in ["0100007F", "0100007F:23", "x:y", "01:233C", "é100007F:233C"] {
            let found = local_address(&line(other));
            assert!(found.is_none_or(|address| other.ends_with(":23") && address.port() == 0x23), "{other}");
        }
        assert_eq!(local_address("  sl  local_address rem_address   st tx_queue"), None);
    }
}
