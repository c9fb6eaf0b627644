//! Framebuffers.

use super::Objects;
use crate::pass_detection::Target;
use ash::vk;
use smallvec::SmallVec;

/// A live framebuffer.
#[derive(Debug, Clone)]
pub struct Framebuffer {
    /// Its attachments, in the order of the render pass; `None` for an unknown view. Empty where the attachments come with
    /// vkCmdBeginRenderPass (imageless).
    pub attachments: SmallVec<[Option<Target>; 8]>,
    /// Whether the attachments come with vkCmdBeginRenderPass.
    pub is_imageless: bool,
}

impl Framebuffer {
    /// The framebuffer that a call creates.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreateFramebuffer.
    pub unsafe fn created(objects: &Objects, info: &vk::FramebufferCreateInfo<'_>) -> Self {
        let is_imageless = info.flags.contains(vk::FramebufferCreateFlags::IMAGELESS);
        let mut attachments = SmallVec::new();
        if !is_imageless && info.attachment_count > 0 {
            // SAFETY: without the flag there is an array of this many views.
            let views =
                unsafe { std::slice::from_raw_parts(info.p_attachments, info.attachment_count as usize) };
            attachments.extend(views.iter().map(|&view| Some(objects.view(view)?.target)));
        }
        Self { attachments, is_imageless }
    }
}
