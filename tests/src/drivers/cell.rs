//! One run of a program: the layers around ours, the configuration, and the outcome.

use super::program::{FRAMES, Program};
use crate::HarnessError;
use crate::run::{LayerMode, Outcome, Run};
use parafovea_zoo::SKIPPED;
use serde::Deserialize;
use std::path::Path;

/// The other layers around ours.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stack {
    /// None: the next layer is the loader's own end of the chain.
    Alone,
    /// Khronos' validation below, with synchronization validation; OpenXR's core validation below the OpenXR half.
    Validated,
    /// A layer that does nothing on either side.
    Between,
}

impl Stack {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Alone, Self::Validated, Self::Between];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Alone => "alone",
            Self::Validated => "validated",
            Self::Between => "between",
        }
    }
}

/// The layer's configuration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    /// Without the layer.
    Off,
    /// Enabled by the environment, disabled by the configuration.
    Inert,
    /// Rings of rates around the centre of the picture.
    Rates,
    /// The same by masks, on devices with rates too.
    Mask,
    /// Rates by contrast, re-use and chroma.
    Everything,
}

impl Mode {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Off, Self::Inert, Self::Rates, Self::Mask, Self::Everything];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Inert => "inert",
            Self::Rates => "rates",
            Self::Mask => "mask",
            Self::Everything => "everything",
        }
    }

    /// The layer with that configuration.
    pub(super) fn layer(self) -> LayerMode {
        let config = match self {
            Self::Off => return LayerMode::Absent,
            Self::Inert => "enabled = false\n",
            // Rings: without rendering there is no contrast to measure.
            Self::Rates => "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n",
            Self::Mask => {
                "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\nbackend = \"mask\"\n"
            }
            Self::Everything => {
                "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
                 [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n"
            }
        };
        LayerMode::On(config.to_owned())
    }
}

/// One run of a program on a device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cell {
    /// The layers around ours.
    pub stack: Stack,
    /// Our configuration.
    pub mode: Mode,
}

/// Exit of a program.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum End {
    /// By itself, with code 0, after all its frames.
    Whole,
    /// By itself, with code 0, because the device lacks something: the reason.
    Skipped(String),
    /// With another exit code.
    Code(i32),
    /// With code 0 after fewer frames.
    Frames(u64),
    /// Killed by a signal of this number.
    Signal(i32),
    /// Killed at its limit.
    Hung,
}

impl End {
    fn of(program: Program, outcome: &Outcome) -> Self {
        let skipped = outcome.output.lines().find_map(|line| line.strip_prefix(SKIPPED));
        let frames = outcome.record.frames.len() as u64;
        match (outcome.timed_out, outcome.exit_code, skipped) {
            (true, ..) => Self::Hung,
            (false, None, _) => Self::Signal(outcome.signal.unwrap_or_default()),
            (false, Some(0), Some(reason)) => Self::Skipped(reason.to_owned()),
            (false, Some(0), None) if program.has_frames() && frames != FRAMES => Self::Frames(frames),
            (false, Some(0), None) => Self::Whole,
            (false, Some(code), _) => Self::Code(code),
        }
    }
}

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole => f.write_str("ended"),
            Self::Skipped(reason) => write!(f, "skipped: {reason}"),
            Self::Code(code) => write!(f, "exit code {code}"),
            Self::Frames(frames) => write!(f, "{frames} of {FRAMES} frames"),
            Self::Signal(signal) => write!(f, "signal {signal}"),
            Self::Hung => f.write_str("hung"),
        }
    }
}

/// Passes of an eye buffer in all frames, and the ones among them that the layer made coarser, or would have.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Engaged {
    /// Passes with a map of rates coarser than 1x1.
    pub coarse: usize,
    /// Passes that draw an eye buffer.
    pub eyes: usize,
    /// Whether the device has rate attachments, and they are armed.
    pub has_attachments: bool,
}

/// Outcome of a run.
pub struct Seen {
    /// Exit of the program.
    pub end: End,
    /// The layer's effect.
    pub engaged: Engaged,
    /// The whole outcome.
    pub outcome: Outcome,
}

/// The parts of a line of the layer's passes file that the matrix needs.
#[derive(Deserialize)]
struct Noted {
    eyes: String,
    unmasked: Option<String>,
    map: Option<NotedMap>,
}

#[derive(Deserialize)]
struct NotedMap {
    rates: String,
}

/// The variable that names that file.
const PASSES_VARIABLE: &str = "PARAFOVEA_PASSES_FILE";

impl Cell {
    /// Runs `program` so. `set_up` chooses the device. None where the validation layer is too old to know the program's calls.
    ///
    /// # Errors
    /// Errors of the harness, and a missing validation layer.
    pub fn run(self, program: Program, set_up: impl Fn(Run) -> Run) -> Result<Option<Seen>, HarnessError> {
        let folder = tempfile::tempdir().map_err(HarnessError::file(&std::env::temp_dir()))?;
        let passes = folder.path().join("passes.jsonl");
        let run = set_up(program.run()?).layer(self.mode.layer()).env(PASSES_VARIABLE, &passes);
        let run = match self.stack {
            Stack::Alone => run,
            Stack::Validated => {
                let run = run.validated_from(program.headers());
                if !run.is_validated() {
                    return Ok(None);
                }
                run
            }
            Stack::Between => run.between_layers(),
        };
        let outcome = run.finish()?;
        if self.stack == Stack::Validated && program.has_frames() && !outcome.findings.vulkan_was_active {
            return Err(outcome.failed("the validation layer was not there"));
        }
        let has_attachments = outcome.log.contains("rate attachments: RateCapabilities");
        let engaged = Engaged { has_attachments, ..engaged(&passes)? };
        Ok(Some(Seen { end: End::of(program, &outcome), engaged, outcome }))
    }
}

/// The summary of a passes file; none without the file, as without the layer.
fn engaged(passes: &Path) -> Result<Engaged, HarnessError> {
    let text = std::fs::read_to_string(passes).unwrap_or_default();
    let mut engaged = Engaged::default();
    for line in text.lines() {
        let noted: Noted = serde_json::from_str(line).map_err(|error| HarnessError::format(passes, error))?;
        if noted.eyes == "none" {
            continue;
        }
        engaged.eyes += 1;
        let is_coarse = noted.map.is_some_and(|map| map.rates.bytes().any(|digit| digit != b'0'));
        engaged.coarse += usize::from(is_coarse && noted.unmasked.is_none());
    }
    Ok(engaged)
}
