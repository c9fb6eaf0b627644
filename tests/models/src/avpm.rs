//! Fit of the audio-visual perception model's coefficients to a user study (paper A, Eq. 13): how [`parafovea_core::avpm::PAPER`] came about.

pub mod fit;
pub mod least_squares;
pub mod study;
