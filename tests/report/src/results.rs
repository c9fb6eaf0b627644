//! Results of measurements, as stored: a page is made from them, at once or later, here or at their commit.

use crate::hardware::Look;
use crate::points::Sweep;
use crate::statistics::{CostAndLoss, RatePoint};
use parafovea_models::errors::RINGS;
use parafovea_models::errors::fvvdp::Differences;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Everything of one report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Machine and programs.
    pub conditions: Conditions,
    /// Scene by scene.
    pub scenes: Vec<SceneResults>,
    /// The same scenes by the look of hardware rates ([`crate::hardware`]): everybody's map over the same pictures. A cost is the share of the pixels that
    /// are shaded, in place of milliseconds.
    #[serde(default)]
    pub hardware: Vec<SceneResults>,
    /// Errors of one scene at 20 pixels a degree, where that was asked for.
    pub fine: Option<Fine>,
    /// Answers of the models to hard input.
    pub hard_cases: Vec<HardCase>,
}

/// Machine and programs of the measurements.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Conditions {
    /// The Vulkan device and its driver.
    pub device: String,
    /// Whether that is a CPU: its time is process CPU time.
    pub device_is_cpu: bool,
    /// Backend that makes passes shade more coarsely there: `mask` or `rate attachment`.
    pub backend: String,
    /// The processor.
    pub processor: String,
    /// Its threads that this may use.
    pub threads: usize,
    /// The commit, and whether there were changes.
    pub commit: String,
    /// The day, as year, month and day.
    pub date: String,
    /// The command line.
    pub command: String,
    /// Parameters of the timed runs: turns, run-up, frames and pixels of a side.
    pub timed: [u64; 4],
    /// Parameters of the judged runs: run-up, frames and pixels of a side.
    pub judged: [u64; 3],
    /// Look of the compared maps.
    #[serde(default)]
    pub look: Look,
    /// Version of FovVideoVDP that judged by JOD; `None`: that was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fvvdp: Option<String>,
}

/// Results of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneResults {
    /// The scene.
    pub scene: String,
    /// Point by point, the application alone first.
    pub points: Vec<PointResults>,
    /// Saving of chroma attenuation in encoded images.
    pub bits: Vec<Bits>,
    /// Judged frames of each gaze script, one after the other; 0: all are of one.
    #[serde(default)]
    pub frames_of_script: usize,
}

/// Results of one technique in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointResults {
    /// Its sweep.
    pub sweep: Sweep,
    /// Its name.
    pub technique: String,
    /// Fragment shader invocations of a frame in the judged runs, as the device counts them; lavapipe 22.3.6 counts those too that an early depth test
    /// rejects.
    pub fragments: u64,
    /// Samples of a frame there that passed the depth test in the application's passes, where that could be counted.
    pub samples: Option<u64>,
    /// Its cost; `None` if it was not measured.
    pub cost: Option<Cost>,
    /// Its errors; None for the application alone, the reference of the others.
    pub errors: Option<Errors>,
}

/// Cost of a technique: time of the device, which on a CPU is process CPU time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Median of a frame, milliseconds.
    pub median_ms: f64,
    /// The 99th percentile of a frame, milliseconds.
    pub p99_ms: f64,
    /// The cost over that of the application alone.
    pub ratio: f64,
    /// Half of the interquartile range of the turns' ratios.
    pub spread: f64,
    /// Time of each frame in the mean of the turns, milliseconds.
    pub frames_ms: Vec<f64>,
}

/// Errors of a technique, around the true gaze.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Contrast loss of each frame: the change of luminance contrast that stays and that which comes and goes, in just noticeable
    /// differences, added as castleCSF adds the sensitivities to both; mean over the view of both eyes.
    pub loss: Vec<f64>,
    /// Detected change of both: changes add up over the view by probability summation, by powers of 3.5, and not by their mean, JND.
    pub detected: Vec<f64>,
    /// Whether the eyes are in a saccade, for each of these frames; empty if that is unknown. Vision is suppressed then (Volkmann 1986), so
    /// neither [`PointResults::loss`] nor a verdict includes these frames.
    #[serde(default)]
    pub in_flight: Vec<bool>,
    /// Its part that stays, by ring.
    pub sustained: [Option<f64>; RINGS],
    /// Its part that comes and goes, by ring.
    pub transient: [Option<f64>; RINGS],
    /// RMS contrast at 8 to 30 Hz over the whole view; nothing for short clips.
    pub flicker: Option<f64>,
    /// Change of colour contrast, just noticeable differences: the greater of red-green and yellow-violet, over the whole view.
    pub chroma: Option<f64>,
    /// ꟻLIP, which knows nothing of gaze, over the whole view.
    pub flip: Option<f64>,
    /// Differences of each frame by foveated FovVideoVDP, for the left eye, of which JOD is made; nothing where that was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fvvdp: Option<Differences>,
}

/// Errors at 20 pixels a degree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fine {
    /// The scene.
    pub scene: String,
    /// Pixels per degree at the centre of the picture.
    pub pixels_per_degree: f32,
    /// Run-up, frames and pixels of a side.
    pub judged: [u64; 3],
    /// Technique by technique, without the application alone.
    pub points: Vec<(String, Errors)>,
}

/// Saving of chroma attenuation with one codec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bits {
    /// The technique whose pictures were encoded.
    pub technique: String,
    /// `JPEG 4:2:0`, for instance.
    pub codec: String,
    /// BD-rate of all bits at equal PSNR of luma: -0.1 for a tenth less.
    pub total: f64,
    /// The same of the bits of chroma alone.
    pub chroma: f64,
    /// All bits and luma's PSNR without and with it, setting by setting.
    pub curves: [Vec<RatePoint>; 2],
}

/// A hard case of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HardCase {
    /// Name of the model.
    pub model: String,
    /// The difficulty.
    pub case: String,
    /// Expected answer.
    pub expected: String,
    /// The answer.
    pub got: String,
    /// Difference from the reference in double precision, where there is one.
    pub error: Option<f64>,
    /// Whether it meets the expectation.
    pub passed: bool,
}

impl Results {
    /// Reads the output of [`Self::write`].
    ///
    /// # Errors
    /// A text that names the file.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// Keeps it in a file.
    ///
    /// # Errors
    /// A text that names the file.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        let text = serde_json::to_string(self).map_err(|error| error.to_string())?;
        std::fs::write(path, text + "\n").map_err(|error| format!("{}: {error}", path.display()))
    }

    /// The techniques, in the order of the first scene.
    pub fn techniques(&self) -> Vec<(Sweep, &str)> {
        let first = self.scenes.first().into_iter().flat_map(|scene| &scene.points);
        first.map(|point| (point.sweep, point.technique.as_str())).collect()
    }
}

impl SceneResults {
    /// The application alone.
    pub fn off(&self) -> Option<&PointResults> {
        self.points.iter().find(|point| point.sweep == Sweep::Off)
    }

    /// A point by its name.
    pub fn point(&self, technique: &str) -> Option<&PointResults> {
        self.points.iter().find(|point| point.technique == technique)
    }

    /// The timed points of a sweep, with the application alone, which ends every sweep.
    pub fn sweep(&self, sweep: Sweep) -> Vec<&PointResults> {
        let is_in = |point: &&PointResults| point.sweep == Sweep::Off || point.sweep == sweep;
        self.points.iter().filter(is_in).filter(|point| point.cost.is_some()).collect()
    }
}

impl PointResults {
    /// Mean contrast loss of the frames in which the eyes do not jump, JND; 0 for the application alone.
    pub fn loss(&self) -> f64 {
        self.errors.as_ref().map_or(0.0, |errors| errors.mean_of(&errors.loss, false).unwrap_or(f64::NAN))
    }

    /// Mean of the detected change in these frames, JND; 0 for the application alone.
    pub fn detected(&self) -> f64 {
        self.errors.as_ref().map_or(0.0, |errors| errors.mean_of(&errors.detected, false).unwrap_or(f64::NAN))
    }

    /// Mean of the change in the frames in which the eyes jump, if they saw then as at rest, JND.
    pub fn detected_in_flight(&self) -> Option<f64> {
        self.errors.as_ref().and_then(|errors| errors.mean_of(&errors.detected, true))
    }

    /// JOD by FovVideoVDP of the frames in which the eyes do not jump: 10 means no difference. None where that was not asked for, and for
    /// the application alone.
    pub fn jod(&self) -> Option<f64> {
        let errors = self.errors.as_ref()?;
        let frames = (0..errors.loss.len()).filter(|frame| !errors.is_in_flight(*frame));
        errors.fvvdp.as_ref()?.lost_jod(frames).map(|lost| 10.0 - lost)
    }

    /// Its cost, in costs of the application alone, and its loss; `None` if its time was not measured.
    pub fn cost_and_loss(&self) -> Option<CostAndLoss> {
        self.cost.as_ref().map(|cost| CostAndLoss { cost: cost.ratio, loss: self.loss() })
    }
}

impl Errors {
    /// Whether the eyes jump in a frame.
    pub fn is_in_flight(&self, frame: usize) -> bool {
        self.in_flight.get(frame).is_some_and(|jumps| *jumps)
    }

    /// The mean of a value of each frame, of those in which the eyes jump or of the others.
    fn mean_of(&self, by_frame: &[f64], in_flight: bool) -> Option<f64> {
        let frames = by_frame.iter().enumerate();
        mean(frames.filter(|(frame, _)| self.is_in_flight(*frame) == in_flight).map(|(_, value)| *value))
    }
}

/// The mean; none of nothing.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
