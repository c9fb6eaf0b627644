//! Faults of an installation: each finding has a meaning and an advice.
//!
//! Reads files and the variables that [`Surroundings`] hands in, and calls neither Vulkan nor OpenXR: their answers come
//! in as [`Probed`], from a program that asks them.

mod audio;
mod configuration;
mod containers;
mod created;
mod device;
mod finding;
mod flatpak;
mod gaze;
mod layers;
mod loaders;
mod log;
mod manifests;
mod order;
mod probed;
mod runtime;
mod surroundings;
mod variables;

pub use finding::{Finding, Fix, Severity};
pub use flatpak::installed_in_flatpak;
pub use manifests::{SYSTEM_DATA, installed_elsewhere, removal};
pub use probed::{ANSWER_PREFIX, CreatedDevice, Device, LoaderLayers, Probed, RuntimeAnswer, VulkanAnswer};
pub use surroundings::Surroundings;

use layers::Layers;

/// Looks at everything, in the order in which a frame would need it.
pub fn examine(surroundings: &Surroundings) -> Vec<Finding> {
    let layers = Layers::find(surroundings);
    let mut findings = manifests::examine(surroundings, &layers);
    findings.extend(variables::examine(surroundings));
    findings.extend(order::examine(surroundings, &layers));
    findings.extend(loaders::examine(surroundings));
    findings.extend(runtime::examine(surroundings));
    findings.extend(device::examine(surroundings, &layers));
    findings.extend(created::examine(surroundings, &layers));
    findings.extend(configuration::examine(surroundings));
    findings.extend(gaze::examine(surroundings, &layers));
    findings.extend(audio::examine(surroundings, &layers));
    findings.extend(log::examine(surroundings));
    findings.extend(containers::examine(surroundings, &layers));
    findings
}

#[cfg(test)]
mod tests;
