//! The answers of the OpenXR loader and the active runtime.

use openxr::sys;
use openxr::{ApplicationInfo, Entry, ExtensionSet, FormFactor, Instance, SystemId, Version};
use parafovea_manifest::doctor::RuntimeAnswer;
use std::mem::zeroed;

const EYE_GAZE: &str = "XR_EXT_eye_gaze_interaction";

/// Names of the API layers that the loader lists: implicit ones where they are enabled, and explicit ones.
pub fn layers() -> Result<Vec<String>, String> {
    let layers =
        entry()?.enumerate_layers().map_err(|error| format!("xrEnumerateApiLayerProperties: {error}"))?;
    Ok(layers.into_iter().map(|layer| layer.layer_name).collect())
}

/// The runtime, its extensions and its headset.
pub fn answer() -> Result<RuntimeAnswer, String> {
    let entry = entry()?;
    let mut answer = RuntimeAnswer::default();
    // Any failure from here on is an answer of the runtime.
    if let Err(failure) = ask(&entry, &mut answer) {
        answer.failure = failure;
    }
    Ok(answer)
}

fn entry() -> Result<Entry, String> {
    // SAFETY: the system's OpenXR loader is one.
    unsafe { Entry::load(&()) }.map_err(|error| format!("the OpenXR loader cannot be loaded: {error}"))
}

fn ask(entry: &Entry, answer: &mut RuntimeAnswer) -> Result<(), String> {
    let offered = entry
        .enumerate_extensions()
        .map_err(|error| format!("xrEnumerateInstanceExtensionProperties: {error}"))?;
    let name = |name: &[u8]| String::from_utf8_lossy(name.strip_suffix(b"\0").unwrap_or(name)).into_owned();
    answer.extensions = offered.names().into_iter().map(name).collect();

    let mut wanted = ExtensionSet::default();
    wanted.ext_eye_gaze_interaction = offered.ext_eye_gaze_interaction;
    let application = ApplicationInfo {
        application_name: "parafovea-probe",
        application_version: 1,
        engine_name: "",
        engine_version: 0,
        api_version: Version::new(1, 0, 0),
    };
    let instance = entry
        .create_instance(&application, &wanted, &[], &())
        .map_err(|error| format!("xrCreateInstance: {error}"))?;
    let runtime = instance.properties().map_err(|error| format!("xrGetInstanceProperties: {error}"))?;
    answer.name = runtime.runtime_name;
    let version = runtime.runtime_version;
    answer.version = [version.major().into(), version.minor().into(), version.patch()];

    let system =
        instance.system(FormFactor::HEAD_MOUNTED_DISPLAY).map_err(|error| format!("xrGetSystem: {error}"))?;
    let (name, tracks_eyes) = headset(&instance, system)?;
    answer.system = Some(name);
    answer.tracks_eyes =
        answer.extensions.iter().any(|extension| extension == EYE_GAZE).then_some(tracks_eyes);
    Ok(())
}

/// The headset's name, and whether it tracks eyes: that is only said where the extension is enabled.
fn headset(instance: &Instance, system: SystemId) -> Result<(String, bool), String> {
    // SAFETY: structures of C, without references: all zero is a value of theirs, and the types are set.
    let (mut gaze, mut properties) = unsafe {
        (
            sys::SystemEyeGazeInteractionPropertiesEXT {
                ty: sys::SystemEyeGazeInteractionPropertiesEXT::TYPE,
                ..zeroed()
            },
            sys::SystemProperties { ty: sys::SystemProperties::TYPE, ..zeroed() },
        )
    };
    properties.next = (&raw mut gaze).cast();
    // SAFETY: a live instance, a system of it, and a chain of two structures that live during the call; a runtime
    // without the extension skips the second.
    let result = unsafe { (instance.fp().get_system_properties)(instance.as_raw(), system, &mut properties) };
    if result.into_raw() < 0 {
        return Err(format!("xrGetSystemProperties: {result}"));
    }
    let name: Vec<u8> =
        properties.system_name.iter().map(|&byte| byte as u8).take_while(|&byte| byte != 0).collect();
    Ok((String::from_utf8_lossy(&name).into_owned(), gaze.supports_eye_gaze_interaction == sys::TRUE))
}
