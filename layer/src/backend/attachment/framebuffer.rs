//! Framebuffers: the view of a rate image joins the application's views.

use crate::abi::copies::{Copies, find, slice};
use ash::vk;

/// The arguments of vkCreateFramebuffer.
pub type CreateFramebuffer<'a> = (
    vk::Device,
    *const vk::FramebufferCreateInfo<'a>,
    *const vk::AllocationCallbacks<'a>,
    *mut vk::Framebuffer,
);

/// The rate images that an imageless framebuffer will be used with. It holds for each of them: Vulkan compares it with the image's
/// creation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImagelessRateAttachment {
    /// Columns and rows of texels.
    pub texels: [u32; 2],
    /// Layers of the view.
    pub layers: u32,
    /// Usage of the image.
    pub usage: vk::ImageUsageFlags,
}

/// Whether a framebuffer has its images named when a render pass begins, and not here.
pub fn is_imageless(info: &vk::FramebufferCreateInfo<'_>) -> bool {
    info.flags.contains(vk::FramebufferCreateFlags::IMAGELESS)
}

/// Width, height and layers of an attachment that an imageless framebuffer promises.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateFramebuffer).
pub unsafe fn promised_size(info: &vk::FramebufferCreateInfo<'_>, attachment: u32) -> [u32; 3] {
    // SAFETY: the chain is valid, by the valid usage of vkCreateFramebuffer.
    let image = unsafe {
        find::<vk::FramebufferAttachmentsCreateInfo<'_>>(info.p_next).and_then(|attachments| {
            slice(attachments.p_attachment_image_infos, attachments.attachment_image_info_count)
                .get(attachment as usize)
        })
    };
    image.map_or([info.width, info.height, info.layers], |image| {
        [image.width, image.height, image.layer_count]
    })
}

/// The framebuffer with a view added behind its own, for a render pass to which rates were added.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateFramebuffer). The result points to memory of `info` and of `copies`.
pub unsafe fn with_view<'c>(
    info: &vk::FramebufferCreateInfo<'c>,
    view: vk::ImageView,
    copies: &mut Copies<'_>,
) -> vk::FramebufferCreateInfo<'c> {
    // SAFETY: valid usage demands so many views.
    let views = unsafe { slice(info.p_attachments, info.attachment_count) };
    let (first, count) = appended(views, view, copies);
    vk::FramebufferCreateInfo { p_attachments: first, attachment_count: count, ..*info }
}

/// The imageless framebuffer, as [`with_view`].
///
/// # Safety
///
/// As for [`with_view`]; the chain outlives `copies`, and is not used elsewhere meanwhile.
pub unsafe fn with_promise<'c>(
    info: &vk::FramebufferCreateInfo<'c>,
    promise: &ImagelessRateAttachment,
    copies: &mut Copies<'_>,
) -> vk::FramebufferCreateInfo<'c> {
    type Attachments<'a> = vk::FramebufferAttachmentsCreateInfo<'a>;
    // SAFETY: the chain is valid, as `# Safety` demands.
    let Some(attachments) = (unsafe { find::<Attachments<'_>>(info.p_next) }) else { return *info };
    // SAFETY: as above.
    let images =
        unsafe { slice(attachments.p_attachment_image_infos, attachments.attachment_image_info_count) };
    let [width, height] = promise.texels;
    let own = vk::FramebufferAttachmentImageInfo {
        usage: promise.usage,
        width,
        height,
        layer_count: promise.layers,
        view_format_count: 1,
        p_view_formats: &super::FORMAT,
        ..Default::default()
    };
    let (first, count) = appended(images, own, copies);
    // SAFETY: as above.
    let p_next = unsafe {
        copies.amend::<Attachments<'_>>(info.p_next, |attachments| {
            attachments.p_attachment_image_infos = first;
            attachments.attachment_image_info_count = count;
        })
    };
    vk::FramebufferCreateInfo { p_next, attachment_count: info.attachment_count + 1, ..*info }
}

/// The begin of a render pass with an imageless framebuffer, with a view added after the ones that it names.
///
/// # Safety
///
/// `info` and its chain are valid and outlive `copies`, and the chain is not used elsewhere meanwhile. The result points to memory of both.
pub unsafe fn begin_with_view<'c>(
    info: &vk::RenderPassBeginInfo<'c>,
    view: vk::ImageView,
    copies: &mut Copies<'_>,
) -> vk::RenderPassBeginInfo<'c> {
    type Begin<'a> = vk::RenderPassAttachmentBeginInfo<'a>;
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        let Some(begin) = find::<Begin<'_>>(info.p_next) else { return *info };
        let (first, count) = appended(slice(begin.p_attachments, begin.attachment_count), view, copies);
        let p_next = copies.amend::<Begin<'_>>(info.p_next, |begin| {
            begin.p_attachments = first;
            begin.attachment_count = count;
        });
        vk::RenderPassBeginInfo { p_next, ..*info }
    }
}

/// An array with one more element, and its length.
fn appended<T: Copy>(some: &[T], more: T, copies: &mut Copies<'_>) -> (*const T, u32) {
    let count = some.len() + 1;
    let first = copies.many((0..count).map(|index| some.get(index).copied().unwrap_or(more)));
    (first.cast_const(), count as u32)
}

#[cfg(test)]
mod tests;
