//! An image as the attachment of a pass.

use super::Image;
use super::image::is_depth;
use ash::vk;

/// An image with its load and store operations and its layouts before and after a pass.
#[derive(Clone, Copy)]
pub struct Attachment {
    pub image: Image,
    pub load: vk::AttachmentLoadOp,
    pub clear: vk::ClearValue,
    pub store: vk::AttachmentStoreOp,
    /// The layout before the pass.
    pub before: vk::ImageLayout,
    /// The layout after it.
    pub after: vk::ImageLayout,
}

impl Image {
    /// Cleared colour that stays a colour target.
    pub fn cleared(self, color: [f32; 4]) -> Attachment {
        Attachment {
            image: self,
            load: vk::AttachmentLoadOp::CLEAR,
            clear: vk::ClearValue { color: vk::ClearColorValue { float32: color } },
            store: vk::AttachmentStoreOp::STORE,
            before: vk::ImageLayout::UNDEFINED,
            after: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }
    }

    /// Colour whose content before the pass does not matter: all of it is drawn over.
    pub fn overwritten(self) -> Attachment {
        Attachment { load: vk::AttachmentLoadOp::DONT_CARE, ..self.cleared([0.0; 4]) }
    }

    /// Cleared depth that is thrown away after the pass.
    pub fn depth_cleared(self, depth: f32) -> Attachment {
        Attachment {
            image: self,
            load: vk::AttachmentLoadOp::CLEAR,
            clear: vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth, stencil: 0 } },
            store: vk::AttachmentStoreOp::DONT_CARE,
            before: vk::ImageLayout::UNDEFINED,
            after: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        }
    }
}

impl Attachment {
    /// Left in this layout.
    pub fn after(self, after: vk::ImageLayout) -> Self {
        Self { after, ..self }
    }

    /// Left to be sampled.
    pub fn sampled(self) -> Self {
        self.after(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)
    }

    /// As an earlier pass left it in the layout of a target.
    pub fn loaded(self) -> Self {
        Self { load: vk::AttachmentLoadOp::LOAD, before: self.after, ..self }
    }

    /// Kept after the pass.
    pub fn stored(self) -> Self {
        Self { store: vk::AttachmentStoreOp::STORE, ..self }
    }

    /// Not kept after the pass.
    pub fn discarded(self) -> Self {
        Self { store: vk::AttachmentStoreOp::DONT_CARE, ..self }
    }

    pub fn is_depth(&self) -> bool {
        is_depth(self.image.format)
    }

    /// For vkCreateRenderPass.
    pub fn description(&self) -> vk::AttachmentDescription {
        vk::AttachmentDescription::default()
            .format(self.image.format)
            .samples(vk::SampleCountFlags::from_raw(self.image.samples))
            .load_op(self.load)
            .store_op(self.store)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .initial_layout(self.before)
            .final_layout(self.after)
    }

    /// For vkCmdBeginRendering.
    pub fn rendering_info(&self, layout: vk::ImageLayout) -> vk::RenderingAttachmentInfo<'static> {
        vk::RenderingAttachmentInfo::default()
            .image_view(self.image.view)
            .image_layout(layout)
            .load_op(self.load)
            .store_op(self.store)
            .clear_value(self.clear)
    }
}
