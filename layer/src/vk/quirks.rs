//! The quirks of a device, from the table that `parafovea doctor` prints too.

use crate::abi::Enablement;
use crate::status::{Topic, decided};
use ash::vk;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::quirks::{Driver, Effect, Quirks};

/// The quirks of a device, as `PARAFOVEA_QUIRKS` adds and removes them.
pub fn of_device(properties: &vk::PhysicalDeviceProperties, driver_id: Option<vk::DriverId>) -> Quirks {
    let environment = Environment::of_process(Enablement::of_process() == Enablement::Elevated);
    let version = properties.driver_version;
    let driver = Driver {
        id: driver_id.map_or(0, |id| id.as_raw().cast_unsigned()),
        device: &properties.device_name_as_c_str().unwrap_or_default().to_string_lossy(),
        version: [
            vk::api_version_major(version),
            vk::api_version_minor(version),
            vk::api_version_patch(version),
        ],
    };
    Quirks::of(&driver, &environment.quirks())
}

/// Logs the quirks of a device that was created for an application with this engine.
pub fn log(quirks: &Quirks, engine: &str) {
    if let Some(complaint) = quirks.complaint() {
        tracing::warn!("{complaint}");
    }
    for quirk in &quirks.rows {
        match quirk.effect {
            Effect::WarnVkd3d if !is_vkd3d(engine) => {}
            Effect::WarnVkd3d => {
                decided(Topic::Quirk, &format_args!("quirk {}: {}", quirk.name, quirk.source));
                tracing::warn!(
                    "vkd3d-proton may flicker on this GPU ({}); if it does, set rates.backend = \"off\"",
                    quirk.source
                );
            }
            _ => {
                decided(Topic::Quirk, &format_args!("quirk {}: {} ({})", quirk.name, quirk.doc, quirk.source))
            }
        }
    }
}

/// Whether an application of this engine may return images before it has submitted the draws to them: Direct3D's, by way of Proton. There,
/// versions of wineopenxr flush and lock DXVK's queue in xrEndFrame only.
pub fn submits_late(engine: &str) -> bool {
    engine == "DXVK" || is_vkd3d(engine)
}

/// vkd3d and vkd3d-proton name themselves so (libs/vkd3d/device.c, vkd3d_init_instance).
fn is_vkd3d(engine: &str) -> bool {
    engine.contains("vkd3d")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn translated_applications_submit_late() {
        assert_eq!(["DXVK", "vkd3d", "vkd3d-proton"].map(submits_late), [true; 3]);
        assert_eq!(["", "Unity", "godot", "UnrealEngine5", "parafovea-scene"].map(submits_late), [false; 5]);
    }
}
