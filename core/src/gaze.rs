//! State of the gaze: tracked, held, lost; fixating, following or in a saccade.

mod calibration;
mod delay;
mod drift;
mod fixation;
mod inflation;
mod polynomial;
mod recentre;
mod rejection;
mod settings;
mod tracker;
mod vergence;

pub use calibration::{Calibration, CalibrationFailure, CalibrationFit, DOTS_DEG, Dots, FittedDot};
pub use delay::{GazeDelay, TimedGaze};
pub use drift::GazeDrift;
pub use inflation::{MAX_FOVEAL_RADIUS_DEG, foveal_inflation_deg};
pub use polynomial::{GazePolynomial, PolynomialOrder};
pub use recentre::{GazeOffset, MAX_OFFSET_DEG, RecentreFailure, Recentring};
pub use rejection::Rejection;
pub use settings::GazeSettings;
pub use tracker::{GazeTracker, is_unchanged};
pub use vergence::{NEAREST_ASSUMED_M, eye_directions};

use crate::geometry::{eccentricity, rotation};
use glam::{Quat, Vec2, Vec3};

/// One answer of the eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeSample {
    /// Gaze directions of the left and the right eye, in the view space common to both eyes (+x right, +y up, -z forward), of any
    /// length. A direction that is zero or not finite means that this eye is not tracked.
    pub directions: [Vec3; 2],
    /// Time at which the eyes looked there, nanoseconds on any one clock (XrTime).
    pub time_ns: i64,
    /// Possible error of that time, nanoseconds; 0: exact.
    pub uncertainty_ns: i64,
    /// Whether the tracker stands by it. When false, the directions are not read.
    pub valid: bool,
}

/// Phase of the gaze.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GazePhase {
    /// Tracked, and resting.
    Fixation,
    /// Tracked, and following something that moves in the world: slow enough to see with.
    Pursuit,
    /// Tracked, and too fast to see fine detail.
    Saccade,
    /// Just landed, just found again, or just lost.
    PostSaccade,
    /// Not seen, for 50 ms or longer, and for less than [`GazeSettings::hold_ms`]: most likely a blink. The last directions are held.
    Blink,
    /// Not seen for longer, or never.
    Lost,
}

/// The gaze as the models use it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeState {
    /// Gaze direction of each eye at the requested time, left first, unit vectors in the space of [`GazeSample::directions`]. In
    /// a saccade: on its path, or at its landing point if it will have landed by then. In a blink and when lost: the last known
    /// directions; -z (forward) before the first ones. Both are equal if the source has one ray for both eyes: see
    /// [`Self::with_vergence`].
    pub directions: [Vec3; 2],
    /// The ray of the gaze, a unit vector, if `directions` are for an assumed distance ([`Self::with_nearest`]); the centre of areas around
    /// one point.
    pub ray: Option<Vec3>,
    /// Speed at which the gaze turns in the world, degrees a second, 0..=1000; 0 while not seen.
    pub velocity_deg_s: f32,
    /// Uncertainty of `directions` that are a prediction, degrees: of a saccade's landing, or of a pursuit's extrapolation.
    pub prediction_error_deg: Option<f32>,
    /// Possible error of `directions` while the head turns, by the uncertain time of the newest sample
    /// ([`GazeSample::uncertainty_ns`]), degrees.
    pub timing_error_deg: f32,
    /// Phase of the gaze.
    pub phase: GazePhase,
    /// Whether changes of the picture go unnoticed ([`GazeSettings::post_saccade_ms`]): from the second sample of a saccade
    /// on, for that time beyond its landing, by the timestamps of the samples, not of their arrival, less their uncertainty.
    pub is_suppressed: bool,
    /// Reliability of the directions: 1 tracked .. 0 lost. It ramps, so that values derived from it never jump.
    pub trust: f32,
}

impl GazeState {
    /// No gaze, and none ever known.
    pub const LOST: Self = Self {
        directions: [Vec3::NEG_Z; 2],
        ray: None,
        velocity_deg_s: 0.0,
        prediction_error_deg: None,
        timing_error_deg: 0.0,
        phase: GazePhase::Lost,
        is_suppressed: false,
        trust: 0.0,
    };

    /// Eccentricity of a direction, in the same space, from the nearer of the two eyes' gaze, in radians within 0..=pi: both eyes count as
    /// looking where either looks.
    ///
    /// A direction without a meaning gives 0, as [`eccentricity`] does.
    pub fn eccentricity(&self, direction: Vec3) -> f32 {
        let [left, right] = self.directions.map(|gaze| eccentricity(gaze, direction));
        left.min(right)
    }

    /// Whether a tile may become coarser, or be rendered less often, than a frame ago. Becoming finer is always
    /// allowed.
    pub fn may_coarsen(&self) -> bool {
        self.is_suppressed || matches!(self.phase, GazePhase::Fixation | GazePhase::Pursuit)
    }

    /// Uncertainty of [`Self::directions`] from motion of the eyes, degrees: velocity * latency, where `latency_s` is the time from
    /// the eye to the image. For directions that are a prediction, at most the error of the prediction. [`Self::timing_error_deg`]
    /// comes to it.
    pub fn motion_deg(&self, latency_s: f32) -> f32 {
        let moved = self.velocity_deg_s * latency_s;
        let of_eyes = match self.prediction_error_deg {
            Some(error) if error < moved => error.max(0.0),
            _ => moved,
        };
        of_eyes + self.timing_error_deg.max(0.0)
    }

    /// The same with a direction for each eye, where there is one ray for both: [`eye_directions`] has the parameters.
    /// Directions that differ already are kept.
    pub fn with_vergence(self, eyes_m: [Vec3; 2], distance_m: Option<f32>) -> Self {
        match distance_m {
            Some(distance_m) => self.verged(eyes_m, distance_m),
            None => self.with_nearest(eyes_m, NEAREST_ASSUMED_M),
        }
    }

    /// As [`Self::with_vergence`], if only the least distance of the content is known, `nearest_m`: the rings around both
    /// directions then hold for farther content, too.
    pub fn with_nearest(self, eyes_m: [Vec3; 2], nearest_m: f32) -> Self {
        let verged = self.verged(eyes_m, nearest_m);
        let ray = (verged.directions != self.directions).then_some(self.directions[0]);
        Self { ray, ..verged }
    }

    fn verged(self, eyes_m: [Vec3; 2], distance_m: f32) -> Self {
        let [left, right] = self.directions;
        if left != right {
            return self;
        }
        Self { directions: eye_directions(left, eyes_m, Some(distance_m)), ..self }
    }

    /// Intersections of the gaze directions with the plane one unit ahead of each eye's view (x to the right, y up).
    /// `orientations` are from each view's space to the common one, so that canted views need no special case. `None` for a
    /// direction 89 degrees or more from the axis of the view, or for an invalid orientation.
    pub fn tangent_points(&self, orientations: [Quat; 2]) -> [Option<Vec2>; 2] {
        [0, 1].map(|eye| {
            let seen = rotation(orientations[eye])?.inverse() * self.directions[eye];
            (seen.z < -LEAST_AHEAD).then(|| seen.truncate() / -seen.z)
        })
    }
}

/// Cosine of 89 degrees.
const LEAST_AHEAD: f32 = 0.017_452_406;

#[cfg(test)]
mod tests;
