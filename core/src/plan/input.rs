//! Input of a plan.

use super::lattice::LatticeShape;
use crate::audio::AudioFeatures;
use crate::gaze::GazeState;
use crate::geometry::Fov;
use crate::perception::ContrastMap;
use glam::Quat;

/// Input of a plan: time, views, gaze and sound.
#[derive(Clone, Copy, Debug)]
pub struct PlanInput<'a> {
    /// Display time of the frame, nanoseconds on any one clock (XrTime).
    pub time_ns: i64,
    /// Number of the frame: one more than that of the frame before.
    pub frame: u64,
    /// Frames a second as measured, Hz. Where that is not a positive number, nothing is re-used.
    pub frame_rate_hz: f32,
    /// The left and the right view.
    pub eyes: [EyeInput<'a>; 2],
    /// From the space common to both views to one that rests in the world (OpenXR's LOCAL space), so that the update
    /// schedule does not move with the head. Any length but 0, which counts as no rotation.
    pub head: Quat,
    /// The gaze, in the space common to both views.
    pub gaze: GazeState,
    /// Features of the sound, if known.
    pub audio: Option<AudioFeatures>,
}

/// One view.
#[derive(Clone, Copy, Debug)]
pub struct EyeInput<'a> {
    /// First pixel of the view in its image.
    pub offset: [u32; 2],
    /// Size of the view, pixels; 0 where there is no such view.
    pub extent: [u32; 2],
    /// Field of view.
    pub fov: Fov,
    /// From the view's space to the common one: canted displays turn the two views apart. Any length but 0.
    pub orientation: Quat,
    /// Contrast of the last frame for each tile of this view, where that is known.
    pub contrast: Option<&'a ContrastMap>,
    /// Whether all tiles have to be rendered, as after a cut or when there is no earlier picture.
    pub refresh: bool,
}

impl EyeInput<'_> {
    pub(super) fn shape(&self, texel: [u32; 2]) -> LatticeShape {
        LatticeShape { offset: self.offset, extent: self.extent, fov: self.fov, texel }
    }
}
