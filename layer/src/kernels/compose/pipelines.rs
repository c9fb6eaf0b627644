//! The pipelines for one format.

use crate::gpu::{Gpu, GpuError, Later, Output, Shared, TilePipeline, TileShader};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// Choice between two shaders that draw the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameters {
    /// Vertices hand the parameters of pixels on: cheaper on a CPU.
    OfVertices,
    /// Pixels read them by themselves: cheaper on a GPU.
    OfPixels,
}

impl Parameters {
    fn spirv(self) -> &'static [u8] {
        match self {
            Self::OfVertices => include_bytes!(concat!(env!("OUT_DIR"), "/compose.spv")),
            Self::OfPixels => include_bytes!(concat!(env!("OUT_DIR"), "/compose_gpu.spv")),
        }
    }
}

/// Pipelines that draw to images of one format, each there some time after it was asked for.
pub(super) struct Pipelines {
    /// Attenuates the colour of all tiles.
    pub(super) chroma: Later<Arc<TilePipeline>>,
    /// Pipelines that complete pictures, once they were asked for.
    pub(super) reuse: Option<Later<ReusePipelines>>,
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
    /// The same where the head has moved, by depth.
    pub(super) moved: [Arc<TilePipeline>; 2],
    /// Edges of fresh tiles, blended with an earlier picture beside stale ones, and the same where the head has moved; `None` if the format
    /// cannot be blended.
    pub(super) borders: Option<Borders>,
}

/// Pipelines that blend.
pub(super) struct Borders {
    /// Pipelines for a head that has not moved.
    pub(super) unmoved: [Arc<TilePipeline>; 2],
    /// Pipelines for a head that has moved.
    pub(super) moved: [Arc<TilePipeline>; 2],
}

impl Pipelines {
    pub(super) fn new(gpu: &Gpu, format: vk::Format, parameters: Parameters) -> Result<Self, GpuError> {
        let shader = TileShader {
            vertex: c"tile",
            fragment: c"pixel",
            has_lists: false,
            has_depth: false,
            output: Output::Color,
        };
        let make = move |shared: &Shared| shared.tile_pipeline(format, parameters.spirv(), &shader);
        Ok(Self { chroma: gpu.shared()?.ask("chroma attenuation is off", make), reuse: None })
    }

    /// Asks for the pipelines that complete pictures.
    pub(super) fn ask_for_reuse(
        &mut self,
        gpu: &Gpu,
        format: vk::Format,
        parameters: Parameters,
    ) -> Result<(), GpuError> {
        if self.reuse.is_none() {
            let make = move |shared: &Shared| ReusePipelines::new(shared, format, parameters);
            self.reuse = Some(gpu.shared()?.ask("re-use is off", make));
        }
        Ok(())
    }

    /// Whether colour can be attenuated.
    pub(super) fn attenuates(&self) -> bool {
        self.chroma.get().is_some()
    }

    /// Whether pictures can be completed.
    pub(super) fn completes(&self) -> bool {
        self.attenuates() && self.reuse.as_ref().is_some_and(|reuse| reuse.get().is_some())
    }
}

impl ReusePipelines {
    fn new(shared: &Shared, format: vk::Format, parameters: Parameters) -> Result<Self, GpuError> {
        let pipeline = |vertex: &'static CStr, fragment: &'static CStr, has_depth: bool, output: Output| {
            let shader = TileShader { vertex, fragment, has_lists: true, has_depth, output };
            shared.tile_pipeline(format, parameters.spirv(), &shader)
        };
        let both = |vertex, [plain, attenuated]: [&'static CStr; 2], has_depth, output| {
            let pipeline = |fragment| pipeline(vertex, fragment, has_depth, output);
            Ok::<_, GpuError>([pipeline(plain)?, pipeline(attenuated)?])
        };
        let borders = || {
            let moved = [c"moved_border", c"moved_border_attenuated"];
            Ok::<_, GpuError>(Borders {
                unmoved: both(c"listed_border", [c"border", c"border_attenuated"], false, Output::Blended)?,
                moved: both(c"listed_moved_border", moved, true, Output::Blended)?,
            })
        };
        let all = Output::ColorAndAlpha;
        Ok(Self {
            fresh: pipeline(c"listed_with_work", c"pixel", false, Output::Color)?,
            still: pipeline(c"listed_still", c"still_attenuated", false, all)?,
            whole: both(c"listed_whole", [c"whole", c"whole_attenuated"], false, all)?,
            mixed: both(c"listed_mixed", [c"mixed", c"mixed_attenuated"], false, all)?,
            moved: both(c"listed_mixed", [c"moved", c"moved_attenuated"], true, all)?,
            borders: if shared.can_blend(format) { Some(borders()?) } else { None },
        })
    }
}
