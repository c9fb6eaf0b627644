//! Applications with actions of their own, and without any.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::failure::{Failure, name, succeeded};
use crate::functions::characters;
use crate::session::{Frame, IDENTITY, Layer, Session};
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::CStr;
use std::ptr::{null, null_mut};

/// Frames of an application whose gaze a layer may come to read only after a while.
const LONG: u32 = 130;

/// An action set with one action.
struct Actions<'s> {
    session: &'s Session<'s>,
    set: xr::ActionSet,
    action: xr::Action,
}

/// No action set, no sync: a player of films.
pub fn no_actions(app: &App) -> Outcome {
    let session = Session::start(app)?;
    let stereo = Stereo::create(&session)?;
    session.frames(LONG, |frame| {
        stereo.paint(frame.index)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    drop(stereo);
    session.finish()
}

/// A button of the simple controller.
pub fn own_actions(app: &App) -> Outcome {
    button(app, 1)
}

/// The same, with a picture that is drawn once and submitted again and again.
pub fn own_actions_and_resubmission(app: &App) -> Outcome {
    button(app, FRAMES)
}

fn button(app: &App, frames_a_picture: u32) -> Outcome {
    let session = Session::create(app)?;
    let actions = Actions::attach(
        &session,
        xr::ActionType::BOOLEAN_INPUT,
        c"/interaction_profiles/khr/simple_controller",
        c"/user/hand/left/input/select/click",
    )?;
    session.begin()?;
    let stereo = Stereo::create(&session)?;
    let mut states = Vec::new();
    session.frames(FRAMES, |frame| {
        let synced = actions.sync()?;
        let state = actions.boolean()?;
        states.push(format!(
            "{} active {} down {} changed {}",
            name(synced),
            state.is_active,
            state.current_state,
            state.changed_since_last_sync,
        ));
        if frame.index % frames_a_picture == 0 {
            stereo.paint(frame.index)?;
        }
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    app.report().note("select", states.join("; "));
    drop(stereo);
    session.finish()
}

/// The application looks at the gaze itself: XR_EXT_eye_gaze_interaction.
pub fn own_eye_gaze(app: &App) -> Outcome {
    let session = Session::create(app)?;
    let actions = Actions::attach(
        &session,
        xr::ActionType::POSE_INPUT,
        c"/interaction_profiles/ext/eye_gaze_interaction",
        c"/user/eyes_ext/input/gaze_ext/pose",
    )?;
    let gaze = actions.space()?;
    session.begin()?;
    let stereo = Stereo::create(&session)?;
    let mut seen = Vec::new();
    session.frames(FRAMES, |frame| {
        let synced = actions.sync()?;
        let active = actions.pose_is_active()?;
        let location = locate(&session, gaze, frame)?;
        let xr::Quaternionf { x, y, z, w } = location.pose.orientation;
        seen.push(format!(
            "{} active {active} flags {:?} at {x:.4} {y:.4} {z:.4} {w:.4}",
            name(synced),
            location.location_flags,
        ));
        stereo.paint(frame.index)?;
        session.submit(frame, &[Layer::Projection(stereo.images())])
    })?;
    app.report().note("gaze", seen.join("; "));
    drop(stereo);
    session.finish()
}

impl<'s> Actions<'s> {
    /// Makes the action, suggests its binding, and attaches the set.
    fn attach(
        session: &'s Session<'s>,
        action_type: xr::ActionType,
        profile: &CStr,
        binding: &CStr,
    ) -> Result<Self, Failure> {
        let xr = &session.app.xr;
        let set_info = xr::ActionSetCreateInfo {
            ty: xr::ActionSetCreateInfo::TYPE,
            next: null(),
            action_set_name: characters(c"case"),
            localized_action_set_name: characters(c"Case"),
            priority: 0,
        };
        let mut set = xr::ActionSet::NULL;
        // SAFETY: the instance is live; the structures outlive the call.
        let result = unsafe { (xr.functions.create_action_set)(xr.instance, &set_info, &mut set) };
        succeeded("xrCreateActionSet", result)?;
        let action_info = xr::ActionCreateInfo {
            ty: xr::ActionCreateInfo::TYPE,
            next: null(),
            action_name: characters(c"input"),
            action_type,
            count_subaction_paths: 0,
            subaction_paths: null(),
            localized_action_name: characters(c"Input"),
        };
        let mut action = xr::Action::NULL;
        // SAFETY: the action set is live; the structures outlive the call.
        let result = unsafe { (xr.functions.create_action)(set, &action_info, &mut action) };
        succeeded("xrCreateAction", result)?;
        let bindings = [xr::ActionSuggestedBinding { action, binding: xr.path(binding)? }];
        let suggestion = xr::InteractionProfileSuggestedBinding {
            ty: xr::InteractionProfileSuggestedBinding::TYPE,
            next: null(),
            interaction_profile: xr.path(profile)?,
            count_suggested_bindings: 1,
            suggested_bindings: bindings.as_ptr(),
        };
        // SAFETY: the instance and the action are live; the structures outlive the call.
        let result = unsafe { (xr.functions.suggest_bindings)(xr.instance, &suggestion) };
        session.app.expect("suggest bindings", result, xr::Result::SUCCESS);
        let attach = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: null(),
            count_action_sets: 1,
            action_sets: &set,
        };
        // SAFETY: the session and the action set are live; the structure outlives the call.
        let result = unsafe { (xr.functions.attach_action_sets)(session.handle, &attach) };
        session.app.expect("attach action sets", result, xr::Result::SUCCESS);
        // SAFETY: as above.
        let result = unsafe { (xr.functions.attach_action_sets)(session.handle, &attach) };
        session.app.expect(
            "attach action sets, the second time",
            result,
            xr::Result::ERROR_ACTIONSETS_ALREADY_ATTACHED,
        );
        Ok(Self { session, set, action })
    }

    /// xrSyncActions: XR_SUCCESS, or XR_SESSION_NOT_FOCUSED.
    fn sync(&self) -> Result<xr::Result, Failure> {
        let active = xr::ActiveActionSet { action_set: self.set, subaction_path: xr::Path::NULL };
        let info = xr::ActionsSyncInfo {
            ty: xr::ActionsSyncInfo::TYPE,
            next: null(),
            count_active_action_sets: 1,
            active_action_sets: &active,
        };
        let sync = self.session.app.xr.functions.sync_actions;
        // SAFETY: the session and the action set are live; the structures outlive the call.
        let result = unsafe { sync(self.session.handle, &info) };
        succeeded("xrSyncActions", result)
    }

    fn get_info(&self) -> xr::ActionStateGetInfo {
        xr::ActionStateGetInfo {
            ty: xr::ActionStateGetInfo::TYPE,
            next: null(),
            action: self.action,
            subaction_path: xr::Path::NULL,
        }
    }

    fn boolean(&self) -> Result<xr::ActionStateBoolean, Failure> {
        let mut state = xr::ActionStateBoolean::out(null_mut());
        let get = self.session.app.xr.functions.get_boolean;
        // SAFETY: the session and the action are live; the structures outlive the call.
        let result = unsafe { get(self.session.handle, &self.get_info(), state.as_mut_ptr()) };
        succeeded("xrGetActionStateBoolean", result)?;
        // SAFETY: the call succeeded, so it filled the structure.
        Ok(unsafe { state.assume_init() })
    }

    fn pose_is_active(&self) -> Result<bool, Failure> {
        let mut state = xr::ActionStatePose::out(null_mut());
        let get = self.session.app.xr.functions.get_pose;
        // SAFETY: as above.
        let result = unsafe { get(self.session.handle, &self.get_info(), state.as_mut_ptr()) };
        succeeded("xrGetActionStatePose", result)?;
        // SAFETY: the call succeeded, so it filled the structure.
        Ok(unsafe { state.assume_init() }.is_active.into())
    }

    fn space(&self) -> Result<xr::Space, Failure> {
        let info = xr::ActionSpaceCreateInfo {
            ty: xr::ActionSpaceCreateInfo::TYPE,
            next: null(),
            action: self.action,
            subaction_path: xr::Path::NULL,
            pose_in_action_space: IDENTITY,
        };
        let mut space = xr::Space::NULL;
        let create = self.session.app.xr.functions.create_action_space;
        // SAFETY: the session and the action are live; the structures outlive the call.
        let result = unsafe { create(self.session.handle, &info, &mut space) };
        succeeded("xrCreateActionSpace", result)?;
        Ok(space)
    }
}

fn locate(session: &Session, space: xr::Space, frame: &Frame) -> Result<xr::SpaceLocation, Failure> {
    let mut location = xr::SpaceLocation::out(null_mut());
    let locate = session.app.xr.functions.locate_space;
    // SAFETY: both spaces are live and the output outlives the call.
    let result = unsafe { locate(space, session.space, frame.display_time, location.as_mut_ptr()) };
    succeeded("xrLocateSpace", result)?;
    // SAFETY: the call succeeded, so it filled the structure.
    Ok(unsafe { location.assume_init() })
}
