//! Suggestions, and states of actions.

use super::Offer;
use crate::abi::copies::slice;
use crate::abi::guard;
use crate::xr::instance::{Instance, any_offering};
use crate::xr::session::{self, Session};
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;
use std::sync::Arc;

/// The instance of a session with its offer, or any with one, so that the runtime returns its own error.
pub(super) fn offering(session: Option<&Arc<Session>>) -> Option<Arc<Instance>> {
    let of_session = session.map(|session| Arc::clone(&session.instance));
    of_session.filter(|instance| instance.offer.is_some()).or_else(any_offering)
}

/// An action's subaction paths without the eyes' path, which the runtime does not know; `None` if it may get the structure unchanged.
///
/// # Safety
///
/// `info` is null or valid.
pub unsafe fn strip_eyes(instance: &Instance, info: *const xr::ActionCreateInfo) -> Option<Vec<xr::Path>> {
    let offer = instance.offer.as_ref().filter(|offer| !offer.is_known_below)?;
    // SAFETY: `info` is null or valid, as `# Safety` demands, with an array of that many paths.
    let paths = unsafe {
        let info = info.as_ref().filter(|info| !info.subaction_paths.is_null())?;
        std::slice::from_raw_parts(info.subaction_paths, info.count_subaction_paths as usize)
    };
    let is_eyes = |path: &&xr::Path| **path == offer.paths.eyes;
    // The runtime is to see a path that is there twice, which is an error.
    let has_eyes = paths.iter().filter(is_eyes).count() == 1;
    has_eyes.then(|| paths.iter().filter(|path| !is_eyes(path)).copied().collect())
}

/// Takes the application's suggestion for the profile of eye gaze where the runtime has no such profile; `None` for all others.
///
/// # Safety
///
/// `suggestion` is valid.
pub unsafe fn suggest(
    instance: &Instance,
    suggestion: &xr::InteractionProfileSuggestedBinding,
) -> Option<xr::Result> {
    let offer = instance.offer.as_ref().filter(|offer| !offer.is_known_below)?;
    if suggestion.interaction_profile != offer.paths.profile {
        return None;
    }
    if suggestion.ty != xr::InteractionProfileSuggestedBinding::TYPE {
        return Some(xr::Result::ERROR_VALIDATION_FAILURE);
    }
    // SAFETY: as `# Safety` demands.
    let bindings = unsafe { bindings(suggestion) };
    if let Some(error) = bindings.iter().find_map(|binding| path_error(instance, binding.binding)) {
        return Some(error);
    }
    let taken = offer.input().suggest(&offer.paths, bindings);
    Some(taken.err().unwrap_or(xr::Result::SUCCESS))
}

/// The runtime's error for a path that it never gave; `None` for others.
fn path_error(instance: &Instance, path: xr::Path) -> Option<xr::Result> {
    let mut length = 0;
    // SAFETY: the next layer's function, a live instance, a place for the length and no room for the text.
    let result =
        unsafe { (instance.next.path_to_string)(instance.handle, path, 0, &mut length, ptr::null_mut()) };
    (result.into_raw() < 0).then_some(result)
}

/// Takes note of a suggestion that the runtime accepted.
///
/// # Safety
///
/// `suggestion` is valid.
pub unsafe fn note_suggestion(instance: &Instance, suggestion: &xr::InteractionProfileSuggestedBinding) {
    let Some(offer) = &instance.offer else { return };
    // SAFETY: as `# Safety` demands.
    let bindings = unsafe { bindings(suggestion) };
    if suggestion.interaction_profile == offer.paths.profile {
        // The runtime's own rules held already.
        let _ = offer.input().suggest(&offer.paths, bindings);
    } else {
        offer.input().note_others(bindings);
    }
}

/// # Safety
///
/// `suggestion` is valid.
unsafe fn bindings(suggestion: &xr::InteractionProfileSuggestedBinding) -> &[xr::ActionSuggestedBinding] {
    // SAFETY: valid usage, as `# Safety` demands: an array of that many bindings.
    unsafe { slice(suggestion.suggested_bindings, suggestion.count_suggested_bindings) }
}

/// Takes note of action sets that were attached.
///
/// # Safety
///
/// `info` is valid.
pub unsafe fn note_attached(session: &Session, info: &xr::SessionActionSetsAttachInfo) {
    let Some(offer) = &session.instance.offer else { return };
    // SAFETY: `info` is valid, as `# Safety` demands: an array of that many sets.
    let sets = unsafe { std::slice::from_raw_parts(info.action_sets, info.count_action_sets as usize) };
    let gazes = offer.input().attach(sets);
    if let Some(offered) = &session.offer {
        offered.attached(gazes);
    }
}

/// Makes the application's `xrSyncActions` with `below`, and decides which actions have the gaze from then on.
///
/// # Safety
///
/// `info` is valid.
pub unsafe fn synchronise(
    session: &Session,
    info: &xr::ActionsSyncInfo,
    below: impl Fn(*const xr::ActionsSyncInfo) -> xr::Result,
) -> xr::Result {
    let Some(offer) = &session.instance.offer else { return below(info) };
    let sets: &[xr::ActiveActionSet] = match info.active_action_sets.is_null() {
        true => &[],
        // SAFETY: `info` is valid, as `# Safety` demands: an array of that many structures.
        false => unsafe {
            std::slice::from_raw_parts(info.active_action_sets, info.count_active_action_sets as usize)
        },
    };
    let is_of_eyes = |set: &xr::ActiveActionSet| set.subaction_path == offer.paths.eyes;
    let result = if !offer.is_known_below && sets.iter().any(is_of_eyes) {
        let others: SmallVec<[xr::ActiveActionSet; 16]> =
            sets.iter().copied().filter(|set| !is_of_eyes(set)).collect();
        below(&xr::ActionsSyncInfo {
            count_active_action_sets: others.len() as u32,
            active_action_sets: others.as_ptr(),
            ..*info
        })
    } else {
        below(info)
    };
    if let (true, Some(offered)) = (result.into_raw() >= 0, &session.offer) {
        let has_gaze = session.gaze.has_gaze_for_application(&session.instance.config.snapshot());
        let is_driven = |action| is_driven_below(session, offer, action);
        offered.synchronised(sets, &offer.paths, (result == xr::Result::SUCCESS, has_gaze), is_driven);
    }
    result
}

/// Whether a source of the runtime's drives a pose action.
fn is_driven_below(session: &Session, offer: &Offer, action: xr::Action) -> bool {
    let info = xr::ActionStateGetInfo {
        ty: xr::ActionStateGetInfo::TYPE,
        next: ptr::null(),
        action,
        subaction_path: xr::Path::NULL,
    };
    let mut state =
        xr::ActionStatePose { ty: xr::ActionStatePose::TYPE, next: ptr::null_mut(), is_active: xr::FALSE };
    // SAFETY: the next layer's function, a live session and valid structures. An action that is destroyed by now is an error, which counts as
    // false.
    let result = unsafe { (offer.next.get_action_state_pose)(session.handle, &info, &mut state) };
    result.into_raw() >= 0 && state.is_active.into()
}

/// The current profile of the eyes; `None` for another user path, or if the runtime knows it. The errors are the runtime's for a path that it
/// knows.
pub fn current_profile(session: &Session, user: xr::Path) -> Option<Result<xr::Path, xr::Result>> {
    let (offer, offered) = session.offered().filter(|(offer, _)| offer.paths.eyes == user)?;
    let current = if offered.is_current() { offer.paths.profile } else { xr::Path::NULL };
    Some(attachment_error(session, offer).map_or(Ok(current), Err))
}

/// The runtime's error for a session without action sets or with another fault; `None` if there is none.
pub(super) fn attachment_error(session: &Session, offer: &Offer) -> Option<xr::Result> {
    let mut other = xr::InteractionProfileState {
        ty: xr::InteractionProfileState::TYPE,
        next: ptr::null_mut(),
        interaction_profile: xr::Path::NULL,
    };
    // SAFETY: the next layer's function, a live session and a valid structure to write to.
    let result = unsafe {
        let get = session.instance.next.get_current_interaction_profile;
        get(session.handle, offer.paths.left_hand, &mut other)
    };
    (result.into_raw() < 0).then_some(result)
}

/// Takes note of an event that the application gets.
///
/// # Safety
///
/// The runtime wrote it.
pub unsafe fn note_event(event: &xr::EventDataBuffer) {
    match event.ty {
        xr::EventDataSessionStateChanged::TYPE => {
            // SAFETY: the type identifies the structure at the start of the buffer; the buffer is larger and as aligned.
            let changed = unsafe { &*ptr::from_ref(event).cast::<xr::EventDataSessionStateChanged>() };
            let known = session::find(changed.session);
            if let Some(offered) = known.as_ref().and_then(|known| known.offer.as_ref()) {
                offered.has_focus(changed.state == xr::SessionState::FOCUSED);
            }
        }
        xr::EventDataInteractionProfileChanged::TYPE => {
            // SAFETY: as above.
            let changed = unsafe { &*ptr::from_ref(event).cast::<xr::EventDataInteractionProfileChanged>() };
            let known = session::find(changed.session);
            if let Some(offered) = known.as_ref().and_then(|known| known.offer.as_ref()) {
                // One event reports all profiles.
                offered.take_owed();
            }
        }
        _ => {}
    }
}

impl Offer {
    /// An action of `set` was made; `had_eyes`: the path of the eyes was stripped.
    pub fn note_action(
        &self,
        action: xr::Action,
        set: xr::ActionSet,
        info: &xr::ActionCreateInfo,
        had_eyes: bool,
    ) {
        let paths = match info.subaction_paths.is_null() {
            true => &[][..],
            // SAFETY: the runtime took the structure, so it is valid: an array of that many paths.
            false => unsafe {
                std::slice::from_raw_parts(info.subaction_paths, info.count_subaction_paths as usize)
            },
        };
        let has_eyes = had_eyes || paths.contains(&self.paths.eyes);
        self.input().note_action(action, set, info.action_type, has_eyes);
    }

    /// The subaction path that the runtime gets for one of an action's: none for the eyes, which it does not know.
    pub(super) fn subaction_below(&self, action: xr::Action, subaction: xr::Path) -> xr::Path {
        let is_ours = !self.is_known_below && subaction == self.paths.eyes && self.input().has_eyes(action);
        if is_ours { xr::Path::NULL } else { subaction }
    }
}

/// `xrGetActionStatePose`: active where the gaze drives the action.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get_action_state_pose(
    handle: xr::Session,
    info: *const xr::ActionStateGetInfo,
    state: *mut xr::ActionStatePose,
) -> xr::Result {
    let known = session::find(handle);
    let Some(instance) = offering(known.as_ref()) else { return xr::Result::ERROR_HANDLE_INVALID };
    let Some(offer) = &instance.offer else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments, or our copy of one.
    let below = |info| unsafe { (offer.next.get_action_state_pose)(handle, info, state) };
    guard(
        "xrGetActionStatePose",
        || below(info),
        |answer| {
            // SAFETY: valid usage: `info` is valid.
            let Some(asked) = (unsafe { info.as_ref() }) else { return answer.record(below(info)) };
            let subaction_path = offer.subaction_below(asked.action, asked.subaction_path);
            let result = answer.record(below(&xr::ActionStateGetInfo { subaction_path, ..*asked }));
            let offered = known.as_ref().and_then(|known| known.offer.as_ref());
            if let (true, Some(offered)) = (result.into_raw() >= 0, offered)
                && offered.follows(asked.action, asked.subaction_path, &offer.paths)
            {
                // SAFETY: the call succeeded, so the structure is valid.
                unsafe { (*state).is_active = offered.is_active(asked.action).into() };
            }
            result
        },
    )
}
