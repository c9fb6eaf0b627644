//! One capture: its threads, and their findings.

use crate::settings::Settings;
use crate::shared::Shared;
use crate::{analysis, sources};
use parafovea_core::audio::AudioFeatures;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::Builder;

/// Listens from when it is made until it is dropped.
pub struct Capture(Arc<Shared>);

/// Features of the captured sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturedFeatures {
    /// Counts sets of features, from 1.
    pub serial: u64,
    /// Time since the last sample that counts was captured, nanoseconds.
    pub age_ns: u64,
    /// The features.
    pub features: AudioFeatures,
    /// Share of the last seconds that was captured intact, 0..=1.
    pub confidence: f32,
}

impl Capture {
    /// Begins to listen. Threads of a capture never keep a process from ending, and end when it is dropped, soon but not
    /// at once: who drops it does not wait.
    ///
    /// # Errors
    /// No thread can be made.
    pub fn start(settings: Settings) -> io::Result<Self> {
        let capture = Self(Arc::new(Shared::new(settings)));
        capture.spawn("parafovea-sound", sources::run)?;
        capture.spawn("parafovea-meter", analysis::run)?;
        Ok(capture)
    }

    /// The newest features; nothing before the first. Neither waits nor allocates.
    pub fn newest(&self) -> Option<CapturedFeatures> {
        let set = self.0.published.newest()?;
        let age_ns = self.0.now_ns().saturating_sub(set.captured_ns);
        Some(CapturedFeatures {
            serial: set.serial,
            age_ns,
            features: set.features,
            confidence: set.confidence,
        })
    }

    /// The oldest line for the log that was not taken yet.
    pub fn next_line(&self) -> Option<String> {
        self.0.messages.next()
    }

    fn spawn(&self, name: &str, run: fn(&Shared)) -> io::Result<()> {
        let shared = self.0.clone();
        let run = move || {
            // Unwind safety: all shared state is atomic or behind a mutex. A panic is reported below, and by a panic hook if one is set. After it
            // there is no more sound, and the last features age out of the plans.
            if catch_unwind(AssertUnwindSafe(|| run(&shared))).is_err() {
                shared.messages.say("capture ended: internal error".to_owned());
                shared.stop();
            }
        };
        Builder::new().name(name.to_owned()).spawn(run).map(drop)
    }
}

impl Drop for Capture {
    fn drop(&mut self) {
        self.0.stop();
    }
}
