//! Targets of passes.

use crate::device::Device;
use crate::pipeline::{DEPTH_FORMAT, FORMAT};
use anyhow::Result;
use ash::vk;

/// An image with a view; its own, or a swapchain's.
pub struct Target<'a> {
    device: &'a Device,
    pub image: vk::Image,
    pub view: vk::ImageView,
    /// Null where the image is a swapchain's.
    memory: vk::DeviceMemory,
    /// With the depth buffer; null with dynamic rendering.
    pub framebuffer: vk::Framebuffer,
    /// Size, pixels.
    pub extent: vk::Extent2D,
}

/// All of a colour image, or of the depth buffer.
pub fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default().aspect_mask(aspect).level_count(1).layer_count(1)
}

impl<'a> Target<'a> {
    /// A depth buffer.
    pub fn depth(device: &'a Device, extent: vk::Extent2D) -> Result<Self> {
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        Self::own(device, extent, DEPTH_FORMAT, usage, vk::ImageAspectFlags::DEPTH)
    }

    /// A colour image.
    pub fn colour(device: &'a Device, extent: vk::Extent2D) -> Result<Self> {
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        Self::own(device, extent, FORMAT, usage, vk::ImageAspectFlags::COLOR)
    }

    /// A swapchain's image.
    pub fn of_swapchain(device: &'a Device, extent: vk::Extent2D, image: vk::Image) -> Result<Self> {
        Self::with_view(device, extent, image, vk::DeviceMemory::null(), FORMAT, vk::ImageAspectFlags::COLOR)
    }

    fn own(
        device: &'a Device,
        extent: vk::Extent2D,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
        aspect: vk::ImageAspectFlags,
    ) -> Result<Self> {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent.into())
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        let vk = &device.functions;
        // SAFETY: plain use of Vulkan: a valid structure, and the handles live as long as this object.
        let (image, memory) = unsafe {
            let image = vk.create_image(&info, None)?;
            let needs = vk.get_image_memory_requirements(image);
            let memory = device.allocate(needs, vk::MemoryPropertyFlags::empty())?;
            vk.bind_image_memory(image, memory, 0)?;
            (image, memory)
        };
        Self::with_view(device, extent, image, memory, format, aspect)
    }

    fn with_view(
        device: &'a Device,
        extent: vk::Extent2D,
        image: vk::Image,
        memory: vk::DeviceMemory,
        format: vk::Format,
        aspect: vk::ImageAspectFlags,
    ) -> Result<Self> {
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(whole(aspect));
        // SAFETY: a valid structure of a live image.
        let view = unsafe { device.functions.create_image_view(&info, None)? };
        Ok(Self { device, image, view, memory, framebuffer: vk::Framebuffer::null(), extent })
    }

    /// Makes the framebuffer of a render pass, with this image and a depth buffer.
    pub fn with_framebuffer(mut self, render_pass: vk::RenderPass, depth: &Target<'_>) -> Result<Self> {
        let views = [self.view, depth.view];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(render_pass)
            .attachments(&views)
            .width(self.extent.width)
            .height(self.extent.height)
            .layers(1);
        // SAFETY: a valid structure of live handles.
        self.framebuffer = unsafe { self.device.functions.create_framebuffer(&info, None)? };
        Ok(self)
    }
}

impl Drop for Target<'_> {
    fn drop(&mut self) {
        let vk = &self.device.functions;
        // SAFETY: the handles are this object's own, or null, and the scene has waited. A swapchain's image stays.
        unsafe {
            vk.destroy_framebuffer(self.framebuffer, None);
            vk.destroy_image_view(self.view, None);
            if self.memory != vk::DeviceMemory::null() {
                vk.destroy_image(self.image, None);
                vk.free_memory(self.memory, None);
            }
        }
    }
}
