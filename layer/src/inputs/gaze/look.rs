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
        /// Where the eyes looked, in the space of the head (-z is straight ahead), of any length.
        direction: Vec3,
        /// When they did, nanoseconds on the clock of display times; 0: not known.
        sampled_ns: i64,
    },
}
