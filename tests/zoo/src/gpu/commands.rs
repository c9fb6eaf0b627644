//! Command buffers, and the commands that every style needs.

use super::{Gpu, Image, Made};
use crate::truth::PassSeen;
use anyhow::Result;
use ash::vk;
use std::sync::atomic::Ordering;

impl Gpu {
    /// Makes so many command buffers in a pool of their own, which is kept.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn command_buffers(
        &self,
        count: u32,
        level: vk::CommandBufferLevel,
    ) -> Result<Vec<vk::CommandBuffer>> {
        self.command_buffers_of(self.families[0], count, level)
    }

    /// The same, for queues of that family.
    ///
    /// # Errors
    /// Errors of vkCreateCommandPool and vkAllocateCommandBuffers.
    pub fn command_buffers_of(
        &self,
        family: u32,
        count: u32,
        level: vk::CommandBufferLevel,
    ) -> Result<Vec<vk::CommandBuffer>> {
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the structure outlives the call.
        let pool = unsafe { self.device.create_command_pool(&info, None) }?;
        self.keep(Made::CommandPool(pool));
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(pool)
            .level(level)
            .command_buffer_count(count);
        // SAFETY: the pool is live.
        Ok(unsafe { self.device.allocate_command_buffers(&info) }?)
    }

    /// Records a primary command buffer from its begin to its end.
    ///
    /// # Errors
    /// Errors of the calls and of `body`.
    pub fn record(
        &self,
        commands: vk::CommandBuffer,
        flags: vk::CommandBufferUsageFlags,
        body: impl FnOnce(vk::CommandBuffer) -> Result<()>,
    ) -> Result<()> {
        let info = vk::CommandBufferBeginInfo::default().flags(flags);
        // SAFETY: the command buffer is not in use: its slot's fence was waited for, or it is new.
        unsafe { self.device.begin_command_buffer(commands, &info) }?;
        body(commands)?;
        // SAFETY: it is being recorded.
        Ok(unsafe { self.device.end_command_buffer(commands) }?)
    }

    /// Sets viewport and scissor to a rectangle at 0, 0.
    pub fn set_viewport(&self, commands: vk::CommandBuffer, [width, height]: [u32; 2]) {
        self.set_rect(commands, [0, 0], [width, height]);
    }

    /// Sets viewport and scissor to a rectangle.
    pub fn set_rect(&self, commands: vk::CommandBuffer, [x, y]: [u32; 2], [width, height]: [u32; 2]) {
        let viewport = vk::Viewport {
            x: x as f32,
            y: y as f32,
            width: width as f32,
            height: height as f32,
            min_depth: 0.0,
            max_depth: 1.0,
        };
        let scissor = vk::Rect2D {
            offset: vk::Offset2D { x: x as i32, y: y as i32 },
            extent: vk::Extent2D { width, height },
        };
        // SAFETY: the command buffer is being recorded.
        unsafe {
            self.device.cmd_set_viewport(commands, 0, &[viewport]);
            self.device.cmd_set_scissor(commands, 0, &[scissor]);
        }
    }

    /// Brings an image from one layout to another, between all work before and all after; nothing where they are equal,
    /// but the order.
    pub fn transition(
        &self,
        commands: vk::CommandBuffer,
        image: &Image,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let barrier = vk::ImageMemoryBarrier::default()
            .image(image.handle)
            .subresource_range(image.range())
            .old_layout(from)
            .new_layout(to)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
        self.barrier(commands, &[], &[barrier]);
    }

    /// Gives a colour target, whose layout stays, from the second queue's family to that of the session: recorded for the second queue
    /// after all uses there, and for the session's before all uses there. Nothing where both have one family.
    pub fn give_back(&self, commands: vk::CommandBuffer, image: &Image) {
        if self.families[0] == self.families[1] {
            return;
        }
        let barrier = vk::ImageMemoryBarrier::default()
            .image(image.handle)
            .subresource_range(image.range())
            .old_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .new_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .src_queue_family_index(self.families[1])
            .dst_queue_family_index(self.families[0])
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
        self.barrier(commands, &[], &[barrier]);
    }

    /// A barrier between all work before and all after.
    pub fn barrier(
        &self,
        commands: vk::CommandBuffer,
        memory: &[vk::MemoryBarrier],
        images: &[vk::ImageMemoryBarrier],
    ) {
        let all = vk::PipelineStageFlags::ALL_COMMANDS;
        // SAFETY: the command buffer is being recorded, outside of a render pass; the images are live.
        unsafe {
            self.device.cmd_pipeline_barrier(
                commands,
                all,
                all,
                vk::DependencyFlags::empty(),
                memory,
                &[],
                images,
            );
        }
    }

    /// Notes a pass that is being begun: number of the frame, and of the pass in it.
    pub fn note_pass(&self, seen: PassSeen) -> (u64, usize) {
        let mut begun = self.begun.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        begun.push(seen);
        (self.frames.load(Ordering::Relaxed), begun.len() - 1)
    }

    /// The number of the next pass, as [`Self::note_pass`] will have it.
    pub fn next_pass(&self) -> (u64, usize) {
        let begun = self.begun.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        (self.frames.load(Ordering::Relaxed), begun.len())
    }

    /// Ends a frame, and returns its passes, which were begun since the last call.
    pub fn take_begun(&self) -> Vec<PassSeen> {
        self.frames.fetch_add(1, Ordering::Relaxed);
        std::mem::take(&mut *self.begun.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}
