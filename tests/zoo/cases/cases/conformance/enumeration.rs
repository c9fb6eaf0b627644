//! The extension, its paths, and the properties of the system.

use super::{Calls, EYES, Outcome};
use crate::app::App;
use crate::controls::{GAZE, GAZE_POSE};
use crate::functions::{extension_function, look_up};
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

/// A structure of a type that no specification names.
#[repr(C)]
struct Unknown {
    ty: xr::StructureType,
    next: *mut c_void,
    content: [u64; 4],
}

/// Sections: Instance, "Extensions"; XR_EXT_eye_gaze_interaction, "Device enumeration"; Semantic Paths; System, "System Properties"; Fundamentals,
/// "Next Pointer Chains".
pub fn conforms_before_a_session(app: &App) -> Outcome {
    let calls = Calls::new(app);
    listed(&calls)?;
    for text in [EYES, GAZE_POSE, GAZE] {
        let (first, second) = (calls.path(text)?, calls.path(text)?);
        calls.check("Semantic Paths", "a path", first != xr::Path::NULL, true);
        calls.check("Semantic Paths", "the same path again", first == second, true);
        let (mut length, mut back) = (0, [0u8; 128]);
        let to_string = extension_function!(app.xr, PathToString)?;
        // SAFETY: the instance is live; the array has the capacity that is passed.
        let result = unsafe { to_string(app.xr.instance, first, 128, &mut length, back.as_mut_ptr().cast()) };
        calls.expect("Semantic Paths", "the text of a path", result, xr::Result::SUCCESS);
        let back = CStr::from_bytes_until_nul(&back).map(|text| text.to_string_lossy().into_owned());
        calls.check("Semantic Paths", "the text", back.unwrap_or_default(), text);
    }
    properties(&calls)
}

/// The extension is listed once, with a version.
fn listed(calls: &Calls) -> Outcome {
    let get = calls.app.xr.get_instance_proc_addr;
    let function = look_up(get, xr::Instance::NULL, "xrEnumerateInstanceExtensionProperties")?;
    // SAFETY: the loader returned the function of this name, which has this signature.
    let enumerate: xr::pfn::EnumerateInstanceExtensionProperties = unsafe { std::mem::transmute(function) };
    let blank = xr::ExtensionProperties {
        ty: xr::ExtensionProperties::TYPE,
        next: null_mut(),
        extension_name: [0; xr::MAX_EXTENSION_NAME_SIZE],
        extension_version: 0,
    };
    let (mut count, mut listed) = (0, vec![blank; 64]);
    // SAFETY: null stands for no layer; the array has the capacity that is passed.
    let result = unsafe { enumerate(null(), 64, &mut count, listed.as_mut_ptr()) };
    calls.expect("Extensions", "list extensions", result, xr::Result::SUCCESS);
    let is_it = |properties: &&xr::ExtensionProperties| {
        let name: Vec<u8> = properties.extension_name.iter().map(|&character| character as u8).collect();
        CStr::from_bytes_until_nul(&name) == Ok(c"XR_EXT_eye_gaze_interaction")
    };
    let found: Vec<_> = listed[..count as usize].iter().filter(is_it).collect();
    calls.check("Extensions", "how often it is listed", found.len(), 1);
    calls.check("Extensions", "its version", found.iter().all(|found| found.extension_version >= 1), true);
    Ok(())
}

fn properties(calls: &Calls) -> Outcome {
    let app = calls.app;
    let get = app.xr.functions.get_system_properties;
    for is_first in [true, false] {
        let mut unknown =
            Unknown { ty: xr::StructureType::from_raw(1_999_999_999), next: null_mut(), content: [7; 4] };
        let mut gaze = xr::SystemEyeGazeInteractionPropertiesEXT {
            ty: xr::SystemEyeGazeInteractionPropertiesEXT::TYPE,
            next: null_mut(),
            supports_eye_gaze_interaction: xr::FALSE,
        };
        let (of_gaze, of_unknown): (*mut c_void, *mut c_void) =
            ((&raw mut gaze).cast(), (&raw mut unknown).cast());
        let (first, second) = if is_first { (of_gaze, of_unknown) } else { (of_unknown, of_gaze) };
        // SAFETY: both are alive, and begin with a type and the next structure.
        unsafe { (*first.cast::<xr::BaseOutStructure>()).next = second.cast() };
        let mut properties = xr::SystemProperties::out(first.cast());
        // SAFETY: the instance is live; the structures outlive the call, which fills them where it succeeds.
        let (none, result, properties) = unsafe {
            let none = get(app.xr.instance, xr::SystemId::NULL, properties.as_mut_ptr());
            let result = get(app.xr.instance, app.xr.system, properties.as_mut_ptr());
            (none, result, properties.assume_init())
        };
        calls.expect("System Properties", "of no system", none, xr::Result::ERROR_SYSTEM_INVALID);
        calls.expect("System Properties", "of the system", result, xr::Result::SUCCESS);
        let supports: bool = gaze.supports_eye_gaze_interaction.into();
        calls.check("Device enumeration", "the system has eye gaze", supports, true);
        calls.check("System Properties", "the system", properties.system_id == app.xr.system, true);
        calls.check("System Properties", "has a name", properties.system_name[0] != 0, true);
        let limits = properties.graphics_properties;
        let has_layers = limits.max_layer_count as usize >= xr::MIN_COMPOSITION_LAYERS_SUPPORTED;
        calls.check("System Properties", "composition layers", has_layers, true);
        let has_size = limits.max_swapchain_image_width > 0 && limits.max_swapchain_image_height > 0;
        calls.check("System Properties", "sizes of images", has_size, true);
        let next = if is_first { (gaze.next, unknown.next) } else { (unknown.next, gaze.next) };
        let is_whole = properties.next == first && next == (second, null_mut());
        calls.check("Next Pointer Chains", "the chain is as it was", is_whole, true);
        calls.check("Next Pointer Chains", "what is unknown is not touched", unknown.content == [7; 4], true);
    }
    Ok(())
}
