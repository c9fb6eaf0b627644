//! Vulkan devices that are created with the layer, in a program of ours.

use super::layers::Layers;
use super::{CreatedDevice, Finding, Surroundings};
use crate::json::Half;

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let probed = &surroundings.probed;
    // If Vulkan fails without the layer too, or our half is not installed, another finding reports it.
    let (Ok(_), true) = (&probed.vulkan, layers.ours(Half::Vulkan).next().is_some()) else {
        return Vec::new();
    };
    match &probed.created {
        Err(reason) => vec![crashes(reason)],
        Ok(devices) => devices.iter().map(of_device).collect(),
    }
}

/// The program that creates devices ended otherwise than by an answer.
fn crashes(reason: &str) -> Finding {
    Finding::problem(
        "crashes",
        format!("a program that creates Vulkan devices with the layer fails: {reason}"),
        "The same program works without the layer. Games would crash, too.",
    )
    .advise("play without PARAFOVEA=1, and report this with the output of parafovea doctor --json")
}

fn of_device(device: &CreatedDevice) -> Finding {
    let CreatedDevice { name, failure, has_layer } = device;
    match failure {
        Some(failure) => Finding::problem(
            "no-device-with-layer",
            format!("{name}: no device can be created with the layer: {failure}"),
            "Games that use this GPU do not start with Parafovea.",
        )
        .advise("play without PARAFOVEA=1, and report this with the output of parafovea doctor --json"),
        None if *has_layer => {
            Finding::good("device-created", format!("{name}: a device was created with the layer"))
        }
        None => Finding::problem(
            "not-on-device",
            format!("{name}: a device was created with the layer enabled, but without the layer on it"),
            "Games get only the other half, which has no effect alone.",
        )
        .advise("to see the reason: VK_LOADER_DEBUG=layer parafovea run -- GAME; then: parafovea install"),
    }
}
