//! The mock runtime's record of a run, as far as the harness needs it.

use crate::HarnessError;
use parafovea_mock_runtime::record::INJECTED;
use parafovea_test_layers::GpuTime;
use serde::Deserialize;
use std::path::Path;

/// The record of one run.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The frames that were ended, in order.
    pub frames: Vec<Frame>,
    /// Violations of the specification by the application, or by the layer on its behalf, as the runtime sees them.
    pub errors: Vec<RuntimeError>,
    /// Allowed, but odd calls: the function, and the oddity, such as unknown structures, in order.
    pub warnings: Vec<(String, String)>,
    /// The swapchains as the runtime was asked for them.
    pub swapchains: Vec<serde_json::Value>,
    /// Attached and synchronised action sets, in order, if the scenario records them: lines of the kinds `actions_attached` and
    /// `actions_synced`.
    pub input: Vec<serde_json::Value>,
    /// Calls that a fault of the scenario happened to.
    pub injected: u64,
}

/// One `xrEndFrame`.
#[derive(Clone, Debug, Deserialize)]
pub struct Frame {
    /// From 0.
    pub index: u64,
    /// Display time, in nanoseconds of the runtime's clock.
    pub display_time_ns: i64,
    /// CPU time of the whole process until then, in nanoseconds.
    pub process_cpu_ns: u64,
    /// CPU time of the thread that called `xrEndFrame`, in nanoseconds.
    #[serde(default)]
    pub thread_cpu_ns: u64,
    /// The part of it that was spent while frames waited for their turn, and others had theirs.
    #[serde(default)]
    pub held_cpu_ns: u64,
    /// Most memory that the process has had resident until then, KiB.
    #[serde(default)]
    pub peak_memory_kib: u64,
    /// The gaze then, as scripted: a unit vector in the head's space; none while it was not tracked.
    #[serde(default)]
    pub gaze: Option<[f32; 3]>,
    /// The head then, in the LOCAL space.
    #[serde(default)]
    pub head: HeadPose,
    /// Number of times since the previous frame that the gaze was located and available.
    #[serde(default)]
    pub gaze_reads: u32,
    /// The composition layers that were submitted.
    #[serde(default)]
    pub layers: Vec<serde_json::Value>,
}

/// Orientation of the head.
#[derive(Clone, Copy, PartialEq, Debug, Default, Deserialize)]
pub struct HeadPose {
    /// A unit quaternion: x, y, z, w.
    pub orientation: [f32; 4],
}

/// A call that the runtime answered with an error of the specification.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
pub struct RuntimeError {
    /// The function.
    pub call: String,
    /// Its result.
    pub result: String,
    /// The violation.
    pub message: String,
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Line {
    Frame(Frame),
    Error(RuntimeError),
    SwapchainCreated(serde_json::Value),
    Warning {
        call: String,
        message: String,
    },
    #[serde(other)]
    Other,
}

impl Record {
    /// Reads a record; one that was never begun is empty.
    ///
    /// # Errors
    /// [`HarnessError::File`], or [`HarnessError::Format`] with the line's number.
    pub fn load(path: &Path) -> Result<Self, HarnessError> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(HarnessError::file(path)(error)),
        };
        let mut record = Self::default();
        for (number, line) in (1..).zip(text.lines()) {
            let failed = |error| HarnessError::format(path, format!("line {number}: {error}"));
            if ["actions_attached", "actions_synced"].iter().any(|kind| line.contains(kind)) {
                record.input.push(serde_json::from_str(line).map_err(failed)?);
            }
            match serde_json::from_str(line).map_err(failed)? {
                Line::Frame(frame) => record.frames.push(frame),
                Line::Error(error) => record.errors.push(error),
                Line::SwapchainCreated(swapchain) => record.swapchains.push(swapchain),
                Line::Warning { message, .. } if message == INJECTED => record.injected += 1,
                Line::Warning { call, message } => record.warnings.push((call, message)),
                Line::Other => {}
            }
        }
        Ok(record)
    }

    /// Requests at the creation of swapchains, in order, without handles, which differ in every run.
    pub fn created(&self) -> Vec<serde_json::Value> {
        let mut swapchains = self.swapchains.clone();
        for swapchain in swapchains.iter_mut().filter_map(serde_json::Value::as_object_mut) {
            swapchain.retain(|name, _| name != "session" && name != "swapchain");
        }
        swapchains
    }

    /// CPU time of the process from one `xrEndFrame` to the next, without the time during its wait for its turn, in milliseconds, without
    /// the first `run_up` frames.
    pub fn cpu_ms_of_frames(&self, run_up: u64) -> Vec<f64> {
        let own_ns = |frame: &Frame| frame.process_cpu_ns.saturating_sub(frame.held_cpu_ns);
        let spent = |pair: &[Frame]| own_ns(&pair[1]).saturating_sub(own_ns(&pair[0])) as f64 / 1e6;
        self.after(run_up).windows(2).map(spent).collect()
    }

    /// CPU time that the thread of `xrEndFrame` spent from one call to the next, in milliseconds, without the first `run_up`
    /// frames. Meaningless where the application calls it from several threads.
    pub fn thread_cpu_ms_of_frames(&self, run_up: u64) -> Vec<f64> {
        let spent = |pair: &[Frame]| pair[1].thread_cpu_ns.saturating_sub(pair[0].thread_cpu_ns) as f64 / 1e6;
        self.after(run_up).windows(2).map(spent).collect()
    }

    /// GPU time of command buffers that were submitted from one `xrEndFrame` to the next, in milliseconds, in the same frames as
    /// [`Self::cpu_ms_of_frames`].
    pub fn gpu_ms_of_frames(&self, run_up: u64, times: &[GpuTime]) -> Vec<f64> {
        let taken = |pair: &[Frame]| {
            let frame = pair[0].process_cpu_ns..pair[1].process_cpu_ns;
            let of_frame = times.iter().filter(|time| frame.contains(&time.process_cpu_ns));
            of_frame.map(|time| time.gpu_ns).sum::<u64>() as f64 / 1e6
        };
        self.after(run_up).windows(2).map(taken).collect()
    }

    /// CPU time that the process had spent when the first `run_up` frames had ended, nanoseconds; 0 without them.
    pub fn process_cpu_ns_after(&self, run_up: u64) -> u64 {
        let last = run_up.checked_sub(1).and_then(|last| self.frames.get(last as usize));
        last.map_or(0, |frame| frame.process_cpu_ns)
    }

    /// The last frame of the run-up, where there is one, and those after it.
    fn after(&self, run_up: u64) -> &[Frame] {
        self.frames.get((run_up as usize).saturating_sub(1)..).unwrap_or_default()
    }
}

/// The median of `values`; of an even number the mean of the middle two. None without any.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_errors_and_unknown_lines_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.jsonl");
        let lines = [
            r#"{"kind":"frame","index":0,"display_time_ns":1,"process_cpu_ns":1000000,"layers":[]}"#,
            r#"{"kind":"frame","index":1,"display_time_ns":2,"process_cpu_ns":3500000,"held_cpu_ns":500000}"#,
            r#"{"kind":"error","call":"xrEndFrame","result":"XR_ERROR_TIME_INVALID","message":"zero"}"#,
            r#"{"kind":"something","else":1}"#,
        ];
        std::fs::write(&path, lines.join("\n")).unwrap();
        let record = Record::load(&path).unwrap();
        assert_eq!((record.frames.len(), record.errors.len()), (2, 1));
        assert_eq!([0, 1, 2].map(|run_up| record.cpu_ms_of_frames(run_up).len()), [1, 1, 0]);
        assert_eq!(record.cpu_ms_of_frames(0), [2.0]);
        assert_eq!([0, 1, 2].map(|run_up| record.process_cpu_ns_after(run_up)), [0, 1_000_000, 3_500_000]);
        let time = |process_cpu_ns, gpu_ns| GpuTime { process_cpu_ns, gpu_ns };
        let times =
            [time(999_999, 7), time(1_000_000, 500_000), time(2_000_000, 250_000), time(3_500_000, 7)];
        assert_eq!(record.gpu_ms_of_frames(0, &times), [0.75]);
    }

    #[test]
    fn a_broken_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.jsonl");
        std::fs::write(&path, "{\"kind\":\"other\"}\n{\n").unwrap();
        assert!(Record::load(&path).unwrap_err().to_string().contains("line 2"));
        assert!(Record::load(&folder.path().join("none")).unwrap().frames.is_empty());
    }

    #[test]
    fn median_of_both_parities() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(vec![]), None);
    }
}
