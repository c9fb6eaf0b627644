//! Properties of a swapchain's images, for the Vulkan half.

use super::eligibility::vulkan_usage;
use crate::kernels::analyze;
use crate::kernels::compose::{DEPTH_USAGE, DepthShape, SwapchainShape, is_color_format};
use crate::link::SwapchainRecord;
use ash::vk;
use openxr_sys as xr;

/// The application's request, and the granted usage.
#[derive(Debug, Clone, Copy)]
pub struct Description {
    extent: [u32; 2],
    layers: u32,
    format: vk::Format,
    samples: u32,
    usage: vk::ImageUsageFlags,
    granted: vk::ImageUsageFlags,
    has_flags: bool,
    /// Whether nothing unknown extends the request.
    is_plain: bool,
    faces: u32,
}

impl Description {
    /// Describes a swapchain created with `info`. `is_plain`: the layer knows every structure in its chain. `granted`: the usage that the
    /// images allow.
    pub fn new(info: &xr::SwapchainCreateInfo, is_plain: bool, granted: vk::ImageUsageFlags) -> Self {
        Self {
            extent: [info.width, info.height],
            layers: info.array_size.saturating_mul(info.face_count.max(1)),
            format: i32::try_from(info.format).map_or(vk::Format::UNDEFINED, vk::Format::from_raw),
            samples: info.sample_count,
            usage: vulkan_usage(info.usage_flags),
            granted,
            has_flags: !info.create_flags.is_empty(),
            is_plain,
            faces: info.face_count,
        }
    }

    /// Size of an image, pixels, and its array layers.
    pub fn extent_and_layers(&self) -> (vk::Extent2D, u32) {
        (vk::Extent2D { width: self.extent[0], height: self.extent[1] }, self.layers)
    }

    /// The shape of the images for the debug view; the error is the reason why nothing may be drawn.
    pub fn drawn_over(&self) -> Result<SwapchainShape, &'static str> {
        if self.has_flags {
            return Err("it is static or protected");
        }
        if self.samples != 1 || self.faces != 1 {
            return Err("it is multisampled, or a cube map");
        }
        if !self.granted.contains(vk::ImageUsageFlags::COLOR_ATTACHMENT) {
            return Err("its images cannot be drawn to");
        }
        let (extent, array_layers) = self.extent_and_layers();
        let (format, usage) = (self.format, self.granted);
        Ok(SwapchainShape { format, extent, array_layers, usage, mutable: false, view_formats: Vec::new() })
    }

    /// The format in which the images can be analysed; `None` if they cannot be.
    pub fn analyzed_format(&self) -> Option<vk::Format> {
        let is_usual = self.is_plain && !self.has_flags && self.samples == 1 && self.faces == 1;
        let can_be =
            is_usual && self.granted.contains(analyze::RELEASED_USAGE) && is_color_format(self.format);
        can_be.then_some(self.format)
    }

    /// Whether the images can have depth that can be copied.
    pub fn can_copy_depth(&self) -> bool {
        let needed = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | DEPTH_USAGE;
        self.granted.contains(needed) && !self.has_flags && self.samples == 1 && self.faces == 1
    }

    /// Their shape, if they have depth.
    pub fn depth_shape(&self) -> DepthShape {
        let (extent, array_layers) = self.extent_and_layers();
        DepthShape { format: self.format, extent, array_layers }
    }

    /// The record for these images, to which it points.
    pub fn record(
        &self,
        swapchain: u64,
        images: &[vk::Image],
        is_virtual: bool,
        has_backend: bool,
    ) -> SwapchainRecord {
        SwapchainRecord {
            swapchain,
            images: images.as_ptr(),
            image_count: images.len() as u32,
            extent: self.extent,
            layers: self.layers,
            format: self.format,
            samples: self.samples,
            usage: self.usage,
            granted: self.granted,
            is_virtual: u32::from(is_virtual),
            is_read: u32::from(
                is_virtual || (has_backend && (self.analyzed_format().is_some() || self.can_copy_depth())),
            ),
        }
    }
}
