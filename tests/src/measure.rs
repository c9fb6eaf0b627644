//! Measurement of a frame's cost and errors: several techniques on one application, in turn, so that other work of the machine affects all
//! of them alike.
//!
//! A [`Subject`] is a scene with a user; a [`Technique`] is applied to it. [`time`] gives each its turns and makes
//! [`Timing`]s of them, [`errors()`] judges the pictures, [`rows()`] and [`Summary`] print both.

mod errors;
mod jod;
mod order;
mod rows;
mod statistics;
mod subject;
mod summary;
mod technique;
mod timing;
mod turns;

pub use errors::{JudgedRun, RUN_UP, errors, fov, judge, judge_runs, judge_shaded, with_pictures};
pub use jod::{jod, jod_shaded};
pub use rows::{Comparison, Row, against_rows, error_rows, print_json, rows};
pub use statistics::{Ratio, Samples};
pub use subject::Subject;
pub use summary::{StyleRows, Summary};
pub use technique::Technique;
pub use timing::{Counts, Effort, LAYER_RUN_UP, RUN_UP_ALONE, Timing, take_turns, time};
pub use turns::{Player, play_in_turn, side_by_side, start_all};
