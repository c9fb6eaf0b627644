//! The models again, in double precision and in the shape of their formulas.

pub mod audio;
pub mod avpm;
pub mod gaze;
pub mod perception;
pub mod plan;
pub mod schedule;
