//! Commands of ours in a command buffer of the application's.

use super::compute::{ComputeLayout, ComputeSet};
use super::{DepthTarget, DeviceBuffer, Gpu, Owned, SamplePass, SampleTarget};
use ash::vk;

/// A command buffer that the application is recording, outside of any render pass.
///
/// Of its state, only the compute bindings change: pipeline and descriptor set 0; except by `draw_depth` and [`AppCommands::draw_samples`].
pub struct AppCommands<'a> {
    gpu: &'a Gpu,
    commands: vk::CommandBuffer,
}

/// One side of a barrier: stages, and the accesses in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scope {
    /// The stages.
    pub stages: vk::PipelineStageFlags,
    /// The accesses.
    pub access: vk::AccessFlags,
}

impl Scope {
    /// Everything that an application may do.
    pub const ALL: Self = Self {
        stages: vk::PipelineStageFlags::ALL_COMMANDS,
        access: vk::AccessFlags::from_raw(
            vk::AccessFlags::MEMORY_READ.as_raw() | vk::AccessFlags::MEMORY_WRITE.as_raw(),
        ),
    };
}

/// Read accesses of masked passes to their buffers: as list, as arguments, and as template, which may be drawn to an image.
const BUFFER_READS: Scope = Scope {
    stages: vk::PipelineStageFlags::from_raw(
        vk::PipelineStageFlags::COMPUTE_SHADER.as_raw()
            | vk::PipelineStageFlags::FRAGMENT_SHADER.as_raw()
            | vk::PipelineStageFlags::DRAW_INDIRECT.as_raw()
            | vk::PipelineStageFlags::TRANSFER.as_raw(),
    ),
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::SHADER_READ.as_raw()
            | vk::AccessFlags::INDIRECT_COMMAND_READ.as_raw()
            | vk::AccessFlags::TRANSFER_READ.as_raw(),
    ),
};

/// Write accesses to those buffers.
const BUFFER_COPIES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };

/// Accesses of compute shaders to buffers.
pub(crate) const COMPUTES: Scope = Scope {
    stages: vk::PipelineStageFlags::COMPUTE_SHADER,
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::SHADER_READ.as_raw() | vk::AccessFlags::SHADER_WRITE.as_raw(),
    ),
};

/// Readers of the results of a compute shader: copies, and compute shaders.
pub(crate) const READS_OF_RESULTS: Scope = Scope {
    stages: vk::PipelineStageFlags::from_raw(
        vk::PipelineStageFlags::COMPUTE_SHADER.as_raw() | vk::PipelineStageFlags::TRANSFER.as_raw(),
    ),
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::SHADER_READ.as_raw()
            | vk::AccessFlags::SHADER_WRITE.as_raw()
            | vk::AccessFlags::TRANSFER_READ.as_raw(),
    ),
};

/// A part of an image that a barrier is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImagePart {
    /// The image.
    pub image: vk::Image,
    /// Aspects: of a depth-stencil image both.
    pub aspects: vk::ImageAspectFlags,
    /// The mip level.
    pub level: u32,
    /// The first array layer.
    pub first_layer: u32,
    /// Number of array layers.
    pub layers: u32,
}

impl ImagePart {
    /// The part as commands that copy take it.
    fn subresource(self) -> vk::ImageSubresourceLayers {
        vk::ImageSubresourceLayers {
            aspect_mask: self.aspects,
            mip_level: self.level,
            base_array_layer: self.first_layer,
            layer_count: self.layers,
        }
    }
}

impl<'a> AppCommands<'a> {
    /// Adds to `commands`.
    ///
    /// # Safety
    /// `commands` is a primary command buffer of the device of `gpu`, for a queue that can draw and compute. It is being recorded, outside
    /// of a render pass, and not elsewhere during the life of the result. Images passed to the methods are live; they and all objects of
    /// ours stay so until its last submission has finished.
    pub unsafe fn new(gpu: &'a Gpu, commands: vk::CommandBuffer) -> Self {
        Self { gpu, commands }
    }

    /// Orders accesses to a part of an image, and changes its layout.
    pub(crate) fn barrier(
        &self,
        part: ImagePart,
        (old_layout, from): (vk::ImageLayout, Scope),
        (new_layout, to): (vk::ImageLayout, Scope),
    ) {
        let info = vk::ImageMemoryBarrier::default()
            .image(part.image)
            .old_layout(old_layout)
            .new_layout(new_layout)
            .src_access_mask(from.access)
            .dst_access_mask(to.access)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask: part.aspects,
                base_mip_level: part.level,
                level_count: 1,
                base_array_layer: part.first_layer,
                layer_count: part.layers,
            });
        let none = vk::DependencyFlags::empty();
        // SAFETY: the command buffer is being recorded outside of a render pass, and the image is live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_pipeline_barrier(
                self.commands,
                from.stages,
                to.stages,
                none,
                &[],
                &[],
                &[info],
            );
        }
    }

    /// Copies from a buffer to a part of an image that is in TRANSFER_DST_OPTIMAL; the region lies in both.
    pub(crate) fn copy_to_image(&self, from: &DeviceBuffer, to: vk::Image, region: vk::BufferImageCopy) {
        let layout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        // SAFETY: the command buffer is being recorded outside of a render pass, and the image is live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_copy_buffer_to_image(self.commands, from.handle(), to, layout, &[region]);
        }
    }

    /// Copies from a part of an image that is in TRANSFER_SRC_OPTIMAL to a buffer; the region lies in both.
    pub(crate) fn copy_from_image(&self, from: vk::Image, to: &DeviceBuffer, region: vk::BufferImageCopy) {
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        // SAFETY: the command buffer is being recorded outside of a render pass, and the image is live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_copy_image_to_buffer(self.commands, from, layout, to.handle(), &[region]);
        }
    }

    /// Copies a part of an image, from its corner on, to as large a part of another of which texels have as many bits; they
    /// are in TRANSFER_SRC_OPTIMAL and TRANSFER_DST_OPTIMAL.
    pub(crate) fn copy_image(&self, from: ImagePart, to: ImagePart, extent: vk::Extent2D) {
        let region = vk::ImageCopy::default()
            .src_subresource(from.subresource())
            .dst_subresource(to.subresource())
            .extent(extent.into());
        let layouts = [vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL];
        // SAFETY: the command buffer is being recorded outside of a render pass, and the images are live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_copy_image(
                self.commands,
                from.image,
                layouts[0],
                to.image,
                layouts[1],
                &[region],
            );
        }
    }

    /// Resolves a part of an image of several samples, from its corner on, to as large a part of one of one sample and the same format; they
    /// are in TRANSFER_SRC_OPTIMAL and TRANSFER_DST_OPTIMAL.
    pub(crate) fn resolve_image(&self, from: ImagePart, to: ImagePart, extent: vk::Extent2D) {
        let region = vk::ImageResolve::default()
            .src_subresource(from.subresource())
            .dst_subresource(to.subresource())
            .extent(extent.into());
        let layouts = [vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL];
        // SAFETY: the command buffer is being recorded outside of a render pass, and the images are live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_resolve_image(
                self.commands,
                from.image,
                layouts[0],
                to.image,
                layouts[1],
                &[region],
            );
        }
    }

    /// Copies a rectangle of depth to the same place of an image of the same format and samples, in the layers that both have;
    /// they are in TRANSFER_SRC_OPTIMAL and TRANSFER_DST_OPTIMAL.
    pub(crate) fn copy_depth(&self, from: ImagePart, to: ImagePart, area: vk::Rect2D) {
        let layers = |part: ImagePart| vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::DEPTH,
            mip_level: part.level,
            base_array_layer: part.first_layer,
            layer_count: from.layers.min(to.layers),
        };
        let offset = vk::Offset3D { x: area.offset.x, y: area.offset.y, z: 0 };
        let region = vk::ImageCopy::default()
            .src_subresource(layers(from))
            .src_offset(offset)
            .dst_subresource(layers(to))
            .dst_offset(offset)
            .extent(area.extent.into());
        let layouts = [vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL];
        // SAFETY: the command buffer is being recorded outside of a render pass, and the images are live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_copy_image(
                self.commands,
                from.image,
                layouts[0],
                to.image,
                layouts[1],
                &[region],
            );
        }
    }

    /// Draws to all layers of a depth image of ours, in a command buffer of ours, which changes the bound graphics state. In order with
    /// copies from the image before and after.
    pub(crate) fn draw_depth(&self, target: &DepthTarget, layout: &ComputeLayout, set: &ComputeSet) {
        // SAFETY: the command buffer is being recorded outside of a render pass, as `new` demands; the set has this layout,
        // which the target was made with.
        unsafe { target.draw(&self.gpu.device, self.commands, layout.handle(), set.handle()) };
    }

    /// Draws to images of several samples, ordered by the caller's barriers. The bound graphics state changes: pipeline, descriptor set 0,
    /// viewport and scissor 0.
    pub(crate) fn draw_samples(
        &self,
        target: &SampleTarget,
        pass: &SamplePass,
        (layout, sets): (&ComputeLayout, &[ComputeSet]),
    ) {
        // SAFETY: the command buffer is being recorded outside of a render pass, as `new` demands; the sets have this layout, which pass and
        // target were made with.
        unsafe { target.draw(&self.gpu.device, self.commands, pass, (layout.handle(), sets)) };
    }

    /// Copies `size` bytes from a buffer, from an offset on, to an offset in one; both are as long.
    pub(crate) fn copy_buffer(&self, from: (vk::Buffer, u64), to: (vk::Buffer, u64), size: u64) {
        let ((from, src_offset), (to, dst_offset)) = (from, to);
        let region = vk::BufferCopy { src_offset, dst_offset, size };
        // SAFETY: the command buffer is being recorded outside of a render pass, and the buffers are live, as `new` demands.
        unsafe { self.gpu.device.cmd_copy_buffer(self.commands, from, to, &[region]) };
    }

    /// Orders copies to buffers after all earlier reading of them by masked passes.
    pub(crate) fn reads_to_copies(&self) {
        self.memory_barrier(BUFFER_READS, BUFFER_COPIES);
    }

    /// Orders reading of buffers by masked passes after copies to them.
    pub(crate) fn copies_to_reads(&self) {
        self.memory_barrier(BUFFER_COPIES, BUFFER_READS);
    }

    /// Orders reads of buffers by masked passes after the writes of compute shaders.
    pub(crate) fn computes_to_reads(&self) {
        self.memory_barrier(COMPUTES, BUFFER_READS);
    }

    /// Orders compute shaders from here on after the writes of earlier ones.
    pub(crate) fn computed_to_computed(&self) {
        self.memory_barrier(COMPUTES, COMPUTES);
    }

    /// Writes parameters of compute shaders to the beginning of a buffer: at most 65,536 bytes, a multiple of 4. Ordered
    /// after earlier use of them, and before later.
    pub(crate) fn write_parameters(&self, to: &DeviceBuffer, bytes: &[u8]) {
        const PARAMETERS: Scope =
            Scope { stages: vk::PipelineStageFlags::COMPUTE_SHADER, access: vk::AccessFlags::SHADER_READ };
        self.memory_barrier(PARAMETERS, BUFFER_COPIES);
        // SAFETY: the command buffer is being recorded outside of a render pass, and the buffer is live, as `new` demands.
        unsafe { self.gpu.device.cmd_update_buffer(self.commands, to.handle(), 0, bytes) };
        self.memory_barrier(BUFFER_COPIES, PARAMETERS);
    }

    /// Writes words to a buffer at an offset in bytes, a multiple of 4, at most 16,384 of them: a transfer, ordered by the caller's
    /// barriers.
    pub(crate) fn update_words(&self, to: vk::Buffer, offset: u64, words: &[u32]) {
        // SAFETY: the command buffer is being recorded outside of a render pass, and the buffer is live, as `new` demands.
        unsafe {
            self.gpu.device.cmd_update_buffer(self.commands, to, offset, bytemuck::cast_slice(words));
        }
    }

    /// Writes one word all over a buffer: a transfer, ordered by the caller's barriers.
    pub(crate) fn fill_words(&self, to: vk::Buffer, word: u32) {
        // SAFETY: the command buffer is being recorded outside of a render pass, and the buffer is live, as `new` demands.
        unsafe { self.gpu.device.cmd_fill_buffer(self.commands, to, 0, vk::WHOLE_SIZE, word) };
    }

    /// Orders accesses to memory.
    pub(crate) fn memory_barrier(&self, from: Scope, to: Scope) {
        let info = vk::MemoryBarrier::default().src_access_mask(from.access).dst_access_mask(to.access);
        let none = vk::DependencyFlags::empty();
        // SAFETY: the command buffer is being recorded outside of a render pass, as `new` demands.
        unsafe {
            self.gpu.device.cmd_pipeline_barrier(
                self.commands,
                from.stages,
                to.stages,
                none,
                &[info],
                &[],
                &[],
            );
        }
    }

    /// Runs the number of workgroups in three words at the arguments: a buffer and an offset in bytes, a multiple of 4.
    pub(crate) fn dispatch_indirect(
        &self,
        layout: &ComputeLayout,
        pipeline: &Owned<vk::Pipeline>,
        set: &ComputeSet,
        (arguments, offset): (vk::Buffer, u64),
    ) {
        let (device, commands, compute) = (&self.gpu.device, self.commands, vk::PipelineBindPoint::COMPUTE);
        // SAFETY: the command buffer is being recorded outside of a render pass, as `new` demands; pipeline and set have
        // this layout, and the buffer was made to hold the arguments.
        unsafe {
            device.cmd_bind_pipeline(commands, compute, pipeline.handle());
            device.cmd_bind_descriptor_sets(commands, compute, layout.handle(), 0, &[set.handle()], &[]);
            device.cmd_dispatch_indirect(commands, arguments, offset);
        }
    }

    /// Runs `groups` workgroups.
    pub(crate) fn dispatch(
        &self,
        layout: &ComputeLayout,
        pipeline: &Owned<vk::Pipeline>,
        set: &ComputeSet,
        groups: [u32; 2],
    ) {
        let (device, commands, compute) = (&self.gpu.device, self.commands, vk::PipelineBindPoint::COMPUTE);
        // SAFETY: the command buffer is being recorded outside of a render pass, as `new` demands; pipeline and set have
        // this layout.
        unsafe {
            device.cmd_bind_pipeline(commands, compute, pipeline.handle());
            device.cmd_bind_descriptor_sets(commands, compute, layout.handle(), 0, &[set.handle()], &[]);
            device.cmd_dispatch(commands, groups[0], groups[1], 1);
        }
    }
}
