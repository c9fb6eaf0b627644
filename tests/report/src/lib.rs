//! `cargo dev report`: speed against error, as a page, as Markdown, as CSV.
//!
//! [`plan::Plan`] lists the measurements: [`points`] in sweeps, in scenes. [`measure()`] makes them and returns [`results::Results`],
//! which are kept as a file, here or, of a GPU, among the sources ([`gpu`]). From them [`verdict`] finds the sweep with less loss at
//! equal cost, with the [`statistics`]; [`advice`] recommends options; [`page`], [`table`] and [`plot`] show it.

#![forbid(unsafe_code)]

pub mod advice;
mod bits;
mod equal_loss;
mod estimates;
pub mod gpu;
pub mod hardware;
mod measure;
pub mod page;
pub mod pictures;
pub mod plan;
pub mod plot;
pub mod points;
pub mod results;
pub mod statistics;
pub mod summary;
pub mod table;
pub mod verdict;

pub use measure::measure;
