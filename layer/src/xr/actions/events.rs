//! `xrPollEvent`: the application's events, without the layer's own.

use super::below_of;
use crate::abi::guard;
use crate::xr::{offer, session};
use openxr_sys as xr;
use std::ptr;

/// Events that are taken out of a queue in one call at most; there cannot be more interaction profiles.
const EVENTS_AT_ONCE: usize = 16;

/// `xrPollEvent`: no event about interaction profiles that there only is because of us.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn poll_event(
    handle: xr::Instance,
    event: *mut xr::EventDataBuffer,
) -> xr::Result {
    let Some((_, next)) = below_of(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.poll_event)(handle, event) };
    guard("xrPollEvent", below, |answer| {
        for _ in 0..EVENTS_AT_ONCE {
            let result = below();
            if result == xr::Result::EVENT_UNAVAILABLE {
                // SAFETY: the call succeeded, so the buffer is valid.
                return answer.record(unsafe { owed_event(handle, event) }.unwrap_or(result));
            }
            // SAFETY: as above.
            if result != xr::Result::SUCCESS || !unsafe { is_ours(&*event) } {
                if result == xr::Result::SUCCESS {
                    // SAFETY: as above.
                    unsafe { offer::note_event(&*event) };
                }
                return answer.record(result);
            }
            // SAFETY: as above; an application must set these values before the call.
            unsafe {
                (*event).ty = xr::EventDataBuffer::TYPE;
                (*event).next = ptr::null();
            }
        }
        answer.record(xr::Result::EVENT_UNAVAILABLE)
    })
}

/// Whether the layer caused an event.
///
/// # Safety
///
/// The runtime wrote it.
unsafe fn is_ours(event: &xr::EventDataBuffer) -> bool {
    if event.ty != xr::EventDataInteractionProfileChanged::TYPE {
        return false;
    }
    // SAFETY: the type identifies the structure at the start of the buffer; the buffer is larger and as aligned.
    let changed = unsafe { &*ptr::from_ref(event).cast::<xr::EventDataInteractionProfileChanged>() };
    let known = session::find(changed.session);
    known
        .is_some_and(|known| known.actions.attached().is_some() && known.actions.profiles.hides_event(&known))
}

/// Writes an event that was kept back until now, if there is one.
///
/// # Safety
///
/// `event` is valid.
unsafe fn owed_event(handle: xr::Instance, event: *mut xr::EventDataBuffer) -> Option<xr::Result> {
    let session = session::owed_event(handle)?;
    let changed = xr::EventDataInteractionProfileChanged {
        ty: xr::EventDataInteractionProfileChanged::TYPE,
        next: ptr::null(),
        session,
    };
    // SAFETY: the buffer is valid, as `# Safety` demands: larger than every event, and as aligned.
    unsafe { event.cast::<xr::EventDataInteractionProfileChanged>().write(changed) };
    Some(xr::Result::SUCCESS)
}
