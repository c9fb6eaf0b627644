//! Framebuffers with one attachment of one layer.

use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;

/// A framebuffer of `view`, which outlives it, of an image of `extent`, for `pass`, which has one attachment of the view's format and
/// samples.
///
/// # Errors
/// A failed call.
pub(super) fn framebuffer(
    gpu: &Arc<Gpu>,
    pass: &Owned<vk::RenderPass>,
    view: &Owned<vk::ImageView>,
    extent: vk::Extent2D,
) -> Result<Owned<vk::Framebuffer>, GpuError> {
    let attachments = [view.handle()];
    let info = vk::FramebufferCreateInfo::default()
        .render_pass(pass.handle())
        .attachments(&attachments)
        .width(extent.width)
        .height(extent.height)
        .layers(1);
    // SAFETY: pass and view are live and fit each other, and the image has this extent.
    unsafe {
        let handle =
            gpu.device.create_framebuffer(&info, None).map_err(GpuError::from_call("vkCreateFramebuffer"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_framebuffer(handle, None)))
    }
}
