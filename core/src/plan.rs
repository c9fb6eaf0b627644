//! The plan of one frame, for each eye: the rate of every tile, its updates, and attenuation of chroma.
//!
//! [`Planner`] makes a [`FramePlan`] of a [`PlanInput`] in three steps. A handful of numbers hold for the whole frame: the safety limits
//! widen every radius by the uncertainty of the gaze, limit how fast tiles become coarser, and turn techniques off while the gaze is lost.
//! From these come a [`DecideParams`](crate::kernels::decide::DecideParams) for each eye, the uniform of the kernel `decide`;
//! [`crate::kernels::decide`] is its reference, with all the work per tile. Around it, [`crate::schedule::CellAges`] selects the
//! directions to render again, and [`crate::chroma::ChromaTemporalFilter`] lets colour follow the gaze.
//!
//! [`FramePlan`] as text (its `Display`) and [`FramePlan::picture`] show a plan to people.

mod changes;
mod contrast;
mod eye;
mod frame;
mod input;
mod lattice;
mod picture;
mod planner;
mod reasons;
mod rings;
mod rules;
mod safety;
mod sensitivity;
mod settings;
mod statistics;
mod text;
mod tile_schedule;
mod tile_updates;

pub use contrast::VisibleContrast;
pub use frame::{EyePlan, FramePlan};
pub use input::{EyeInput, PlanInput};
pub use lattice::{LatticeShape, MAX_SIDE, MOST_TILES, TEXEL_SIDES, TileLattice, tile_of};
pub use planner::Planner;
pub use reasons::{Reason, Reasons};
pub use rings::{AvailableRates, COARSER_RATES, Rings, STEPS_PER_OCTAVE};
pub use sensitivity::Sensitivity;
pub use settings::{
    AudioVisual, DeviceRates, PlanSettings, RateSettings, SafetySettings, UpdateSettings, UpdateUnit,
};
pub use statistics::Statistics;

#[cfg(test)]
mod tests;
