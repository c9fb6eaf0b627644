//! Barriers and passes that leave images of XR swapchains in another layout.

use super::pending::{barriers, barriers2};
use super::{Buffer, timed, with_buffer};
use crate::abi::guard;
use crate::pass_detection::Target;
use ash::vk;
use std::slice;

/// `vkCmdPipelineBarrier`.
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
    // SAFETY: the application's own arguments; `count` barriers of images are there.
    guard(
        "vkCmdPipelineBarrier",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                with_buffer: handle,
                cmd_pipeline_barrier(
                    handle, from, to, flags, memory_count, memory, buffer_count, buffers, count, images
                ),
                ()
            )
        },
        // SAFETY: the application's own arguments, valid for the next layer as for us; `images` are `count`, as the specification demands.
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_pipeline_barrier) else { return };
            if let Some(known) = &known {
                timed::work_begins(known, handle);
            }
            if let Some(known) = known.as_ref().filter(|_| count > 0) {
                known.fill_for(handle, barriers(slice::from_raw_parts(images, count as usize)));
            }
            next(handle, from, to, flags, memory_count, memory, buffer_count, buffers, count, images);
            answer.made();
            if let Some(known) = known.filter(|known| count > 0 && !known.armed.layouts.is_empty()) {
                let images = slice::from_raw_parts(images, count as usize);
                known.leave(images.iter().map(|barrier| (barrier.image, barrier.new_layout)));
            }
        },
    );
}

/// `vkCmdPipelineBarrier2`.
pub unsafe extern "system" fn pipeline_barrier2(
    handle: vk::CommandBuffer,
    info: *const vk::DependencyInfo<'_>,
) {
    // SAFETY: the application's own arguments; `info` is valid, with as many barriers as it says.
    guard(
        "vkCmdPipelineBarrier2",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_pipeline_barrier2(handle, info), ()) },
        // SAFETY: as above: `info` is valid, with as many barriers as it says.
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_pipeline_barrier2) else { return };
            if let Some(known) = &known {
                timed::work_begins(known, handle);
                known.fill_for(handle, barriers2(&*info));
            }
            next(handle, info);
            answer.made();
            let count = (*info).image_memory_barrier_count as usize;
            if let Some(known) = known.filter(|known| count > 0 && !known.armed.layouts.is_empty()) {
                let images = slice::from_raw_parts((*info).p_image_memory_barriers, count);
                known.leave(images.iter().map(|barrier| (barrier.image, barrier.new_layout)));
            }
        },
    );
}

impl Buffer {
    /// Notes the layouts that commands leave images in, of those that are followed.
    fn leave(&self, images: impl Iterator<Item = (vk::Image, vk::ImageLayout)>) {
        let followed = images.filter(|(image, _)| self.armed.layouts.of(*image).is_some());
        let mut followed = followed.peekable();
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
        self.leave(
            targets.filter_map(|(target, layout)| Some((objects.image_of(target.image)?.handle, layout))),
        );
    }
}
