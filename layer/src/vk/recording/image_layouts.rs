//! Barriers and passes that leave swapchain images in another layout.

use super::pending::{barriers, barriers2};
use super::{Buffer, timed, with_buffer};
use crate::abi::copies::slice;
use crate::pass_detection::Target;
use ash::vk;

/// `vkCmdPipelineBarrier`.
///
/// # Safety
///
/// The valid usage of the call.
#[allow(clippy::too_many_arguments, reason = "the arguments of vkCmdPipelineBarrier")]
pub unsafe extern "system" fn pipeline_barrier(
    handle: vk::CommandBuffer,
    from: vk::PipelineStageFlags,
    to: vk::PipelineStageFlags,
    flags: vk::DependencyFlags,
    memory_count: u32,
    memory: *const vk::MemoryBarrier<'_>,
    buffer_count: u32,
    buffers: *const vk::BufferMemoryBarrier<'_>,
    count: u32,
    images: *const vk::ImageMemoryBarrier<'_>,
) {
    hook!(
        "vkCmdPipelineBarrier",
        with_buffer,
        cmd_pipeline_barrier(
            handle,
            from,
            to,
            flags,
            memory_count,
            memory,
            buffer_count,
            buffers,
            count,
            images
        ),
        |known, next| {
            // SAFETY: valid usage demands so many barriers of images.
            let images = unsafe { slice(images, count) };
            if let Some(known) = &known {
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { timed::work_begins(known, handle) };
            }
            if let Some(known) = known.as_ref().filter(|_| count > 0) {
                // SAFETY: as above.
                unsafe { known.fill_for(handle, barriers(images)) };
            }
            next();
            if let Some(known) = known.filter(|known| count > 0 && !known.armed.layouts.is_empty()) {
                known.leave(transitions(images));
            }
        }
    );
}

/// `vkCmdPipelineBarrier2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn pipeline_barrier2(
    handle: vk::CommandBuffer,
    info: *const vk::DependencyInfo<'_>,
) {
    hook!("vkCmdPipelineBarrier2", with_buffer, cmd_pipeline_barrier2(handle, info), |known, next| {
        // SAFETY: the pointer is valid, by valid usage, for the time of the call, with so many barriers of images.
        let (info, images) =
            unsafe { (&*info, slice((*info).p_image_memory_barriers, (*info).image_memory_barrier_count)) };
        if let Some(known) = &known {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe {
                timed::work_begins(known, handle);
                known.fill_for(handle, barriers2(info));
            }
        }
        next();
        if let Some(known) = known.filter(|known| !images.is_empty() && !known.armed.layouts.is_empty()) {
            known.leave(transitions2(images));
        }
    });
}

/// Aspects of an image, and the layout in which a command leaves them; `None`: as they were.
type Transition = (vk::Image, Option<vk::ImageLayout>, vk::ImageAspectFlags);

/// The new layout of a barrier. With the same layout twice, it changes none, whatever the layout is (Vulkan specification,
/// VkImageMemoryBarrier2): DXVK leaves images in one and then has such a barrier with another.
fn new_layout(old: vk::ImageLayout, new: vk::ImageLayout) -> Option<vk::ImageLayout> {
    (old != new).then_some(new)
}

/// The transitions by barriers.
pub(super) fn transitions(images: &[vk::ImageMemoryBarrier<'_>]) -> impl Iterator<Item = Transition> {
    images
        .iter()
        .map(|of| (of.image, new_layout(of.old_layout, of.new_layout), of.subresource_range.aspect_mask))
}

/// The same of the newer structure.
pub(super) fn transitions2(images: &[vk::ImageMemoryBarrier2<'_>]) -> impl Iterator<Item = Transition> {
    images
        .iter()
        .map(|of| (of.image, new_layout(of.old_layout, of.new_layout), of.subresource_range.aspect_mask))
}

impl Buffer {
    /// Notes the layouts that commands leave aspects of followed images in. Stencil alone is not read.
    pub(super) fn leave(&self, images: impl Iterator<Item = Transition>) {
        let is_followed = |image| self.armed.layouts.of(image).is_some();
        let followed = images
            .filter(|(image, _, aspects)| *aspects != vk::ImageAspectFlags::STENCIL && is_followed(*image));
        let mut followed = followed.map(|(image, layout, _)| (image, layout)).peekable();
        if followed.peek().is_some() {
            self.recorded().layouts.extend(followed);
        }
    }

    /// The same for the targets of a pass, with their layouts after it.
    pub(super) fn leave_targets(&self, targets: impl Iterator<Item = (Target, vk::ImageLayout)>) {
        if self.armed.layouts.is_empty() {
            return;
        }
        let objects = &self.armed.objects;
        self.leave(targets.filter_map(|(target, layout)| {
            let image = objects.image_of(target.image)?.handle;
            Some((image, Some(layout), vk::ImageAspectFlags::empty()))
        }));
    }
}
