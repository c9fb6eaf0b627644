//! The models again, in double precision and in the shape of their formulas.

pub mod perception;
pub mod plan;
