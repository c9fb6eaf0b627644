//! Creation and destruction of the application's action sets and actions.

use super::application::ApplicationInput;
use super::{below_of, gaze_action};
use crate::abi::guard;
use crate::xr::instance::{self, Instance};
use crate::xr::offer;
use openxr_sys as xr;
use std::sync::Arc;

/// The instance whose application made a set or an action; any, for a handle that nobody knows, so that the runtime returns its own error.
fn owner(is_its: impl Fn(&ApplicationInput) -> bool) -> Option<Arc<Instance>> {
    let known = instance::find_hooked(|instance| is_its(&instance.actions.application()));
    known.or_else(instance::any_hooked)
}

/// `xrCreateActionSet`: the application will attach the set later.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_action_set(
    handle: xr::Instance,
    info: *const xr::ActionSetCreateInfo,
    action_set: *mut xr::ActionSet,
) -> xr::Result {
    let Some((known, next)) = below_of(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.create_action_set)(handle, info, action_set) };
    guard("xrCreateActionSet", below, |answer| {
        if let Some(known) = &known {
            known.actions.application().note_input();
        }
        let result = answer.record(below());
        if let (true, Some(known)) = (result.into_raw() >= 0, &known) {
            // SAFETY: the call succeeded, so both pointers are valid.
            let (set, priority) = unsafe { (*action_set, (*info).priority) };
            known.actions.application().note_set(set, priority);
            if let Some(offer) = &known.offer {
                offer.input().note_set(set, priority);
            }
        }
        result
    })
}

/// `xrCreateAction`: the set of an action decides the priority of ours.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_action(
    set: xr::ActionSet,
    info: *const xr::ActionCreateInfo,
    action: *mut xr::Action,
) -> xr::Result {
    let Some(known) = owner(|input| input.has_set(set)) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments, or our copy of one.
    let below = |info| unsafe { (known.next.create_action)(set, info, action) };
    guard(
        "xrCreateAction",
        || below(info),
        |answer| {
            // SAFETY: valid usage: `info` is valid.
            if known.has_own_eye_gaze() && unsafe { names_eyes(&known, info) } {
                return answer.record(xr::Result::ERROR_PATH_UNSUPPORTED);
            }
            // SAFETY: as above.
            let without_eyes = unsafe { offer::strip_eyes(&known, info) };
            let result = answer.record(match &without_eyes {
                None => below(info),
                Some(paths) => below(&xr::ActionCreateInfo {
                    count_subaction_paths: paths.len() as u32,
                    subaction_paths: paths.as_ptr(),
                    // SAFETY: it was read.
                    ..unsafe { *info }
                }),
            });
            if result.into_raw() >= 0 {
                // SAFETY: the call succeeded: `info` is valid, and `action` points to the new handle.
                let (action, info) = unsafe { (*action, &*info) };
                known.actions.application().note_action(action, set);
                if let Some(offer) = &known.offer {
                    offer.note_action(action, set, info, without_eyes.is_some());
                }
            }
            result
        },
    )
}

/// `xrDestroyActionSet`: the layer suggests its actions no longer.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_action_set(set: xr::ActionSet) -> xr::Result {
    let Some(known) = owner(|input| input.has_set(set)) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own argument.
    let below = || unsafe { (known.next.destroy_action_set)(set) };
    guard("xrDestroyActionSet", below, |answer| {
        known.actions.application().forget_set(set);
        if let Some(offer) = &known.offer {
            offer.input().forget_set(set);
        }
        answer.record(below())
    })
}

/// `xrDestroyAction`: the layer suggests it no longer.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_action(action: xr::Action) -> xr::Result {
    let Some(known) = owner(|input| input.has_action(action)) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument.
    let below = || unsafe { (known.next.destroy_action)(action) };
    guard("xrDestroyAction", below, |answer| {
        known.actions.application().forget_action(action);
        if let Some(offer) = &known.offer {
            offer.input().forget_action(action);
        }
        answer.record(below())
    })
}

/// Whether the eyes are among the subaction paths of an action that is to be made.
///
/// # Safety
///
/// `info` is null or valid.
unsafe fn names_eyes(instance: &Instance, info: *const xr::ActionCreateInfo) -> bool {
    // SAFETY: `info` is null or valid, as `# Safety` demands, with an array of that many paths.
    let paths = unsafe {
        let info = info.as_ref().filter(|info| !info.subaction_paths.is_null());
        info.map(|info| std::slice::from_raw_parts(info.subaction_paths, info.count_subaction_paths as usize))
    };
    let eyes = || gaze_action::eyes(&instance.next, instance.handle).ok();
    paths.is_some_and(|paths| !paths.is_empty() && eyes().is_some_and(|eyes| paths.contains(&eyes)))
}
