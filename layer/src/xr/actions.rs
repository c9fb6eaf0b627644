//! Eye gaze through `XR_EXT_eye_gaze_interaction`, for an application that does not use it.
//!
//! The layer adds an action set of its own: first in the application's `xrAttachSessionActionSets` (a SteamVR bug keeps only the last set
//! usable, which must be the application's), and in each of its `xrSyncActions`. An application without any input gets ours attached and
//! synchronised after `gaze.attach_alone_after_s`. The application sees its own input, and events, as it would without us.

mod application;
mod events;
mod gaze_action;
mod instance_state;
mod profiles;
mod session_state;
mod sets;

pub use events::poll_event;
pub use gaze_action::paths as gaze_paths;
pub use instance_state::{Headset, InstanceActions};
pub use session_state::SessionActions;
pub use sets::{create_action, create_action_set, destroy_action, destroy_action_set};

use super::dispatch::Next;
use super::instance::{self, Instance, next_of_any};
use super::{offer, session};
use crate::abi::guard;
use application::Suggested;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ffi::c_char;
use std::sync::Arc;

/// An instance, if it is known, and the functions below it.
fn below_of(handle: xr::Instance) -> Option<(Option<Arc<Instance>>, Next)> {
    let known = instance::hooked(handle);
    let next = known.as_ref().map(|known| known.next).or_else(next_of_any)?;
    Some((known, next))
}

/// `xrStringToPath`: a sign that the application will create action sets.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn string_to_path(
    handle: xr::Instance,
    text: *const c_char,
    path: *mut xr::Path,
) -> xr::Result {
    let Some((known, next)) = below_of(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.string_to_path)(handle, text, path) };
    guard("xrStringToPath", below, |answer| {
        if let Some(known) = &known {
            known.actions.application().note_input();
        }
        answer.record(below())
    })
}

/// `xrSuggestInteractionProfileBindings`: the application's suggestion for eye gaze is remembered, because
/// our suggestion will take its place. Without the extension, which is on because of us, it gets no such profile.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn suggest_bindings(
    handle: xr::Instance,
    suggestion: *const xr::InteractionProfileSuggestedBinding,
) -> xr::Result {
    let Some((known, next)) = below_of(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.suggest_interaction_profile_bindings)(handle, suggestion) };
    guard("xrSuggestInteractionProfileBindings", below, |answer| {
        let Some(known) = &known else { return answer.record(below()) };
        known.actions.application().note_input();
        // SAFETY: valid usage: `suggestion` is valid.
        let asked = unsafe { suggestion.as_ref() };
        let is_gaze = |asked: &xr::InteractionProfileSuggestedBinding| {
            gaze_action::profile(&known.next, known.handle) == Ok(asked.interaction_profile)
        };
        if known.has_own_eye_gaze() && asked.is_some_and(is_gaze) {
            return answer.record(xr::Result::ERROR_PATH_UNSUPPORTED);
        }
        // SAFETY: valid usage: the suggestion is valid.
        if let Some(result) = asked.and_then(|asked| unsafe { offer::suggest(known, asked) }) {
            return answer.record(result);
        }
        let result = answer.record(below());
        if let (xr::Result::SUCCESS, Some(asked)) = (result, asked) {
            // SAFETY: the call succeeded, so the suggestion is valid.
            unsafe { offer::note_suggestion(known, asked) };
            // SAFETY: as above.
            let suggested = unsafe { Suggested::read(known, asked) };
            known.actions.application().note_suggestion(suggested);
        }
        result
    })
}

/// `xrAttachSessionActionSets`: with ours, first. If that fails, the application's call is made unchanged, so that the application gets the
/// runtime's own result.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn attach(
    handle: xr::Session,
    info: *const xr::SessionActionSetsAttachInfo,
) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument, or our copy of it.
    let below = |info| unsafe { (next.attach_session_action_sets)(handle, info) };
    guard(
        "xrAttachSessionActionSets",
        || below(info),
        |answer| {
            // SAFETY: valid usage: `info` is valid.
            let asked = unsafe { info.as_ref() }
                .filter(|info| info.count_action_sets > 0 && !info.action_sets.is_null());
            let ours = known.as_ref().and_then(|known| {
                Some((known, known.actions.prepare(known, &known.instance.config.snapshot())?))
            });
            let (Some(asked), Some((known, gaze))) = (asked, ours) else {
                let result = answer.record(below(info));
                if let Some(known) = &known {
                    known.actions.attached_without(known, result);
                    if let (true, Some(asked)) = (result.into_raw() >= 0, asked) {
                        // SAFETY: the call succeeded, so the structure is valid.
                        unsafe { offer::note_attached(known, asked) };
                    }
                }
                return result;
            };
            let mut sets = vec![gaze.set];
            // SAFETY: valid usage: an array of that many handles.
            sets.extend_from_slice(unsafe {
                std::slice::from_raw_parts(asked.action_sets, asked.count_action_sets as usize)
            });
            let merged = xr::SessionActionSetsAttachInfo {
                count_action_sets: sets.len() as u32,
                action_sets: sets.as_ptr(),
                ..*asked
            };
            let result = below(&merged);
            if result.into_raw() >= 0 {
                answer.record(result);
                known.actions.attached_with_application(known, gaze);
                return result;
            }
            let own = answer.record(below(info));
            tracing::info!(
                "no eye tracker: xrAttachSessionActionSets returned {result:?} with the action set of the layer, and {own:?} without it"
            );
            known.actions.attached_without(known, own);
            own
        },
    )
}

/// `xrSyncActions`: with ours. If that fails before it has ever succeeded, as for [`attach`]; later it is the application's
/// mistake, which the runtime is to see once. A call without any set passes unchanged if the runtime keeps the gaze.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn sync(handle: xr::Session, info: *const xr::ActionsSyncInfo) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument, or our copy of it.
    let below = |info| unsafe { (next.sync_actions)(handle, info) };
    guard(
        "xrSyncActions",
        || below(info),
        |answer| {
            // SAFETY: valid usage: `info` is valid.
            let asked = unsafe { info.as_ref() };
            let ours = known.as_ref().and_then(|known| Some((known, known.actions.attached()?)));
            let (Some(asked), Some((known, gaze))) = (asked, ours) else {
                return answer.record(match (asked, &known) {
                    // SAFETY: valid usage: the structure is valid.
                    (Some(asked), Some(known)) => unsafe { offer::synchronise(known, asked, below) },
                    _ => below(info),
                });
            };
            known.actions.application_synchronises();
            if asked.count_active_action_sets == 0 && known.actions.may_sync_nothing() {
                let result = answer.record(below(info));
                if result != xr::Result::SUCCESS || known.actions.keeps_gaze(known, gaze) {
                    if result == xr::Result::SUCCESS {
                        known.actions.profiles.show(known);
                    }
                    return result;
                }
            }
            let mut active: SmallVec<[xr::ActiveActionSet; 16]> = SmallVec::new();
            if !asked.active_action_sets.is_null() {
                // SAFETY: valid usage: an array of that many structures.
                active.extend_from_slice(unsafe {
                    std::slice::from_raw_parts(
                        asked.active_action_sets,
                        asked.count_active_action_sets as usize,
                    )
                });
            }
            active.push(gaze.active());
            let merged = xr::ActionsSyncInfo {
                count_active_action_sets: active.len() as u32,
                active_action_sets: active.as_ptr(),
                ..*asked
            };
            let result = below(&merged);
            if result.into_raw() >= 0 || known.actions.has_synchronised_ours() {
                answer.record(result);
                known.actions.synchronised_ours(result);
                if result == xr::Result::SUCCESS {
                    known.actions.profiles.show(known);
                }
                return result;
            }
            let own = answer.record(below(info));
            if own.into_raw() >= 0 {
                tracing::warn!("eye tracker off: xrSyncActions with its action set returned {result:?}");
                known.actions.give_up(known);
            }
            own
        },
    )
}

/// `xrGetCurrentInteractionProfile`: no profile if there would be none without us.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get_current_profile(
    handle: xr::Session,
    user: xr::Path,
    profile: *mut xr::InteractionProfileState,
) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.get_current_interaction_profile)(handle, user, profile) };
    guard("xrGetCurrentInteractionProfile", below, |answer| {
        if let Some(current) = known.as_ref().and_then(|known| offer::current_profile(known, user)) {
            // SAFETY: valid usage: the structure is null or valid.
            return answer.record(match (current, unsafe { profile.as_mut() }) {
                (Err(error), _) => error,
                (Ok(path), Some(profile)) if profile.ty == xr::InteractionProfileState::TYPE => {
                    profile.interaction_profile = path;
                    xr::Result::SUCCESS
                }
                (Ok(_), _) => xr::Result::ERROR_VALIDATION_FAILURE,
            });
        }
        let hides_eyes = known.as_ref().filter(|known| known.instance.has_own_eye_gaze());
        if hides_eyes.is_some_and(|known| gaze_action::eyes(&next, known.instance.handle) == Ok(user)) {
            return answer.record(xr::Result::ERROR_PATH_UNSUPPORTED);
        }
        let result = answer.record(below());
        let (true, Some(known)) = (result.into_raw() >= 0, &known) else { return result };
        // SAFETY: the call succeeded, so the structure is valid.
        let answered = unsafe { &mut (*profile).interaction_profile };
        match known.actions.profiles.answer(*answered) {
            Ok(path) => {
                *answered = path;
                result
            }
            Err(error) => answer.record(error),
        }
    })
}
