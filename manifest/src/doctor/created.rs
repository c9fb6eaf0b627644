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
    match (&probed.created, &probed.created_without_layer) {
        (Ok(devices), without) => {
            // A driver may have several devices of one name: their order tells them apart.
            let without = without.as_deref().unwrap_or(&[]);
            let find = |index: usize, name: &str| without.get(index).filter(|device| device.name == name);
            devices
                .iter()
                .enumerate()
                .map(|(index, device)| of_device(device, find(index, &device.name)))
                .collect()
        }
        (Err(reason), Ok(_)) => vec![crashes(reason)],
        (Err(reason), Err(_)) => vec![no_device(
            format!("a program that creates Vulkan devices failed, also without the layer: {reason}"),
            "Games that use Vulkan fail on this machine, with and without Parafovea.",
        )],
    }
}

/// The program that creates devices ended otherwise than by an answer.
fn crashes(reason: &str) -> Finding {
    Finding::problem(
        "crashes",
        format!("a program that creates Vulkan devices with the layer failed: {reason}"),
        "The same program works without the layer. Games would fail, too.",
    )
    .advise("play without PARAFOVEA=1, and report this with the output of parafovea doctor --json")
}

/// A fault without the layer, too.
fn no_device(found: String, means: &str) -> Finding {
    Finding::warning("device-refused", found, means)
        .advise("update or reinstall the driver of the GPU; with several GPUs, check that the game uses the right one")
}

/// A device that was created with the layer, or was not, and the same one without the layer, if that is known.
fn of_device(device: &CreatedDevice, without: Option<&CreatedDevice>) -> Finding {
    let CreatedDevice { name, failure, has_layer } = device;
    match failure {
        Some(failure) if without.is_none_or(|without| without.failure.is_none()) => Finding::problem(
            "no-device-with-layer",
            format!("{name}: no device can be created with the layer: {failure}"),
            match without {
                Some(_) => {
                    "Without the layer, a device can be created. Games that use this GPU do not start with Parafovea."
                }
                None => "Games that use this GPU do not start with Parafovea. Without the layer, the result is not known.",
            },
        )
        .advise("play without PARAFOVEA=1, and report this with the output of parafovea doctor --json"),
        Some(failure) => no_device(
            format!("{name}: no device can be created, with or without the layer: {failure}"),
            "Games that use this GPU do not start, with or without Parafovea.",
        ),
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
