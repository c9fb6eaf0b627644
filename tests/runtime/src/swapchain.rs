//! Swapchains: images on the application's device, acquired, waited for and released by the rules.

mod ring;

use crate::abi::pointers::{In, List, Out};
use crate::fault::{Fault, section};
use crate::record::{Line, SwapchainCreated};
use crate::runtime::{Runtime, call};
use crate::scenario::Answer;
use crate::vulkan::{Images, Shape, format};
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use openxr_sys::{Handle, SwapchainCreateFlags};
pub(crate) use ring::Ring;

/// An `XrSwapchain`.
pub(crate) struct Swapchain {
    pub session: xr::Session,
    pub shape: Shape,
    pub ring: Ring,
    pub images: Images,
    /// Calls of `xrWaitSwapchainImage`.
    waits: u64,
}

/// A format's name without `VK_FORMAT_`.
pub(crate) fn format_name(format: vk::Format) -> String {
    format!("{format:?}")
}

/// `xrEnumerateSwapchainFormats`.
pub(crate) extern "system" fn enumerate_formats(
    session: xr::Session,
    capacity: u32,
    count: Out<u32>,
    items: Out<i64>,
) -> xr::Result {
    call("xrEnumerateSwapchainFormats", |runtime| {
        let formats = runtime.sessions.get(session)?.gpu.formats();
        let formats: Vec<_> = formats.iter().map(|format| i64::from(format.as_raw())).collect();
        List { capacity, count, items }.fill("formats", &formats)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrCreateSwapchain`.
pub(crate) extern "system" fn create(
    session: xr::Session,
    info: In<xr::SwapchainCreateInfo>,
    swapchain: Out<xr::Swapchain>,
) -> xr::Result {
    call("xrCreateSwapchain", |runtime| {
        let info = runtime.read(&info)?;
        let (owner, instance) = runtime.session_and_instance(session)?;
        let list = info.extension::<xr::VulkanSwapchainFormatListCreateInfoKHR>();
        let list = list.filter(|_| instance.has("XR_KHR_vulkan_swapchain_format_list"));
        let view_formats = list.map(|list| list.view_formats()).transpose()?.unwrap_or_default();
        let shape = check_shape(runtime, owner.gpu.formats(), &info, view_formats)?;
        let count = if shape.is_static { 1 } else { runtime.scenario.swapchain.images };
        let images = Images::new(&owner.gpu, &shape, count)?;
        let line = SwapchainCreated {
            session: session.into_raw(),
            swapchain: 0,
            format: format_name(shape.format),
            create_flags: info.create_flags.into_raw(),
            usage_flags: info.usage_flags.into_raw(),
            width: info.width,
            height: info.height,
            sample_count: info.sample_count,
            face_count: info.face_count,
            array_size: info.array_size,
            mip_count: info.mip_count,
            view_formats: shape.view_formats.iter().map(|&format| format_name(format)).collect(),
            images: count,
        };
        let created = Swapchain { session, ring: Ring::new(count, shape.is_static), shape, images, waits: 0 };
        let handle = runtime.swapchains.insert(&mut runtime.serial, created);
        swapchain.set("swapchain", handle)?;
        runtime
            .recorder
            .line(&Line::SwapchainCreated(SwapchainCreated { swapchain: handle.into_raw(), ..line }));
        Ok(xr::Result::SUCCESS)
    })
}

fn check_shape(
    runtime: &Runtime,
    formats: &[vk::Format],
    info: &xr::SwapchainCreateInfo,
    view_formats: &[u32],
) -> Result<Shape, Fault> {
    let format = formats.iter().copied().find(|format| i64::from(format.as_raw()) == info.format);
    let format = format.ok_or_else(|| {
        let message = format!("format {} is none of xrEnumerateSwapchainFormats", info.format);
        Fault::new(xr::Result::ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, section::SWAPCHAINS, message)
    })?;
    check_counts(runtime, info)?;
    if info.create_flags.contains(SwapchainCreateFlags::PROTECTED_CONTENT) {
        let message = "protected content is not supported";
        return Err(Fault::new(xr::Result::ERROR_FEATURE_UNSUPPORTED, section::SWAPCHAINS, message));
    }
    if !SwapchainCreateFlags::STATIC_IMAGE.contains(info.create_flags) {
        let message = format!("createFlags is {:#x}", info.create_flags.into_raw());
        return Err(Fault::validation(section::SWAPCHAINS, message));
    }
    let view_formats = view_formats.iter().map(|&raw| vk::Format::from_raw(raw as i32)).collect::<Vec<_>>();
    let mutable = info.usage_flags.contains(xr::SwapchainUsageFlags::MUTABLE_FORMAT);
    check_view_formats(format, mutable, &view_formats)?;
    Ok(Shape {
        format,
        usage: format::usage(format, info.usage_flags)?,
        mutable,
        view_formats,
        extent: vk::Extent2D { width: info.width, height: info.height },
        samples: vk::SampleCountFlags::from_raw(info.sample_count),
        faces: info.face_count,
        array_layers: info.array_size * info.face_count,
        mips: info.mip_count,
        is_static: info.create_flags.contains(SwapchainCreateFlags::STATIC_IMAGE),
    })
}

fn check_counts(runtime: &Runtime, info: &xr::SwapchainCreateInfo) -> Result<(), Fault> {
    let system = &runtime.scenario.system;
    let size = 1..=system.max_size;
    let mips = 1..=info.width.max(info.height).max(1).ilog2() + 1;
    let checks = [
        ("width", info.width, size.contains(&info.width), format!("1 to {}", system.max_size)),
        ("height", info.height, size.contains(&info.height), format!("1 to {}", system.max_size)),
        (
            "sampleCount",
            info.sample_count,
            info.sample_count.is_power_of_two() && info.sample_count <= system.max_samples,
            format!("a power of two up to {}", system.max_samples),
        ),
        ("faceCount", info.face_count, matches!(info.face_count, 1 | 6), "1 or 6".to_owned()),
        ("arraySize", info.array_size, (1..=256).contains(&info.array_size), "1 to 256".to_owned()),
        ("mipCount", info.mip_count, mips.contains(&info.mip_count), format!("1 to {}", mips.end())),
    ];
    match checks.into_iter().find(|(_, _, valid, _)| !valid) {
        Some((member, value, _, allowed)) => {
            Err(Fault::validation(section::SWAPCHAINS, format!("{member} is {value}; allowed: {allowed}")))
        }
        None => Ok(()),
    }
}

fn check_view_formats(format: vk::Format, mutable: bool, list: &[vk::Format]) -> Result<(), Fault> {
    let invalid = |message: String| Err(Fault::validation(section::FORMAT_LIST, message));
    if !mutable && list.iter().any(|&view| view != format) {
        return invalid(format!(
            "viewFormats {list:?} has more than {format:?}, without MUTABLE_FORMAT usage"
        ));
    }
    match list.iter().find(|&&view| !format::compatible(format, view)) {
        Some(view) => invalid(format!("viewFormats has {view:?}, which is not compatible with {format:?}")),
        None => Ok(()),
    }
}

/// `xrDestroySwapchain`.
pub(crate) extern "system" fn destroy(swapchain: xr::Swapchain) -> xr::Result {
    call("xrDestroySwapchain", |runtime| {
        runtime.swapchains.remove(swapchain)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEnumerateSwapchainImages`.
pub(crate) extern "system" fn enumerate_images(
    swapchain: xr::Swapchain,
    capacity: u32,
    count: Out<u32>,
    items: Out<xr::SwapchainImageVulkanKHR>,
) -> xr::Result {
    call("xrEnumerateSwapchainImages", |runtime| {
        let images = runtime.swapchains.get(swapchain)?.images.handles();
        let images = if runtime.answer == Answer::NoImages { &[] } else { images };
        let list = List { capacity, count, items };
        match runtime.scenario.swapchain.unread_images {
            true => list.fill_unread("images", images)?,
            false => list.fill_structures("images", images, |filled, image| filled.image = image.as_raw())?,
        }
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrAcquireSwapchainImage`.
pub(crate) extern "system" fn acquire(
    swapchain: xr::Swapchain,
    info: In<xr::SwapchainImageAcquireInfo>,
    index: Out<u32>,
) -> xr::Result {
    call("xrAcquireSwapchainImage", |runtime| {
        runtime.read_optional(&info)?;
        index.set("index", 0)?;
        let swapchain = runtime.swapchains.get_mut(swapchain)?;
        let acquired = swapchain.ring.acquire()?;
        swapchain.images.make_ready(&swapchain.shape)?;
        index.set("index", acquired)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrWaitSwapchainImage`.
pub(crate) extern "system" fn wait(
    swapchain: xr::Swapchain,
    info: In<xr::SwapchainImageWaitInfo>,
) -> xr::Result {
    call("xrWaitSwapchainImage", |runtime| {
        let timeout = runtime.read(&info)?.timeout;
        let swapchain = runtime.swapchains.get_mut(swapchain)?;
        let number = swapchain.waits;
        swapchain.waits += 1;
        // An infinite wait cannot time out.
        let expires = timeout != xr::Duration::INFINITE;
        if expires && runtime.scenario.swapchain.wait_timeouts.contains(&number) {
            swapchain.ring.check_wait()?;
            return Ok(xr::Result::TIMEOUT_EXPIRED);
        }
        swapchain.ring.wait()?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrReleaseSwapchainImage`.
pub(crate) extern "system" fn release(
    swapchain: xr::Swapchain,
    info: In<xr::SwapchainImageReleaseInfo>,
) -> xr::Result {
    call("xrReleaseSwapchainImage", |runtime| {
        runtime.read_optional(&info)?;
        runtime.swapchains.get_mut(swapchain)?.ring.release()?;
        Ok(xr::Result::SUCCESS)
    })
}
