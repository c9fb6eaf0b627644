//! The hooks for a swapchain's images: of a virtual one, they are ours.

use super::ring::CallOrderInvalid;
use super::{Substitute, Swapchain, find};
use crate::abi::{attempt, guard};
use crate::xr::frame::{analyze_released, draw_over_released};
use crate::xr::session::Session;
use ash::vk;
use ash::vk::Handle;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::sync::Arc;

fn substitute_of(known: &Option<Arc<Swapchain>>) -> Option<&Substitute> {
    known.as_ref()?.substitute.as_ref()
}

/// `xrEnumerateSwapchainImages`: of a virtual swapchain, our images.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn enumerate_images(
    handle: xr::Swapchain,
    capacity: u32,
    count: *mut u32,
    images: *mut xr::SwapchainImageBaseHeader,
) -> xr::Result {
    let Some((known, next)) = find(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.enumerate_swapchain_images)(handle, capacity, count, images) };
    let virtual_one = || known.as_ref().and_then(|known| Some((known, known.substitute.as_ref()?)));
    // The rest of the hook after a panic: a virtual swapchain remains virtual.
    let pass_on = || match virtual_one() {
        // SAFETY: the application's own arguments.
        Some(ours) => unsafe { enumerate_ours(ours, capacity, count, images) },
        None => below(),
    };
    guard("xrEnumerateSwapchainImages", pass_on, |answer| {
        let Some(ours) = virtual_one() else {
            let result = answer.record(below());
            // With XR_SESSION_LOSS_PENDING, too.
            if let (true, Some(known)) = (result.into_raw() >= 0, &known) {
                // SAFETY: the call succeeded with these arguments.
                known.notify_images(&unsafe { runtimes(capacity, count, images) });
            }
            return result;
        };
        // SAFETY: the application's own arguments.
        answer.record(unsafe { enumerate_ours(ours, capacity, count, images) })
    })
}

/// Our images, as `xrEnumerateSwapchainImages` returns them.
///
/// # Safety
///
/// The arguments of `xrEnumerateSwapchainImages` in a Vulkan session.
unsafe fn enumerate_ours(
    (known, substitute): (&Arc<Swapchain>, &Substitute),
    capacity: u32,
    count: *mut u32,
    images: *mut xr::SwapchainImageBaseHeader,
) -> xr::Result {
    // SAFETY: valid usage demands that `count` is valid; null is answered all the same.
    let Some(count) = (unsafe { count.as_mut() }) else { return xr::Result::ERROR_VALIDATION_FAILURE };
    let room = if images.is_null() { 0 } else { capacity };
    let ours = substitute.images_within(room, |kept| known.keeps_only(kept));
    *count = ours.len() as u32;
    if capacity == 0 {
        return xr::Result::SUCCESS;
    }
    if (capacity as usize) < ours.len() {
        return xr::Result::ERROR_SIZE_INSUFFICIENT;
    }
    if images.is_null() {
        return xr::Result::ERROR_VALIDATION_FAILURE;
    }
    let images = images.cast::<xr::SwapchainImageVulkanKHR>();
    for (at, image) in ours.iter().enumerate() {
        // SAFETY: valid usage demands an array of `capacity` structures, which are no fewer than ours; in a Vulkan session each is an
        // XrSwapchainImageVulkanKHR. Its other members stay unread: xrgears and xrdesktop leave them uninitialised, as Monado allows.
        unsafe { (&raw mut (*images.add(at)).image).write(image.as_raw()) };
    }
    xr::Result::SUCCESS
}

/// The images that the runtime has written; none where it only counted them.
///
/// # Safety
///
/// `xrEnumerateSwapchainImages` succeeded with these arguments.
unsafe fn runtimes(
    capacity: u32,
    count: *const u32,
    images: *const xr::SwapchainImageBaseHeader,
) -> SmallVec<[vk::Image; 8]> {
    if capacity == 0 || count.is_null() || images.is_null() {
        return SmallVec::new();
    }
    let images = images.cast::<xr::SwapchainImageVulkanKHR>();
    // SAFETY: the call succeeded: there is an array of `capacity` structures, of which `count` were written; in a Vulkan
    // session each is an XrSwapchainImageVulkanKHR, of which the runtime wrote one member. The others may be uninitialised.
    unsafe {
        let image = |at| vk::Image::from_raw((&raw const (*images.add(at)).image).read());
        (0..(*count).min(capacity) as usize).map(image).collect()
    }
}

/// `xrAcquireSwapchainImage`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn acquire_image(
    handle: xr::Swapchain,
    info: *const xr::SwapchainImageAcquireInfo,
    index: *mut u32,
) -> xr::Result {
    let Some((known, next)) = find(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.acquire_swapchain_image)(handle, info, index) };
    // SAFETY: valid usage: `info` is null or valid, `index` is valid.
    let ours = |substitute: &Substitute| unsafe {
        let is_valid = info.as_ref().is_none_or(|info| info.ty == xr::SwapchainImageAcquireInfo::TYPE);
        let Some(index) = index.as_mut().filter(|_| is_valid) else {
            return xr::Result::ERROR_VALIDATION_FAILURE;
        };
        result_of(substitute.ring().acquire().map(|image| *index = image))
    };
    let pass_on = || substitute_of(&known).map_or_else(below, ours);
    guard("xrAcquireSwapchainImage", pass_on, |answer| {
        let _section = known.as_ref().and_then(|known| known.session.runtime_section());
        // The runtime may have no image until it has the one that is held.
        if let Some(known) = &known {
            known.release_early(&next);
        }
        let Some(substitute) = substitute_of(&known) else {
            let result = answer.record(below());
            if let (true, Some(known)) = (result.into_raw() >= 0, &known) {
                // SAFETY: the call succeeded, so `index` is valid.
                known.acquired_images().acquired(unsafe { *index });
            }
            return result;
        };
        substitute.make_ready();
        answer.record(ours(substitute))
    })
}

/// `xrWaitSwapchainImage`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn wait_image(
    handle: xr::Swapchain,
    info: *const xr::SwapchainImageWaitInfo,
) -> xr::Result {
    let Some((known, next)) = find(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.wait_swapchain_image)(handle, info) };
    let timeout = || {
        // SAFETY: valid usage: `info` is valid.
        let info = unsafe { info.as_ref() }?;
        (info.ty == xr::SwapchainImageWaitInfo::TYPE).then_some(info.timeout)
    };
    let ours = |substitute: &Substitute, is_free: &dyn Fn(u32, xr::Duration) -> bool| {
        let Some(timeout) = timeout() else { return xr::Result::ERROR_VALIDATION_FAILURE };
        let awaited = substitute.ring().awaited();
        match awaited {
            Ok(image) if !is_free(image, timeout) => xr::Result::TIMEOUT_EXPIRED,
            _ => result_of(substitute.ring().wait()),
        }
    };
    let pass_on = || substitute_of(&known).map_or_else(below, |substitute| ours(substitute, &|_, _| true));
    guard("xrWaitSwapchainImage", pass_on, |answer| {
        let result = answer.record(match (&known, substitute_of(&known)) {
            (Some(known), Some(substitute)) => {
                ours(substitute, &|image, timeout| known.waits_until_free(substitute, image, timeout))
            }
            _ => below(),
        });
        if let (xr::Result::SUCCESS, Some(known)) = (result, &known) {
            known.acquired_images().waited();
        }
        result
    })
}

/// `xrReleaseSwapchainImage`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn release_image(
    handle: xr::Swapchain,
    info: *const xr::SwapchainImageReleaseInfo,
) -> xr::Result {
    let Some((known, next)) = find(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.release_swapchain_image)(handle, info) };
    // SAFETY: valid usage: `info` is null or valid.
    let ours = |substitute: &Substitute| match unsafe { info.as_ref() } {
        Some(info) if info.ty != xr::SwapchainImageReleaseInfo::TYPE => xr::Result::ERROR_VALIDATION_FAILURE,
        _ => result_of(substitute.ring().release()),
    };
    let pass_on = || substitute_of(&known).map_or_else(below, ours);
    guard("xrReleaseSwapchainImage", pass_on, |answer| {
        let _section = known.as_ref().and_then(|known| known.session.runtime_section());
        let Some(substitute) = substitute_of(&known) else {
            // SAFETY: valid usage: `info` is null or valid.
            let is_plain = unsafe { info.as_ref() }.is_none_or(|info| info.next.is_null());
            if let Some(known) = &known {
                known.release_early(&next);
            }
            if known.as_ref().is_some_and(|known| is_plain && known.holds_release()) {
                return answer.record(xr::Result::SUCCESS);
            }
            let may_use = |session: &Session| !session.is_asleep() && !session.submits_late();
            if let Some(known) = known.as_ref().filter(|known| may_use(&known.session)) {
                if let Some(index) = known.acquired_images().ready() {
                    // SAFETY: in this call the queue is the runtime's, hence ours, and until it returns the image is the application's,
                    // which has submitted all that draws to it. The debug view comes last: nothing of it is analysed.
                    attempt("the contrast of an image", || unsafe { analyze_released(&[(known, index)]) });
                    // SAFETY: as above.
                    attempt("the debug view", || unsafe { draw_over_released(known, index) });
                }
                attempt("the depth of an image", || known.keep_depth());
            }
            let result = answer.record(below());
            if let (true, Some(known)) = (result.into_raw() >= 0, &known) {
                known.acquired_images().released();
            }
            return result;
        };
        answer.record(ours(substitute))
    })
}

fn result_of(done: Result<(), CallOrderInvalid>) -> xr::Result {
    match done {
        Ok(()) => xr::Result::SUCCESS,
        Err(CallOrderInvalid) => xr::Result::ERROR_CALL_ORDER_INVALID,
    }
}
