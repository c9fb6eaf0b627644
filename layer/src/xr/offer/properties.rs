//! `xrGetSystemProperties`: whether the system has eye gaze, for an application that asked for the extension and for others.

use crate::abi::{guard, pnext};
use crate::xr::gaze::Offered;
use crate::xr::instance::{self, next_of_any};
use openxr_sys as xr;

/// `xrGetSystemProperties`: the system has eye gaze if the user offers it. An application that did not ask for the extension gets its
/// structure back unchanged.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn get_system_properties(
    handle: xr::Instance,
    system: xr::SystemId,
    properties: *mut xr::SystemProperties,
) -> xr::Result {
    let known = instance::hooked(handle);
    let Some(next) = known.as_ref().map(|known| known.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.get_system_properties)(handle, system, properties) };
    guard("xrGetSystemProperties", below, |answer| {
        let concerned = known.as_ref().filter(|known| known.offer.is_some() || known.has_own_eye_gaze());
        let Some(known) = concerned.filter(|_| !properties.is_null()) else {
            return answer.record(below());
        };
        // SAFETY: valid usage: the structure and its chain are valid, and the application lets no other code use them.
        let gaze = unsafe {
            pnext::unlink::<xr::SystemEyeGazeInteractionPropertiesEXT>(&raw mut (*properties).next)
        };
        let Some(mut gaze) = gaze else { return answer.record(below()) };
        let Some(offer) = &known.offer else { return answer.record(below()) };
        let is_offered = Offered::of(&known.config.snapshot()).is_some();
        if offer.is_known_below {
            // Back in its chain.
            drop(gaze);
            let result = answer.record(below());
            if result.into_raw() >= 0 && is_offered {
                // SAFETY: as above.
                let gaze = unsafe { pnext::unlink(&raw mut (*properties).next) };
                if let Some(mut gaze) = gaze {
                    let gaze: &mut xr::SystemEyeGazeInteractionPropertiesEXT = gaze.get();
                    gaze.supports_eye_gaze_interaction = xr::TRUE;
                }
            }
            return result;
        }
        let result = answer.record(below());
        if result.into_raw() >= 0 {
            gaze.get().supports_eye_gaze_interaction = is_offered.into();
        }
        result
    })
}
