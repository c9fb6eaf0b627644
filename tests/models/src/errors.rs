//! Visible differences of a clip from its reference, around the true gaze.
//!
//! A clip has the images of both eyes after the runtime's compositor, with the true gaze direction of each eye.
//! [`judge()`] compares it with the reference, which is the same moments without degradation, and reports each
//! [`Metric`] in rings of eccentricity: the mean over the ring's pixels and the worst 16 x 16 tile. The same clips
//! give the same report, bit for bit.
//!
//! [`fvvdp`] asks a published metric for one figure for the whole clip.

mod bands;
mod clip;
mod field;
pub mod fvvdp;
mod judge;
mod metrics;
mod pool;
mod report;
mod temporal;

pub use bands::BAND_SUPPORT_PX;
pub use clip::{Clip, Eye, Frame, Picture, Viewing};
pub use field::{CELL_PX, RING_EDGES_DEG, RING_NAMES, RINGS, TILE_PX};
pub use judge::{Judge, JudgeError, judge, seen_of_stills};
pub use metrics::{Metric, flicker::BAND_HZ, interocular::REACH_PX};
pub use pool::WorstTile;
pub use report::{EyeSummary, Report, Row};
pub use temporal::HALF_LENGTH_S;
