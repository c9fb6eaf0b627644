//! Inputs of the user: the latest values that a frame needs.

pub mod audio;
pub mod cost;
pub mod gaze;
