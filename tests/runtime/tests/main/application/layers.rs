//! Swapchains and layers of the tests.

use super::{IDENTITY, structure};
use ash::vk;
use openxr_sys as xr;

/// Width and height of the tests' swapchains.
pub const SIZE: u32 = 64;

/// Parameters of a swapchain that can be painted.
pub fn swapchain_info() -> xr::SwapchainCreateInfo {
    structure!(SwapchainCreateInfo {
        usage_flags: xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::TRANSFER_DST,
        format: i64::from(vk::Format::R8G8B8A8_SRGB.as_raw()),
        sample_count: 1,
        width: SIZE,
        height: SIZE,
        face_count: 1,
        array_size: 1,
        mip_count: 1,
    })
}

/// All of the first layer of a swapchain.
pub fn whole(swapchain: xr::Swapchain) -> xr::SwapchainSubImage {
    let extent = xr::Extent2Di { width: SIZE as i32, height: SIZE as i32 };
    let image_rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
    xr::SwapchainSubImage { swapchain, image_rect, image_array_index: 0 }
}

/// The field of view of the default views.
pub fn fov() -> xr::Fovf {
    let angle = 45_f32.to_radians();
    xr::Fovf { angle_left: -angle, angle_right: angle, angle_up: angle, angle_down: -angle }
}

/// Both views of a swapchain, from the head, as the default views see.
pub fn views(swapchain: xr::Swapchain) -> [xr::CompositionLayerProjectionView; 2] {
    let view = structure!(CompositionLayerProjectionView {
        pose: IDENTITY,
        fov: fov(),
        sub_image: whole(swapchain),
    });
    [view; 2]
}

/// A projection layer.
pub fn projection(
    space: xr::Space,
    views: &[xr::CompositionLayerProjectionView],
) -> xr::CompositionLayerProjection {
    structure!(CompositionLayerProjection {
        space: space,
        view_count: views.len() as u32,
        views: views.as_ptr(),
    })
}

/// A layer as `xrEndFrame` takes it.
pub fn header<T>(layer: &T) -> &xr::CompositionLayerBaseHeader {
    // SAFETY: every layer begins like the header.
    unsafe { &*std::ptr::from_ref(layer).cast() }
}
