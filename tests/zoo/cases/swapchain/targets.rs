//! Render pass, views and framebuffers over the images of a swapchain.

use super::{Shape, texels};
use crate::failure::Failure;
use crate::paint::Texels;
use ash::vk;
use std::collections::HashMap;

/// One framebuffer for each image index, array layer and mip level.
pub struct Targets {
    pub render_pass: vk::RenderPass,
    pub framebuffers: HashMap<(u32, u32, u32), vk::Framebuffer>,
    views: Vec<vk::ImageView>,
}

impl Targets {
    pub fn create(device: &ash::Device, shape: &Shape, images: &[vk::Image]) -> Result<Self, Failure> {
        let mut targets = Self {
            render_pass: render_pass(device, shape)?,
            framebuffers: HashMap::new(),
            views: Vec::new(),
        };
        for (index, image) in images.iter().enumerate() {
            for array_layer in 0..shape.array_layers {
                for mip_level in 0..shape.mip_levels {
                    let key = (index as u32, array_layer, mip_level);
                    targets.add(device, shape, *image, key)?;
                }
            }
        }
        Ok(targets)
    }

    pub fn destroy(&mut self, device: &ash::Device) {
        // SAFETY: the caller waited for the work that uses them, and they are not used again.
        unsafe {
            for framebuffer in self.framebuffers.values() {
                device.destroy_framebuffer(*framebuffer, None);
            }
            for view in &self.views {
                device.destroy_image_view(*view, None);
            }
            device.destroy_render_pass(self.render_pass, None);
        }
    }

    fn add(
        &mut self,
        device: &ash::Device,
        shape: &Shape,
        image: vk::Image,
        key: (u32, u32, u32),
    ) -> Result<(), Failure> {
        let (_, array_layer, mip_level) = key;
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(texels(shape.view_format).aspect())
            .base_array_layer(array_layer)
            .layer_count(1)
            .base_mip_level(mip_level)
            .level_count(1);
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(shape.view_format)
            .subresource_range(range);
        // SAFETY: the image is the swapchain's, on this device, and has this layer and level.
        let view = unsafe { device.create_image_view(&info, None) }?;
        self.views.push(view);
        let attachments = [view];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&attachments)
            .width((shape.size[0] >> mip_level).max(1))
            .height((shape.size[1] >> mip_level).max(1))
            .layers(1);
        // SAFETY: the view and the render pass are live and agree in format.
        let framebuffer = unsafe { device.create_framebuffer(&info, None) }?;
        self.framebuffers.insert(key, framebuffer);
        Ok(())
    }
}

/// One attachment, cleared, in the layout that OpenXR gives and takes images in. The dependencies order our own
/// passes only: the runtime synchronises its own work with the image.
fn render_pass(device: &ash::Device, shape: &Shape) -> Result<vk::RenderPass, Failure> {
    let depth = texels(shape.view_format) == Texels::Depth;
    let (layout, stages, writes) = if depth {
        (
            vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
            vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS,
            vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE,
        )
    } else {
        (
            vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT,
            vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
        )
    };
    let attachments = [vk::AttachmentDescription::default()
        .format(shape.view_format)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(layout)
        .final_layout(layout)];
    let references = [vk::AttachmentReference { attachment: 0, layout }];
    let subpass = vk::SubpassDescription::default().pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS);
    let subpasses = [if depth {
        subpass.depth_stencil_attachment(&references[0])
    } else {
        subpass.color_attachments(&references)
    }];
    let dependencies = [vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .dst_subpass(0)
        .src_stage_mask(stages)
        .dst_stage_mask(stages)
        .src_access_mask(writes)
        .dst_access_mask(writes)];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: the structures outlive the call.
    Ok(unsafe { device.create_render_pass(&info, None) }?)
}
