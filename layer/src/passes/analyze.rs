//! `analyze`: the contrast of each tile of a finished picture, for the next frame's decision on rates.
//!
//! Nothing of it leaves the GPU.

pub use parafovea_core::kernels::analyze::AnalyzeParams;

use crate::gpu::{
    AppCommands, Bound, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImagePart, Owned,
    Scope, color_view,
};
use ash::vk;
use parafovea_core::kernels::analyze::{Shown, level_offset, level_size};
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
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
];

/// One entry point for each level of the pyramid, then those of the parts of tiles and of the tiles.
const ENTRIES: [&CStr; LEVELS + 3] =
    [c"luminance", c"level1", c"level2", c"level3", c"level4", c"level5", c"parts", c"tiles"];

/// Parts that a tile is gathered in, numbers of each, and threads of a workgroup of tiles. The shader has the same numbers.
const PARTS: u32 = 8;
const PART_LEN: u32 = 5;
const THREADS: u32 = 64;

/// Threads along a side of a workgroup that makes a level. The shader has the same number.
const GROUP_SIDE: u32 = 8;

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
    _view: Owned<vk::ImageView>,
    _params: DeviceBuffer,
    levels: DeviceBuffer,
    _tiles: Arc<ViewTiles>,
    params: AnalyzeParams,
    picture: ImagePart,
}

impl AnalyzeTarget {
    /// Levels 0 to [`LEVELS`] of the pyramid, see [`level_offset`], and what the tiles are put together from, valid as long as `self`.
    pub fn levels(&self) -> vk::Buffer {
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
        let [a, b, c, d, e, f, g, h] = ENTRIES.map(|entry| layout.pipeline(spirv, entry));
        Ok(Self { pipelines: [a?, b?, c?, d?, e?, f?, g?, h?], layout, gpu: Arc::clone(gpu) })
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
        let [columns, rows] = params.tiles.map(u64::from);
        let parts = columns * rows * u64::from(PARTS * PART_LEN);
        let numbers = level_offset(params.extent, LEVELS + 1) as u64 + parts;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_SRC;
        let levels = DeviceBuffer::without_content(gpu, usage, numbers * size_of::<f32>() as u64)?;
        let bound = [
            (0, Bound::Buffer(params_buffer.handle())),
            (1, Bound::Image(view.handle())),
            (2, Bound::Buffer(levels.handle())),
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
            _view: view,
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
        let (levels, of_tiles) = self.pipelines.split_at(LEVELS + 1);
        for (level, pipeline) in levels.iter().enumerate() {
            // Before the first one, too: the analysis before this one may still be reading.
            commands.computed_to_computed();
            // A thread makes two by two texels of a coarser level.
            let side = if level == 0 { GROUP_SIDE } else { 2 * GROUP_SIDE };
            let groups = level_size(target.params.extent, level).map(|texels| texels.div_ceil(side));
            commands.dispatch(&self.layout, pipeline, &target.set, groups);
        }
        let [columns, rows] = target.params.tiles;
        for (pipeline, tiles_of_group) in of_tiles.iter().zip([THREADS / PARTS, THREADS]) {
            commands.computed_to_computed();
            let groups = [columns.div_ceil(tiles_of_group), rows];
            commands.dispatch(&self.layout, pipeline, &target.set, groups);
        }
        commands.computed_to_computed();
        commands.barrier(target.picture, (read, COMPUTES), (layout, Scope::ALL));
    }
}
