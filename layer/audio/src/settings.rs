//! What shall be heard.

use parafovea_core::audio::AudioSettings;
use std::path::PathBuf;

/// What shall be heard, and how it is summed up.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What is listened to.
    pub source: Source,
    /// How it is summed up.
    pub features: AudioSettings,
    /// T_s of paper A's Algorithm 1: how often features are published, seconds, 0.1..=1, rounded to 0.1.
    pub interval_s: f32,
}

/// What is listened to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// What the system plays.
    System,
    /// A WAV file, over and over, as fast as it would be played.
    File(PathBuf),
}

impl Default for Settings {
    fn default() -> Self {
        Self { source: Source::System, features: AudioSettings::default(), interval_s: 0.1 }
    }
}
