//! A frame, as a gate takes it.

use crate::gaze::GazePhase;

/// A rendered frame with its cost, which may be known later than the frame ended. Frames come in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GateFrame {
    /// Now, nanoseconds on any one clock.
    pub time_ns: i64,
    /// Time *spent* on the frame, nanoseconds, never the time between frames, which a display's clock or a frame limiter can pin: GPU
    /// time of the whole frame, our own work with it, or CPU time of the process where a CPU renders. None if unknown.
    pub cost_ns: Option<u64>,
    /// Whether the technique was on in that frame.
    pub was_on: bool,
    /// Phase of the gaze now.
    pub phase: GazePhase,
    /// Number that identifies the set of eye passes of that frame. `None` without passes.
    pub passes: Option<u32>,
    /// Pixels of the largest eye pass of that frame; 0: unknown, and counted as in the frame before.
    pub pixels: u32,
}
