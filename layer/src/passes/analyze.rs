//! `analyze`: the contrast of each tile of a finished picture, for the next frame's decision on rates.
//!
//! Nothing of it leaves the GPU.

pub use parafovea_core::kernels::analyze::AnalyzeParams;

use crate::gpu::{
    AppCommands, Bound, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImageDescription,
    ImagePart, Owned, OwnedImage, Scope, color_view,
};
use ash::vk;
use parafovea_core::kernels::analyze::{Shown, level_blocks, levels_extent};
use parafovea_core::perception::TileContrast;
use parafovea_core::perception::pyramid::LEVELS;
use std::ffi::CStr;
use std::sync::Arc;

/// What a picture to be analysed must have been created with.
pub const USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::SAMPLED;

/// Parameters, picture, levels of the pyramid, contrast, rates, what was shown.
const BINDINGS: [vk::DescriptorType; 6] = [
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::STORAGE_IMAGE,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
];

/// One entry point for each level of the pyramid, then that of the tiles.
const ENTRIES: [&CStr; LEVELS + 2] =
    [c"luminance", c"level1", c"level2", c"level3", c"level4", c"level5", c"tiles"];

/// Threads of a workgroup of tiles, and along a side of one that makes a level. The shader has the same numbers.
const THREADS: u32 = 64;
const GROUP_SIDE: u32 = 8;

/// Of the image of all levels: a block of two by two texels. Any Vulkan device has it as storage image.
const BLOCK: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// What is known of the tiles of one view, on the GPU from frame to frame.
pub struct ViewTiles {
    contrast: DeviceBuffer,
    rates: DeviceBuffer,
    shown: DeviceBuffer,
    tiles: [u32; 2],
}

impl ViewTiles {
    /// Of so many columns and rows of tiles, of which nothing is known: no contrast, shaded at 1x1.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] for more tiles than the device takes.
    pub fn new(gpu: &Arc<Gpu>, tiles: [u32; 2]) -> Result<Self, GpuError> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST;
        let [columns, rows] = tiles.map(u64::from);
        let contrast = columns * rows * size_of::<TileContrast>() as u64;
        let rates = u64::from(rate_row_bytes(tiles[0])) * rows;
        Ok(Self {
            contrast: DeviceBuffer::new(gpu, usage, contrast, |_| {})?,
            // A shader reads whole words.
            rates: DeviceBuffer::new(gpu, usage, rates.max(4), |_| {})?,
            shown: DeviceBuffer::new(gpu, usage, columns * rows * size_of::<Shown>() as u64, |_| {})?,
            tiles,
        })
    }

    /// Contrast, [`TileContrast`] by [`TileContrast`], valid as long as `self`.
    pub fn contrast(&self) -> vk::Buffer {
        self.contrast.handle()
    }

    /// The rates that the tiles are shaded at, a byte each ([`parafovea_core::rate::ShadingRate::texel`]), rows of
    /// [`rate_row_bytes`], valid as long as `self`.
    pub fn rates(&self) -> vk::Buffer {
        self.rates.handle()
    }

    /// Columns and rows.
    pub fn tiles(&self) -> [u32; 2] {
        self.tiles
    }
}

/// Bytes from one row of rates to the next: each begins with a word.
pub fn rate_row_bytes(columns: u32) -> u32 {
    columns.next_multiple_of(4)
}

/// The pass.
pub struct Analyze {
    pipelines: [Owned<vk::Pipeline>; ENTRIES.len()],
    layout: ComputeLayout,
    gpu: Arc<Gpu>,
}

/// A picture, and what its analysis works in. Several pictures that are analysed one after the other, such as the images
/// of a swapchain, may share [`ViewTiles`].
pub struct AnalyzeTarget {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _views: [Owned<vk::ImageView>; 2],
    _params: DeviceBuffer,
    levels: OwnedImage,
    _tiles: Arc<ViewTiles>,
    params: AnalyzeParams,
    picture: ImagePart,
}

impl AnalyzeTarget {
    /// Levels 0 to [`LEVELS`] of the pyramid, see [`parafovea_core::kernels::analyze::level_place`], in GENERAL and valid as long as `self`.
    pub fn levels(&self) -> vk::Image {
        self.levels.handle()
    }
}

impl Analyze {
    /// Prepares the pass.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/analyze.spv"));
        let [a, b, c, d, e, f, g] = ENTRIES.map(|entry| layout.pipeline(spirv, entry));
        Ok(Self { pipelines: [a?, b?, c?, d?, e?, f?, g?], layout, gpu: Arc::clone(gpu) })
    }

    /// Prepares to analyse layer `layer` of `image`, read as `format`, into `tiles`.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] where `params` are not of these tiles; a failed call.
    pub fn target(
        &self,
        (image, format, layer): (vk::Image, vk::Format, u32),
        params: &AnalyzeParams,
        tiles: &Arc<ViewTiles>,
    ) -> Result<AnalyzeTarget, GpuError> {
        if params.tiles != tiles.tiles || params.extent.contains(&0) {
            return Err(GpuError::Invalid("a picture with other tiles"));
        }
        let gpu = &self.gpu;
        let view = color_view(gpu, image, format, layer)?;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let params_buffer = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(params))?;
        let [width, height] = levels_extent(params.extent);
        let description = ImageDescription {
            format: BLOCK,
            extent: vk::Extent2D { width, height },
            array_layers: 1,
            usage: vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_SRC,
            mutable: false,
            view_formats: &[],
        };
        let levels = OwnedImage::new(gpu, &description)?;
        let levels_view = color_view(gpu, levels.handle(), BLOCK, 0)?;
        let bound = [
            (0, Bound::Buffer(params_buffer.handle())),
            (1, Bound::Image(view.handle())),
            (2, Bound::Image(levels_view.handle())),
            (3, Bound::Buffer(tiles.contrast())),
            (4, Bound::Buffer(tiles.rates())),
            (5, Bound::Buffer(tiles.shown.handle())),
        ];
        let set = ComputeSet::new(&self.layout, &bound)?;
        let aspects = vk::ImageAspectFlags::COLOR;
        let picture = ImagePart { image, aspects, level: 0, first_layer: layer, layers: 1 };
        let tiles = Arc::clone(tiles);
        Ok(AnalyzeTarget {
            set,
            _views: [view, levels_view],
            _params: params_buffer,
            levels,
            _tiles: tiles,
            params: *params,
            picture,
        })
    }

    /// Records the analysis of `target`. The picture was written by what was recorded before, and is in `layout` before and
    /// after. What the tiles hold is ordered between calls, and before later compute shaders on this queue.
    pub fn record(&self, commands: &AppCommands, target: &AnalyzeTarget, layout: vk::ImageLayout) {
        let read = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        commands.barrier(target.picture, (layout, Scope::ALL), (read, COMPUTES));
        // Nothing is kept of the analysis before this one, which may still be reading.
        let levels = ImagePart { image: target.levels.handle(), first_layer: 0, ..target.picture };
        commands.barrier(
            levels,
            (vk::ImageLayout::UNDEFINED, COMPUTES),
            (vk::ImageLayout::GENERAL, COMPUTES),
        );
        let (of_levels, of_tiles) = self.pipelines.split_at(LEVELS + 1);
        for (level, pipeline) in of_levels.iter().enumerate() {
            // Before the first one, too: so may it be using the tiles.
            commands.computed_to_computed();
            // A thread makes a block of the picture, or two by two of a coarser level.
            let side = if level == 0 { GROUP_SIDE } else { 2 * GROUP_SIDE };
            let groups = level_blocks(target.params.extent, level).map(|blocks| blocks.div_ceil(side));
            commands.dispatch(&self.layout, pipeline, &target.set, groups);
        }
        let [columns, rows] = target.params.tiles;
        for pipeline in of_tiles {
            commands.computed_to_computed();
            commands.dispatch(&self.layout, pipeline, &target.set, [columns.div_ceil(THREADS), rows]);
        }
        commands.computed_to_computed();
        commands.barrier(target.picture, (read, COMPUTES), (layout, Scope::ALL));
    }
}
