//! Eye gaze through `XR_EXT_eye_gaze_interaction`, for an application that does not use it.
//!
//! An action set of ours rides along: first in the application's `xrAttachSessionActionSets` (a SteamVR bug keeps
//! only the last set usable, which must be the application's), and in each of its `xrSyncActions`. An
//! application without any action sets gets ours attached and synchronised after a grace period.

mod gaze_action;
mod instance_state;
mod session_state;

pub use instance_state::InstanceActions;
pub use session_state::SessionActions;

use super::instance::{self, next_of_any};
use super::session;
use crate::abi::guard;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;

/// `xrCreateActionSet`: an application that has one will attach it some day.
pub unsafe extern "system" fn create_action_set(
    handle: xr::Instance,
    info: *const xr::ActionSetCreateInfo,
    action_set: *mut xr::ActionSet,
) -> xr::Result {
    let known = instance::hooked(handle);
    let Some(next) = known.as_ref().map(|known| known.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.create_action_set)(handle, info, action_set) };
    guard("xrCreateActionSet", below, |answer| {
        if let Some(known) = &known {
            known.actions.note_action_set();
        }
        answer.record(below())
    })
}

/// `xrSuggestInteractionProfileBindings`: what the application suggests for eye gaze is remembered, because
/// our suggestion will take its place.
pub unsafe extern "system" fn suggest_bindings(
    handle: xr::Instance,
    suggestion: *const xr::InteractionProfileSuggestedBinding,
) -> xr::Result {
    let known = instance::hooked(handle);
    let Some(next) = known.as_ref().map(|known| known.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.suggest_interaction_profile_bindings)(handle, suggestion) };
    guard("xrSuggestInteractionProfileBindings", below, |answer| {
        let result = answer.record(below());
        if let (xr::Result::SUCCESS, Some(known)) = (result, &known) {
            // SAFETY: the call succeeded, so the suggestion is valid.
            unsafe { known.actions.note_suggestion(known, &*suggestion) };
        }
        result
    })
}

/// `xrAttachSessionActionSets`: with ours, first. If that fails, the call is made as the application made it,
/// so that the runtime's own result is what the application gets.
pub unsafe extern "system" fn attach(
    handle: xr::Session,
    info: *const xr::SessionActionSetsAttachInfo,
) -> xr::Result {
    let known = session::find(handle);
    let Some(next) = known.as_ref().map(|known| known.instance.next).or_else(next_of_any) else {
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
            let ours = known.as_ref().and_then(|known| Some((known, known.actions.prepare(known)?)));
            let (Some(asked), Some((known, gaze))) = (asked, ours) else { return answer.record(below(info)) };
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
            tracing::info!("no eye gaze: attaching our action set returned {result:?}, without it {own:?}");
            own
        },
    )
}

/// `xrSyncActions`: with ours. If that fails, as for [`attach`].
pub unsafe extern "system" fn sync(handle: xr::Session, info: *const xr::ActionsSyncInfo) -> xr::Result {
    let known = session::find(handle);
    let Some(next) = known.as_ref().map(|known| known.instance.next).or_else(next_of_any) else {
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
            let (Some(asked), Some((known, gaze))) = (asked, ours) else { return answer.record(below(info)) };
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
            if result.into_raw() >= 0 {
                return answer.record(result);
            }
            let own = answer.record(below(info));
            if own.into_raw() >= 0 {
                tracing::warn!("eye gaze is off: xrSyncActions with our action set returned {result:?}");
                known.actions.give_up();
            }
            own
        },
    )
}

/// Events that are taken out of a queue in one call at most; there cannot be more interaction profiles.
const EVENTS_AT_ONCE: usize = 16;

/// `xrPollEvent`: an application that has attached nothing gets no event about interaction profiles, which
/// there only is because we did.
pub unsafe extern "system" fn poll_event(
    handle: xr::Instance,
    event: *mut xr::EventDataBuffer,
) -> xr::Result {
    let known = instance::hooked(handle);
    let Some(next) = known.as_ref().map(|known| known.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.poll_event)(handle, event) };
    guard("xrPollEvent", below, |answer| {
        for _ in 0..EVENTS_AT_ONCE {
            let result = below();
            let is_ours = || {
                // SAFETY: the call succeeded, so the buffer is valid.
                let ty = unsafe { (*event).ty };
                ty == xr::StructureType::EVENT_DATA_INTERACTION_PROFILE_CHANGED
                    && session::any_of(handle, |session| session.actions.is_attached_alone())
            };
            if result != xr::Result::SUCCESS || !is_ours() {
                return answer.record(result);
            }
            // SAFETY: as above; what an application must set before the call.
            unsafe {
                (*event).ty = xr::EventDataBuffer::TYPE;
                (*event).next = ptr::null();
            }
        }
        answer.record(xr::Result::EVENT_UNAVAILABLE)
    })
}
