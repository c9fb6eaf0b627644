//! `xrGetInstanceProcAddr`: our hooks, and the next layer's functions for all else.

use super::{dispatch, instance, offer};
use crate::abi::guard;
use openxr_sys as xr;
use openxr_sys::pfn;
use std::ffi::{CStr, c_char};

/// `xrGetInstanceProcAddr`. A hook stands in only for a function that the next layer has.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get(
    handle: xr::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> xr::Result {
    let Some(known) = instance::find(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the caller's own arguments.
    let next = || unsafe { (known.next_get_instance_proc_addr)(handle, name, function) };
    guard("xrGetInstanceProcAddr", next, |answer| {
        let result = answer.record(next());
        if let (xr::Result::SUCCESS, Some(hooked)) = (result, &known.hooked) {
            // SAFETY: the call succeeded, so both pointers are valid (its valid usage).
            unsafe {
                let name = CStr::from_ptr(name);
                let offered = || hooked.offer.as_ref().and_then(|_| offer::hook(name));
                if let Some(hook) = dispatch::hook(name).or_else(offered) {
                    *function = Some(hook);
                }
            }
        }
        result
    })
}
