//! Copies between images of equal size, and other commands without draws.

use super::{Buffer, Gpu, Image, Made};
use anyhow::Result;
use ash::vk;

const SOURCE: vk::ImageLayout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
const DESTINATION: vk::ImageLayout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;

impl Gpu {
    /// Copies an image that is in TRANSFER_SRC_OPTIMAL into one that becomes a colour target.
    pub fn copy(&self, commands: vk::CommandBuffer, from: &Image, to: &Image) {
        let region = vk::ImageCopy::default()
            .src_subresource(from.subresource())
            .dst_subresource(to.subresource())
            .extent(vk::Extent3D { width: to.extent[0], height: to.extent[1], depth: 1 });
        self.transition(commands, to, vk::ImageLayout::UNDEFINED, DESTINATION);
        // SAFETY: the command buffer is being recorded, outside of a render pass; the layouts are those.
        unsafe { self.cmd_copy_image(commands, from.handle, SOURCE, to.handle, DESTINATION, &[region]) };
        self.transition(commands, to, DESTINATION, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
    }

    /// Copies an image that is in SHADER_READ_ONLY_OPTIMAL, and stays so, into a buffer.
    pub fn read_back(&self, commands: vk::CommandBuffer, from: &Image, to: &Buffer) {
        let region = vk::BufferImageCopy::default()
            .image_subresource(from.subresource())
            .image_extent(vk::Extent3D { width: from.extent[0], height: from.extent[1], depth: 1 });
        let sampled = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        self.transition(commands, from, sampled, SOURCE);
        // SAFETY: as above; the buffer has room for the image.
        unsafe { self.cmd_copy_image_to_buffer(commands, from.handle, SOURCE, to.handle, &[region]) };
        self.transition(commands, from, SOURCE, sampled);
    }

    /// As [`Self::copy`], with the rows in the opposite order.
    pub fn blit_upside_down(&self, commands: vk::CommandBuffer, from: &Image, to: &Image) {
        let [width, height] = to.extent.map(|length| length as i32);
        let corner = |x, y, z| vk::Offset3D { x, y, z };
        let region = vk::ImageBlit::default()
            .src_subresource(from.subresource())
            .src_offsets([corner(0, height, 0), corner(width, 0, 1)])
            .dst_subresource(to.subresource())
            .dst_offsets([corner(0, 0, 0), corner(width, height, 1)]);
        self.transition(commands, to, vk::ImageLayout::UNDEFINED, DESTINATION);
        // SAFETY: as above.
        unsafe {
            let nearest = vk::Filter::NEAREST;
            self.cmd_blit_image(commands, from.handle, SOURCE, to.handle, DESTINATION, &[region], nearest);
        }
        self.transition(commands, to, DESTINATION, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
    }

    /// Scales an image that is in TRANSFER_SRC_OPTIMAL into one that becomes a colour target.
    pub fn scale(&self, commands: vk::CommandBuffer, from: &Image, to: &Image) {
        let corners = |image: &Image| {
            let [x, y] = image.extent.map(|length| length as i32);
            [vk::Offset3D::default(), vk::Offset3D { x, y, z: 1 }]
        };
        let region = vk::ImageBlit::default()
            .src_subresource(from.subresource())
            .src_offsets(corners(from))
            .dst_subresource(to.subresource())
            .dst_offsets(corners(to));
        self.transition(commands, to, vk::ImageLayout::UNDEFINED, DESTINATION);
        // SAFETY: as above.
        unsafe {
            let linear = vk::Filter::LINEAR;
            self.cmd_blit_image(commands, from.handle, SOURCE, to.handle, DESTINATION, &[region], linear);
        }
        self.transition(commands, to, DESTINATION, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
    }

    /// Halves the first level of an image, in SHADER_READ_ONLY_OPTIMAL, into the next ones, down to the last.
    pub fn fill_levels(&self, commands: vk::CommandBuffer, image: &Image) {
        let sampled = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        let size = |level: u32| {
            let [x, y] = image.extent.map(|length| (length >> level).max(1) as i32);
            [vk::Offset3D::default(), vk::Offset3D { x, y, z: 1 }]
        };
        let subresource = |level| vk::ImageSubresourceLayers { mip_level: level, ..image.subresource() };
        self.transition(commands, &image.level(0), sampled, SOURCE);
        for level in 1..image.levels {
            let region = vk::ImageBlit::default()
                .src_subresource(subresource(level - 1))
                .src_offsets(size(level - 1))
                .dst_subresource(subresource(level))
                .dst_offsets(size(level));
            let handle = image.handle;
            self.transition(commands, &image.level(level), vk::ImageLayout::UNDEFINED, DESTINATION);
            // SAFETY: as above.
            unsafe {
                let linear = vk::Filter::LINEAR;
                self.cmd_blit_image(commands, handle, SOURCE, handle, DESTINATION, &[region], linear);
            }
            self.transition(commands, &image.level(level), DESTINATION, SOURCE);
        }
        self.transition(commands, image, SOURCE, sampled);
    }

    /// One layer of an image, with a view of its own, which is kept.
    ///
    /// # Errors
    /// Errors of vkCreateImageView.
    pub fn layer(&self, image: &Image, layer: u32) -> Result<Image> {
        let layer = self.viewed(&Image { base_layer: layer, layers: 1, levels: 1, ..*image })?;
        self.keep(Made::View(layer.view));
        Ok(layer)
    }

    /// Makes a semaphore, and keeps it.
    ///
    /// # Errors
    /// Errors of vkCreateSemaphore.
    pub fn semaphore(&self) -> Result<vk::Semaphore> {
        // SAFETY: the structure outlives the call.
        let semaphore = unsafe { self.device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }?;
        self.keep(Made::Semaphore(semaphore));
        Ok(semaphore)
    }

    /// Submits a command buffer to the second queue, which signals a semaphore when it is done.
    ///
    /// # Errors
    /// Errors of vkQueueSubmit.
    pub fn submit_aside(&self, commands: vk::CommandBuffer, done: vk::Semaphore) -> Result<()> {
        let (commands, done) = ([commands], [done]);
        let info = vk::SubmitInfo::default().command_buffers(&commands).signal_semaphores(&done);
        // SAFETY: this thread is the only one that uses the queue; the command buffer was recorded.
        Ok(unsafe { self.device.queue_submit(self.second_queue, &[info], vk::Fence::null()) }?)
    }
}
