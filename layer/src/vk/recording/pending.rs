//! Fills that wait in a command buffer for a reader, see [`crate::backend::mask::Pending`].

use super::image_layouts::{transitions, transitions2};
use super::{Buffer, draws, stencil, timed, with_buffer};
use crate::abi::copies::slice;
use crate::backend::mask::{Attachments, MaskMap, Pending};
use crate::pass_detection::ImageKey;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

impl Buffer {
    /// Records the fills that `ends` holds for, and binds the application's state again.
    ///
    /// # Safety
    ///
    /// `handle` is this command buffer, which is recording, outside of a render pass.
    pub unsafe fn fill_where(&self, handle: vk::CommandBuffer, ends: impl Fn(&Pending) -> bool) {
        let mut ended: SmallVec<[Pending; 2]> = SmallVec::new();
        let bound = {
            let mut recorded = self.recorded();
            if recorded.pending.is_empty() {
                return;
            }
            recorded.pending.retain(|pending| {
                let ends = ends(pending);
                if ends {
                    ended.push(pending.clone());
                }
                !ends
            });
            if ended.is_empty() {
                return;
            }
            (recorded.compute.clone(), recorded.drawing.bound(), recorded.offsets.clone())
        };
        let Some(masks) = &self.armed.masks else { return };
        // SAFETY: the command buffer is recording, as `# Safety` demands; an image of which something waits is live, as it is in use.
        unsafe {
            for pending in &ended {
                masks.fill(pending, handle);
            }
            let (compute, drawing, offsets) = bound;
            compute.restore(&self.armed.next, handle);
            drawing.restore(&self.armed.next, handle);
            offsets.restore(&self.armed.next, handle);
        }
    }

    /// Records all fills that wait.
    ///
    /// # Safety
    ///
    /// As for [`Self::fill_where`].
    pub unsafe fn fill_all(&self, handle: vk::CommandBuffer) {
        // SAFETY: as above.
        unsafe { self.fill_where(handle, |_| true) };
    }

    /// Records all fills that wait, before state is bound that cannot be bound again after a fill.
    ///
    /// # Safety
    ///
    /// `handle` is this command buffer, which is recording.
    pub(super) unsafe fn fill_before_binding(&self, handle: vk::CommandBuffer) {
        if self.armed.masks.is_some() && !self.recorded().is_within_pass() {
            // SAFETY: the command buffer is recording, as `# Safety` demands, outside of a render pass.
            unsafe { self.fill_all(handle) };
        }
    }

    /// Records the fills of images that barriers bring to other layouts or queue families.
    ///
    /// # Safety
    ///
    /// As for [`Self::fill_where`], unless nothing waits.
    pub(super) unsafe fn fill_for(
        &self,
        handle: vk::CommandBuffer,
        barriers: impl Iterator<Item = (vk::Image, vk::ImageLayout, [u32; 2])> + Clone,
    ) {
        let ends = |pending: &Pending| {
            barriers.clone().any(|(image, layout, families)| pending.ends_with(image, layout, families))
        };
        // SAFETY: the command buffer is recording, as `# Safety` demands. Within render passes, barriers change no layout (Vulkan specification,
        // VUID-vkCmdPipelineBarrier-oldLayout-01181).
        unsafe { self.fill_where(handle, ends) };
    }

    /// Settles fills as a pass with these attachments begins, with this mask if it has a template: fills of its targets stay pending if they
    /// are of the same mask, fills of depth that it clears throughout are void, and fills of its other attachments end.
    ///
    /// # Safety
    ///
    /// As for [`Self::fill_where`].
    pub(super) unsafe fn settle(
        &self,
        handle: vk::CommandBuffer,
        attachments: &Attachments,
        area: vk::Rect2D,
        mask: Option<&Arc<MaskMap>>,
    ) {
        let is_void = |pending: &Pending| {
            let [width, height] = pending.map.extent();
            let is_all = area.offset == vk::Offset2D::default()
                && area.extent.width >= width
                && area.extent.height >= height;
            let cleared = attachments.depth.filter(|depth| depth.is_cleared);
            is_all && cleared.is_some_and(|depth| depth.target == pending.target)
        };
        let is_own = |pending: &Pending| mask.is_some_and(|mask| Arc::ptr_eq(mask, &pending.map));
        self.recorded().pending.retain(|pending| !is_void(pending));
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe {
            self.fill_where(handle, |pending| {
                let image = pending.target.image;
                (attachments.have(image) && !is_own(pending)) || attachments.others.contains(&image)
            });
        }
        // The fills that the pass leaves pending are known when it ends.
        self.recorded().pending.retain(|pending| !attachments.have(pending.target.image));
    }

    /// The mask whose template waits in depth of several samples.
    pub(super) fn covering(&self, depth: Option<ImageKey>) -> Option<Arc<MaskMap>> {
        let depth = depth?;
        let recorded = self.recorded();
        let holds = recorded.pending.iter().find(|pending| pending.target.image == depth);
        holds.map(|pending| Arc::clone(&pending.map))
    }
}

/// `vkEndCommandBuffer`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end_buffer(handle: vk::CommandBuffer) -> vk::Result {
    hook!("vkEndCommandBuffer", with_buffer, end_command_buffer(handle), |known, next| {
        if let Some(known) = known {
            stencil::changes(&known, handle);
            draws::settle(&known, handle);
            known.recorded().count_viewports();
            // SAFETY: the command buffer is recording, outside of render passes, by valid usage.
            unsafe {
                known.fill_all(handle);
                timed::buffer_ends(&known, handle);
            }
        }
        next()
    })
}

/// `vkCmdSetEvent`: the wait for the event may come after other commands, and the first half of its barrier covers earlier ones only.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_event(
    handle: vk::CommandBuffer,
    event: vk::Event,
    stages: vk::PipelineStageFlags,
) {
    hook!("vkCmdSetEvent", with_buffer, cmd_set_event(handle, event, stages), |known, next| {
        if let Some(known) = known {
            // SAFETY: the command buffer is recording, outside of render passes, by valid usage.
            unsafe { known.fill_all(handle) };
        }
        next();
    });
}

/// `vkCmdSetEvent2`, as [`set_event`].
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_event2(
    handle: vk::CommandBuffer,
    event: vk::Event,
    info: *const vk::DependencyInfo<'_>,
) {
    hook!("vkCmdSetEvent2", with_buffer, cmd_set_event2(handle, event, info), |known, next| {
        if let Some(known) = known {
            // SAFETY: as for `set_event`.
            unsafe { known.fill_all(handle) };
        }
        next();
    });
}

/// `vkCmdWaitEvents`.
///
/// # Safety
///
/// The valid usage of the call.
#[allow(clippy::too_many_arguments, reason = "the arguments of vkCmdWaitEvents")]
pub unsafe extern "system" fn wait_events(
    handle: vk::CommandBuffer,
    event_count: u32,
    events: *const vk::Event,
    from: vk::PipelineStageFlags,
    to: vk::PipelineStageFlags,
    memory_count: u32,
    memory: *const vk::MemoryBarrier<'_>,
    buffer_count: u32,
    buffers: *const vk::BufferMemoryBarrier<'_>,
    count: u32,
    images: *const vk::ImageMemoryBarrier<'_>,
) {
    hook!(
        "vkCmdWaitEvents",
        with_buffer,
        cmd_wait_events(
            handle,
            event_count,
            events,
            from,
            to,
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
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe { known.fill_for(handle, barriers(images)) };
            }
            next();
            if let Some(known) = known.filter(|known| count > 0 && !known.armed.layouts.is_empty()) {
                known.leave(transitions(images));
            }
        }
    );
}

/// `vkCmdWaitEvents2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn wait_events2(
    handle: vk::CommandBuffer,
    count: u32,
    events: *const vk::Event,
    infos: *const vk::DependencyInfo<'_>,
) {
    hook!("vkCmdWaitEvents2", with_buffer, cmd_wait_events2(handle, count, events, infos), |known, next| {
        // SAFETY: valid usage demands a structure for each event.
        let infos = unsafe { slice(infos, count) };
        if let Some(known) = &known {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { timed::work_begins(known, handle) };
            for info in infos {
                // SAFETY: the structure is valid, and the command buffer recording, by valid usage.
                unsafe { known.fill_for(handle, barriers2(info)) };
            }
        }
        next();
        if let Some(known) = known.filter(|known| !known.armed.layouts.is_empty()) {
            for info in infos {
                // SAFETY: as above.
                let images = unsafe { slice(info.p_image_memory_barriers, info.image_memory_barrier_count) };
                known.leave(transitions2(images));
            }
        }
    });
}

/// Image barriers, as far as they count.
pub(super) fn barriers<'a>(
    images: &'a [vk::ImageMemoryBarrier<'_>],
) -> impl Iterator<Item = (vk::Image, vk::ImageLayout, [u32; 2])> + Clone + 'a {
    images.iter().map(|barrier| {
        let families = [barrier.src_queue_family_index, barrier.dst_queue_family_index];
        (barrier.image, barrier.new_layout, families)
    })
}

/// The same of a dependency.
///
/// # Safety
///
/// `info` has as many image barriers as its count.
pub(super) unsafe fn barriers2<'a>(
    info: &'a vk::DependencyInfo<'_>,
) -> impl Iterator<Item = (vk::Image, vk::ImageLayout, [u32; 2])> + Clone + 'a {
    // SAFETY: the array has that many elements, as `# Safety` demands.
    let images = unsafe { slice(info.p_image_memory_barriers, info.image_memory_barrier_count) };
    images.iter().map(|barrier| {
        let families = [barrier.src_queue_family_index, barrier.dst_queue_family_index];
        (barrier.image, barrier.new_layout, families)
    })
}
