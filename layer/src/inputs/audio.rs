//! Sound, while the configuration asks for it: another library listens, on threads of its own.

#[cfg(debug_assertions)]
mod features_file;

use crate::abi::audio_library::Capture;
use crate::abi::threads::spawn;
use crate::config::{AudioMode, AudioSource, Config, FilePath};
use parafovea_core::audio::AudioFeatures;
use parafovea_manifest::audio_library::{FeaturesRecord, SOURCE_FILE, SOURCE_SYSTEM, SettingsRecord};
use std::ptr::null;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Interval between looks for log lines of the library that captures.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Sound input of a session.
#[derive(Default)]
pub struct AudioInput {
    listening: Option<Listening>,
    /// The last features and their number, for the file of tests.
    #[cfg(debug_assertions)]
    last: Option<(Option<AudioFeatures>, u64)>,
}

/// The capture that the configuration asks for.
struct Listening {
    wanted: Wanted,
    shared: Arc<Shared>,
}

/// State shared by the library's loading thread and the planning threads.
#[derive(Default)]
struct Shared {
    /// There once the library is loaded and listens.
    capture: OnceLock<Capture>,
    is_over: AtomicBool,
}

/// Sound settings of the configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wanted {
    source: u32,
    file: FilePath,
    is_paper: bool,
    window_s: f32,
    interval_s: f32,
    least_lufs: f32,
    greatest_lufs: f32,
}

impl AudioInput {
    /// The reliable features of sound now, as configured. Neither waits nor allocates, but where
    /// the configuration changed: then a thread begins, or ends, to listen.
    pub fn poll(&mut self, config: &Config) -> Option<AudioFeatures> {
        let wanted = Wanted::of(config);
        if self.listening.as_ref().map(|listening| listening.wanted) != wanted {
            self.listening = wanted.map(Listening::begin);
        }
        let listening = self.listening.as_ref()?;
        let record = listening.shared.capture.get().and_then(Capture::features);
        let features = record.and_then(|record| relied_on(&record, listening.wanted.interval_s));
        #[cfg(debug_assertions)]
        {
            let newest = (features, record.map_or(0, |record| record.serial));
            if features_file::is_wanted() && self.last.replace(newest) != Some(newest) {
                features_file::write(features.as_ref(), record.as_ref());
            }
        }
        features
    }

    /// Ends the capture, while its features are not wanted.
    pub fn rest(&mut self) {
        self.listening = None;
        #[cfg(debug_assertions)]
        {
            self.last = None;
        }
    }
}

impl Wanted {
    fn of(config: &Config) -> Option<Self> {
        let audio = &config.audio;
        let source = match audio.source {
            _ if !config.enabled => return None,
            AudioSource::Off => return None,
            AudioSource::System => SOURCE_SYSTEM,
            AudioSource::File => SOURCE_FILE,
        };
        Some(Self {
            source,
            file: audio.file,
            is_paper: audio.mode == AudioMode::Paper,
            window_s: audio.window_s,
            interval_s: audio.interval_s,
            least_lufs: audio.least_lufs,
            greatest_lufs: audio.greatest_lufs,
        })
    }

    fn record(&self) -> SettingsRecord {
        SettingsRecord {
            source: self.source,
            path: null(),
            path_len: 0,
            is_paper: u32::from(self.is_paper),
            window_s: self.window_s,
            interval_s: self.interval_s,
            least_lufs: self.least_lufs,
            greatest_lufs: self.greatest_lufs,
        }
    }
}

impl Listening {
    /// Begins to listen, on another thread: to load a library takes its time. Without the thread, there are no features until other
    /// settings are wanted.
    fn begin(wanted: Wanted) -> Self {
        let shared = Arc::new(Shared::default());
        let theirs = shared.clone();
        let run = move || listen(&wanted, &theirs);
        if let Err(error) = spawn("parafovea-audio", run) {
            tracing::warn!("sound: not captured: cannot start a thread: {error}");
        }
        Self { wanted, shared }
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
    }
}

/// Loads the library, begins to listen, and passes its lines on to the log.
fn listen(wanted: &Wanted, shared: &Shared) {
    let capture = match Capture::start(&wanted.record(), wanted.file.path()) {
        Ok(capture) => shared.capture.get_or_init(|| capture),
        Err(reason) => return tracing::warn!("sound: not captured: {reason}"),
    };
    while !shared.is_over.load(Ordering::Relaxed) {
        while let Some(line) = capture.next_line() {
            tracing::info!("sound: {line}");
        }
        std::thread::sleep(LOOK_EVERY);
    }
    tracing::info!("sound: capture ended");
}

/// The reliable part of features.
fn relied_on(record: &FeaturesRecord, interval_s: f32) -> Option<AudioFeatures> {
    let features = AudioFeatures {
        loudness_lufs: record.loudness_lufs,
        gamma_ld: record.gamma_ld,
        gamma_fq_kilomel: record.gamma_fq_kilomel,
        silent: record.is_silent == 1,
    };
    features.relied_on(record.age_ns as f32 / 1e9, record.confidence, interval_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_listens_unless_asked_to() {
        let mut config = Config::default();
        assert_eq!(Wanted::of(&config), None, "off by default");
        config.audio.source = AudioSource::System;
        assert_eq!(Wanted::of(&config).unwrap().source, SOURCE_SYSTEM);
        config.enabled = false;
        assert_eq!(Wanted::of(&config), None);
        let mut audio_input = AudioInput::default();
        assert_eq!(audio_input.poll(&config), None);
        assert!(audio_input.listening.is_none());
    }

    #[test]
    fn the_defaults_of_the_configuration_are_those_of_the_model() {
        let (audio, model) = (Config::default().audio, parafovea_core::audio::AudioSettings::default());
        assert_eq!(
            (audio.mode, audio.window_s, audio.interval_s, audio.least_lufs, audio.greatest_lufs),
            (
                AudioMode::Default,
                model.window_s,
                parafovea_core::audio::INTERVAL_S,
                model.least_lufs,
                model.greatest_lufs
            )
        );
        assert_eq!(model.mode, parafovea_core::audio::Mode::Default);
    }

    #[test]
    fn old_features_are_not_relied_on() {
        let record = FeaturesRecord {
            serial: 1,
            age_ns: 150_000_000,
            loudness_lufs: -20.0,
            gamma_ld: 15.0,
            gamma_fq_kilomel: 1.5,
            is_silent: 0,
            confidence: 1.0,
            reserved: 0,
        };
        assert_eq!(relied_on(&record, 0.1).unwrap().gamma_ld, 15.0);
        assert_eq!(relied_on(&FeaturesRecord { age_ns: 500_000_000, ..record }, 0.1), None);
        assert!(relied_on(&FeaturesRecord { is_silent: 1, ..record }, 0.1).unwrap().silent);
    }
}
