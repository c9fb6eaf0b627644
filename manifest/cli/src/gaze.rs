//! `parafovea gaze`.

mod measurement;

use crate::status::{self, Watched};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Found, Osc, Status, watch_gaze};
use serde_json::json;
use std::fmt::Write;
use std::process::ExitCode;

/// Options of `parafovea gaze`.
#[derive(Clone, Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    command: Option<Command>,
    /// Application to show, by OpenXR application name, executable name or process ID
    #[arg(value_name = "APPLICATION")]
    application: Option<String>,
    /// Show the state once, instead of every second
    #[arg(long)]
    once: bool,
    /// Print one JSON object per line, for each application and second
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Debug, clap::Subcommand)]
enum Command {
    Recentre(measurement::Recentre),
    Calibrate(measurement::Calibrate),
}

/// Shows source and quality of the gaze in running applications, until it is interrupted or its reader ends.
pub fn gaze(options: Options) -> ExitCode {
    let Options { command, application, once, json } = options;
    match &command {
        Some(Command::Recentre(options)) => return measurement::recentre(options),
        Some(Command::Calibrate(options)) => return measurement::calibrate(options),
        None => {}
    }
    let environment = Environment::of_process(false);
    let watch = |found: &[Found]| {
        for found in found.iter().filter(|_| !once) {
            // An application that rests is shown with the tracker's figures of each second.
            let _ = watch_gaze(&environment, found.status.pid);
        }
    };
    let text = |found: &[Found]| {
        watch(found);
        of_all(found)
    };
    let json_lines = |found: &[Found]| {
        watch(found);
        as_json(found)
    };
    status::watch(application.as_deref(), once, json, Watched { text, json: json_lines })
}

/// Applications that are active.
fn of_all(found: &[Found]) -> String {
    let active: Vec<String> = found
        .iter()
        .map(|found| &found.status)
        .filter(|status| status.inert.is_empty())
        .map(|status| {
            let head = format!("{}\n", status::title(status));
            head + &of_one(status)
        })
        .collect();
    if active.is_empty() {
        return "No running application has an active OpenXR session with Parafovea. To list inert applications too: parafovea status\n"
            .to_owned();
    }
    active.join("\n")
}

fn of_one(status: &Status) -> String {
    let gaze = &status.gaze;
    let mut text = String::new();
    let mut line = |name: &str, value: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {name:9} {value}");
    };
    line("gaze", &gaze.to_string());
    line("source", &format!("gaze.source = \"{}\"", gaze.source));
    let known = |value: Option<String>| value.unwrap_or_else(|| "unknown".to_owned());
    if gaze.holder != "centre" {
        line("rate", &known(gaze.rate_hz.map(|rate| format!("{rate:.0} Hz"))));
        line("age", &known(gaze.age_ms.map(|age| format!("{age:.0} ms at display time"))));
        line("valid", &known(gaze.valid.map(|share| format!("in {:.0} % of the frames", share * 100.0))));
        let noise =
            gaze.noise_deg.map(|noise| format!("{noise:.2} degrees from sample to sample in fixations"));
        line("noise", &known(noise));
        line("blinks", &gaze.blinks.to_string());
        line("saccades", &gaze.saccades.to_string());
    }
    if let Some(delay) = gaze.packet_delay() {
        line("delay", &delay);
    }
    if let Some(correction) = &status.gaze_correction.correction {
        line("corrected", &measurement::of_correction(correction));
    }
    if let Some(drift) = gaze.drift() {
        line("drift", &drift);
    }
    if !gaze.osc.address.is_empty() {
        line("packets", &packets(&gaze.osc));
    }
    text
}

fn packets(osc: &Osc) -> String {
    if !osc.failure.is_empty() {
        return format!("none: {}: {}", osc.address, osc.failure);
    }
    let unused: Vec<String> = [
        (osc.malformed, "malformed"),
        (osc.late, "late"),
        (osc.other_senders, "from a second sender"),
        (osc.implausible, "implausible"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, kind)| format!("{count} {kind}"))
    .collect();
    let unused = if unused.is_empty() { String::new() } else { format!("; unused: {}", unused.join(", ")) };
    let floods = if osc.floods > 0 {
        format!("; above the packet limit: {} times", osc.floods)
    } else {
        String::new()
    };
    format!("{} at {}{unused}{floods}", osc.packets, osc.address)
}

fn as_json(found: &[Found]) -> String {
    let line = |Found { status, age, .. }: &Found| {
        let mut object = json!(status.gaze);
        object["correction"] = json!(status.gaze_correction);
        object["application"] = json!(status.application);
        object["pid"] = json!(status.pid);
        object["status_age_ms"] = json!(age.as_millis() as u64);
        format!("{object}\n")
    };
    found.iter().filter(|found| found.status.inert.is_empty()).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_manifest::status::Gaze;
    use std::time::Duration;

    fn found(gaze: Gaze) -> Vec<Found> {
        let status = Status { application: "Game".to_owned(), pid: 7, gaze, ..Status::default() };
        vec![Found { status, age: Duration::ZERO, log: None }]
    }

    fn followed() -> Gaze {
        Gaze {
            source: "auto".to_owned(),
            holder: "osc".to_owned(),
            is_valid: true,
            age_ms: Some(58.0),
            rate_hz: Some(120.0),
            valid: Some(0.98),
            noise_deg: Some(0.12),
            blinks: 4,
            saccades: 37,
            is_given: false,
            packet_delay_ms: Some(63.0),
            drift_deg: Some(2.1),
            osc: Osc {
                address: "127.0.0.1:9020".to_owned(),
                format: "VRChat".to_owned(),
                packets: 1200,
                malformed: 3,
                other_senders: 5,
                floods: 2,
                ..Osc::default()
            },
        }
    }

    #[test]
    fn the_signal_of_a_followed_gaze_is_shown() {
        let text = of_all(&found(followed()));
        for line in [
            "  gaze      OSC (VRChat): valid, 120 Hz, 58 ms old at display time; delay of packets 63 ms",
            "  source    gaze.source = \"auto\"",
            "  rate      120 Hz",
            "  age       58 ms at display time",
            "  valid     in 98 % of the frames",
            "  noise     0.12 degrees from sample to sample in fixations",
            "  delay     63 ms from an eye movement to the first displayed frame with the new gaze, measured with the runtime's eye tracker; 50 ms were assumed before",
            "  blinks    4",
            "  saccades  37",
            "  drift     the mean gaze has drifted by 2.1 degrees since the first five minutes; if the headset slipped: parafovea gaze recentre",
            "  packets   1200 at 127.0.0.1:9020; unused: 3 malformed, 5 from a second sender; above the packet limit: 2 times",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\nin\n{text}");
        }
        let object: serde_json::Value = serde_json::from_str(&as_json(&found(followed()))).unwrap();
        assert_eq!((&object["application"], &object["osc"]["packets"]), (&json!("Game"), &json!(1200)));
    }

    #[test]
    fn a_fixed_gaze_has_no_signal_and_a_port_that_is_taken_is_named() {
        let text = of_all(&found(Gaze {
            source: "auto".to_owned(),
            holder: "centre".to_owned(),
            osc: Osc { failure: "address in use".to_owned(), ..followed().osc },
            ..Gaze::default()
        }));
        assert!(text.contains("packets   none: 127.0.0.1:9020: address in use"), "{text}");
        assert!(!text.contains("noise") && !text.contains("drift"), "{text}");
        let inert = Status { inert: "its graphics API is not Vulkan".to_owned(), ..Status::default() };
        let inert = [Found { status: inert, age: Duration::ZERO, log: None }];
        assert!(of_all(&inert).starts_with("No running application") && as_json(&inert).is_empty());
    }
}
