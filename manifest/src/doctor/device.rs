//! Answers of Vulkan and OpenXR: layers listed by the loaders, capabilities of the GPU, and eye tracking.

use super::configuration::in_force;
use super::layers::Layers;
use super::manifests::called;
use super::{Device, Finding, RuntimeAnswer, Surroundings, runtime};
use crate::config::Config;
use crate::json::Half;
use crate::options::GazeSource;
use crate::quirks::{Driver, Quirk, Quirks};

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let probed = &surroundings.probed;
    let mut findings = Vec::new();
    match &probed.layers {
        Err(reason) => findings.push(unknown("layers of the loaders", reason)),
        Ok(listed) => {
            for (half, names) in [(Half::OpenXr, &listed.openxr), (Half::Vulkan, &listed.vulkan)] {
                let lists = names.as_ref().map(|names| names.iter().any(|name| name == half.layer_name()));
                if lists == Some(false) && layers.ours(half).next().is_some() {
                    findings.push(not_listed(half));
                }
            }
        }
    }
    match &probed.vulkan {
        Err(reason) => findings.push(unknown("capabilities of the GPU", reason)),
        Ok(vulkan) if vulkan.devices.is_empty() => findings.push(
            Finding::problem("no-device", "Vulkan finds no device", "Games that use Vulkan do not start.")
                .advise("install a driver (Debian, Ubuntu: mesa-vulkan-drivers, or the NVIDIA driver)"),
        ),
        Ok(vulkan) => {
            findings.extend(of_devices(&vulkan.devices));
            let changes = surroundings.environment.quirks();
            findings.extend(vulkan.devices.iter().flat_map(|device| quirks(device, &changes)));
            // The complaint is the same for every device: the first one's is enough.
            let complaint = vulkan.devices.first().and_then(|device| quirks_of(device, &changes).complaint());
            findings.extend(complaint.map(|complaint| {
                Finding::warning("unknown-quirk", complaint, "The rest of the variable applies.")
                    .advise("correct the variable, or unset it")
            }));
        }
    }
    match &probed.openxr {
        Err(reason) => findings.push(unknown("capabilities of the OpenXR runtime", reason)),
        // If no runtime is set, another finding reports that.
        Ok(runtime) if !runtime.name.is_empty() || runtime::is_set(surroundings) => {
            findings.extend(of_runtime(runtime, &in_force(surroundings).1.unwrap_or_default()));
        }
        Ok(_) => {}
    }
    findings
}

fn unknown(what: &str, reason: &str) -> Finding {
    Finding::note(
        "cannot-check",
        format!("cannot check the {what}: {reason}"),
        "This does not affect the other checks.",
    )
}

fn not_listed(half: Half) -> Finding {
    let name = called(half);
    Finding::problem(
        "not-listed",
        format!("the {name} loader does not list the layer, although its manifest exists"),
        "Games get only the other half, which has no effect alone.",
    )
    .advise(match half {
        Half::OpenXr => {
            "to see the reason: XR_LOADER_DEBUG=all parafovea run -- GAME; then: parafovea install"
        }
        Half::Vulkan => {
            "to see the reason: VK_LOADER_DEBUG=layer parafovea run -- GAME; then: parafovea install"
        }
    })
}

fn of_devices(devices: &[Device]) -> Vec<Finding> {
    // Games take a GPU where there is one.
    let has_gpu = devices.iter().any(|device| !device.is_cpu);
    let looked_at = devices.iter().filter(|device| !device.is_cpu || !has_gpu);
    let mut findings: Vec<Finding> = looked_at.filter_map(of_device).collect();
    if !has_gpu {
        findings.push(
            Finding::warning(
                "no-gpu",
                "Vulkan finds no GPU, only a device that renders on the CPU",
                "It is too slow for virtual reality, with or without Parafovea.",
            )
            .advise(
                "install the driver of your GPU (Debian, Ubuntu: mesa-vulkan-drivers, or the NVIDIA driver)",
            ),
        );
    }
    findings
}

/// Abilities of a GPU; that a CPU has no rates matters less than that it is one.
fn of_device(device: &Device) -> Option<Finding> {
    let name = match device.driver.as_str() {
        "" => device.name.clone(),
        driver => format!("{} ({driver})", device.name),
    };
    if device.rates.is_empty() {
        let finding = Finding::warning(
            "no-shading-rates",
            format!("{name} does not support shading-rate attachments (VK_KHR_fragment_shading_rate)"),
            "Parafovea uses a mask instead, which works in fewer games and loses more contrast.",
        )
        .advise(
            "update the driver; NVIDIA GPUs since RTX 20, AMD GPUs since RX 6000 and Intel Arc support it",
        );
        return (!device.is_cpu).then_some(finding);
    }
    let [[least, _], [most, _]] = device.texel;
    let texel = if least == most { least.to_string() } else { format!("{least} to {most}") };
    let coarsest = coarsest(&device.rates);
    let layers = if device.layered { "a layer for each eye" } else { "one layer for both eyes" };
    let samples = match device.samples {
        0 => String::new(),
        samples => format!(", and up to {samples} samples per pixel"),
    };
    let found = format!(
        "{name} supports shading rates up to {coarsest}, in tiles of {texel} pixels, with {layers}{samples}"
    );
    Some(match coarsest {
        "4x4" => Finding::good("shading-rates", found),
        _ => {
            let means =
                format!("The periphery is never coarser than {coarsest}, regardless of rates.peripheral.");
            Finding::note("shading-rates", found, means)
        }
    })
}

fn quirks_of(device: &Device, changes: &str) -> Quirks {
    let driver = Driver { id: device.driver_id, device: &device.name, version: device.driver_version };
    Quirks::of(&driver, changes)
}

/// The layer's special treatment of a device with shading rates.
fn quirks(device: &Device, changes: &str) -> Vec<Finding> {
    if device.rates.is_empty() {
        return Vec::new();
    }
    let finding = |quirk: &&Quirk| {
        let found = format!("{}: quirk {}: {}", device.name, quirk.name, quirk.doc);
        Finding::note("quirk", found, format!("Source: {}.", quirk.source))
    };
    quirks_of(device, changes).rows.iter().map(finding).collect()
}

/// The rate that shades the most pixels at once.
fn coarsest(rates: &[String]) -> &str {
    let pixels = |rate: &&String| -> u32 { rate.split('x').map(|side| side.parse().unwrap_or(1)).product() };
    rates.iter().max_by_key(pixels).map_or("1x1", String::as_str)
}

fn of_runtime(runtime: &RuntimeAnswer, config: &Config) -> Vec<Finding> {
    let has = |name: &str| runtime.extensions.iter().any(|extension| extension == name);
    if runtime.name.is_empty() {
        return vec![
            Finding::problem(
                "runtime-refuses",
                format!("the OpenXR runtime cannot create an instance: {}", runtime.failure),
                "Games find no headset.",
            )
            .advise("start the runtime (SteamVR, or the service of WiVRn or Monado), then run parafovea doctor again"),
        ];
    }
    let version = runtime.version.map(|part| part.to_string()).join(".");
    let mut findings = vec![Finding::good("runtime-answers", format!("{} {version} responds", runtime.name))];
    if !has("XR_KHR_vulkan_enable") && !has("XR_KHR_vulkan_enable2") {
        findings.push(
            Finding::problem(
                "runtime-without-vulkan",
                format!("{} does not support Vulkan", runtime.name),
                "Parafovea needs games that render with Vulkan, or with Direct3D through Proton.",
            )
            .advise("use another runtime, such as SteamVR, WiVRn or Monado"),
        );
    }
    let needs_eyes = matches!(config.gaze.source, GazeSource::Auto | GazeSource::Eyes);
    let without_eyes = without_eyes(config);
    if !needs_eyes {
        let source = config.gaze.source.name();
        findings.push(Finding::good(
            "no-eye-gaze-needed",
            format!("gaze.source = \"{source}\" needs no eye tracker of the runtime"),
        ));
    } else if !has("XR_EXT_eye_gaze_interaction") {
        findings.push(
            Finding::warning(
                "no-eye-gaze",
                format!("{} does not offer eye tracking (XR_EXT_eye_gaze_interaction)", runtime.name),
                "Without OSC packets of an eye tracker, shading rates are fixed around the axis of each lens.",
            )
            .advise(without_eyes),
        );
    } else if runtime.tracks_eyes == Some(false) {
        let headset = runtime.system.as_deref().unwrap_or("the headset");
        findings.push(
            Finding::warning(
                "no-eye-tracker",
                format!("{headset} does not track eyes"),
                "Without OSC packets of an eye tracker, shading rates are fixed around the axis of each lens.",
            )
            .advise(format!(
                "turn on eye tracking in the headset and its runtime, if available; {without_eyes}"
            )),
        );
    } else if let Some(headset) = &runtime.system {
        findings.push(Finding::good("headset", format!("{headset} is connected and tracks eyes")));
    }
    if runtime.system.is_none() {
        let reason = if runtime.failure.is_empty() { "no reason given" } else { &runtime.failure };
        findings.push(
            Finding::note(
                "no-headset",
                format!("{} has no headset at present: {reason}", runtime.name),
                "The eye tracking of a headset can be checked only while it is on.",
            )
            .advise("turn the headset on, then run parafovea doctor again"),
        );
    }
    findings
}

/// Sources of the gaze without an eye tracker of the runtime.
fn without_eyes(config: &Config) -> String {
    let address = config.gaze.osc_listen.socket();
    let auto = if config.gaze.source == GazeSource::Eyes { "set gaze.source = \"auto\" and " } else { "" };
    format!(
        "for an eye tracker with a program of its own, {auto}let the program send OSC packets to {address}; for fixed foveation \
         without an eye tracker, set preset = \"fixed\", which sets gaze.source = \"centre\" and wide rings"
    )
}
