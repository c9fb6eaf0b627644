//! The pipelines for one format.

use crate::gpu::{Gpu, GpuError, Output, TilePipeline, TileShader, tile_pipeline};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

const SPIRV: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/compose.spv"));

/// Pipelines that draw to images of one format.
pub(super) struct Pipelines {
    /// Attenuates the colour of all tiles.
    pub(super) chroma: Arc<TilePipeline>,
    /// What completes pictures, once that is prepared.
    pub(super) reuse: Option<ReusePipelines>,
}

/// Pipelines that draw listed tiles. Of two the second attenuates colour too.
pub(super) struct ReusePipelines {
    /// Attenuates the colour of tiles that are shown as they are.
    pub(super) fresh: Arc<TilePipeline>,
    /// Attenuates the colour of tiles taken from an earlier picture as a whole, where nothing has moved.
    pub(super) still: Arc<TilePipeline>,
    /// Tiles taken from an earlier picture as a whole.
    pub(super) whole: [Arc<TilePipeline>; 2],
    /// Tiles of which pixels are taken from an earlier picture.
    pub(super) mixed: [Arc<TilePipeline>; 2],
    /// Edges of fresh tiles, blended with an earlier picture beside stale ones; nothing where the format cannot be blended.
    pub(super) border: Option<[Arc<TilePipeline>; 2]>,
}

impl Pipelines {
    pub(super) fn new(gpu: &Arc<Gpu>, format: vk::Format) -> Result<Self, GpuError> {
        let shader =
            TileShader { vertex: c"tile", fragment: c"pixel", has_lists: false, output: Output::Color };
        Ok(Self { chroma: tile_pipeline(gpu, format, SPIRV, &shader)?, reuse: None })
    }
}

impl ReusePipelines {
    pub(super) fn new(gpu: &Arc<Gpu>, format: vk::Format) -> Result<Self, GpuError> {
        let pipeline = |vertex: &'static CStr, fragment: &'static CStr, output: Output| {
            tile_pipeline(gpu, format, SPIRV, &TileShader { vertex, fragment, has_lists: true, output })
        };
        let both = |vertex, [plain, attenuated]: [&'static CStr; 2], output| {
            Ok::<_, GpuError>([pipeline(vertex, plain, output)?, pipeline(vertex, attenuated, output)?])
        };
        let border = || both(c"listed_border", [c"border", c"border_attenuated"], Output::Blended);
        let all = Output::ColorAndAlpha;
        Ok(Self {
            fresh: pipeline(c"listed_with_work", c"pixel", Output::Color)?,
            still: pipeline(c"listed", c"still_attenuated", all)?,
            whole: both(c"listed_found", [c"whole", c"whole_attenuated"], all)?,
            mixed: both(c"listed", [c"mixed", c"mixed_attenuated"], all)?,
            border: if gpu.can_blend(format) { Some(border()?) } else { None },
        })
    }
}
