//! What contrast there is, and how much of it is seen.

pub mod csf;

/// Octave bands of spatial frequency that contrast is measured in, finest first.
pub const BANDS: usize = 4;
