//! Quality in just objectionable differences (JOD) by FovVideoVDP: the published program, at the true gaze.
//!
//! Mantiuk et al., "FovVideoVDP: A visible difference predictor for wide field-of-view video", ACM Transactions on Graphics
//! 40(4), 2021; pyfvvdp on PyPI. 10 means no difference; at a difference of one, 75 % of people prefer the better clip. Its
//! licence is CC BY-NC 4.0: **not for commercial use**. It is neither part of this repository nor needed elsewhere in it:
//! [`Fvvdp::of`] takes the Python environment of the user.

use crate::errors::clip::{Clip, Eye, Viewing};
use glam::Vec2;
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Version of pyfvvdp: figures of different versions cannot be compared.
pub const VERSION: &str = "1.2.2";

const SCRIPT: &str = include_str!("fvvdp.py");

/// Imports all that the script does, and prints the package's version.
const ASK: &str =
    "import numpy, torch, pyfvvdp; from importlib.metadata import version; print(version('pyfvvdp'))";

/// Reason why there is no JOD.
#[derive(Debug, thiserror::Error)]
pub enum FvvdpError {
    /// A missing file or program.
    #[error("{what}")]
    Io {
        /// The command.
        what: String,
        /// Cause of the failure.
        #[source]
        source: io::Error,
    },
    /// A program that ended with an error.
    #[error("{what}: {}", message.trim())]
    Failed {
        /// The command.
        what: String,
        /// End of the program's output.
        message: String,
    },
    /// A Python interpreter that cannot be used.
    #[error("{}: {reason}", python.display())]
    Python {
        /// The interpreter.
        python: PathBuf,
        /// Its deficiency.
        reason: String,
    },
    /// Clips that cannot be compared: no frames, not the same number or size, the eye absent, or a gaze that the picture's
    /// plane does not show.
    #[error("the clips have no frames of one size with eye {eye} looking ahead")]
    Clips {
        /// 0 left, 1 right.
        eye: usize,
    },
}

/// An environment with FovVideoVDP in it.
#[derive(Clone, Debug)]
pub struct Fvvdp {
    python: PathBuf,
}

/// A figure of FovVideoVDP.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Jod {
    /// 10 means no difference; lower is worse, without a limit.
    pub jod: f64,
    /// Version of the package.
    pub version: String,
    /// The same frame by frame.
    #[serde(flatten)]
    pub differences: Differences,
}

/// Visible differences of each frame, pooled over the picture: FovVideoVDP makes a JOD of their mean.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Differences {
    /// Difference of each frame, at least 0. It depends on earlier frames too, which FovVideoVDP filters over 250 ms.
    pub by_frame: Vec<f64>,
    /// The lost JOD of some frames are the mean of their differences to this power.
    pub exponent: f64,
}

impl Differences {
    /// JOD below 10 that FovVideoVDP assigns to these frames: its pooling over time, by the mean. None if there are no frames, or if one of
    /// them is missing.
    pub fn lost_jod(&self, frames: impl IntoIterator<Item = usize>) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0u32);
        for frame in frames {
            sum += self.by_frame.get(frame)?;
            count += 1;
        }
        (count > 0).then(|| (sum / f64::from(count)).powf(self.exponent))
    }
}

/// Input of `fvvdp.py`.
#[derive(Serialize)]
struct Job {
    reference: &'static str,
    test: &'static str,
    frames: usize,
    width: u32,
    height: u32,
    gaze_px: Vec<[f32; 2]>,
    fov_horizontal_deg: f32,
    white_cd_m2: f32,
    contrast: f32,
    refresh_hz: f32,
}

impl Fvvdp {
    /// The environment of an existing Python interpreter. Nothing is installed.
    ///
    /// # Errors
    /// [`FvvdpError::Python`]: it cannot be started, cannot import pyfvvdp or one of the packages that it needs, or has another version.
    pub fn of(python: &Path) -> Result<Self, FvvdpError> {
        let failed = |reason| FvvdpError::Python { python: python.to_owned(), reason };
        let output = Command::new(python).args(["-c", ASK]).output();
        let output = output.map_err(|error| failed(format!("cannot be started: {error}")))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no reason given");
            return Err(failed(format!("cannot import pyfvvdp: {last}")));
        }
        match String::from_utf8_lossy(&output.stdout).trim() {
            VERSION => Ok(Self { python: python.to_owned() }),
            other => Err(failed(format!("pyfvvdp {VERSION} is needed, and this is `{other}`"))),
        }
    }

    /// JOD of one eye (0 left, 1 right) of a clip, at the reference's gaze in each frame.
    ///
    /// FovVideoVDP takes the view axis to be at the picture's centre. Where the field of view is not symmetrical, the
    /// picture has its true size there, but is not where it is.
    ///
    /// # Errors
    /// [`FvvdpError`].
    pub fn jod(
        &self,
        reference: &Clip,
        test: &Clip,
        eye: usize,
        viewing: &Viewing,
    ) -> Result<Jod, FvvdpError> {
        let job = job(reference, test, eye, viewing).ok_or(FvvdpError::Clips { eye })?;
        let temporary = tempfile::tempdir().map_err(io_error("making a temporary folder"))?;
        let folder = temporary.path();
        for (name, clip) in [(job.reference, reference), (job.test, test)] {
            write_codes(&folder.join(name), clip, eye).map_err(io_error("writing the clips"))?;
        }
        let text = serde_json::to_string(&job).map_err(|error| FvvdpError::Failed {
            what: "describing the clips".into(),
            message: error.to_string(),
        })?;
        let (script, job) = (folder.join("fvvdp.py"), folder.join("job.json"));
        std::fs::write(&script, SCRIPT).map_err(io_error("writing the script"))?;
        std::fs::write(&job, text).map_err(io_error("describing the clips"))?;
        let output = run(Command::new(&self.python).arg(&script).arg(&job), "running pyfvvdp")?;
        serde_json::from_str(output.trim()).map_err(|error| FvvdpError::Failed {
            what: "reading what pyfvvdp found".into(),
            message: format!("{error}: {output}"),
        })
    }
}

fn job(reference: &Clip, test: &Clip, eye: usize, viewing: &Viewing) -> Option<Job> {
    let eyes = |clip: &Clip| -> Option<Vec<Eye>> {
        clip.frames.iter().map(|frame| frame.eyes.get(eye)?.clone()).collect()
    };
    let (reference, test) = (eyes(reference)?, eyes(test)?);
    let first = reference.first()?;
    let extent @ [width, height] = first.picture.extent();
    let same = |eye: &Eye| eye.picture.extent() == extent && eye.fov == first.fov;
    if reference.len() != test.len() || !reference.iter().chain(&test).all(same) {
        return None;
    }
    let tangents = first.fov.tangents();
    let plane = tangents.plane(extent);
    let gaze = |eye: &Eye| {
        // FovVideoVDP counts from the centre of the first pixel.
        let pixel: Vec2 = (eye.gaze.truncate() / -eye.gaze.z - plane.origin) / plane.step - 0.5;
        (eye.gaze.z < 0.0 && pixel.is_finite()).then(|| pixel.to_array())
    };
    Some(Job {
        reference: "reference.rgb",
        test: "test.rgb",
        frames: reference.len(),
        width,
        height,
        gaze_px: reference.iter().map(gaze).collect::<Option<_>>()?,
        fov_horizontal_deg: 2.0 * ((tangents.right - tangents.left).abs() / 2.0).atan().to_degrees(),
        white_cd_m2: viewing.white_cd_m2,
        contrast: viewing.contrast,
        refresh_hz: viewing.refresh_hz,
    })
}

fn write_codes(path: &Path, clip: &Clip, eye: usize) -> io::Result<()> {
    let mut file = io::BufWriter::new(std::fs::File::create(path)?);
    for frame in &clip.frames {
        if let Some(eye) = frame.eyes.get(eye).and_then(Option::as_ref) {
            file.write_all(eye.picture.codes().as_flattened())?;
        }
    }
    file.flush()
}

/// Standard output of a program that succeeds.
fn run(command: &mut Command, what: &str) -> Result<String, FvvdpError> {
    let output = command.output().map_err(io_error(what))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let mut last: Vec<&str> = said.lines().rev().take(5).collect();
    last.reverse();
    Err(FvvdpError::Failed { what: what.into(), message: last.join("\n") })
}

fn io_error(what: &str) -> impl FnOnce(io::Error) -> FvvdpError {
    let what = what.to_owned();
    |source| FvvdpError::Io { what, source }
}

#[cfg(test)]
mod tests;
