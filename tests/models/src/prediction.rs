//! How far the gaze that a frame is made for is from where the eyes look when it is shown: what `cargo dev bench gaze` prints.

mod before;
mod errors;
mod movement;
mod report;

pub use before::{Before, before};
pub use errors::{DELAYS_MS, Errors, Frames, Predictor, RATES_HZ, SEEDS, measure};
pub use movement::{Movement, Movements};
pub use report::{Row, rows, table};
