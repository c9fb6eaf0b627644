//! The stored correction of the eye tracker, and its measurement for `parafovea gaze recentre`.
//!
//! The frame's thread corrects the gaze and hands over samples ([`GazeCorrecting`]); requests and files are the status thread's
//! ([`RecentreRequests`]). Nothing of the gaze is logged.

use super::auto::Holder;
use super::{Look, degrees, turned};
use glam::Vec3;
use parafovea_core::gaze::{GazeOffset, Recentring};
use parafovea_manifest::gaze_correction::GazeCorrection;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{AskedRecentre, Recentre};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The correction of a session's gaze.
#[derive(Debug, Default)]
pub struct GazeCorrecting(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    /// The source of the gaze that is corrected, and the angles to the left and upwards, degrees.
    correction: Option<(Holder, [f32; 2])>,
    measurement: Option<Measurement>,
}

impl State {
    fn corrected(&self, source: Holder, look: Look) -> Look {
        match self.correction {
            Some((corrected, offset_deg)) if corrected == source => turned(look, offset_deg),
            _ => look,
        }
    }
}

#[derive(Debug, Default)]
struct Measurement {
    recentring: Recentring,
    /// The first source with a gaze: the measurement is of that.
    source: Option<Holder>,
}

impl GazeCorrecting {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The corrected gaze of an eye tracker, for a frame that is shown at `time_ns`. Allocates nothing.
    pub fn corrected(&self, source: Holder, look: Look, time_ns: i64) -> Look {
        let mut state = self.state();
        if let Some(Measurement { recentring, source: measured }) = &mut state.measurement {
            let sample = match look {
                Look::At { direction, sampled_ns } if direction != Vec3::ZERO => {
                    let at = if sampled_ns > 0 { sampled_ns } else { time_ns };
                    let is_its = *measured.get_or_insert(source) == source;
                    is_its.then(|| (degrees(direction), at))
                }
                _ => None,
            };
            recentring.push(sample, time_ns);
        }
        state.corrected(source, look)
    }

    /// The same for the application: no measurement takes the sample.
    pub fn corrected_for_application(&self, source: Holder, look: Look) -> Look {
        self.state().corrected(source, look)
    }

    fn set_correction(&self, correction: Option<&GazeCorrection>) {
        let known = correction.and_then(|correction| {
            let source =
                [Holder::Eyes, Holder::Osc].into_iter().find(|source| source.name() == correction.source)?;
            Some((source, correction.offset_deg))
        });
        self.state().correction = known;
    }

    /// Begins a measurement, or with `None` ends it without a result.
    fn set_measurement(&self, measurement: Option<Measurement>) {
        let before = std::mem::replace(&mut self.state().measurement, measurement);
        drop(before);
    }

    /// The measurement, once it is over.
    fn take_measured(&self) -> Option<Measurement> {
        self.state().measurement.take_if(|measurement| measurement.recentring.is_over())
    }
}

/// Follows requests for a measurement, and the file of the correction.
#[derive(Debug)]
pub struct RecentreRequests {
    correcting: Arc<GazeCorrecting>,
    asked: AskedRecentre,
    headset: String,
    file: Option<PathBuf>,
    /// The fault of the file that was logged.
    fault: String,
    status: Recentre,
}

impl RecentreRequests {
    /// Reads the correction of a headset, and looks for requests to the process `pid`.
    pub fn new(
        environment: &Environment,
        pid: u32,
        headset: String,
        correcting: Arc<GazeCorrecting>,
    ) -> Self {
        let file = GazeCorrection::file(environment, &headset);
        let status = Recentre {
            file: file.as_ref().map(|file| file.display().to_string()).unwrap_or_default(),
            ..Recentre::default()
        };
        let asked = AskedRecentre::new(environment, pid);
        let mut requests = Self { correcting, asked, headset, file, fault: String::new(), status };
        requests.read();
        requests
    }

    /// Begins and ends measurements, and takes over a correction that was stored or removed meanwhile, by whatever process.
    pub fn poll(&mut self) -> Recentre {
        self.read();
        let asked = self.asked.look();
        match asked {
            Some(number) if number != self.status.number => {
                self.correcting.set_measurement(Some(Measurement::default()));
                (self.status.number, self.status.is_measuring) = (number, true);
                self.status.failure.clear();
            }
            None if self.status.is_measuring => {
                self.correcting.set_measurement(None);
                self.status.is_measuring = false;
                "it was withdrawn".clone_into(&mut self.status.failure);
            }
            _ => {}
        }
        if let Some(measured) = self.correcting.take_measured() {
            self.status.is_measuring = false;
            self.status.failure = self.store(&measured).err().unwrap_or_default();
        }
        self.status.clone()
    }

    /// The correction of the file; without one there is none.
    fn read(&mut self) {
        let read = self.file.as_deref().map_or(Ok(None), GazeCorrection::read);
        let fault = read.as_ref().err().cloned().unwrap_or_default();
        if fault != self.fault {
            if !fault.is_empty() {
                tracing::warn!(
                    "correction of the eye tracker ignored: {fault}; to replace it: parafovea gaze recentre"
                );
            }
            self.fault = fault;
        }
        let correction = read.ok().flatten();
        if correction != self.status.correction {
            self.correcting.set_correction(correction.as_ref());
            self.status.correction = correction;
        }
    }

    /// Stores the result of a measurement, or returns why there is none.
    fn store(&mut self, measured: &Measurement) -> Result<(), String> {
        let GazeOffset { offset_deg, spread_deg } =
            measured.recentring.offset().map_err(|reason| reason.to_string())?;
        let file = self.file.as_ref().ok_or(match self.headset.is_empty() {
            true => "the runtime does not name the headset",
            false => "neither XDG_STATE_HOME nor HOME is set, so there is no folder for the correction",
        })?;
        let source = measured.source.map_or("", Holder::name);
        GazeCorrection::new(&self.headset, source, offset_deg, spread_deg)
            .write(file)
            .map_err(|error| format!("{}: {error}", file.display()))?;
        self.read();
        tracing::info!("the eye tracker was recentred, as parafovea gaze recentre requested");
        Ok(())
    }
}

#[cfg(test)]
mod tests;
