//! Sources of actions, and their names.

use super::hooks::{attachment_error, offering};
use crate::abi::guard;
use crate::xr::session;
use openxr_sys as xr;
use std::ffi::{CStr, c_char};
use std::ptr;

/// Name of the gaze as a source; user path and component can be left out, but nothing else names it.
const NAME: &CStr = c"Eye gaze";

/// The flags of all components: user path, interaction profile and component.
const ALL_COMPONENTS: u64 = 7;

/// `xrEnumerateBoundSourcesForAction`: with the gaze.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn enumerate_bound_sources(
    handle: xr::Session,
    info: *const xr::BoundSourcesForActionEnumerateInfo,
    capacity: u32,
    count: *mut u32,
    sources: *mut xr::Path,
) -> xr::Result {
    let known = session::find(handle);
    let Some(instance) = offering(known.as_ref()) else { return xr::Result::ERROR_HANDLE_INVALID };
    let Some(offer) = &instance.offer else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (offer.next.enumerate_bound_sources)(handle, info, capacity, count, sources) };
    guard("xrEnumerateBoundSourcesForAction", below, |answer| {
        // SAFETY: valid usage: `info` is valid.
        let action = unsafe { info.as_ref() }.map(|info| info.action);
        let offered = known.as_ref().and_then(|known| known.offer.as_ref());
        let is_bound = offered.is_some_and(|offered| {
            offered.is_current() && action.is_some_and(|action| offered.is_bound(action))
        });
        if !is_bound || count.is_null() {
            return answer.record(below());
        }
        let mut others = 0;
        // SAFETY: the next layer's function with the application's own arguments, and a place for the count.
        let result =
            unsafe { (offer.next.enumerate_bound_sources)(handle, info, 0, &mut others, ptr::null_mut()) };
        if result.into_raw() < 0 {
            return answer.record(result);
        }
        let mut all = vec![xr::Path::NULL; others as usize];
        if others > 0 {
            // SAFETY: as above, with an array of that many paths.
            let result = unsafe {
                (offer.next.enumerate_bound_sources)(handle, info, others, &mut others, all.as_mut_ptr())
            };
            if result.into_raw() < 0 {
                return answer.record(result);
            }
            all.truncate(others as usize);
        }
        if !all.contains(&offer.paths.pose) {
            all.push(offer.paths.pose);
        }
        // SAFETY: valid usage: the application's array has room for `capacity` paths.
        answer.record(unsafe { fill(&all, capacity, count, sources) })
    })
}

/// `xrGetInputSourceLocalizedName`: also of the gaze, where the runtime does not know it.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get_localized_name(
    handle: xr::Session,
    info: *const xr::InputSourceLocalizedNameGetInfo,
    capacity: u32,
    count: *mut u32,
    buffer: *mut c_char,
) -> xr::Result {
    let known = session::find(handle);
    let Some(instance) = offering(known.as_ref()) else { return xr::Result::ERROR_HANDLE_INVALID };
    let Some(offer) = &instance.offer else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (offer.next.get_localized_name)(handle, info, capacity, count, buffer) };
    guard("xrGetInputSourceLocalizedName", below, |answer| {
        let session = known.as_ref().filter(|known| known.offer.is_some() && !offer.is_known_below);
        // SAFETY: valid usage: `info` is valid.
        let asked = unsafe { info.as_ref() }.filter(|info| {
            info.ty == xr::InputSourceLocalizedNameGetInfo::TYPE && info.source_path == offer.paths.pose
        });
        let (Some(session), Some(asked), false) = (session, asked, count.is_null()) else {
            return answer.record(below());
        };
        if let Some(error) = attachment_error(session, offer) {
            return answer.record(error);
        }
        if !(1..=ALL_COMPONENTS).contains(&asked.which_components.into_raw()) {
            return answer.record(xr::Result::ERROR_VALIDATION_FAILURE);
        }
        let name: Vec<c_char> = NAME.to_bytes_with_nul().iter().map(|&byte| byte as c_char).collect();
        // SAFETY: valid usage: the application's buffer has room for `capacity` characters.
        answer.record(unsafe { fill(&name, capacity, count, buffer) })
    })
}

/// Fills an application's array, by the rules of OpenXR ("Buffer Size Parameters").
///
/// # Safety
///
/// `count` is valid; `to` has room for `capacity` items.
unsafe fn fill<T: Copy>(items: &[T], capacity: u32, count: *mut u32, to: *mut T) -> xr::Result {
    // SAFETY: as `# Safety` demands.
    unsafe { *count = items.len() as u32 };
    if capacity == 0 {
        return xr::Result::SUCCESS;
    }
    if (capacity as usize) < items.len() {
        return xr::Result::ERROR_SIZE_INSUFFICIENT;
    }
    if to.is_null() {
        return xr::Result::ERROR_VALIDATION_FAILURE;
    }
    // SAFETY: as `# Safety` demands; the two do not overlap, for `items` are ours.
    unsafe { ptr::copy_nonoverlapping(items.as_ptr(), to, items.len()) };
    xr::Result::SUCCESS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_is_filled_only_if_it_has_room() {
        let (mut count, mut to) = (0, [0; 3]);
        // SAFETY: an array of three numbers, or none of no room.
        let mut filled = |capacity, to: *mut i32| unsafe { (fill(&[7, 8], capacity, &mut count, to), count) };
        assert_eq!(filled(0, ptr::null_mut()), (xr::Result::SUCCESS, 2));
        assert_eq!(filled(1, to.as_mut_ptr()), (xr::Result::ERROR_SIZE_INSUFFICIENT, 2));
        assert_eq!(filled(3, ptr::null_mut()), (xr::Result::ERROR_VALIDATION_FAILURE, 2));
        assert_eq!(filled(3, to.as_mut_ptr()), (xr::Result::SUCCESS, 2));
        assert_eq!(to, [7, 8, 0]);
    }
}
