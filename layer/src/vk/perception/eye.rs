//! What is known of one eye.

use super::Tools;
use crate::gpu::GpuError;
use crate::link::PictureRecord;
use crate::passes::analyze::ViewTiles;
use crate::passes::decide::DecideTarget;
use glam::{Quat, Vec2};
use parafovea_core::geometry::{ImagePlane, View};
use std::sync::Arc;

/// An eye whose pictures are analysed.
pub struct Eye {
    /// Its tiles.
    pub tiles: Arc<EyeTiles>,
    /// The view of the picture that was analysed last, and the number of the plan by then; nothing where contrast is not known.
    pub measured: Option<(View, u64)>,
}

/// The tiles of an eye's picture, on the GPU.
pub struct EyeTiles {
    /// 0: left, 1: right.
    pub eye: usize,
    /// Contrast and rates.
    pub view: Arc<ViewTiles>,
    /// What they are decided with.
    pub decide: DecideTarget,
}

impl EyeTiles {
    /// Of so many columns and rows, of which nothing is known.
    ///
    /// # Errors
    /// A failed call, or more tiles than the device takes.
    pub fn new(tools: &Tools, eye: usize, tiles: [u32; 2]) -> Result<Self, GpuError> {
        let view = Arc::new(ViewTiles::new(&tools.gpu, tiles)?);
        let decide = tools.decide.target(&view)?;
        Ok(Self { eye, view, decide })
    }
}

/// The view of a picture.
pub fn view_of(record: &PictureRecord) -> Option<View> {
    let [x, y, z, w] = record.orientation;
    let [origin, step] = record.plane.map(Vec2::from);
    let view = View { orientation: Quat::from_xyzw(x, y, z, w), plane: ImagePlane { origin, step } };
    (view.orientation.is_finite() && origin.is_finite() && step.is_finite()).then_some(view)
}
