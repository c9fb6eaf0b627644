//! What streams of events of many kinds of applications are recognised as.

mod application;
mod random;
mod styles;
