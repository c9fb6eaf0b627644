//! Verdicts on streams of events of many kinds of applications.

pub mod application;
pub mod random;
mod styles;
