//! The answer of an eye tracker.

use glam::Vec3;

/// The answer of the eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// There is none, or it cannot be asked any more.
    NoTracker,
    /// It does not see the eyes, or is not believed.
    Unseen,
    /// The newest that it knows.
    At {
        /// Direction of the gaze in the space of the head (-z is the centre of the view), of any length.
        direction: Vec3,
        /// Time of the sample, nanoseconds on the clock of display times; 0: not known.
        sampled_ns: i64,
        /// Possible error of that time, nanoseconds; 0: exact.
        uncertainty_ns: i64,
    },
}
