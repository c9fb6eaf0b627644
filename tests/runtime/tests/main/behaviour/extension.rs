//! Other extensions, and structures that are none.

use super::SUCCESS;
use crate::application::{Application, ENABLE, V1_0, V1_1, call, structure};
use crate::case::Output;
use openxr_sys as xr;
use parafovea_mock_runtime::record::Line;
use std::ffi::c_void;
use std::sync::atomic::{AtomicU32, Ordering};

pub fn functions() {
    let (plain, with_mask) =
        (["xrGetVisibilityMaskKHR", "xrLocateSpaces", "xrNoSuchFunction"], ["XR_KHR_visibility_mask"]);
    let found = |app: Application| plain.map(|name| app.find(name).is_some());
    assert_eq!(found(Application::with_instance(V1_0, &[])), [false; 3]);
    assert_eq!(found(Application::with_instance(V1_0, &with_mask)), [true, false, false]);
    assert_eq!(found(Application::with_instance(V1_1, &[])), [false, true, false]);
}

pub fn visibility_mask() {
    let app = Application::ready_with(V1_0, &[ENABLE, "XR_KHR_visibility_mask"]);
    let (stereo, ty) =
        (xr::ViewConfigurationType::PRIMARY_STEREO, xr::VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH);
    let mut mask = structure!(VisibilityMaskKHR {});
    assert_eq!(call!(app, GetVisibilityMaskKHR(app.session, stereo, 0, ty, &mut mask)), SUCCESS);
    assert_eq!((mask.vertex_count_output, mask.index_count_output), (12, 12));
    let (mut vertices, mut indices) = ([xr::Vector2f::default(); 12], [u32::MAX; 12]);
    (mask.vertex_capacity_input, mask.vertices) = (12, vertices.as_mut_ptr());
    (mask.index_capacity_input, mask.indices) = (12, indices.as_mut_ptr());
    assert_eq!(call!(app, GetVisibilityMaskKHR(app.session, stereo, 0, ty, &mut mask)), SUCCESS);
    assert!(indices.iter().all(|&index| index < 12));
}

pub fn timespec() {
    let app = Application::with_instance(V1_0, &["XR_KHR_convert_timespec_time"]);
    let (mut time, mut back) = (xr::Time::from_nanos(0), libc::timespec { tv_sec: 0, tv_nsec: 0 });
    let timespec = libc::timespec { tv_sec: 3, tv_nsec: 5 };
    assert_eq!(call!(app, ConvertTimespecTimeToTimeKHR(app.instance, &timespec, &mut time)), SUCCESS);
    assert_eq!(time.as_nanos(), 3_000_000_005);
    assert_eq!(call!(app, ConvertTimeToTimespecTimeKHR(app.instance, time, &mut back)), SUCCESS);
    assert_eq!((back.tv_sec, back.tv_nsec), (3, 5));
}

pub fn unknown_structure() {
    let app = Application::ready();
    let list = structure!(VulkanSwapchainFormatListCreateInfoKHR {});
    let info = structure!(ViewLocateInfo { next: std::ptr::from_ref(&list).cast() });
    let info = structure!(SystemGetInfo {
        next: std::ptr::from_ref(&info).cast(),
        form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY,
    });
    assert_eq!(call!(app, GetSystem(app.instance, &info, &mut xr::SystemId::from_raw(0))), SUCCESS);
}

pub fn unknown_structure_recorded(output: &Output) {
    let warned = output
        .record
        .iter()
        .filter(|line| matches!(line, Line::Warning { call, .. } if call == "xrGetSystem"));
    assert_eq!(warned.count(), 2);
}

static HEARD: AtomicU32 = AtomicU32::new(0);

/// # Safety
/// As `PFN_xrDebugUtilsMessengerCallbackEXT`: `data` points to the message.
unsafe extern "system" fn hear(
    _: xr::DebugUtilsMessageSeverityFlagsEXT,
    _: xr::DebugUtilsMessageTypeFlagsEXT,
    data: *const xr::DebugUtilsMessengerCallbackDataEXT,
    user_data: *mut c_void,
) -> xr::Bool32 {
    // SAFETY: the runtime passes valid data, and the pointer that the messenger was made with.
    unsafe {
        assert_eq!(std::ffi::CStr::from_ptr((*data).function_name), c"xrPathToString");
        (*user_data.cast::<AtomicU32>()).fetch_add(1, Ordering::Relaxed);
    }
    xr::FALSE
}

pub fn messenger(app: &mut Application) -> xr::Result {
    let info = structure!(DebugUtilsMessengerCreateInfoEXT {
        message_severities: xr::DebugUtilsMessageSeverityFlagsEXT::ERROR,
        message_types: xr::DebugUtilsMessageTypeFlagsEXT::VALIDATION,
        user_callback: Some(hear),
        user_data: std::ptr::from_ref(&HEARD).cast_mut().cast(),
    });
    let mut messenger = xr::DebugUtilsMessengerEXT::default();
    assert_eq!(call!(app, CreateDebugUtilsMessengerEXT(app.instance, &info, &mut messenger)), SUCCESS);
    let mut count = 0;
    let result =
        call!(app, PathToString(app.instance, xr::Path::from_raw(99), 0, &mut count, std::ptr::null_mut()));
    assert_eq!(HEARD.load(Ordering::Relaxed), 1);
    result
}
