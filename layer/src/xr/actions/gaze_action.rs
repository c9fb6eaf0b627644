//! Our action set, with one action: the pose of the gaze.

use crate::xr::dispatch::Next;
use crate::xr::offer::GazePaths;
use openxr_sys as xr;
use std::ffi::{CStr, c_char};
use std::ptr;

/// Source: XR_EXT_eye_gaze_interaction, "Interaction Profile".
const PROFILE: &CStr = c"/interaction_profiles/ext/eye_gaze_interaction";
const GAZE_POSE: &CStr = c"/user/eyes_ext/input/gaze_ext/pose";
const EYES: &CStr = c"/user/eyes_ext";
const GAZE_SOURCE: &CStr = c"/user/eyes_ext/input/gaze_ext";

/// The action set with its action; both go with their instance.
#[derive(Debug, Clone, Copy)]
pub struct GazeAction {
    /// The action set.
    pub set: xr::ActionSet,
    /// Number of the application's newest suggestion for eye gaze when it was made, from 1; 0: none.
    pub suggestion: u32,
    action: xr::Action,
    binding: xr::Path,
    profile: xr::Path,
}

/// Wanted properties of an action set of the layer.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    /// Number within its instance, from 1: names are unique.
    pub number: u32,
    /// Priority of the application's set with the gaze: a lower one would lose the source to that set, a higher one would take it
    /// away. 0, the lowest, without such a set.
    pub priority: u32,
    /// The application's suggestion for the profile of eye gaze: each suggestion replaces the one before.
    pub applications: Vec<xr::ActionSuggestedBinding>,
    /// [`GazeAction::suggestion`].
    pub suggestion: u32,
}

impl GazeAction {
    /// Makes the action set, and suggests its binding beside the application's.
    ///
    /// # Errors
    ///
    /// The step that failed, and its result.
    pub fn create(
        next: &Next,
        instance: xr::Instance,
        wanted: &Wanted,
    ) -> Result<Self, (&'static str, xr::Result)> {
        let made = Self::make(next, instance, wanted)
            .map_err(|result| ("creating the action set of the gaze", result))?;
        made.suggest(next, instance, &wanted.applications)
            .inspect_err(|_| destroy(next, made.set))
            .map_err(|result| ("suggesting the binding of the gaze", result))?;
        Ok(made)
    }

    fn make(next: &Next, instance: xr::Instance, wanted: &Wanted) -> Result<Self, xr::Result> {
        let profile = profile(next, instance)?;
        let binding = path(next, instance, GAZE_POSE)?;
        let (of_set, localized) = match wanted.number {
            0 | 1 => ("parafovea_gaze".to_owned(), "Parafovea: eye gaze".to_owned()),
            number => (format!("parafovea_gaze_{number}"), format!("Parafovea: eye gaze ({number})")),
        };
        let set_info = xr::ActionSetCreateInfo {
            ty: xr::ActionSetCreateInfo::TYPE,
            next: ptr::null(),
            action_set_name: name(&of_set),
            localized_action_set_name: name(&localized),
            priority: wanted.priority,
        };
        let mut set = xr::ActionSet::default();
        let mut action = xr::Action::default();
        // SAFETY: the next layer's functions, a live instance, valid structures and places for the handles.
        unsafe {
            succeeded((next.create_action_set)(instance, &set_info, &mut set))?;
            let action_info = xr::ActionCreateInfo {
                ty: xr::ActionCreateInfo::TYPE,
                next: ptr::null(),
                action_name: name("gaze"),
                action_type: xr::ActionType::POSE_INPUT,
                count_subaction_paths: 0,
                subaction_paths: ptr::null(),
                localized_action_name: name("Gaze"),
            };
            succeeded((next.create_action)(set, &action_info, &mut action))
                .inspect_err(|_| destroy(next, set))?;
        }
        Ok(Self { set, suggestion: wanted.suggestion, action, binding, profile })
    }

    fn suggest(
        &self,
        next: &Next,
        instance: xr::Instance,
        applications: &[xr::ActionSuggestedBinding],
    ) -> Result<(), xr::Result> {
        let mut bindings = applications.to_vec();
        bindings.push(xr::ActionSuggestedBinding { action: self.action, binding: self.binding });
        let suggestion = xr::InteractionProfileSuggestedBinding {
            ty: xr::InteractionProfileSuggestedBinding::TYPE,
            next: ptr::null(),
            interaction_profile: self.profile,
            count_suggested_bindings: bindings.len() as u32,
            suggested_bindings: bindings.as_ptr(),
        };
        // SAFETY: the next layer's function, a live instance and a valid structure.
        succeeded(unsafe { (next.suggest_interaction_profile_bindings)(instance, &suggestion) })
    }

    /// The space of the gaze: it looks along -z. The action set must be attached to the session: one runtime
    /// refuses spaces before that (peers: VDXR).
    ///
    /// # Errors
    ///
    /// The errors of `xrCreateActionSpace`.
    pub fn space(&self, next: &Next, session: xr::Session) -> Result<xr::Space, xr::Result> {
        let info = xr::ActionSpaceCreateInfo {
            ty: xr::ActionSpaceCreateInfo::TYPE,
            next: ptr::null(),
            action: self.action,
            subaction_path: xr::Path::NULL,
            pose_in_action_space: xr::Posef::IDENTITY,
        };
        let mut space = xr::Space::default();
        // SAFETY: the next layer's function, a live session, a valid structure and a place for the handle.
        succeeded(unsafe { (next.create_action_space)(session, &info, &mut space) })?;
        Ok(space)
    }

    /// Whether the runtime has a source for the gaze, by the newest synchronisation or, on some runtimes, without any.
    pub fn is_active(&self, next: &Next, session: xr::Session) -> bool {
        let info = xr::ActionStateGetInfo {
            ty: xr::ActionStateGetInfo::TYPE,
            next: ptr::null(),
            action: self.action,
            subaction_path: xr::Path::NULL,
        };
        let mut state = xr::ActionStatePose {
            ty: xr::ActionStatePose::TYPE,
            next: ptr::null_mut(),
            is_active: xr::FALSE,
        };
        // SAFETY: the next layer's function, a live session and valid structures.
        let result = unsafe { (next.get_action_state_pose)(session, &info, &mut state) };
        result.into_raw() >= 0 && state.is_active.into()
    }

    /// As it is synchronised.
    pub fn active(&self) -> xr::ActiveActionSet {
        xr::ActiveActionSet { action_set: self.set, subaction_path: xr::Path::NULL }
    }
}

fn destroy(next: &Next, set: xr::ActionSet) {
    // SAFETY: the next layer's function and an action set of ours, which nothing uses. Should it fail, the set
    // goes with its instance.
    let _ = unsafe { (next.destroy_action_set)(set) };
}

/// The path of the interaction profile.
///
/// # Errors
///
/// The errors of `xrStringToPath`.
pub fn profile(next: &Next, instance: xr::Instance) -> Result<xr::Path, xr::Result> {
    path(next, instance, PROFILE)
}

/// The path of the eyes, as a user path.
///
/// # Errors
///
/// The errors of `xrStringToPath`.
pub fn eyes(next: &Next, instance: xr::Instance) -> Result<xr::Path, xr::Result> {
    path(next, instance, EYES)
}

/// The paths of the extension.
///
/// # Errors
///
/// The errors of `xrStringToPath`.
pub fn paths(next: &Next, instance: xr::Instance) -> Result<GazePaths, xr::Result> {
    let path = |text| path(next, instance, text);
    Ok(GazePaths {
        profile: path(PROFILE)?,
        eyes: path(EYES)?,
        pose: path(GAZE_POSE)?,
        source: path(GAZE_SOURCE)?,
        left_hand: path(c"/user/hand/left")?,
    })
}

/// The path of a text.
///
/// # Errors
///
/// The errors of `xrStringToPath`.
pub fn path(next: &Next, instance: xr::Instance, text: &CStr) -> Result<xr::Path, xr::Result> {
    let mut path = xr::Path::NULL;
    // SAFETY: the next layer's function, a live instance, a C string and a place for the path.
    succeeded(unsafe { (next.string_to_path)(instance, text.as_ptr(), &mut path) })?;
    Ok(path)
}

fn name<const N: usize>(text: &str) -> [c_char; N] {
    let mut name = [0; N];
    for (to, from) in name.iter_mut().take(N - 1).zip(text.bytes()) {
        *to = from as c_char;
    }
    name
}

fn succeeded(result: xr::Result) -> Result<(), xr::Result> {
    if result.into_raw() < 0 { Err(result) } else { Ok(()) }
}
