//! Statements of the specification about eye gaze, each checked by one call: the demands of Khronos' conformance suite on a runtime with
//! XR_EXT_eye_gaze_interaction, and its demands on input in general, for the profile of eye gaze. Each check names its section. The
//! statements are the specification's; the suite served as a list of checks (OpenXR-CTS, `test_XR_EXT_eye_gaze_interaction.cpp`,
//! `test_actions.cpp`, `test_xrGetSystemProperties.cpp`).

pub mod actions;
pub mod enumeration;
pub mod states;
pub mod without;

use super::Outcome;
use crate::app::App;
use crate::controls::{Controls, GAZE, GAZE_POSE};
use crate::failure::Failure;
use crate::session::IDENTITY;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ptr::{null, null_mut};

/// The user path of the eyes.
const EYES: &str = "/user/eyes_ext";

/// A handle and a path that no runtime gave.
const NOBODYS: u64 = 0x1234;

/// Calls about input with their results.
struct Calls<'a> {
    app: &'a App,
    controls: Controls<'a>,
}

impl<'a> Calls<'a> {
    fn new(app: &'a App) -> Self {
        Self { app, controls: Controls::new(app) }
    }

    /// Checks a result against the only one that the section allows.
    fn expect(&self, section: &str, what: &str, result: xr::Result, expected: xr::Result) {
        self.app.expect(&format!("{section}: {what}"), result, expected);
    }

    /// Checks any other statement of the section.
    fn check(&self, section: &str, what: &str, value: impl ToString, expected: impl ToString) {
        self.app.report().fact(&format!("{section}: {what}"), value, expected);
    }

    fn path(&self, text: &str) -> Result<xr::Path, Failure> {
        self.controls.path(text)
    }

    /// xrSuggestInteractionProfileBindings with a structure of type `ty`.
    fn suggest_as(
        &self,
        ty: xr::StructureType,
        profile: &str,
        bindings: &[(xr::Action, xr::Path)],
    ) -> Result<xr::Result, Failure> {
        let bindings: Vec<_> = bindings
            .iter()
            .map(|(action, binding)| xr::ActionSuggestedBinding { action: *action, binding: *binding })
            .collect();
        let suggestion = xr::InteractionProfileSuggestedBinding {
            ty,
            next: null(),
            interaction_profile: self.path(profile)?,
            count_suggested_bindings: bindings.len() as u32,
            suggested_bindings: bindings.as_ptr(),
        };
        let xr = &self.app.xr;
        // SAFETY: the instance is live and the structures outlive the call. The runtime has to detect errors in them.
        Ok(unsafe { (xr.functions.suggest_bindings)(xr.instance, &suggestion) })
    }

    /// The same for the profile of eye gaze.
    fn suggest(&self, bindings: &[(xr::Action, xr::Path)]) -> Result<xr::Result, Failure> {
        self.suggest_as(xr::InteractionProfileSuggestedBinding::TYPE, GAZE, bindings)
    }

    /// xrCreateAction of a pose with these subaction paths; `name` makes the action's name unique.
    fn create_action(&self, set: xr::ActionSet, name: &std::ffi::CStr, users: &[xr::Path]) -> xr::Result {
        let info = xr::ActionCreateInfo {
            ty: xr::ActionCreateInfo::TYPE,
            next: null(),
            action_name: crate::functions::characters(name),
            action_type: xr::ActionType::POSE_INPUT,
            count_subaction_paths: users.len() as u32,
            subaction_paths: users.as_ptr(),
            localized_action_name: crate::functions::characters(name),
        };
        let mut action = xr::Action::NULL;
        // SAFETY: the action set is live; the structures outlive the call.
        unsafe { (self.app.xr.functions.create_action)(set, &info, &mut action) }
    }

    /// xrCreateActionSpace.
    fn create_space(
        &self,
        session: xr::Session,
        (action, subaction_path): (xr::Action, xr::Path),
        pose_in_action_space: xr::Posef,
    ) -> (xr::Result, xr::Space) {
        let info = xr::ActionSpaceCreateInfo {
            ty: xr::ActionSpaceCreateInfo::TYPE,
            next: null(),
            action,
            subaction_path,
            pose_in_action_space,
        };
        let mut space = xr::Space::NULL;
        // SAFETY: the session is live; the structures outlive the call.
        let result = unsafe { (self.app.xr.functions.create_action_space)(session, &info, &mut space) };
        (result, space)
    }

    /// xrGetActionStatePose: the result, and whether the action is active.
    fn pose(&self, session: xr::Session, action: xr::Action, subaction_path: xr::Path) -> (xr::Result, bool) {
        let info =
            xr::ActionStateGetInfo { ty: xr::ActionStateGetInfo::TYPE, next: null(), action, subaction_path };
        let mut state =
            xr::ActionStatePose { ty: xr::ActionStatePose::TYPE, next: null_mut(), is_active: xr::FALSE };
        // SAFETY: the session is live; the structures outlive the call.
        let result = unsafe { (self.app.xr.functions.get_pose)(session, &info, &mut state) };
        (result, state.is_active.into())
    }

    /// xrGetCurrentInteractionProfile into a structure of type `ty`.
    fn profile_as(
        &self,
        ty: xr::StructureType,
        session: xr::Session,
        user: xr::Path,
    ) -> (xr::Result, xr::Path) {
        let mut state =
            xr::InteractionProfileState { ty, next: null_mut(), interaction_profile: xr::Path::NULL };
        // SAFETY: the session is live; the structure outlives the call.
        let result = unsafe { (self.app.xr.functions.get_current_profile)(session, user, &mut state) };
        (result, state.interaction_profile)
    }

    fn profile(&self, session: xr::Session, user: xr::Path) -> (xr::Result, xr::Path) {
        self.profile_as(xr::InteractionProfileState::TYPE, session, user)
    }

    /// xrEnumerateBoundSourcesForAction with room for so many: the result, the count and the sources.
    fn sources(
        &self,
        session: xr::Session,
        action: xr::Action,
        room: u32,
    ) -> (xr::Result, u32, Vec<xr::Path>) {
        let info = xr::BoundSourcesForActionEnumerateInfo {
            ty: xr::BoundSourcesForActionEnumerateInfo::TYPE,
            next: null(),
            action,
        };
        let (mut count, mut sources) = (0, vec![xr::Path::NULL; room as usize]);
        let enumerate = self.app.xr.functions.enumerate_bound_sources;
        // SAFETY: the session is live; the array has the capacity that is passed.
        let result = unsafe { enumerate(session, &info, room, &mut count, sources.as_mut_ptr()) };
        (result, count, sources)
    }

    /// xrGetInputSourceLocalizedName with room for so many characters: the result, the count and the characters.
    fn name_of(
        &self,
        session: xr::Session,
        source_path: xr::Path,
        parts: u64,
        room: u32,
    ) -> (xr::Result, u32, Vec<u8>) {
        let info = xr::InputSourceLocalizedNameGetInfo {
            ty: xr::InputSourceLocalizedNameGetInfo::TYPE,
            next: null(),
            source_path,
            which_components: xr::InputSourceLocalizedNameFlags::from_raw(parts),
        };
        let (mut count, mut text) = (0, vec![0u8; room as usize]);
        let get = self.app.xr.functions.get_localized_name;
        // SAFETY: the session is live; the array has the capacity that is passed.
        let result = unsafe { get(session, &info, room, &mut count, text.as_mut_ptr().cast()) };
        (result, count, text)
    }

    /// xrAttachSessionActionSets.
    fn attach(&self, session: xr::Session, sets: &[xr::ActionSet]) -> xr::Result {
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: null(),
            count_action_sets: sets.len() as u32,
            action_sets: sets.as_ptr(),
        };
        // SAFETY: the session and the action sets are live; the structure outlives the call.
        unsafe { (self.app.xr.functions.attach_action_sets)(session, &info) }
    }

    /// xrSyncActions of whole sets.
    fn sync(&self, session: xr::Session, sets: &[xr::ActionSet]) -> xr::Result {
        let active: Vec<_> = sets
            .iter()
            .map(|set| xr::ActiveActionSet { action_set: *set, subaction_path: xr::Path::NULL })
            .collect();
        crate::controls::sync(self.app, session, &active)
    }

    /// A pose action in a set of its own, bound to the gaze.
    fn gaze(&self) -> Result<(xr::ActionSet, xr::Action), Failure> {
        let set = self.controls.set(0)?;
        let action = self.controls.action(set, xr::ActionType::POSE_INPUT, &[])?;
        let result = self.suggest(&[(action, self.path(GAZE_POSE)?)])?;
        self.expect("Eye gaze input", "suggest the pose of the gaze", result, xr::Result::SUCCESS);
        Ok((set, action))
    }
}

/// Pose at `offset` from `pose`, in the space of `pose`.
fn moved(pose: xr::Posef, offset: xr::Posef) -> xr::Posef {
    let quat = |q: xr::Quaternionf| glam::Quat::from_xyzw(q.x, q.y, q.z, q.w);
    let vec = |v: xr::Vector3f| glam::Vec3::new(v.x, v.y, v.z);
    let turn = quat(pose.orientation) * quat(offset.orientation);
    let place = vec(pose.position) + quat(pose.orientation) * vec(offset.position);
    xr::Posef {
        orientation: xr::Quaternionf { x: turn.x, y: turn.y, z: turn.z, w: turn.w },
        position: xr::Vector3f { x: place.x, y: place.y, z: place.z },
    }
}

/// Whether two poses are the same, up to rounding. An orientation has two quaternions.
fn is_same(a: xr::Posef, b: xr::Posef) -> bool {
    let quat = |q: xr::Quaternionf| glam::Quat::from_xyzw(q.x, q.y, q.z, q.w);
    let vec = |v: xr::Vector3f| glam::Vec3::new(v.x, v.y, v.z);
    let [a_turn, b_turn] = [a, b].map(|pose| quat(pose.orientation));
    a_turn.dot(b_turn).abs() > 0.999_999 && vec(a.position).abs_diff_eq(vec(b.position), 1e-4)
}

/// The origin of a space, a metre ahead of that of the action, turned to the left.
fn beside() -> xr::Posef {
    let turn = glam::Quat::from_rotation_y(0.7);
    xr::Posef {
        orientation: xr::Quaternionf { x: turn.x, y: turn.y, z: turn.z, w: turn.w },
        position: xr::Vector3f { x: 0.25, y: 0.0, z: -1.0 },
    }
}

/// No orientation at all.
fn malformed() -> xr::Posef {
    xr::Posef { orientation: xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 0.0 }, ..IDENTITY }
}
