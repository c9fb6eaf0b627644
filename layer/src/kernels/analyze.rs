//! `analyze`: the contrast of each tile of a finished picture, for the next frame's decision on rates.
//!
//! Nothing of it leaves the GPU.

pub use parafovea_core::kernels::analyze::AnalyzeParams;

use super::compose::stores_unit_range;
use crate::gpu::{
    AppCommands, Bound, COMPUTES, ComputeLayout, ComputeSet, DeviceBuffer, Gpu, GpuError, ImageDescription,
    ImagePart, Owned, OwnedImage, Scope, color_view, sampled_view, serial,
};
use ash::vk;
use parafovea_core::kernels::analyze::{Shown, level_blocks, levels_extent};
use parafovea_core::perception::TileContrast;
use parafovea_core::perception::pyramid::LEVELS;
use std::ffi::CStr;
use std::sync::Arc;

/// Usage of a picture to be analysed.
pub const USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::SAMPLED;

/// Usage of an image with one that is analysed as the application returns it: in COLOR_ATTACHMENT_OPTIMAL, as OpenXR demands.
pub const RELEASED_USAGE: vk::ImageUsageFlags =
    vk::ImageUsageFlags::from_raw(USAGE.as_raw() | vk::ImageUsageFlags::COLOR_ATTACHMENT.as_raw());

/// Parameters, picture, levels of the pyramid, contrast, rates, shown picture, time for which the picture has been the same.
const BINDINGS: [vk::DescriptorType; 7] = [
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::STORAGE_IMAGE,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
];

/// One entry point for each level of the pyramid but the picture itself, then that of the tiles.
const ENTRIES: [&CStr; LEVELS + 1] = [c"level1", c"level2", c"level3", c"level4", c"level5", c"tiles"];

/// Threads of a workgroup, one beside the other: rows are read and written as they lie in memory. The shader has the same number.
const THREADS: u32 = 64;

/// Of the image of all levels: a block of two by two texels. Any Vulkan device has it as storage image.
const BLOCK: vk::Format = vk::Format::R16G16B16A16_SFLOAT;

/// Contrast and rates of the tiles of one view, on the GPU from frame to frame.
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
    /// Of any format, and of one that [`stores_unit_range`].
    luminance: [Owned<vk::Pipeline>; 2],
    /// Whether these make level 1 too.
    reduces_at_once: bool,
    compared: [Owned<vk::Pipeline>; 2],
    rates_compared: Owned<vk::Pipeline>,
    settle: Owned<vk::Pipeline>,
    stages: [Owned<vk::Pipeline>; ENTRIES.len()],
    layout: ComputeLayout,
    gpu: Arc<Gpu>,
}

/// Memory for the analysis of pictures of one size, one after the other: levels 0 to [`LEVELS`] of the pyramid, see
/// [`parafovea_core::kernels::analyze::level_place`], in GENERAL from the first analysis on; and the time for which they have been the
/// same.
pub struct Levels {
    // In the order in which each may be destroyed.
    view: Owned<vk::ImageView>,
    image: OwnedImage,
    same: DeviceBuffer,
    extent: [u32; 2],
}

impl Levels {
    /// Of pictures of so many pixels, of which none was analysed.
    ///
    /// # Errors
    /// A failed call, or [`GpuError::Unsupported`] for more pixels than the device takes.
    pub fn new(gpu: &Arc<Gpu>, extent: [u32; 2]) -> Result<Self, GpuError> {
        let [width, height] = levels_extent(extent);
        let description = ImageDescription {
            format: BLOCK,
            samples: vk::SampleCountFlags::TYPE_1,
            extent: vk::Extent2D { width, height },
            array_layers: 1,
            usage: vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_SRC,
            mutable: false,
            view_formats: &[],
        };
        let image = OwnedImage::new(gpu, &description)?;
        let view = color_view(gpu, image.handle(), BLOCK, 0)?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::INDIRECT_BUFFER
            | vk::BufferUsageFlags::TRANSFER_DST;
        let same = DeviceBuffer::without_content(gpu, usage, SAME_BYTES)?;
        Ok(Self { view, image, same, extent })
    }

    /// The image, valid as long as `self`.
    pub fn image(&self) -> vk::Image {
        self.image.handle()
    }

    /// The size of the pictures, pixels.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }
}

/// Of the shader's structure `Same`: arguments for each of the stages, and two numbers.
const SAME_BYTES: u64 = ARGUMENTS_BYTES * ENTRIES.len() as u64 + 2 * 4;
const ARGUMENTS_BYTES: u64 = 3 * 4;

/// A picture, and the memory of its analysis. Several pictures that are analysed one after the other, such as the images of a swapchain,
/// may share [`ViewTiles`] and [`Levels`].
pub struct AnalyzeTarget {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _view: Owned<vk::ImageView>,
    _params: DeviceBuffer,
    levels: Arc<Levels>,
    _tiles: Arc<ViewTiles>,
    params: AnalyzeParams,
    picture: ImagePart,
    is_unit: bool,
    serial: u64,
}

impl AnalyzeTarget {
    /// A number that no other object has ([`crate::gpu::serial`]).
    pub fn serial(&self) -> u64 {
        self.serial
    }
}

/// A picture to analyse.
#[derive(Clone, Copy)]
pub struct AnalyzedPicture<'a> {
    /// The picture.
    pub target: &'a AnalyzeTarget,
    /// Its layout before and after.
    pub layout: vk::ImageLayout,
    /// 0, or the number of consecutive analyses up to this one that compare the picture and its rates with those before, in the same levels
    /// and tiles and by the same parameters; a comparison pays where the view rests. Once they were the same for
    /// [`SETTLED`](parafovea_core::kernels::analyze::SETTLED) pictures, only the comparison is done.
    pub comparison: u32,
}

impl Analyze {
    /// Prepares the pass.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        Self::reducing(gpu, !gpu.is_software())
    }

    /// The same with level 1 made at once with luminance, by reading pixels several times: half of the dispatch's traffic to memory is
    /// saved, and much work added; or without. Both make the same.
    ///
    /// # Errors
    /// A failed call.
    pub fn reducing(gpu: &Arc<Gpu>, at_once: bool) -> Result<Self, GpuError> {
        let layout = ComputeLayout::new(gpu, &BINDINGS)?;
        let spirv = include_bytes!(concat!(env!("OUT_DIR"), "/analyze.spv"));
        let pipeline = |entry| layout.pipeline(spirv, entry);
        let both = |entries: [&'static CStr; 2]| {
            let [any, unit] = entries.map(pipeline);
            Ok::<_, GpuError>([any?, unit?])
        };
        let [a, b, c, d, e, f] = ENTRIES.map(pipeline);
        Ok(Self {
            luminance: both(if at_once {
                [c"luminance", c"luminance_unit"]
            } else {
                [c"alone", c"alone_unit"]
            })?,
            reduces_at_once: at_once,
            compared: both([c"compared", c"compared_unit"])?,
            rates_compared: pipeline(c"rates_compared")?,
            settle: pipeline(c"settle")?,
            stages: [a?, b?, c?, d?, e?, f?],
            layout,
            gpu: Arc::clone(gpu),
        })
    }

    /// Prepares to analyse layer `layer` of `image`, read as `format`, into `tiles`, by way of `levels`.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] where `params` are not of these tiles and levels; a failed call.
    pub fn target(
        &self,
        (image, format, layer): (vk::Image, vk::Format, u32),
        params: &AnalyzeParams,
        (tiles, levels): (&Arc<ViewTiles>, &Arc<Levels>),
    ) -> Result<AnalyzeTarget, GpuError> {
        if params.tiles != tiles.tiles || params.extent != levels.extent || params.extent.contains(&0) {
            return Err(GpuError::Invalid("an image of another size or tile layout"));
        }
        let gpu = &self.gpu;
        let view = sampled_view(gpu, image, format, layer)?;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let params_buffer = DeviceBuffer::holding(gpu, storage, bytemuck::bytes_of(params))?;
        let bound = [
            (0, Bound::Buffer(params_buffer.handle())),
            (1, Bound::Image(view.handle())),
            (2, Bound::Image(levels.view.handle())),
            (3, Bound::Buffer(tiles.contrast())),
            (4, Bound::Buffer(tiles.rates())),
            (5, Bound::Buffer(tiles.shown.handle())),
            (6, Bound::Buffer(levels.same.handle())),
        ];
        let set = ComputeSet::new(&self.layout, &bound)?;
        let aspects = vk::ImageAspectFlags::COLOR;
        let picture = ImagePart { image, aspects, level: 0, first_layer: layer, layers: 1 };
        Ok(AnalyzeTarget {
            set,
            _view: view,
            _params: params_buffer,
            levels: Arc::clone(levels),
            _tiles: Arc::clone(tiles),
            params: *params,
            picture,
            is_unit: stores_unit_range(format),
            serial: serial(),
        })
    }

    /// Records the analysis of pictures with tiles and levels of their own, side by side: of each stage, all dispatches come before the next
    /// one's. They were written by commands recorded before. The content of the tiles is ordered between calls, and before later compute
    /// shaders on this queue.
    pub fn record(&self, commands: &AppCommands, pictures: &[AnalyzedPicture<'_>]) {
        let read = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        // Both eyes may be in one layer of an image.
        let images = || {
            let is_first = |index: usize, picture: &AnalyzedPicture<'_>| {
                !pictures[..index].iter().any(|before| before.target.picture == picture.target.picture)
            };
            pictures.iter().enumerate().filter(move |(index, picture)| is_first(*index, picture))
        };
        for (_, picture) in images() {
            commands.barrier(picture.target.picture, (picture.layout, Scope::ALL), (read, COMPUTES));
        }
        self.record_all(commands, || pictures.iter().filter(|picture| picture.comparison == 0));
        for picture in pictures.iter().filter(|picture| picture.comparison > 0) {
            self.record_compared(commands, picture.target, picture.comparison == 1);
        }
        commands.computed_to_computed();
        for (_, picture) in images() {
            commands.barrier(picture.target.picture, (read, COMPUTES), (picture.layout, Scope::ALL));
        }
    }

    fn record_all<'a, I: Iterator<Item = &'a AnalyzedPicture<'a>>>(
        &self,
        commands: &AppCommands,
        pictures: impl Fn() -> I,
    ) {
        if pictures().next().is_none() {
            return;
        }
        for AnalyzedPicture { target, .. } in pictures() {
            // Nothing is kept of the analysis before this one, which may still be reading.
            let levels = ImagePart { image: target.levels.image(), first_layer: 0, ..target.picture };
            commands.barrier(
                levels,
                (vk::ImageLayout::UNDEFINED, COMPUTES),
                (vk::ImageLayout::GENERAL, COMPUTES),
            );
        }
        // Before the first one, too: so may it be using the tiles.
        commands.computed_to_computed();
        for AnalyzedPicture { target, .. } in pictures() {
            let luminance = &self.luminance[usize::from(target.is_unit)];
            let groups = if self.reduces_at_once { level_groups(target, 1) } else { block_groups(target) };
            commands.dispatch(&self.layout, luminance, &target.set, groups);
        }
        for (index, stage) in self.stages.iter().enumerate().skip(self.reduces_at_once.into()) {
            commands.computed_to_computed();
            for AnalyzedPicture { target, .. } in pictures() {
                let groups = match index + 1 {
                    level @ ..=LEVELS => level_groups(target, level),
                    _ => tile_groups(target),
                };
                commands.dispatch(&self.layout, stage, &target.set, groups);
            }
        }
    }

    fn record_compared(&self, commands: &AppCommands, target: &AnalyzeTarget, is_first: bool) {
        let same = target.levels.same.handle();
        if is_first {
            commands.memory_barrier(COMPUTES_AND_ARGUMENTS, WRITES);
            commands.fill_words(same, 0);
            commands.memory_barrier(WRITES, COMPUTES);
        }
        // Earlier commands may still be reading.
        commands.memory_barrier(COMPUTES_AND_ARGUMENTS, COMPUTES);
        let compared = &self.compared[usize::from(target.is_unit)];
        commands.dispatch(&self.layout, compared, &target.set, block_groups(target));
        commands.dispatch(&self.layout, &self.rates_compared, &target.set, tile_groups(target));
        commands.computed_to_computed();
        commands.dispatch(&self.layout, &self.settle, &target.set, [1; 2]);
        for (index, stage) in (0..).zip(&self.stages) {
            commands.memory_barrier(COMPUTES, COMPUTES_AND_ARGUMENTS);
            commands.dispatch_indirect(&self.layout, stage, &target.set, (same, index * ARGUMENTS_BYTES));
        }
    }
}

/// A thread makes two by two blocks.
fn level_groups(target: &AnalyzeTarget, level: usize) -> [u32; 2] {
    let [columns, rows] = level_blocks(target.params.extent, level);
    [columns.div_ceil(2 * THREADS), rows.div_ceil(2)]
}

/// A thread has a block of luminance.
fn block_groups(target: &AnalyzeTarget) -> [u32; 2] {
    let [columns, rows] = level_blocks(target.params.extent, 0);
    [columns.div_ceil(THREADS), rows]
}

/// A thread has a tile.
fn tile_groups(target: &AnalyzeTarget) -> [u32; 2] {
    let [columns, rows] = target.params.tiles;
    [columns.div_ceil(THREADS), rows]
}

/// The stages' accesses, and their counts of workgroups.
const COMPUTES_AND_ARGUMENTS: Scope = Scope {
    stages: vk::PipelineStageFlags::from_raw(
        COMPUTES.stages.as_raw() | vk::PipelineStageFlags::DRAW_INDIRECT.as_raw(),
    ),
    access: vk::AccessFlags::from_raw(
        COMPUTES.access.as_raw() | vk::AccessFlags::INDIRECT_COMMAND_READ.as_raw(),
    ),
};

const WRITES: Scope =
    Scope { stages: vk::PipelineStageFlags::TRANSFER, access: vk::AccessFlags::TRANSFER_WRITE };
