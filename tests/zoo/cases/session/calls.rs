//! The calls that begin sessions, with their results.

use super::IDENTITY;
use crate::app::App;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ptr::{from_ref, null};

/// xrCreateSession on the application's device.
pub fn create_session(app: &App) -> (xr::Result, xr::Session) {
    let binding = app.vulkan.binding();
    let info = xr::SessionCreateInfo {
        ty: xr::SessionCreateInfo::TYPE,
        next: from_ref(&binding).cast(),
        create_flags: xr::SessionCreateFlags::EMPTY,
        system_id: app.xr.system,
    };
    let mut handle = xr::Session::NULL;
    // SAFETY: the instance and the device of the binding are live; the structures outlive the call.
    let result = unsafe { (app.xr.functions.create_session)(app.xr.instance, &info, &mut handle) };
    (result, handle)
}

/// xrCreateReferenceSpace of the LOCAL space of a live session.
pub fn create_local_space(app: &App, session: xr::Session) -> (xr::Result, xr::Space) {
    let info = xr::ReferenceSpaceCreateInfo {
        ty: xr::ReferenceSpaceCreateInfo::TYPE,
        next: null(),
        reference_space_type: xr::ReferenceSpaceType::LOCAL,
        pose_in_reference_space: IDENTITY,
    };
    let mut space = xr::Space::NULL;
    // SAFETY: the structure outlives the call; the runtime refuses handles that are not live.
    let result = unsafe { (app.xr.functions.create_reference_space)(session, &info, &mut space) };
    (result, space)
}

/// xrBeginSession with stereo views.
pub fn begin_session(app: &App, session: xr::Session) -> xr::Result {
    let info = xr::SessionBeginInfo {
        ty: xr::SessionBeginInfo::TYPE,
        next: null(),
        primary_view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
    };
    // SAFETY: the structure outlives the call; the runtime refuses handles that are not live.
    unsafe { (app.xr.functions.begin_session)(session, &info) }
}
