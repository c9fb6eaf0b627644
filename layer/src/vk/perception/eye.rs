//! The state of one eye.

use super::Tools;
use crate::gpu::GpuError;
use crate::kernels::analyze::{Levels, ViewTiles};
use crate::kernels::decide::DecideTarget;
use crate::link::EyeBufferRecord;
use ash::vk;
use glam::{Quat, Vec2};
use parafovea_core::geometry::{ImagePlane, View};
use std::sync::Arc;

/// An eye whose pictures are analysed.
pub struct Eye {
    /// Its tiles.
    pub tiles: Arc<EyeTiles>,
    /// The picture that was analysed last; `None` if contrast is not known.
    pub measured: Option<Measured>,
}

/// A picture that was analysed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The view that it shows.
    pub view: View,
    /// Number of the plan at that time.
    pub received: u64,
    /// The parameters of its analysis.
    pub by: Parameters,
    /// Number of consecutive analyses before this one of the same view, with the same parameters.
    pub same_view: u32,
}

/// Parameters of a picture's analysis, beside its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
    /// Luminance of white.
    pub white_cd_m2: f32,
    /// Whether the mean of a tile counts, and not its peak.
    pub is_mean: bool,
    /// The format in which the picture is read.
    pub format: vk::Format,
}

impl Measured {
    /// That of a record, after the last measured picture.
    pub fn new(
        record: &EyeBufferRecord,
        texel: [u32; 2],
        received: u64,
        last: Option<&Self>,
    ) -> Option<Self> {
        let view = view_of(record)?;
        let EyeBufferRecord { white_cd_m2, is_mean, format, .. } = *record;
        let by = Parameters { texel, white_cd_m2, is_mean: is_mean == 1, format };
        let before = last.filter(|last| last.view == view && last.by == by);
        Some(Self {
            view,
            received,
            by,
            same_view: before.map_or(0, |last| last.same_view.saturating_add(1)),
        })
    }
}

/// The tiles of an eye buffer, on the GPU.
pub struct EyeTiles {
    /// 0: left, 1: right.
    pub eye: usize,
    /// Contrast and rates.
    pub view: Arc<ViewTiles>,
    /// Memory for the analysis of pictures.
    pub levels: Arc<Levels>,
    /// The target of decisions.
    pub decide: DecideTarget,
}

impl EyeTiles {
    /// Of that many columns and rows, with nothing known, of pictures of that many pixels.
    ///
    /// # Errors
    /// A failed call, or more tiles or pixels than the device takes.
    pub fn new(tools: &Tools, eye: usize, tiles: [u32; 2], extent: [u32; 2]) -> Result<Self, GpuError> {
        let view = Arc::new(ViewTiles::new(&tools.gpu, tiles)?);
        let levels = Arc::new(Levels::new(&tools.gpu, extent)?);
        let decide = tools.decide.target(&view)?;
        Ok(Self { eye, view, levels, decide })
    }
}

/// The view of a picture.
fn view_of(record: &EyeBufferRecord) -> Option<View> {
    let [x, y, z, w] = record.orientation;
    let [origin, step] = record.plane.map(Vec2::from);
    let view = View { orientation: Quat::from_xyzw(x, y, z, w), plane: ImagePlane { origin, step } };
    (view.orientation.is_finite() && origin.is_finite() && step.is_finite()).then_some(view)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    fn record() -> EyeBufferRecord {
        EyeBufferRecord {
            eye: 0,
            queue: [0; 2],
            swapchain: 1,
            image: vk::Image::null(),
            format: vk::Format::R8G8B8A8_SRGB,
            layer: 0,
            rect: [0, 0, 64, 64],
            plane: [[-1.0, 1.0], [0.03, -0.03]],
            orientation: [0.0, 0.0, 0.0, 1.0],
            white_cd_m2: 100.0,
            is_mean: 0,
        }
    }

    #[test]
    fn views_are_the_same_until_anything_differs() {
        let mut last: Option<Measured> = None;
        let mut next = |record: &EyeBufferRecord, texel: u32| {
            last = Measured::new(record, [texel; 2], 7, last.as_ref());
            last.map(|measured| measured.same_view)
        };
        assert_eq!([(); 3].map(|()| next(&record(), 16)), [Some(0), Some(1), Some(2)]);
        // Another image of the swapchain shows the same.
        assert_eq!(next(&EyeBufferRecord { image: vk::Image::from_raw(5), ..record() }, 16), Some(3));
        let others = [
            EyeBufferRecord { orientation: [0.0, 1e-3, 0.0, 1.0], ..record() },
            EyeBufferRecord { plane: [[-1.0, 1.0], [0.03, -0.031]], ..record() },
            EyeBufferRecord { white_cd_m2: 99.0, ..record() },
            EyeBufferRecord { is_mean: 1, ..record() },
            EyeBufferRecord { format: vk::Format::R8G8B8A8_UNORM, ..record() },
        ];
        for other in others {
            assert_eq!(next(&other, 16), Some(0), "{other:?}");
            assert_eq!(next(&record(), 16), Some(0));
        }
        assert_eq!(next(&record(), 32), Some(0));
        assert_eq!(next(&EyeBufferRecord { orientation: [f32::NAN; 4], ..record() }, 32), None);
        assert_eq!(next(&record(), 32), Some(0));
    }
}
