//! Outcome of a run.

use super::child::Exit;
use super::validation::Findings;
use super::{COSTS_FILE, COUNT_FILE, FAULT_FILE, LIVE_FILE, SAMPLES_FILE, SHADING_RATE_FILE, TIMES_FILE};
use crate::HarnessError;
use crate::installation::Installation;
use crate::picture::Picture;
use crate::record::Record;
use crate::scenario::Scenario;
use parafovea_test_layers::{
    CostsReport, Count, Counted, FaultReport, GpuTime, GpuTimes, LiveObjects, SampleCount, ShadingRateLine,
};
use serde::de::DeserializeOwned;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};

/// An application's end, and everything that it left. Its folder goes with it, unless a test fails.
pub struct Outcome {
    /// The application's name.
    pub application: String,
    /// Its exit code; none when it was killed, by a signal or because its time was over.
    pub exit_code: Option<i32>,
    /// The signal that killed it, other than the one sent when its time was over.
    pub signal: Option<i32>,
    /// Whether it was killed because its time was over.
    pub timed_out: bool,
    /// Its output.
    pub output: String,
    /// The runtime's record.
    pub record: Record,
    /// Findings of validation.
    pub findings: Findings,
    /// The layer's log, of all executables.
    pub log: String,
    folder: Folder,
    pictures: PathBuf,
}

impl Outcome {
    pub(super) fn collect(
        application: String,
        folder: Folder,
        installation: &Installation,
        scenario: &Scenario,
        exit: Exit,
    ) -> Result<Self, HarnessError> {
        let pictures = folder.path().join(&scenario.output.dir);
        Ok(Self {
            application,
            exit_code: exit.status.and_then(|status| status.code()),
            signal: exit.status.and_then(|status| status.signal()),
            timed_out: exit.status.is_none(),
            record: Record::load(&pictures.join("record.jsonl"))?,
            findings: Findings::read(folder.path(), &exit.output),
            output: exit.output,
            log: read_logs(&installation.log_folder()),
            folder,
            pictures,
        })
    }

    /// The sub-image that the application submitted for a view of its first composition layer, as stored.
    ///
    /// # Errors
    /// [`HarnessError::File`] where that frame was not saved.
    pub fn submitted(&self, view: usize, frame: u64) -> Result<Picture, HarnessError> {
        Picture::load(&submitted_path(&self.pictures, view, frame))
    }

    /// An eye's image in a frame, after the runtime's compositor.
    ///
    /// # Errors
    /// [`HarnessError::File`] where that frame was not saved.
    pub fn eye(&self, eye: usize, frame: u64) -> Result<Picture, HarnessError> {
        Picture::load(&self.pictures.join(format!("eye{eye}_{frame}.png")))
    }

    /// Fragment shader invocations that the counting layer saw, on all devices.
    ///
    /// # Errors
    /// [`HarnessError::File`] if it is missing, [`HarnessError::Application`] if it could not count.
    pub fn fragments(&self) -> Result<u64, HarnessError> {
        self.fragments_after(0)
    }

    /// As [`Self::fragments`], of submits after the first `run_up` frames.
    ///
    /// # Errors
    /// As for [`Self::fragments`].
    pub fn fragments_after(&self, run_up: u64) -> Result<u64, HarnessError> {
        let number = |count: Count| match (count.fragment_invocations, count.reason) {
            (Some(_), _) => Ok(self.counted_after(run_up, &count.by_submit)),
            (None, reason) => Err(self.failed(&reason.unwrap_or_default())),
        };
        self.reports(COUNT_FILE)?.into_iter().map(number).sum()
    }

    /// Samples that passed depth and stencil tests in the render passes that the application began, on all devices: the shaded samples if
    /// the driver tests early, which [`Self::fragments`] does not count on every driver.
    ///
    /// # Errors
    /// As for [`Self::fragments`].
    pub fn samples(&self) -> Result<u64, HarnessError> {
        self.samples_after(0)
    }

    /// As [`Self::samples`], of submits after the first `run_up` frames.
    ///
    /// # Errors
    /// As for [`Self::fragments`].
    pub fn samples_after(&self, run_up: u64) -> Result<u64, HarnessError> {
        let number = |count: SampleCount| match (count.samples, count.reason) {
            (Some(_), _) => Ok(self.counted_after(run_up, &count.by_submit)),
            (None, reason) => Err(self.failed(&reason.unwrap_or_default())),
        };
        self.reports(SAMPLES_FILE)?.into_iter().map(number).sum()
    }

    fn counted_after(&self, run_up: u64, by_submit: &[Counted]) -> u64 {
        let from_ns = self.record.process_cpu_ns_after(run_up);
        by_submit
            .iter()
            .filter(|counted| counted.process_cpu_ns >= from_ns)
            .map(|counted| counted.value)
            .sum()
    }

    /// Time on the GPU that the application's and the layer's command buffers took in each frame, on all devices, in
    /// milliseconds; of the frames that [`Record::cpu_ms_of_frames`] has.
    ///
    /// # Errors
    /// As for [`Self::fragments`]; also where no command buffer was timed.
    pub fn gpu_ms_of_frames(&self, run_up: u64) -> Result<Vec<f64>, HarnessError> {
        let mut times: Vec<GpuTime> = Vec::new();
        for device in self.reports::<GpuTimes>(TIMES_FILE)? {
            if let Some(reason) = device.reason {
                return Err(self.failed(&format!("its command buffers were not timed: {reason}")));
            }
            times.extend(device.buffers);
        }
        if times.is_empty() {
            return Err(self.failed("none of its command buffers was timed: no timestamps on its queues"));
        }
        Ok(self.record.gpu_ms_of_frames(run_up, &times))
    }

    /// Calls of each device that [`Run::faulted`](super::Run::faulted) counted.
    ///
    /// # Errors
    /// [`HarnessError::File`] if it is missing.
    pub fn faults(&self) -> Result<Vec<FaultReport>, HarnessError> {
        self.reports(FAULT_FILE)
    }

    /// The frames of [`Run::planted`](super::Run::planted).
    ///
    /// # Errors
    /// [`HarnessError::File`] if it is missing, [`HarnessError::Application`] if not exactly one device drew a frame.
    pub fn costs(&self) -> Result<CostsReport, HarnessError> {
        let mut drawing = self.reports::<CostsReport>(COSTS_FILE)?;
        drawing.retain(|device| device.frames > 0);
        match <[CostsReport; 1]>::try_from(drawing) {
            Ok([device]) => Ok(device),
            Err(devices) => Err(self.failed(&format!("{} devices drew frames", devices.len()))),
        }
    }

    /// Counts of [`Run::live_counted`](super::Run::live_counted), one for each vkDeviceWaitIdle of the application, on all devices.
    ///
    /// # Errors
    /// [`HarnessError::File`] if it is missing.
    pub fn live_objects(&self) -> Result<Vec<LiveObjects>, HarnessError> {
        self.reports(LIVE_FILE)
    }

    /// A layer's reports of each device, a line each.
    fn reports<T: DeserializeOwned>(&self, file: &str) -> Result<Vec<T>, HarnessError> {
        let path = self.folder.path().join(file);
        let text = std::fs::read_to_string(&path).map_err(HarnessError::file(&path))?;
        let report = |line| serde_json::from_str(line).map_err(|error| HarnessError::format(&path, error));
        text.lines().map(report).collect()
    }

    /// Findings and passes of [`Run::shading_rates`](super::Run::shading_rates), in its order; empty without it.
    ///
    /// # Errors
    /// [`HarnessError::Format`] where a line is not one of that layer's.
    pub fn shading_rates(&self) -> Result<Vec<ShadingRateLine>, HarnessError> {
        let path = self.folder.path().join(SHADING_RATE_FILE);
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let line = |line| serde_json::from_str(line).map_err(|error| HarnessError::format(&path, error));
        text.lines().map(line).collect()
    }

    /// As [`complaints`], of its log.
    pub fn complaints(&self) -> Vec<&str> {
        complaints(&self.log)
    }

    /// Fails unless the application ended by itself with code 0.
    ///
    /// # Errors
    /// [`HarnessError::Application`], as [`Self::failed`] makes it.
    pub fn expect_end(self) -> Result<Self, HarnessError> {
        let frames = self.record.frames.len() as u64;
        self.expect_frames(frames)
    }

    /// Fails unless the application ended by itself with code 0 after so many frames.
    ///
    /// # Errors
    /// [`HarnessError::Application`], as [`Self::failed`] makes it.
    pub fn expect_frames(self, frames: u64) -> Result<Self, HarnessError> {
        let done = self.record.frames.len() as u64;
        if self.exit_code == Some(0) && done == frames {
            return Ok(self);
        }
        let end = match (self.timed_out, self.exit_code) {
            (true, _) => "its time was over".to_owned(),
            (false, Some(code)) => format!("exit code {code}"),
            (false, None) => format!("killed by signal {}", self.signal.unwrap_or_default()),
        };
        Err(self.failed(&format!("{done} of {frames} frames, {end}")))
    }

    /// The application did not meet the expectation: an error with the end of its output and of the layer's log.
    pub fn failed(&self, reason: &str) -> HarnessError {
        HarnessError::Application {
            application: self.application.clone(),
            reason: reason.to_owned(),
            output: format!("{}{}", last_lines(&self.output, 30), last_lines(&self.log, 10)),
        }
    }
}

/// Signs of warnings, errors and caught mistakes in the layer's log.
const SIGNS: [&str; 3] = [" WARN ", " ERROR ", "internal error"];

/// The warning of a device that is behind: a software device that compiles on a busy machine takes seconds, which is no mistake.
const LATE: &str = "the headset shows earlier images until the device catches up";

/// Warnings and errors in the layer's log, apart from the one of a device that is behind.
pub fn complaints(log: &str) -> Vec<&str> {
    let is_complaint = |line: &&str| SIGNS.iter().any(|sign| line.contains(sign)) && !line.contains(LATE);
    log.lines().filter(is_complaint).collect()
}

/// Path of the runtime's file of that sub-image of the first composition layer.
pub(super) fn submitted_path(folder: &Path, view: usize, frame: u64) -> PathBuf {
    folder.join(format!("submitted_0_{view}_{frame}.png"))
}

fn last_lines(text: &str, count: usize) -> String {
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(count)..].iter().map(|line| format!("  {line}\n")).collect()
}

/// All logs in a folder, one after the other; nothing where there is none.
pub(super) fn read_logs(folder: &Path) -> String {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    files.filter_map(|file| std::fs::read_to_string(file.path()).ok()).collect()
}

/// A run's folder: removed at its end, kept for a look when the test that it belongs to fails.
pub(super) struct Folder(Option<tempfile::TempDir>, PathBuf);

impl Folder {
    pub(super) fn new(parent: &Path) -> Result<Self, HarnessError> {
        std::fs::create_dir_all(parent).map_err(HarnessError::file(parent))?;
        let folder =
            tempfile::Builder::new().prefix("run-").tempdir_in(parent).map_err(HarnessError::file(parent))?;
        let path = folder.path().to_owned();
        Ok(Self(Some(folder), path))
    }

    pub(super) fn path(&self) -> &Path {
        &self.1
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if std::thread::panicking()
            && let Some(folder) = self.0.take()
        {
            eprintln!("kept: {}", folder.keep().display());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_is_behind_is_no_complaint() {
        let late = format!("12:00:00.000  WARN a submit did not end in time: {LATE}");
        let mistakes = [
            "12:00:00.000  WARN no rates",
            "12:00:00.000 ERROR no device",
            "12:00:00.000  INFO internal error",
        ];
        let log = [&["12:00:00.000  INFO session active", &late][..], &mistakes].concat().join("\n");
        assert_eq!(complaints(&log), mistakes);
    }
}
