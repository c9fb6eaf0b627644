//! The models again, in double precision and in the shape of their formulas.

pub mod audio;
pub mod avpm;
pub mod chroma;
pub mod gaze;
pub mod geometry;
pub mod perception;
pub mod plan;
pub mod schedule;
