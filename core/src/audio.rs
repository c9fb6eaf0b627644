//! What is heard: loudness and mel feature (paper A, Eq. 1-6).

mod features;

pub use features::AudioFeatures;
