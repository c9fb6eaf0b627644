//! The audio-visual perception model (paper A, Eq. 12-17).
