//! Spaces of the application that rest in the world.

use crate::abi::{attempt, guard};
use crate::registry::Registry;
use crate::xr::instance::next_of_any;
use crate::xr::{offer, session};
use openxr_sys as xr;
use std::sync::Arc;

/// The session of each.
static RESTING: Registry<xr::Space, xr::Session> = Registry::new();

/// Whether a space of the application rests in the world. False for spaces of kinds that are not known.
pub fn rests(space: xr::Space) -> bool {
    RESTING.get(space).is_some()
}

/// Forgets the spaces of a session, before it is destroyed: they go with it.
pub fn forget_all_of(session: xr::Session) {
    RESTING.remove_where(|of| *of == session);
}

/// `xrCreateReferenceSpace`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_reference(
    handle: xr::Session,
    info: *const xr::ReferenceSpaceCreateInfo,
    space: *mut xr::Space,
) -> xr::Result {
    let Some((known, next)) = session::find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.create_reference_space)(handle, info, space) };
    guard("xrCreateReferenceSpace", below, |answer| {
        let result = answer.record(below());
        if result.into_raw() >= 0 && known.is_some_and(|known| known.active.is_some()) {
            // SAFETY: the call succeeded, so both pointers are valid.
            let (kind, space) = unsafe { ((*info).reference_space_type, *space) };
            match kind {
                xr::ReferenceSpaceType::LOCAL
                | xr::ReferenceSpaceType::LOCAL_FLOOR
                | xr::ReferenceSpaceType::STAGE => RESTING.insert(space, Arc::new(handle)),
                _ => {
                    RESTING.remove(space);
                }
            }
        }
        result
    })
}

/// `xrDestroySpace`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(space: xr::Space) -> xr::Result {
    let known = RESTING.get(space).and_then(|of| session::find(*of));
    let Some(next) = known.map(|known| known.instance.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument.
    let below = || unsafe { (next.destroy_space)(space) };
    let forget = || {
        drop(RESTING.remove(space));
        offer::forget_space(space);
    };
    let pass_through = || {
        attempt("xrDestroySpace", forget);
        below()
    };
    guard("xrDestroySpace", pass_through, |answer| {
        forget();
        answer.record(below())
    })
}
