//! `xrCreateSwapchain`.

use super::description::Description;
use super::eligibility::{
    NotSubstituted, analyzed_usage, filled_usage, is_plain, kept_depth_usage, runtime_usage, shape,
    vulkan_usage,
};
use super::{SWAPCHAINS, Substitute, Swapchain, depth, eye_sizes};
use crate::abi::guard;
use crate::config::{Config, images_for_reuse, wants_maps};
use crate::kernels::analyze;
use crate::kernels::compose::{APP_USAGE, SwapchainShape};
use crate::link::BACKEND_MASK;
use crate::xr::session::{self, Active, Session};
use ash::vk;
use ash::vk::Handle;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;
use std::sync::Arc;

/// `xrCreateSwapchain`: for a virtual one, for one whose pictures may be analysed or have to be filled, and for one with depth that may be
/// copied, the runtime is asked for more usage. If it refuses, the application's call is made unchanged, so that the application gets the
/// runtime's own result.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    session: xr::Session,
    info: *const xr::SwapchainCreateInfo,
    swapchain: *mut xr::Swapchain,
) -> xr::Result {
    let Some((known, next)) = session::find_with_next(session) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function; `info` is the application's, or our copy of it.
    let below = |info| unsafe { (next.create_swapchain)(session, info, swapchain) };
    guard(
        "xrCreateSwapchain",
        || below(info),
        |answer| {
            let Some((known, active)) =
                known.as_ref().and_then(|known| Some((known, known.active.as_ref()?)))
            else {
                return answer.record(below(info));
            };
            let _section = active.device.runtime_section();
            let config = known.instance.config.snapshot();
            // SAFETY: valid usage: `info` is valid, and its chain is.
            let asked = unsafe { info.as_ref() };
            let mut planned = match asked {
                // SAFETY: as above.
                Some(asked) => unsafe { plan(known, active, &config, asked) },
                None => Err(NotSubstituted::NoWork),
            };
            // The result with the first of these usages that the runtime accepts, and that usage.
            let with_first = |asked: &xr::SwapchainCreateInfo, usages: &[xr::SwapchainUsageFlags]| {
                let mut done = (xr::Result::ERROR_RUNTIME_FAILURE, asked.usage_flags);
                for &usage_flags in usages {
                    let before = done;
                    done = (below(&xr::SwapchainCreateInfo { usage_flags, ..*asked }), usage_flags);
                    if done.0.into_raw() >= 0 {
                        if usages.first() != Some(&usage_flags) {
                            tracing::info!(
                                "the runtime refused additional swapchain usage flags: {:?}",
                                before.0
                            );
                        }
                        break;
                    }
                }
                done
            };
            // SAFETY: as above.
            let is_known = asked.is_some_and(|asked| unsafe { is_plain(asked) });
            let mut result = xr::Result::ERROR_RUNTIME_FAILURE;
            let mut usage_flags = xr::SwapchainUsageFlags::EMPTY;
            if let (Some(asked), Ok(_)) = (asked, &planned) {
                (result, usage_flags) = with_first(asked, &virtual_usages(known, &config, asked));
            }
            if planned.is_ok() && result.into_raw() < 0 {
                planned = Err(NotSubstituted::Usage(result));
            }
            if let (Some(asked), Err(_)) = (asked, &planned) {
                let more = more_usages(known, (active, &config), asked, is_known);
                (result, usage_flags) = with_first(asked, &more);
            }
            if result.into_raw() < 0 {
                usage_flags = asked.map_or(usage_flags, |asked| asked.usage_flags);
                result = below(info);
            }
            if answer.record(result).into_raw() >= 0 {
                // SAFETY: the call succeeded, so `swapchain` points to the new handle.
                let made = unsafe { (asked, *swapchain) };
                if let (Some(asked), handle) = made {
                    track(known, (active, &config), (asked, is_known, usage_flags), handle, planned);
                }
            }
            result
        },
    )
}

/// Usages of the runtime's images of a virtual swapchain, best first.
fn virtual_usages(
    session: &Session,
    config: &Config,
    info: &xr::SwapchainCreateInfo,
) -> SmallVec<[xr::SwapchainUsageFlags; 2]> {
    let analyzed = session.may_judge(config).then_some(true);
    analyzed.into_iter().chain([false]).map(|analyzed| runtime_usage(info.usage_flags, analyzed)).collect()
}

/// Usages of the runtime's images, best first, where the application draws to them itself; none if only the application's own is needed.
fn more_usages(
    session: &Session,
    (active, config): (&Active, &Config),
    info: &xr::SwapchainCreateInfo,
    is_plain: bool,
) -> SmallVec<[xr::SwapchainUsageFlags; 2]> {
    let asked = info.usage_flags;
    let needed = match () {
        () if may_be_filled(active, config, info) => filled_usage(asked),
        () if depth::may_be_kept(active, config, info) => kept_depth_usage(asked),
        () => asked,
    };
    let if_granted = Description::new(info, is_plain, analyze::RELEASED_USAGE);
    let may_be_analyzed = session.may_judge(config) && if_granted.analyzed_format().is_some();
    let analyzed = may_be_analyzed.then(|| analyzed_usage(needed));
    let mut usages: SmallVec<_> =
        analyzed.into_iter().chain([needed]).filter(|more| *more != asked).collect();
    usages.dedup();
    usages
}

/// Whether passes that draw to a swapchain may have masks.
fn may_be_filled(active: &Active, config: &Config, info: &xr::SwapchainCreateInfo) -> bool {
    wants_maps(config)
        && active.device.capabilities.backend == BACKEND_MASK
        && info.sample_count == 1
        && info.usage_flags.contains(xr::SwapchainUsageFlags::COLOR_ATTACHMENT)
        && !info.create_flags.contains(xr::SwapchainCreateFlags::PROTECTED_CONTENT)
}

/// The shape of our images, if the swapchain is to be virtual.
///
/// # Safety
///
/// `info` is valid, and its chain is.
unsafe fn plan(
    session: &Session,
    active: &Active,
    config: &Config,
    info: &xr::SwapchainCreateInfo,
) -> Result<SwapchainShape, NotSubstituted> {
    let tools = if session.may_have_work(config) { active.tools() } else { None };
    // No work is done for a queue that was once too far behind: images of ours would never be shown.
    let tools = tools.filter(|tools| !tools.gpu.is_abandoned()).ok_or(NotSubstituted::NoWork)?;
    // Before the lock, as it asks the runtime.
    let recommended = eye_sizes::recommended(session);
    let mut compose = tools.compose();
    // SAFETY: `info` and its chain are valid, as `# Safety` demands.
    let shape = unsafe { shape(info, |format| compose.supports(format)) }?;
    let size = [info.width, info.height];
    if !eye_sizes::may_show_eyes(size, &recommended) {
        return Err(NotSubstituted::Size(size));
    }
    let prepared = match session.may_reuse(config) {
        true => compose.prepare_reuse(shape.format),
        false => compose.prepare(shape.format),
    };
    prepared.map_err(|error| {
        error.log(&format!("swapchains of format {:?} stay unchanged", shape.format));
        NotSubstituted::Format(shape.format)
    })?;
    Ok(shape)
}

/// Begins to track a swapchain, virtual if that was planned and our images can be made. The runtime created its own with
/// these usage flags.
fn track(
    session: &Arc<Session>,
    (active, config): (&Active, &Config),
    (info, is_plain, usage_flags): (&xr::SwapchainCreateInfo, bool, xr::SwapchainUsageFlags),
    handle: xr::Swapchain,
    planned: Result<SwapchainShape, NotSubstituted>,
) {
    let substitute = match planned {
        Ok(shape) => substitute(session, (active, config), handle, &shape, vulkan_usage(usage_flags)),
        Err(NotSubstituted::NoWork) => None,
        Err(reason) => {
            tracing::info!("swapchain unchanged: {reason}");
            None
        }
    };
    let granted = match &substitute {
        Some(_) => vulkan_usage(info.usage_flags) | APP_USAGE,
        None => vulkan_usage(usage_flags),
    };
    let description = Description::new(info, is_plain, granted);
    if substitute.is_none()
        && session.may_judge(config)
        && !info.usage_flags.contains(xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT)
        && description.analyzed_format().is_none()
    {
        tracing::info!("rings instead of rates by contrast in a swapchain: its images cannot be read");
    }
    let swapchain = Arc::new(Swapchain::new(session, handle, description, substitute));
    if let Some(substitute) = &swapchain.substitute {
        swapchain.notify_images(substitute.app.images());
    }
    let is_virtual = swapchain.substitute.is_some();
    SWAPCHAINS.insert(handle, swapchain);
    if is_virtual {
        // Its images reach the runtime in no ignored frame.
        active.plan.sleep.wake();
    }
}

/// Both sides of a virtual swapchain; `None`, with one line in the log, where it has to stay as it is.
fn substitute(
    session: &Session,
    (active, config): (&Active, &Config),
    handle: xr::Swapchain,
    shape: &SwapchainShape,
    granted: vk::ImageUsageFlags,
) -> Option<Substitute> {
    let tools = active.tools()?;
    let images = runtime_images(session, handle)
        .inspect_err(|result| {
            tracing::warn!("swapchain unchanged: xrEnumerateSwapchainImages returned {result:?}");
        })
        .ok()?;
    let least = if session.may_reuse(config) { images_for_reuse(config) } else { 0 };
    let substitute = Substitute::new(&tools.gpu, shape, (images, granted), least)
        .inspect_err(|error| error.log("swapchain unchanged"))
        .ok()?;
    if let Some(reason) = substitute.refused {
        tracing::info!("no re-use in a swapchain: {reason}");
    }
    let vk::Extent2D { width, height } = shape.extent;
    tracing::info!(
        "swapchain of {width}x{height}x{} {:?}: the application draws to {} images of the layer",
        shape.array_layers,
        shape.format,
        substitute.app.images().len(),
    );
    Some(substitute)
}

/// The images of the runtime's swapchain.
pub(super) fn runtime_images(session: &Session, handle: xr::Swapchain) -> Result<Vec<vk::Image>, xr::Result> {
    let enumerate = |images: &mut [xr::SwapchainImageVulkanKHR]| {
        let mut count = 0;
        // SAFETY: the next layer's function with a live handle and an array of as many structures as said,
        // which begin as the base header does.
        let result = unsafe {
            (session.instance.next.enumerate_swapchain_images)(
                handle,
                images.len() as u32,
                &mut count,
                images.as_mut_ptr().cast(),
            )
        };
        if result.into_raw() < 0 { Err(result) } else { Ok(count as usize) }
    };
    let empty = xr::SwapchainImageVulkanKHR {
        ty: xr::SwapchainImageVulkanKHR::TYPE,
        next: ptr::null_mut(),
        image: 0,
    };
    let mut images = vec![empty; enumerate(&mut [])?];
    let count = enumerate(&mut images)?.min(images.len());
    if count == 0 {
        return Err(xr::Result::ERROR_RUNTIME_FAILURE);
    }
    Ok(images[..count].iter().map(|image| vk::Image::from_raw(image.image)).collect())
}
