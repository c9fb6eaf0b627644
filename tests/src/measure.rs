//! Measuring what a frame costs: several techniques on one application, by turns, so that what else the machine does
//! falls on all of them alike.
//!
//! A [`Subject`] is an application with what its user does; a [`Technique`] is what is done to it. [`time`] gives each
//! its turns and makes [`Timing`]s of them, [`rows`] turns these into lines of results.

mod rows;
mod statistics;
mod subject;
mod technique;
mod timing;

pub use rows::{Row, print_json, print_table, rows};
pub use statistics::Samples;
pub use subject::Subject;
pub use technique::Technique;
pub use timing::{Effort, Timing, time};
