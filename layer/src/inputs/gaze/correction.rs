//! The stored correction of the eye tracker, its measurements for `parafovea gaze calibrate` and `recentre`, and the drift of the gaze
//! since then.
//!
//! The frame's thread corrects the gaze and hands over samples ([`SessionGazeCorrection`]); requests and files are the status thread's
//! ([`CorrectionRequests`]). Nothing of the gaze is logged.

use super::auto::ActiveGazeSource;
use super::{Look, degrees, direction};
use glam::Vec3;
use parafovea_core::gaze::{
    Calibration, CalibrationFit, DOTS_DEG, GazeDrift, GazeOffset, GazePhase, GazePolynomial, Recentring,
};
use parafovea_manifest::gaze_correction::{GazeCalibration, GazeCorrection};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{AskedMeasurement, CorrectionStatus, GazeMeasurement};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The correction of a session's gaze.
#[derive(Debug, Default)]
pub struct SessionGazeCorrection(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    corrections: Corrections,
    measurement: Option<Measurement>,
    drift: GazeDrift,
    /// The source of the gaze whose drift it is.
    drifting: ActiveGazeSource,
}

impl State {
    fn corrected(&self, source: ActiveGazeSource, look: Look) -> Look {
        match (look, self.corrections.of(source)) {
            (Look::At { direction: seen, sampled_ns, uncertainty_ns }, Some(correction))
                if seen != Vec3::ZERO =>
            {
                let direction = direction(correction.corrected(degrees(seen)));
                Look::At { direction, sampled_ns, uncertainty_ns }
            }
            _ => look,
        }
    }
}

/// The correction of a source's gaze.
#[derive(Clone, Copy, Debug)]
struct Correction {
    source: ActiveGazeSource,
    calibration: Option<GazePolynomial>,
    /// Added to the calibrated gaze, degrees to the left and upwards.
    offset_deg: [f32; 2],
}

impl Correction {
    /// The stored correction of a source.
    ///
    /// # Errors
    /// The fault of the calibration.
    fn stored(stored: &GazeCorrection, source: ActiveGazeSource) -> Result<Self, &'static str> {
        let polynomial = |stored: &GazeCalibration| {
            GazePolynomial::new(stored.coefficients_deg, stored.area_deg).ok_or(
                "calibration: coefficients_deg: expected corrections of at most 10 degrees within area_deg, without a fold",
            )
        };
        let calibration = stored.calibration.as_ref().map(polynomial).transpose()?;
        Ok(Self { source, calibration, offset_deg: stored.offset_deg })
    }

    /// Without an offset.
    fn calibrated(&self, left_up_deg: [f32; 2]) -> [f32; 2] {
        self.calibration.map_or(left_up_deg, |calibration| calibration.corrected(left_up_deg))
    }

    fn corrected(&self, left_up_deg: [f32; 2]) -> [f32; 2] {
        let [left, up] = self.calibrated(left_up_deg);
        [left + self.offset_deg[0], up + self.offset_deg[1]]
    }
}

/// The corrections of a headset: at most one of each source.
#[derive(Clone, Copy, Debug, Default)]
struct Corrections([Option<Correction>; EYE_TRACKERS.len()]);

/// Sources of a gaze that can be corrected.
const EYE_TRACKERS: [ActiveGazeSource; 2] = [ActiveGazeSource::Eyes, ActiveGazeSource::Osc];

impl Corrections {
    /// The stored corrections of all eye trackers.
    ///
    /// # Errors
    /// The fault of a calibration.
    fn stored(stored: &GazeCorrection) -> Result<Self, &'static str> {
        let mut corrections = Self::default();
        for (correction, source) in corrections.0.iter_mut().zip(EYE_TRACKERS) {
            let of_source = stored.of_all_sources().find(|one| one.source == source.name());
            *correction = of_source.map(|one| Correction::stored(one, source)).transpose()?;
        }
        Ok(corrections)
    }

    fn of(&self, source: ActiveGazeSource) -> Option<Correction> {
        self.0.into_iter().flatten().find(|correction| correction.source == source)
    }
}

/// A measurement that is under way, of the first source with a gaze.
#[derive(Debug)]
struct Measurement {
    source: Option<ActiveGazeSource>,
    dots: Shown,
}

/// The dots of a measurement.
#[derive(Debug)]
enum Shown {
    One(Recentring),
    Nine(Calibration),
}

impl Measurement {
    fn new(kind: GazeMeasurement) -> Self {
        let dots = match kind {
            GazeMeasurement::Recentre => Shown::One(Recentring::default()),
            GazeMeasurement::Calibrate => Shown::Nine(Calibration::default()),
        };
        Self { source: None, dots }
    }

    /// Takes the gaze of a source, for a frame that is shown at `time_ns`. An offset is measured after the calibration that holds, and a
    /// calibration without any correction.
    fn push(&mut self, source: ActiveGazeSource, look: Look, correction: Option<&Correction>, time_ns: i64) {
        let sample = match look {
            Look::At { direction, sampled_ns, .. } if direction != Vec3::ZERO => {
                let at = if sampled_ns > 0 { sampled_ns } else { time_ns };
                let is_its = *self.source.get_or_insert(source) == source;
                is_its.then(|| (degrees(direction), at))
            }
            _ => None,
        };
        match &mut self.dots {
            Shown::One(recentring) => {
                let calibrated =
                    |(angles, at)| (correction.map_or(angles, |known| known.calibrated(angles)), at);
                recentring.push(sample.map(calibrated), time_ns);
            }
            Shown::Nine(calibration) => calibration.push(sample, time_ns),
        }
    }

    fn is_over(&self) -> bool {
        match &self.dots {
            Shown::One(recentring) => recentring.is_over(),
            Shown::Nine(calibration) => calibration.is_over(),
        }
    }

    /// The index of the dot that is shown.
    fn dot(&self) -> usize {
        match &self.dots {
            Shown::One(_) => 0,
            Shown::Nine(calibration) => calibration.dot().unwrap_or(0),
        }
    }
}

impl SessionGazeCorrection {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The corrected gaze of an eye tracker, for a frame that is shown at `time_ns`. Allocates nothing outside of measurements.
    pub fn corrected(&self, source: ActiveGazeSource, look: Look, time_ns: i64) -> Look {
        let mut guard = self.state();
        let state = &mut *guard;
        if let Some(measurement) = &mut state.measurement {
            measurement.push(source, look, state.corrections.of(source).as_ref(), time_ns);
        }
        state.corrected(source, look)
    }

    /// The same for the application: no measurement takes the sample.
    pub fn corrected_for_application(&self, source: ActiveGazeSource, look: Look) -> Look {
        self.state().corrected(source, look)
    }

    /// Takes the phase of the gaze by a corrected `look`, for a frame that is shown at `time_ns`. Looks at dots are not drift.
    pub fn note_phase(&self, source: ActiveGazeSource, look: Look, phase: GazePhase, time_ns: i64) {
        let mut state = self.state();
        if state.drifting != source {
            (state.drifting, state.drift) = (source, GazeDrift::default());
        }
        let fixated = match look {
            Look::At { direction, .. } if phase == GazePhase::Fixation && state.measurement.is_none() => {
                Some(degrees(direction))
            }
            _ => None,
        };
        state.drift.push(fixated, time_ns);
    }

    /// The drift of the mean gaze, degrees; `None`: not known, or none.
    pub fn drift_deg(&self) -> Option<f32> {
        self.state().drift.drift_deg()
    }

    /// The place of the dot of debug view "ahead": degrees to the left and upwards of the centre of the view, unless a calibration
    /// shows another one.
    pub fn dot_deg(&self) -> [f32; 2] {
        self.state().measurement.as_ref().map_or([0.0; 2], |measurement| DOTS_DEG[measurement.dot()])
    }

    fn correction(&self, source: Option<ActiveGazeSource>) -> Option<Correction> {
        self.state().corrections.of(source?)
    }

    fn set_corrections(&self, corrections: Corrections) {
        let mut state = self.state();
        (state.corrections, state.drift) = (corrections, GazeDrift::default());
    }

    /// Begins a measurement, or with `None` ends it without a result.
    fn set_measurement(&self, measurement: Option<Measurement>) {
        let before = std::mem::replace(&mut self.state().measurement, measurement);
        drop(before);
    }

    /// The measurement, once it is over.
    fn take_measured(&self) -> Option<Measurement> {
        self.state().measurement.take_if(|measurement| measurement.is_over())
    }

    /// The number of the dot of the measurement, from 1; 0 without one.
    fn dot_number(&self) -> u32 {
        self.state().measurement.as_ref().map_or(0, |measurement| measurement.dot() as u32 + 1)
    }
}

/// Follows requests for a measurement, and the file of the correction.
#[derive(Debug)]
pub struct CorrectionRequests {
    correcting: Arc<SessionGazeCorrection>,
    asked: AskedMeasurement,
    headset: String,
    file: Option<PathBuf>,
    /// The fault of the file that was logged.
    fault: String,
    status: CorrectionStatus,
}

impl CorrectionRequests {
    /// Reads the correction of a headset, and looks for requests to the process `pid`.
    pub fn new(
        environment: &Environment,
        pid: u32,
        headset: String,
        correcting: Arc<SessionGazeCorrection>,
    ) -> Self {
        let file = GazeCorrection::file(environment, &headset);
        let status = CorrectionStatus {
            file: file.as_ref().map(|file| file.display().to_string()).unwrap_or_default(),
            ..CorrectionStatus::default()
        };
        let asked = AskedMeasurement::new(environment, pid);
        let mut requests = Self { correcting, asked, headset, file, fault: String::new(), status };
        requests.read();
        requests
    }

    /// Begins and ends measurements, and takes over a correction that was stored or removed meanwhile, by any process.
    pub fn poll(&mut self) -> CorrectionStatus {
        self.read();
        let asked = self.asked.look();
        match asked {
            Some((kind, number)) if number != self.status.number => {
                self.correcting.set_measurement(Some(Measurement::new(kind)));
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
        self.status.dot = self.correcting.dot_number();
        self.status.clone()
    }

    /// The correction of the file; without one there is none.
    fn read(&mut self) {
        let read = self.file.as_deref().map_or(Ok(None), read);
        let fault = read.as_ref().err().cloned().unwrap_or_default();
        if fault != self.fault {
            if !fault.is_empty() {
                tracing::warn!(
                    "correction of the eye tracker ignored: {fault}; to replace it: parafovea gaze calibrate, or recentre"
                );
            }
            self.fault = fault;
        }
        let (correction, known) = read.ok().flatten().unzip();
        if correction != self.status.correction {
            self.correcting.set_corrections(known.unwrap_or_default());
            self.status.correction = correction;
        }
    }

    /// Stores the result of a measurement, or returns why there is none.
    fn store(&mut self, measured: &Measurement) -> Result<(), String> {
        let source = measured.source.map_or("", ActiveGazeSource::name);
        let stored = self.status.correction.as_ref();
        let present = stored.and_then(|stored| stored.of_all_sources().find(|one| one.source == source));
        let correction = match &measured.dots {
            Shown::One(recentring) => {
                let GazeOffset { offset_deg, spread_deg } =
                    recentring.offset().map_err(|reason| reason.to_string())?;
                let offset = GazeCorrection::new(&self.headset, source, offset_deg, spread_deg);
                offset.with_calibration(present.and_then(|present| present.calibration.clone()))
            }
            Shown::Nine(calibration) => {
                let present = self.correcting.correction(measured.source);
                let before = |angles| present.map_or(angles, |present| present.corrected(angles));
                let fit = stored_fit(&calibration.fit(before).map_err(|reason| reason.to_string())?);
                let (_, spread_deg) = fit.accuracy_and_precision_deg();
                GazeCorrection::new(&self.headset, source, [0.0; 2], spread_deg).with_calibration(Some(fit))
            }
        };
        let correction = correction.in_place_of(stored);
        let file = self.file.as_ref().ok_or(match self.headset.is_empty() {
            true => "the runtime does not name the headset",
            false => "neither XDG_STATE_HOME nor HOME is set, so there is no folder for the correction",
        })?;
        correction.write(file).map_err(|error| format!("{}: {error}", file.display()))?;
        self.read();
        match &measured.dots {
            Shown::One(_) => {
                tracing::info!("the eye tracker was recentred, as parafovea gaze recentre requested");
            }
            Shown::Nine(_) => {
                tracing::info!("the eye tracker was calibrated, as parafovea gaze calibrate requested");
            }
        }
        Ok(())
    }
}

/// The corrections of a file, in the file's form and in that of frames.
fn read(file: &Path) -> Result<Option<(GazeCorrection, Corrections)>, String> {
    let Some(stored) = GazeCorrection::read(file)? else { return Ok(None) };
    let corrections = Corrections::stored(&stored).map_err(|fault| format!("{}: {fault}", file.display()))?;
    Ok(Some((stored, corrections)))
}

/// The file's form of a fit.
fn stored_fit(fit: &CalibrationFit) -> GazeCalibration {
    GazeCalibration {
        coefficients_deg: fit.polynomial.coefficients_deg(),
        area_deg: fit.polynomial.area_deg(),
        error_deg: fit.error_deg,
        error_before_deg: fit.error_before_deg,
        dots_deg: fit.dots.map(|dot| [dot.accuracy_deg, dot.precision_deg]),
    }
}

#[cfg(test)]
mod tests;
