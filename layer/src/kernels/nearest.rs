//! `nearest`: the skipped blocks of depth that outlives its pass, and of colour that is not interpolated, in a copy of ours that goes back
//! to the picture.
//!
//! The copy is a buffer, so that texels of every size can be filled on every device. Copies between buffers and the depth aspect do not
//! change stencil (Vulkan specification, "Copying Data Between Buffers and Images").

use super::fill::SkipBuffer;
use crate::gpu::{
    AppCommands, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImagePart, Owned,
    READS_OF_RESULTS, Scope,
};
use ash::vk;
use parafovea_core::kernels::nearest::NearestParams;
use std::sync::Arc;

/// Usage of depth.
pub const USAGE: vk::ImageUsageFlags = super::fill::USAGE;

/// Parameters, list, picture.
const BINDINGS: [vk::DescriptorType; 3] = [vk::DescriptorType::STORAGE_BUFFER; 3];

/// The compiled kernel, for pictures of any size.
pub struct NearestKernels {
    // In the order in which each may be destroyed.
    cover: Owned<vk::Pipeline>,
    fill: Owned<vk::Pipeline>,
    layout: ComputeLayout,
}

impl NearestKernels {
    /// Compiles both entry points.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/nearest.spv"));
        let [cover, fill] = [c"cover", c"fill"].map(|entry| layout.pipeline(spirv, entry));
        Ok(Self { cover: cover?, fill: fill?, layout })
    }
}

/// The copy of pictures of one size.
pub struct NearestCopy {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _buffer: DeviceBuffer,
    words: DeviceBuffer,
    params: NearestParams,
    height: u32,
    layers: u32,
}

impl NearestCopy {
    /// Prepares for pictures with these parameters, `height` pixels and `layers` array layers, by a list; that and the kernels outlive the
    /// result.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(
        gpu: &Arc<Gpu>,
        kernels: &NearestKernels,
        params: NearestParams,
        (height, layers): (u32, u32),
        list: &SkipBuffer,
    ) -> Result<Self, GpuError> {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let copied = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
        let size = u64::from(params.layer_words) * 4 * u64::from(layers);
        let words = DeviceBuffer::without_content(gpu, storage | copied, size)?;
        let buffer = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(&params))?;
        let set = ComputeSet::of_buffers(&kernels.layout, &[buffer.handle(), list.handle(), words.handle()])?;
        Ok(Self { set, _buffer: buffer, words, params, height, layers })
    }

    /// Bytes of a texel.
    pub fn texel_size(&self) -> u32 {
        self.params.texel_size
    }

    /// Records, ahead of a pass that loads `depth`, that the skipped blocks of `list` are covered with the nearest depth. `depth` is in
    /// `layout` before and after. Kernels and list are the ones passed to [`Self::new`].
    pub fn cover(
        &self,
        commands: &AppCommands,
        (kernels, list): (&NearestKernels, &SkipBuffer),
        (depth, area): (ImagePart, vk::Rect2D),
        layout: vk::ImageLayout,
    ) {
        self.record(commands, (&kernels.layout, &kernels.cover), list, (depth, area), layout);
    }

    /// As [`Self::cover`], after a pass, that skipped blocks of `picture`, depth or colour, are filled.
    pub fn fill(
        &self,
        commands: &AppCommands,
        (kernels, list): (&NearestKernels, &SkipBuffer),
        (picture, area): (ImagePart, vk::Rect2D),
        layout: vk::ImageLayout,
    ) {
        self.record(commands, (&kernels.layout, &kernels.fill), list, (picture, area), layout);
    }

    fn record(
        &self,
        commands: &AppCommands,
        (kernel, pipeline): (&ComputeLayout, &Owned<vk::Pipeline>),
        list: &SkipBuffer,
        (picture, area): (ImagePart, vk::Rect2D),
        layout: vk::ImageLayout,
    ) {
        use vk::ImageLayout as Layout;
        // The application waits for its own pass: these commands run between that pass and all of its waits.
        commands.barrier(picture, (layout, Scope::ALL), (Layout::TRANSFER_SRC_OPTIMAL, READS));
        commands.memory_barrier(READS_OF_RESULTS, WRITES);
        for region in self.regions(picture, area) {
            commands.copy_from_image(picture.image, &self.words, region);
        }
        commands.memory_barrier(WRITES, COMPUTES);
        commands.dispatch_indirect(kernel, pipeline, &self.set, (list.handle(), 0));
        commands.memory_barrier(COMPUTES, READS);
        commands.barrier(
            picture,
            (Layout::TRANSFER_SRC_OPTIMAL, READS),
            (Layout::TRANSFER_DST_OPTIMAL, WRITES),
        );
        for region in self.regions(picture, area) {
            commands.copy_to_image(&self.words, picture.image, region);
        }
        commands.barrier(picture, (Layout::TRANSFER_DST_OPTIMAL, WRITES), (layout, Scope::ALL));
    }

    /// A render area of each layer, at its own place in the copy.
    fn regions(&self, picture: ImagePart, area: vk::Rect2D) -> impl Iterator<Item = vk::BufferImageCopy> {
        let (row, size, height) = (self.params.row_texels(), self.params.texel_size, self.height);
        let first = u64::from(area.offset.y.unsigned_abs()) * u64::from(row)
            + u64::from(area.offset.x.unsigned_abs());
        (0..picture.layers.min(self.layers)).map(move |layer| {
            let texel = u64::from(layer) * u64::from(row) * u64::from(height) + first;
            vk::BufferImageCopy::default()
                .buffer_offset(texel * u64::from(size))
                .buffer_row_length(row)
                .buffer_image_height(height)
                .image_subresource(vk::ImageSubresourceLayers {
                    aspect_mask: picture.aspects & !vk::ImageAspectFlags::STENCIL,
                    mip_level: picture.level,
                    base_array_layer: picture.first_layer + layer,
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
