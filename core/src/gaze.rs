//! What the gaze is worth at this moment: tracked, held, lost; fixating or in a saccade.

mod inflation;
mod tracker;

pub use inflation::{MAX_FOVEAL_RADIUS_DEG, foveal_inflation_deg};
pub use tracker::{GazeSettings, GazeTracker};

use crate::geometry::eccentricity;
use glam::Vec3;

/// One answer of the eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeSample {
    /// Where the left and the right eye look, in the view space common to both eyes (+x right, +y up, -z
    /// forward), of any length. A direction that is zero or not finite says that this eye is not seen.
    pub directions: [Vec3; 2],
    /// When the eyes looked there, nanoseconds on any one clock (XrTime).
    pub time_ns: i64,
    /// Whether the tracker stands by it. When false, the directions are not read.
    pub valid: bool,
}

/// What the eyes are doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GazePhase {
    /// Tracked, and slow enough to see with: fixation or pursuit.
    Fixation,
    /// Tracked, and too fast to see fine detail.
    Saccade,
    /// Just landed (or just found again): nothing may become coarser now.
    PostSaccade,
    /// Not seen, for less than [`GazeSettings::hold_ms`]: most likely a blink. The last directions are held.
    Blink,
    /// Not seen for longer, or never.
    Lost,
}

/// The gaze as the models use it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeState {
    /// Where each eye looks, left first, unit vectors in the space of [`GazeSample::directions`]; the last known
    /// ones in a blink and when lost, straight ahead (-z) before there were any.
    pub directions: [Vec3; 2],
    /// Speed of the eyes, degrees a second, 0..=1000; 0 while not seen.
    pub velocity_deg_s: f32,
    /// What the eyes are doing.
    pub phase: GazePhase,
    /// How far the directions may be relied on: 1 tracked .. 0 lost. Ramps, so that what follows it never jumps.
    pub trust: f32,
}

impl GazeState {
    /// No gaze, and none ever known.
    pub const LOST: Self =
        Self { directions: [Vec3::NEG_Z; 2], velocity_deg_s: 0.0, phase: GazePhase::Lost, trust: 0.0 };

    /// Eccentricity of a direction, in the same space, from the nearer of the two eyes' gaze, in radians within
    /// 0..=pi: what either eye could be looking at counts as looked at, in both eyes.
    ///
    /// A direction without a meaning gives 0, as [`eccentricity`] does.
    pub fn eccentricity(&self, direction: Vec3) -> f32 {
        let [left, right] = self.directions.map(|gaze| eccentricity(gaze, direction));
        left.min(right)
    }

    /// Whether a tile may become coarser, or be rendered less often, than a frame ago. Becoming finer is always
    /// allowed.
    pub fn may_coarsen(&self) -> bool {
        self.phase == GazePhase::Fixation
    }
}

#[cfg(test)]
mod tests;
