//! Settings of a capture.

use parafovea_core::audio::AudioSettings;
use std::path::PathBuf;

/// The sound to capture, and its summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The source of the sound.
    pub source: Source,
    /// Settings of its features.
    pub features: AudioSettings,
    /// T_s of paper A's Algorithm 1: interval at which features are published, seconds, 0.1..=1, rounded to 0.1.
    pub interval_s: f32,
}

/// A source of sound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// The system's sound.
    System,
    /// A WAV file, over and over, as fast as it would be played.
    File(PathBuf),
}

impl Default for Settings {
    fn default() -> Self {
        Self { source: Source::System, features: AudioSettings::default(), interval_s: 0.1 }
    }
}
