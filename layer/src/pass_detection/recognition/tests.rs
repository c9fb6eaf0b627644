//! What streams of events of many kinds of applications are recognised as.

pub mod application;
pub mod random;
mod styles;
