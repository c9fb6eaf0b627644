//! `depth`: the skipped blocks of an application's depth that outlives its pass, in a copy of ours that goes back to it.
//!
//! Copies between buffers and the depth aspect leave stencil as it is (Vulkan specification, "Copying Data Between Buffers
//! and Images").

use super::fill::SkipBuffer;
use crate::gpu::{
    AppCommands, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImagePart, Owned,
    READS_OF_RESULTS, Scope,
};
use ash::vk;
use parafovea_core::kernels::depth::DepthParams;
use parafovea_core::mask::DepthFormat;
use std::sync::Arc;

/// Usage of depth.
pub const USAGE: vk::ImageUsageFlags = super::fill::USAGE;

/// Parameters, list, depth.
const BINDINGS: [vk::DescriptorType; 3] = [vk::DescriptorType::STORAGE_BUFFER; 3];

/// The compiled kernel, for depth of any size.
pub struct DepthKernels {
    // In the order in which each may be destroyed.
    cover: Owned<vk::Pipeline>,
    fill: Owned<vk::Pipeline>,
    layout: ComputeLayout,
}

impl DepthKernels {
    /// Compiles both entry points.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/depth.spv"));
        let [cover, fill] = [c"cover", c"fill"].map(|entry| layout.pipeline(spirv, entry));
        Ok(Self { cover: cover?, fill: fill?, layout })
    }
}

/// The copy of depth of one size.
pub struct DepthCopy {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _params: DeviceBuffer,
    words: DeviceBuffer,
    texel_size: u64,
    extent: [u32; 2],
    layers: u32,
}

impl DepthCopy {
    /// Prepares for depth of `extent` pixels and `layers` array layers, whose nearest value is `near`, by a list; that and the kernels
    /// outlive the result.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] for sizes that the kernel cannot serve; a failed call.
    pub fn new(
        gpu: &Arc<Gpu>,
        kernels: &DepthKernels,
        (format, near): (DepthFormat, f32),
        (extent, layers): ([u32; 2], u32),
        list: &SkipBuffer,
    ) -> Result<Self, GpuError> {
        let params = DepthParams::new(extent, format, near)
            .ok_or(GpuError::Unsupported("loaded or read depth of this size"))?;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let copied = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
        let size = u64::from(params.layer_words) * 4 * u64::from(layers);
        let words = DeviceBuffer::without_content(gpu, storage | copied, size)?;
        let params = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(&params))?;
        let set = ComputeSet::of_buffers(&kernels.layout, &[params.handle(), list.handle(), words.handle()])?;
        let texel_size = format.texel_size() as u64;
        Ok(Self { set, _params: params, words, texel_size, extent, layers })
    }

    /// Records, ahead of a pass that loads `depth`, that the skipped blocks of `list` are covered with the nearest depth. `depth` is in
    /// `layout` before and after. Kernels and list are the ones passed to [`Self::new`].
    pub fn cover(
        &self,
        commands: &AppCommands,
        (kernels, list): (&DepthKernels, &SkipBuffer),
        (depth, area): (ImagePart, vk::Rect2D),
        layout: vk::ImageLayout,
    ) {
        self.record(commands, (&kernels.layout, &kernels.cover), list, (depth, area), layout);
    }

    /// As [`Self::cover`], after a pass, that skipped blocks are filled.
    pub fn fill(
        &self,
        commands: &AppCommands,
        (kernels, list): (&DepthKernels, &SkipBuffer),
        (depth, area): (ImagePart, vk::Rect2D),
        layout: vk::ImageLayout,
    ) {
        self.record(commands, (&kernels.layout, &kernels.fill), list, (depth, area), layout);
    }

    fn record(
        &self,
        commands: &AppCommands,
        (kernel, pipeline): (&ComputeLayout, &Owned<vk::Pipeline>),
        list: &SkipBuffer,
        (depth, area): (ImagePart, vk::Rect2D),
        layout: vk::ImageLayout,
    ) {
        use vk::ImageLayout as Layout;
        // The application waits for its own pass: these commands run between that pass and all of its waits.
        commands.barrier(depth, (layout, Scope::ALL), (Layout::TRANSFER_SRC_OPTIMAL, READS));
        commands.memory_barrier(READS_OF_RESULTS, WRITES);
        for region in self.regions(depth, area) {
            commands.copy_from_image(depth.image, &self.words, region);
        }
        commands.memory_barrier(WRITES, COMPUTES);
        commands.dispatch_indirect(kernel, pipeline, &self.set, (list.handle(), 0));
        commands.memory_barrier(COMPUTES, READS);
        commands.barrier(
            depth,
            (Layout::TRANSFER_SRC_OPTIMAL, READS),
            (Layout::TRANSFER_DST_OPTIMAL, WRITES),
        );
        for region in self.regions(depth, area) {
            commands.copy_to_image(&self.words, depth.image, region);
        }
        commands.barrier(depth, (Layout::TRANSFER_DST_OPTIMAL, WRITES), (layout, Scope::ALL));
    }

    /// A render area of each layer, at its own place in the copy.
    fn regions(&self, depth: ImagePart, area: vk::Rect2D) -> impl Iterator<Item = vk::BufferImageCopy> {
        let [width, height] = self.extent;
        let size = self.texel_size;
        let first = u64::from(area.offset.y.unsigned_abs()) * u64::from(width)
            + u64::from(area.offset.x.unsigned_abs());
        (0..depth.layers.min(self.layers)).map(move |layer| {
            let texel = u64::from(layer) * u64::from(width) * u64::from(height) + first;
            vk::BufferImageCopy::default()
                .buffer_offset(texel * size)
                .buffer_row_length(width)
                .buffer_image_height(height)
                .image_subresource(vk::ImageSubresourceLayers {
                    aspect_mask: vk::ImageAspectFlags::DEPTH,
                    mip_level: depth.level,
                    base_array_layer: depth.first_layer + layer,
                    layer_count: 1,
                })
                .image_offset(vk::Offset3D { x: area.offset.x, y: area.offset.y, z: 0 })
                .image_extent(area.extent.into())
        })
    }
}

/// Read accesses of copies.
const READS: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_READ };

/// Write accesses of copies.
const WRITES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };
