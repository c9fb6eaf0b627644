//! The depth template on the GPU: a buffer that is copied to the application's depth ahead of its pass, or is drawn to an
//! image that is.

use crate::backend::mask::Eligible;
use crate::gpu::{AppCommands, DeviceBuffer, Gpu, GpuError, ImagePart, Scope};
use crate::kernels::template::TemplateImage;
use ash::vk;
use parafovea_core::kernels::template::TemplateParams;
use parafovea_core::mask::{BLOCK, DepthFormat, Mask, TemplateDepths, write_template};
use std::sync::Arc;

/// The template of one kind of pass. Its content may change between two submits, by a copy of the output of [`DepthTemplate::write`] to
/// [`DepthTemplate::handle`].
pub struct DepthTemplate {
    // Before `buffer`, which its set names.
    image: Option<TemplateImage>,
    buffer: DeviceBuffer,
    is_storage: bool,
    format: DepthFormat,
    depths: TemplateDepths,
    extent: [u32; 2],
    layers: u32,
}

/// The pass's accesses to depth.
const TESTS: Scope = Scope {
    stages: vk::PipelineStageFlags::from_raw(
        vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS.as_raw()
            | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS.as_raw(),
    ),
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
            | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
    ),
};

/// The copy's accesses to it.
const COPIES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };

impl DepthTemplate {
    /// A template for depth of `extent` pixels and `layers` array layers; everything is shaded at first.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] where an image that it has to be drawn to cannot be made.
    pub fn new(
        gpu: &Arc<Gpu>,
        Eligible { format, depths, drawn, .. }: Eligible,
        extent: [u32; 2],
        layers: u32,
    ) -> Result<Self, GpuError> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
        let size = layer_size(format, extent) * u64::from(layers);
        let nothing = Mask::new(extent, 0);
        let write = |bytes: &mut [u8]| {
            for layer in bytes.chunks_exact_mut(layer_size(format, extent).max(1) as usize) {
                write_template(&nothing, 0, format, depths, layer);
            }
        };
        // A buffer that is too large for writes by shaders can still be copied.
        let storage = usage | vk::BufferUsageFlags::STORAGE_BUFFER;
        let (buffer, is_storage) = match DeviceBuffer::new(gpu, storage, size, write) {
            Ok(buffer) => (buffer, true),
            Err(GpuError::Unsupported(_)) => (DeviceBuffer::new(gpu, usage, size, write)?, false),
            Err(error) => return Err(error),
        };
        let image = drawn.map(|image| {
            if !is_storage {
                return Err(GpuError::Unsupported("a multisampled template of this size"));
            }
            let layer_words = (layer_size(format, extent) / 4) as u32;
            let params = TemplateParams::new(extent[0], layer_words, format, depths);
            TemplateImage::new(gpu, image, (extent, layers), (params, depths), buffer.handle())
        });
        Ok(Self { image: image.transpose()?, buffer, is_storage, format, depths, extent, layers })
    }

    /// Whether it may be copied: after [`Self::redraw`] was recorded, if it is drawn.
    pub fn is_ready(&self) -> bool {
        self.image.as_ref().is_none_or(TemplateImage::is_drawn)
    }

    /// Records, behind a change of the buffer and in a command buffer of ours, the copy of that content to the image, if there is one.
    pub fn redraw(&self, commands: &AppCommands) {
        if let Some(image) = &self.image {
            image.record(commands);
        }
    }

    /// The buffer, which copies may write, valid as long as `self`.
    pub fn handle(&self) -> vk::Buffer {
        self.buffer.handle()
    }

    /// Whether compute shaders may write it.
    pub fn is_storage(&self) -> bool {
        self.is_storage
    }

    /// Its size in bytes.
    pub fn size(&self) -> u64 {
        self.layer_size() * u64::from(self.layers)
    }

    fn layer_size(&self) -> u64 {
        layer_size(self.format, self.extent)
    }

    /// Its depth outside of skipped blocks, and in those.
    pub fn depths(&self) -> TemplateDepths {
        self.depths
    }

    /// Writes the buffer's content for `mask` to `out`, of [`Self::size`] bytes.
    pub fn write(&self, mask: &Mask, out: &mut [u8]) {
        let layers = out.chunks_exact_mut(self.layer_size().max(1) as usize);
        for (layer, out) in (0..self.layers).zip(layers) {
            write_template(mask, layer, self.format, self.depths, out);
        }
    }

    /// Whether the copy can begin at this render area: offsets into buffers of depth are multiples of four bytes, offsets into images are
    /// free.
    pub fn takes(&self, area: vk::Rect2D) -> bool {
        let vk::Rect2D { offset, extent } = area;
        let end =
            [i64::from(offset.x) + i64::from(extent.width), i64::from(offset.y) + i64::from(extent.height)];
        let inside = offset.x >= 0
            && offset.y >= 0
            && end[0] <= i64::from(self.extent[0])
            && end[1] <= i64::from(self.extent[1]);
        let is_aligned = || (0..self.layers).all(|layer| self.offset(area, layer).is_multiple_of(4));
        inside && (self.image.is_some() || is_aligned())
    }

    /// Offset in the buffer of the first pixel of a render area, which lies inside, bytes.
    fn offset(&self, area: vk::Rect2D, layer: u32) -> u64 {
        let pixel = u64::from(area.offset.y.unsigned_abs()) * u64::from(self.extent[0])
            + u64::from(area.offset.x.unsigned_abs());
        u64::from(layer) * self.layer_size() + pixel * self.format.texel_size() as u64
    }

    /// Records the copy to `depth`, ahead of a pass that loads depth where the application clears it; nothing for a render
    /// area that [`Self::takes`] does not hold for. `layouts`: in which the application's pass expects it, which may be
    /// UNDEFINED, and in which the pass finds it now.
    pub fn record(
        &self,
        commands: &AppCommands,
        depth: ImagePart,
        area: vk::Rect2D,
        layouts: [vk::ImageLayout; 2],
    ) {
        if !self.takes(area) {
            return;
        }
        let [before, within] = layouts;
        let copied = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        // Of the application's own waiting nothing is known here: some of it is part of the pass.
        commands.barrier(depth, (before, Scope::ALL), (copied, COPIES));
        if let Some(image) = &self.image {
            commands.copy_depth(image.part(), depth, area);
        }
        let copied_layers = if self.image.is_some() { 0 } else { depth.layers.min(self.layers) };
        for layer in 0..copied_layers {
            let region = vk::BufferImageCopy::default()
                .buffer_offset(self.offset(area, layer))
                .buffer_row_length(self.extent[0])
                .buffer_image_height(self.extent[1])
                .image_subresource(vk::ImageSubresourceLayers {
                    aspect_mask: vk::ImageAspectFlags::DEPTH,
                    mip_level: depth.level,
                    base_array_layer: depth.first_layer + layer,
                    layer_count: 1,
                })
                .image_offset(vk::Offset3D { x: area.offset.x, y: area.offset.y, z: 0 })
                .image_extent(area.extent.into());
            commands.copy_to_image(&self.buffer, depth.image, region);
        }
        commands.barrier(depth, (copied, COPIES), (within, TESTS));
    }
}

fn layer_size(format: DepthFormat, extent: [u32; 2]) -> u64 {
    let [width, height] = match format {
        DepthFormat::Blocks => extent.map(|side| side.div_ceil(BLOCK)),
        _ => extent,
    };
    // Layers begin at multiples of four bytes.
    (u64::from(width) * u64::from(height) * format.texel_size() as u64).next_multiple_of(4)
}
