//! `fill`: the skipped blocks of a picture, directly after the pass that drew it.
//!
//! The blocks come from a [`SkipBuffer`], which is the argument of the dispatch too. They are filled in a copy of ours, which is copied
//! back to the picture: the application's image needs no usage but transfers, even if its format has no storage support. The copy holds the
//! bits of a texel (`R32_UINT`), so that every format of 32 bits can be filled on every device; half floats are in their own format.

pub use parafovea_core::kernels::fill::FillFormat;

use crate::gpu::{
    AppCommands, Bound, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImageDescription, ImagePart,
    Owned, OwnedImage, Scope, array_view,
};
use ash::vk;
use parafovea_core::mask::SkipList;
use std::ffi::CStr;
use std::sync::Arc;

/// Usage of a picture to be filled.
pub const USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::TRANSFER_SRC.as_raw() | vk::ImageUsageFlags::TRANSFER_DST.as_raw(),
);

/// Kind of fill for a picture that is drawn to in a format, and the format of the copy in which it is filled; `None` for formats
/// that are not filled.
pub fn fill_format(format: vk::Format) -> Option<(FillFormat, vk::Format)> {
    let (kind, view) = match format {
        vk::Format::R8G8B8A8_UNORM | vk::Format::B8G8R8A8_UNORM | vk::Format::A8B8G8R8_UNORM_PACK32 => {
            (FillFormat::Unorm8, vk::Format::R32_UINT)
        }
        vk::Format::R8G8B8A8_SRGB | vk::Format::B8G8R8A8_SRGB | vk::Format::A8B8G8R8_SRGB_PACK32 => {
            (FillFormat::Srgb8, vk::Format::R32_UINT)
        }
        vk::Format::A2B10G10R10_UNORM_PACK32 | vk::Format::A2R10G10B10_UNORM_PACK32 => {
            (FillFormat::Unorm10, vk::Format::R32_UINT)
        }
        vk::Format::B10G11R11_UFLOAT_PACK32 => (FillFormat::Float11, vk::Format::R32_UINT),
        vk::Format::R16G16B16A16_SFLOAT => (FillFormat::Float16, vk::Format::R16G16B16A16_SFLOAT),
        _ => return None,
    };
    Some((kind, view))
}

/// The list, and two images of which each pipeline uses one.
const BINDINGS: [vk::DescriptorType; 3] = [
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_IMAGE,
    vk::DescriptorType::STORAGE_IMAGE,
];

/// The entry point of a format, and the binding of its images.
fn entry(format: FillFormat) -> (&'static CStr, u32) {
    match format {
        FillFormat::Unorm8 => (c"unorm8", 1),
        FillFormat::Srgb8 => (c"srgb8", 1),
        FillFormat::Unorm10 => (c"unorm10", 1),
        FillFormat::Float11 => (c"float11", 1),
        FillFormat::Float16 => (c"float16", 2),
    }
}

/// The pass.
pub struct Fill {
    pipelines: [Owned<vk::Pipeline>; FillFormat::ALL.len()],
    layout: ComputeLayout,
    gpu: Arc<Gpu>,
}

/// A skip list on the GPU. It belongs to one kind of pass of the application; its content may change between two submits, by a copy to
/// [`SkipBuffer::handle`].
pub struct SkipBuffer {
    buffer: DeviceBuffer,
    words: usize,
}

impl SkipBuffer {
    /// A buffer with room for `blocks` blocks, that holds `list` at first.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] for more blocks than the device takes.
    pub fn new(gpu: &Arc<Gpu>, blocks: usize, list: &SkipList) -> Result<Self, GpuError> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::INDIRECT_BUFFER
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST;
        let words = SkipList::capacity_words(blocks).max(list.words().len());
        let buffer = DeviceBuffer::new(gpu, usage, words as u64 * 4, |bytes| {
            for (bytes, word) in bytes.chunks_exact_mut(4).zip(list.words()) {
                bytes.copy_from_slice(&word.to_ne_bytes());
            }
        })?;
        Ok(Self { buffer, words })
    }

    /// The buffer, which copies may write, valid as long as `self`.
    pub fn handle(&self) -> vk::Buffer {
        self.buffer.handle()
    }

    /// Capacity in 32-bit words.
    pub fn capacity_words(&self) -> usize {
        self.words
    }
}

/// The copy in which pictures of one size are filled, by one list.
pub struct FillTarget {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _view: Owned<vk::ImageView>,
    copy: OwnedImage,
    format: FillFormat,
    extent: vk::Extent2D,
    layers: u32,
}

impl FillTarget {
    /// Kind of its fill.
    pub fn format(&self) -> FillFormat {
        self.format
    }

    fn part(&self) -> ImagePart {
        let aspects = vk::ImageAspectFlags::COLOR;
        ImagePart { image: self.copy.handle(), aspects, level: 0, first_layer: 0, layers: self.layers }
    }
}

impl Fill {
    /// Prepares the pass, for all formats: which of them an application uses shows only while it records.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/fill.spv"));
        let [a, b, c, d, e] = FillFormat::ALL.map(|format| layout.pipeline(spirv, entry(format).0));
        Ok(Self { pipelines: [a?, b?, c?, d?, e?], layout, gpu: Arc::clone(gpu) })
    }

    /// Prepares to fill pictures of `extent` pixels and `layers` array layers, which are drawn to in `format`, by a list,
    /// which outlives the result.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] for formats that cannot be filled; a failed call.
    pub fn target(
        &self,
        format: vk::Format,
        [width, height]: [u32; 2],
        layers: u32,
        list: &SkipBuffer,
    ) -> Result<FillTarget, GpuError> {
        let (kind, stored) =
            fill_format(format).ok_or(GpuError::Unsupported("filling images of this format"))?;
        let extent = vk::Extent2D { width, height };
        let description = ImageDescription {
            format: stored,
            samples: vk::SampleCountFlags::TYPE_1,
            extent,
            array_layers: layers,
            usage: USAGE | vk::ImageUsageFlags::STORAGE,
            mutable: false,
            view_formats: &[],
        };
        let copy = OwnedImage::new(&self.gpu, &description)?;
        let aspects = vk::ImageAspectFlags::COLOR;
        let part = ImagePart { image: copy.handle(), aspects, level: 0, first_layer: 0, layers };
        let view = array_view(&self.gpu, part, stored, vk::ImageUsageFlags::STORAGE)?;
        let set = ComputeSet::new(
            &self.layout,
            &[(0, Bound::Buffer(list.handle())), (entry(kind).1, Bound::Image(view.handle()))],
        )?;
        Ok(FillTarget { set, _view: view, copy, format: kind, extent, layers })
    }

    /// Records the fill of `picture`, whose first layer is the list's layer 0, through `target`, by `list`, the one that `target` was made
    /// with. The picture was drawn by commands recorded before, and is in `layout` before and after.
    pub fn record(
        &self,
        commands: &AppCommands,
        target: &FillTarget,
        list: &SkipBuffer,
        picture: ImagePart,
        layout: vk::ImageLayout,
    ) {
        use vk::ImageLayout as Layout;
        let copy = target.part();
        let pipeline = &self.pipelines[target.format as usize];
        // The application waits for its own pass: the fill runs between that pass and all of its waits.
        commands.barrier(picture, (layout, Scope::ALL), (Layout::TRANSFER_SRC_OPTIMAL, READS));
        commands.barrier(copy, (Layout::UNDEFINED, READS), (Layout::TRANSFER_DST_OPTIMAL, WRITES));
        commands.copy_image(picture, copy, target.extent);
        commands.barrier(copy, (Layout::TRANSFER_DST_OPTIMAL, WRITES), (Layout::GENERAL, FILLS));
        commands.dispatch_indirect(&self.layout, pipeline, &target.set, (list.buffer.handle(), 0));
        commands.barrier(copy, (Layout::GENERAL, FILLS), (Layout::TRANSFER_SRC_OPTIMAL, READS));
        commands.barrier(
            picture,
            (Layout::TRANSFER_SRC_OPTIMAL, READS),
            (Layout::TRANSFER_DST_OPTIMAL, WRITES),
        );
        commands.copy_image(copy, picture, target.extent);
        commands.barrier(picture, (Layout::TRANSFER_DST_OPTIMAL, WRITES), (layout, Scope::ALL));
    }
}

/// Read accesses of copies.
const READS: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_READ };

/// Write accesses of copies.
const WRITES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };

/// The fill's accesses to the copy.
const FILLS: Scope = Scope {
    stages: vk::PipelineStageFlags::COMPUTE_SHADER,
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::SHADER_READ.as_raw() | vk::AccessFlags::SHADER_WRITE.as_raw(),
    ),
};
