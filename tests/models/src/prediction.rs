//! Error of the predicted gaze: the angle between the gaze that a frame is rendered for and the true gaze at its display time. The figures
//! of `cargo dev bench gaze`.

mod before;
mod errors;
mod movement;
mod report;

pub use before::{Before, before};
pub use errors::{DELAYS_MS, Errors, Frames, Predictor, RATES_HZ, SEEDS, measure};
pub use movement::{Movement, Movements};
pub use report::{Row, rows, table};
