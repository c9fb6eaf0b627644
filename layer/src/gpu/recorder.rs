//! Recording of commands.

use super::barrier::ImageBarrier;
use super::{ColorTarget, Comparison, IndirectSize, TilePipeline};
use ash::vk;

/// A command buffer that is being recorded.
pub(crate) struct Recorder<'a> {
    device: &'a ash::Device,
    commands: vk::CommandBuffer,
}

/// Most bytes in one update of a buffer (vkCmdUpdateBuffer).
const MOST_UPDATED: usize = 65_536;

/// The first `layers` layers of an image with one mip level.
fn range(aspect_mask: vk::ImageAspectFlags, layers: u32) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange {
        aspect_mask,
        base_mip_level: 0,
        level_count: 1,
        base_array_layer: 0,
        layer_count: layers,
    }
}

impl<'a> Recorder<'a> {
    pub(super) fn new(device: &'a ash::Device, commands: vk::CommandBuffer) -> Self {
        Self { device, commands }
    }

    /// Records a barrier over all layers of a colour image.
    pub(crate) fn barrier(&self, barrier: &ImageBarrier, image: vk::Image, layers: u32) {
        self.barrier_of(barrier, image, vk::ImageAspectFlags::COLOR, layers);
    }

    /// The same for all aspects of any image.
    pub(crate) fn barrier_of(
        &self,
        barrier: &ImageBarrier,
        image: vk::Image,
        aspects: vk::ImageAspectFlags,
        layers: u32,
    ) {
        let info = vk::ImageMemoryBarrier::default()
            .image(image)
            .old_layout(barrier.old_layout)
            .new_layout(barrier.new_layout)
            .src_access_mask(barrier.src_access)
            .dst_access_mask(barrier.dst_access)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .subresource_range(range(aspects, layers));
        let (src, dst) = (barrier.src_stage, barrier.dst_stage);
        let none = vk::DependencyFlags::empty();
        // SAFETY: the command buffer is being recorded, outside of a render pass; the image is live.
        unsafe { self.device.cmd_pipeline_barrier(self.commands, src, dst, none, &[], &[], &[info]) };
    }

    /// Copies all layers from an image in TRANSFER_SRC_OPTIMAL to one of the same format and size in
    /// TRANSFER_DST_OPTIMAL.
    pub(crate) fn copy_image(&self, from: vk::Image, to: vk::Image, extent: vk::Extent2D, layers: u32) {
        self.copy_aspect(vk::ImageAspectFlags::COLOR, [from, to], extent, layers);
    }

    /// The same for one aspect of images, the first of which is copied to the second.
    pub(crate) fn copy_aspect(
        &self,
        aspect_mask: vk::ImageAspectFlags,
        [from, to]: [vk::Image; 2],
        extent: vk::Extent2D,
        layers: u32,
    ) {
        let subresource = vk::ImageSubresourceLayers {
            aspect_mask,
            mip_level: 0,
            base_array_layer: 0,
            layer_count: layers,
        };
        let region = vk::ImageCopy::default()
            .src_subresource(subresource)
            .dst_subresource(subresource)
            .extent(extent.into());
        self.copy_regions(from, to, &[region]);
    }

    /// Copies rectangles from an image in TRANSFER_SRC_OPTIMAL to one of the same format in TRANSFER_DST_OPTIMAL; they are
    /// within both, and do not overlap where they go to.
    pub(crate) fn copy_regions(&self, from: vk::Image, to: vk::Image, regions: &[vk::ImageCopy]) {
        let (source, target) = (vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        // SAFETY: the command buffer is being recorded, outside of a render pass; both images are live and contain the regions.
        unsafe { self.device.cmd_copy_image(self.commands, from, source, to, target, regions) };
    }

    /// Runs a comparison.
    pub(crate) fn compare(&self, compare: &Compare<'_>) {
        let (device, commands, compute) = (self.device, self.commands, vk::PipelineBindPoint::COMPUTE);
        let [newest, earlier] = compare.textures;
        let sets = [compare.parameters, newest, earlier, compare.depth.unwrap_or_default()];
        let sets = &sets[..3 + usize::from(compare.depth.is_some())];
        let layout = compare.comparison.layout();
        // SAFETY: the command buffer is being recorded, outside of a render pass; the sets have the layouts of the pipeline, and
        // one dynamic offset, which comes from the uniform's ring; the number of workgroups lies in a ring, too.
        unsafe {
            device.cmd_bind_pipeline(commands, compute, compare.comparison.handle());
            device.cmd_bind_descriptor_sets(commands, compute, layout, 0, sets, &[compare.offset]);
            device.cmd_dispatch_indirect(commands, compare.groups.buffer, compare.groups.offset);
        }
    }

    /// Makes writes of compute shaders to buffers visible to the host, once the submit has finished.
    pub(crate) fn computed_to_host(&self) {
        let info = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::SHADER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ);
        let (src, dst) = (vk::PipelineStageFlags::COMPUTE_SHADER, vk::PipelineStageFlags::HOST);
        let none = vk::DependencyFlags::empty();
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe { self.device.cmd_pipeline_barrier(self.commands, src, dst, none, &[info], &[], &[]) };
    }

    /// Writes bytes to a buffer at an offset, both multiples of four, within it.
    pub(crate) fn update_buffer(&self, to: vk::Buffer, offset: u64, bytes: &[u8]) {
        for (part, bytes) in (0u64..).zip(bytes.chunks(MOST_UPDATED)) {
            let offset = offset + part * MOST_UPDATED as u64;
            // SAFETY: the command buffer is being recorded, outside of a render pass; the buffer is live, may be copied to, and has
            // room for as many bytes as an update may have.
            unsafe { self.device.cmd_update_buffer(self.commands, to, offset, bytes) };
        }
    }

    /// From reads of buffers by fragment shaders, and earlier updates of unread parts, to updates.
    pub(crate) fn reads_to_updates(&self) {
        let updates = vk::PipelineStageFlags::TRANSFER;
        let before = vk::PipelineStageFlags::FRAGMENT_SHADER | updates;
        let writes = vk::AccessFlags::TRANSFER_WRITE;
        let barrier = vk::MemoryBarrier::default().src_access_mask(writes).dst_access_mask(writes);
        self.memory_barrier(before, updates, barrier);
    }

    /// From updates of buffers, and copies to them on this queue, to reads of fragment shaders.
    pub(crate) fn updates_to_reads(&self) {
        let (updates, reads) = (vk::PipelineStageFlags::TRANSFER, vk::PipelineStageFlags::FRAGMENT_SHADER);
        let barrier = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::SHADER_READ);
        self.memory_barrier(updates, reads, barrier);
    }

    fn memory_barrier(
        &self,
        before: vk::PipelineStageFlags,
        after: vk::PipelineStageFlags,
        barrier: vk::MemoryBarrier<'_>,
    ) {
        let none = vk::DependencyFlags::empty();
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe {
            self.device.cmd_pipeline_barrier(self.commands, before, after, none, &[barrier], &[], &[]);
        }
    }

    /// Records the draws of `draw` to `target`, which is COLOR_ATTACHMENT_OPTIMAL and keeps its content.
    pub(crate) fn draw_to(&self, target: &ColorTarget, draw: impl FnOnce(&DrawRecorder)) {
        let info = vk::RenderPassBeginInfo::default()
            .render_pass(target.pass())
            .framebuffer(target.framebuffer())
            .render_area(target.extent().into());
        // SAFETY: the command buffer is being recorded, outside of a render pass, and the pass is ended below;
        // pass and framebuffer fit each other.
        unsafe {
            self.device.cmd_begin_render_pass(self.commands, &info, vk::SubpassContents::INLINE);
        }
        draw(&DrawRecorder { recorder: self });
        // SAFETY: the pass was begun above.
        unsafe { self.device.cmd_end_render_pass(self.commands) };
    }
}

/// A comparison to run.
pub(crate) struct Compare<'a> {
    /// Its pipeline.
    pub(crate) comparison: &'a Comparison,
    /// Set 0.
    pub(crate) parameters: vk::DescriptorSet,
    /// Offset of its uniform, from its ring.
    pub(crate) offset: u32,
    /// Sets 1 and 2.
    pub(crate) textures: [vk::DescriptorSet; 2],
    /// Set 3, of a comparison that has it.
    pub(crate) depth: Option<vk::DescriptorSet>,
    /// Number of workgroups.
    pub(crate) groups: IndirectSize,
}

/// Recording within a render pass.
pub(crate) struct DrawRecorder<'a> {
    recorder: &'a Recorder<'a>,
}

/// Tiles to draw.
pub(crate) struct TileDraw<'a> {
    /// The pipeline that draws them.
    pub(crate) pipeline: &'a TilePipeline,
    /// Set 0, of the kind that the pipeline takes.
    pub(crate) parameters: vk::DescriptorSet,
    /// Offsets of the uniforms of that kind, each from its ring.
    pub(crate) offsets: &'a [u32],
    /// Set 1, where the pipeline's shaders use it.
    pub(crate) texture: Option<vk::DescriptorSet>,
    /// Sets 2 and 3, of a pipeline that has them; then it has a texture too.
    pub(crate) depth: Option<[vk::DescriptorSet; 2]>,
    /// The rectangle that the tiles divide, within the target.
    pub(crate) viewport: vk::Rect2D,
    /// The rectangle that may be written, within the target.
    pub(crate) scissor: vk::Rect2D,
    /// The instances.
    pub(crate) tiles: Tiles,
}

/// Instances of a draw, from the first one on.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Tiles {
    /// So many.
    Number(u32),
    /// As many as memory contains.
    Indirect(IndirectSize),
}

impl DrawRecorder<'_> {
    /// Draws tiles.
    pub(crate) fn draw_tiles(&self, draw: &TileDraw<'_>) {
        let Recorder { device, commands, .. } = *self.recorder;
        let viewport = vk::Viewport {
            x: draw.viewport.offset.x as f32,
            y: draw.viewport.offset.y as f32,
            width: draw.viewport.extent.width as f32,
            height: draw.viewport.extent.height as f32,
            min_depth: 0.0,
            max_depth: 1.0,
        };
        let (texture, [depth, earlier]) = (draw.texture.unwrap_or_default(), draw.depth.unwrap_or_default());
        let count = if draw.depth.is_some() { 4 } else { 1 + usize::from(draw.texture.is_some()) };
        let sets = &[draw.parameters, texture, depth, earlier][..count];
        let layout = draw.pipeline.layout();
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: within a render pass that the pipeline is compatible with; the sets have the layouts of the
        // pipeline, and as many dynamic offsets as uniforms, which come from the same rings. A set that its shaders do not use
        // need not be bound.
        unsafe {
            device.cmd_bind_pipeline(commands, graphics, draw.pipeline.handle());
            device.cmd_bind_descriptor_sets(commands, graphics, layout, 0, sets, draw.offsets);
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[draw.scissor]);
            match draw.tiles {
                Tiles::Number(instances) => device.cmd_draw(commands, 4, instances, 0, 0),
                Tiles::Indirect(size) => device.cmd_draw_indirect(commands, size.buffer, size.offset, 1, 0),
            }
        }
    }
}
