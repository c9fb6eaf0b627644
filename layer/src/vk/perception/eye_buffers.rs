//! The images that finished eye buffers are in, each ready to be analysed.

use super::Tools;
use super::eye::EyeTiles;
use crate::gpu::GpuError;
use crate::kernels::analyze::{AnalyzeParams, AnalyzeTarget};
use crate::link::EyeBufferRecord;
use ash::vk;
use parafovea_core::color::Matrix;
use parafovea_core::kernels::analyze::{Aggregation, ContrastSettings};
use smallvec::SmallVec;
use std::sync::Arc;

/// Most images of an application; with more, the list is emptied.
const MOST: usize = 64;

/// The eye buffers of a session.
#[derive(Default)]
pub struct EyeBuffers {
    known: Vec<Known>,
    /// The swapchains with images that were ever analysed, known or not, and the queue: work there that reads them may be pending.
    swapchains: SmallVec<[(u64, vk::Queue); 4]>,
}

/// Place of an eye buffer, and the parameters of its analysis.
#[derive(Clone, Copy, PartialEq)]
struct EyeBufferKey {
    swapchain: u64,
    image: vk::Image,
    format: vk::Format,
    layer: u32,
    rect: [u32; 4],
    white_cd_m2: f32,
    is_mean: u32,
}

/// An eye buffer that was analysed before.
pub struct Known {
    key: EyeBufferKey,
    tiles: Arc<EyeTiles>,
    target: Arc<AnalyzeTarget>,
}

impl EyeBuffers {
    /// The analysis of an eye buffer into these tiles, if it was made before.
    pub fn find(&self, record: &EyeBufferRecord, tiles: &Arc<EyeTiles>) -> Option<Arc<AnalyzeTarget>> {
        let key = EyeBufferKey::of(record);
        let known = self.known.iter().find(|known| known.key == key && Arc::ptr_eq(&known.tiles, tiles));
        known.map(|known| Arc::clone(&known.target))
    }

    /// Keeps the analysis of an eye buffer.
    pub fn keep(
        &mut self,
        record: &EyeBufferRecord,
        queue: vk::Queue,
        tiles: &Arc<EyeTiles>,
        target: AnalyzeTarget,
    ) -> Arc<AnalyzeTarget> {
        if self.known.len() >= MOST {
            self.known.clear();
        }
        let reader = (record.swapchain, queue);
        if !self.swapchains.contains(&reader) {
            self.swapchains.push(reader);
        }
        let (key, target) = (EyeBufferKey::of(record), Arc::new(target));
        self.known.push(Known { key, tiles: Arc::clone(tiles), target: Arc::clone(&target) });
        target
    }

    /// Forgets the eye buffers of a swapchain; the queue on which its images were analysed, if they ever were.
    pub fn forget(&mut self, swapchain: u64) -> Option<vk::Queue> {
        self.known.retain(|known| known.key.swapchain != swapchain);
        let at = self.swapchains.iter().position(|(known, _)| *known == swapchain)?;
        Some(self.swapchains.swap_remove(at).1)
    }

    /// Takes out the eye buffers that were analysed into other tiles of an eye than `kept`.
    pub fn take_others(&mut self, eye: usize, kept: Option<&Arc<EyeTiles>>) -> Vec<Known> {
        let is_other = |known: &mut Known| {
            known.tiles.eye == eye && !kept.is_some_and(|kept| Arc::ptr_eq(kept, &known.tiles))
        };
        self.known.extract_if(.., is_other).collect()
    }

    /// Takes out all eye buffers.
    pub fn take_all(&mut self) -> Vec<Known> {
        std::mem::take(&mut self.known)
    }
}

impl EyeBufferKey {
    fn of(record: &EyeBufferRecord) -> Self {
        let EyeBufferRecord { swapchain, image, format, layer, rect, white_cd_m2, is_mean, .. } = *record;
        Self { swapchain, image, format, layer, rect, white_cd_m2, is_mean }
    }
}

/// Prepares to analyse an eye buffer by tiles of `texel` pixels, which are counted from its own corner.
///
/// # Errors
/// A failed call.
pub fn target(
    tools: &Tools,
    record: &EyeBufferRecord,
    texel: [u32; 2],
    tiles: &Arc<EyeTiles>,
) -> Result<AnalyzeTarget, GpuError> {
    let aggregation = if record.is_mean == 1 { Aggregation::Mean } else { Aggregation::Peak };
    let settings = ContrastSettings { texel, aggregation, ..ContrastSettings::default() };
    let [x, y, width, height] = record.rect;
    let params = AnalyzeParams::new([x, y], [width, height], &settings, record.white_cd_m2, Matrix::Bt709);
    let levels = tiles.levels(&tools.gpu)?;
    tools.analyze.target((record.image, record.format, record.layer), &params, (&tiles.view, levels))
}
