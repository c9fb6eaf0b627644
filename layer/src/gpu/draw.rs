//! Targets of draws: one colour attachment that keeps its content.

use super::framebuffer::framebuffer;
use super::{Gpu, GpuError, Owned, attachment_view};
use ash::vk;
use std::sync::Arc;

/// A render pass over one attachment of this format, as [`make_color_pass`] makes it.
pub(crate) fn color_pass(gpu: &Gpu, format: vk::Format) -> Result<Arc<Owned<vk::RenderPass>>, GpuError> {
    gpu.shared()?.color_pass(format)
}

/// A render pass of Vulkan 1.0 over one attachment of this format, which is COLOR_ATTACHMENT_OPTIMAL before
/// and after. Passes made alike are compatible.
pub(super) fn make_color_pass(gpu: &Arc<Gpu>, format: vk::Format) -> Result<Owned<vk::RenderPass>, GpuError> {
    let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let attachments = [vk::AttachmentDescription::default()
        .format(format)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::LOAD)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(layout)
        .final_layout(layout)];
    let references = [vk::AttachmentReference { attachment: 0, layout }];
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&references)];
    let info = vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses);
    // SAFETY: the device is live.
    unsafe {
        let handle =
            gpu.device.create_render_pass(&info, None).map_err(GpuError::from_call("vkCreateRenderPass"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_render_pass(handle, None)))
    }
}

/// One layer of an image, to draw to.
pub(crate) struct ColorTarget {
    framebuffer: Owned<vk::Framebuffer>,
    _view: Owned<vk::ImageView>,
    pass: Arc<Owned<vk::RenderPass>>,
    extent: vk::Extent2D,
}

impl ColorTarget {
    /// Over layer `layer` of `image`, which has the format of `pass`.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        pass: &Arc<Owned<vk::RenderPass>>,
        image: vk::Image,
        format: vk::Format,
        extent: vk::Extent2D,
        layer: u32,
    ) -> Result<Self, GpuError> {
        let view = attachment_view(gpu, image, format, layer)?;
        let framebuffer = framebuffer(gpu, pass, &view, extent)?;
        Ok(Self { framebuffer, _view: view, pass: Arc::clone(pass), extent })
    }

    pub(super) fn pass(&self) -> vk::RenderPass {
        self.pass.handle()
    }

    pub(super) fn framebuffer(&self) -> vk::Framebuffer {
        self.framebuffer.handle()
    }

    pub(super) fn extent(&self) -> vk::Extent2D {
        self.extent
    }
}
