//! `cargo dev report`: speed against error, as a page, as Markdown, as CSV.
//!
//! [`plan::Plan`] says what is measured: [`points`] in sweeps, in scenes. [`measure()`] does it and gives [`results::Results`], which
//! are kept as a file, here or, of a GPU, among the sources ([`gpu`]). From them [`verdict`] says who loses less at equal cost, with the
//! [`statistics`]; [`advice`] says what to switch on; [`page`], [`table`] and [`plot`] show it.

#![forbid(unsafe_code)]

pub mod advice;
mod bits;
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
