//! An application that does not enable the extension.

use super::{Calls, EYES, Outcome};
use crate::app::App;
use crate::cases::stereo::Stereo;
use crate::controls::{GAZE_POSE, LEFT_SELECT, SIMPLE};
use crate::session::{Layer, Session};
use openxr_sys as xr;
use std::ptr::null_mut;

/// No part of the extension is available, with or without eye gaze in the system. Sections: XR_EXT_eye_gaze_interaction, "Device enumeration"
/// (the property is of the extension); Input, "Creating Actions", "Suggested Bindings", "Current Interaction Profile" (paths of extensions
/// that are not enabled are not supported).
pub fn conforms_without_eye_gaze(app: &App) -> Outcome {
    let calls = Calls::new(app);
    let mut gaze = xr::SystemEyeGazeInteractionPropertiesEXT {
        ty: xr::SystemEyeGazeInteractionPropertiesEXT::TYPE,
        next: null_mut(),
        supports_eye_gaze_interaction: xr::FALSE,
    };
    let mut properties = xr::SystemProperties::out((&raw mut gaze).cast());
    let get = app.xr.functions.get_system_properties;
    // SAFETY: the instance is live; the structures outlive the call.
    let result = unsafe { get(app.xr.instance, app.xr.system, properties.as_mut_ptr()) };
    calls.expect("System Properties", "with a structure that is not known", result, xr::Result::SUCCESS);
    let supports: bool = gaze.supports_eye_gaze_interaction.into();
    calls.check("Device enumeration", "the system has eye gaze", supports, false);

    let set = calls.controls.set(0)?;
    let look = calls.controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
    let button = calls.controls.action(set, xr::ActionType::BOOLEAN_INPUT, &[])?;
    let (eyes, unsupported) = (calls.path(EYES)?, xr::Result::ERROR_PATH_UNSUPPORTED);
    let result = calls.suggest(&[(look, calls.path(GAZE_POSE)?)])?;
    calls.expect("Suggested Bindings", "of the profile of eye gaze", result, unsupported);
    let result = calls.create_action(set, c"of_eyes", &[eyes]);
    calls.expect("Creating Actions", "of the eyes", result, unsupported);
    let result = calls.create_action(set, c"of_both", &[calls.path("/user/hand/left")?, eyes]);
    calls.expect("Creating Actions", "of hand and eyes", result, unsupported);
    calls.controls.suggest(SIMPLE, &[(button, LEFT_SELECT)])?;
    let session = Session::start(app)?;
    calls.expect("Action Sets", "attach", calls.attach(session.handle, &[set]), xr::Result::SUCCESS);
    let stereo = Stereo::create(&session)?;
    session.frames(20, |frame| {
        if frame.index == 0 {
            stereo.paint(0)?;
        }
        calls.sync(session.handle, &[set]);
        let (result, is_active) = calls.pose(session.handle, look, xr::Path::NULL);
        calls.expect("Reading Input Action State", "a pose", result, xr::Result::SUCCESS);
        calls.check("Reading Input Action State", "without a source", is_active, false);
        let (result, _) = calls.profile(session.handle, eyes);
        calls.expect("Current Interaction Profile", "of the eyes", result, unsupported);
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    let (_, count, _) = calls.sources(session.handle, look, 0);
    calls.check("Bound Sources", "of an action without bindings", count, 0);
    drop(stereo);
    session.finish()
}
