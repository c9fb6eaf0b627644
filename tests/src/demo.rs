//! The demo: applications with the default preset and without the layer, on the mock runtime, while head and eyes move.
//!
//! Each application has three parts. Timed turns: without and with the layer side by side, a frame each in turn, as `parafovea run` starts
//! applications, with the gate deciding. Counted runs: shaded samples and pictures, with rates on or off for good, as the gate decided in
//! the timed turns. Judgement: error by angle from the true gaze.

mod application;
mod chroma;
mod decision;
mod observed;
mod overlay;
mod report;
mod single;
mod strip;
mod timed;
mod view;
mod work;

pub use application::{Exhibit, exhibits};
pub use decision::Decision;
pub use observed::Observed;
pub use report::{print_json, print_tables};
pub use single::{Saving, savings};
pub use view::EyeView;
pub use work::work;

use crate::measure::{Ratio, Technique};
use crate::progress::Progress;
use crate::{HarnessError, artifacts};
use parafovea_models::errors::{Metric, RINGS, Report};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::thread::ScopedJoinHandle;

/// Configuration of `parafovea run` without a file.
const PRESET: &str = "preset = \"balanced\"\n";

/// Half of the field in which the layer never shades coarsely, degrees: the least value of `rates.foveal_deg`.
const FOVEA_DEG: f32 = 5.0;

/// Cost of an application in one mode, both eyes together.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// CPU time of the whole process for a frame, milliseconds, rendering included: the median of all timed frames.
    pub cpu_ms: f64,
    /// Samples of a frame that passed the depth test in the application's render passes; none where it has occlusion queries
    /// itself.
    pub samples: Option<u64>,
}

/// Result of one application.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// The application.
    pub app: String,
    /// Timed frames in each mode, all turns together.
    pub frames: usize,
    /// Without the layer.
    pub off: Cost,
    /// With it.
    pub on: Cost,
    /// CPU time with the layer, in units of that without it, from the turns ([`crate::measure::Samples::ratio_to`]).
    pub ratio: f64,
    /// Half of the interquartile range of the ratios of [`timed::BLOCK`]s of frames.
    pub spread: f64,
    /// Largest difference within 5 degrees of the gaze in the picture shown, code values (0..=255), of both eyes.
    pub fovea_max_error: u8,
    /// Lost contrast in just noticeable differences by ring around the true gaze, named by degrees; none for a ring outside the view.
    pub jnd: Vec<(&'static str, Option<f64>)>,
    /// Mean of the whole view, just noticeable differences, changes over time included.
    pub jnd_view: f64,
    /// Likewise, as detected: small losses far below one JND hardly count.
    pub jnd_detected: f64,
    /// The layer's decision.
    #[serde(flatten)]
    pub decision: Decision,
}

/// Times, counts and judges `exhibit`, and saves its pictures in `folder`. Returns the counted run without the layer, too.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn run(
    exhibit: &Exhibit,
    folder: &Path,
    progress: &mut Progress,
) -> Result<(Finding, Observed), HarnessError> {
    let techniques = [Technique::off(), Technique::layer("balanced", PRESET)];
    let timed = timed::time(exhibit, &techniques, exhibit.timed, progress)?;
    let [off_ms, on_ms] = [&timed[0].cpu_ms, &timed[1].cpu_ms];
    let Ratio { value: ratio, spread } = on_ms.ratio_to(off_ms);
    let decision = Decision::of(timed[1].status.as_ref());

    progress.next(&format!("{}: pictures, samples and shading rates, off | balanced", exhibit.name()));
    let settled = settled(decision.engaged);
    let view = format!("{settled}[debug]\nview = \"rates\"\n");
    let (subject, effort) = (&exhibit.subject, exhibit.counted);
    let counted = |technique| move || Observed::of(subject, effort, &technique);
    // Nothing is timed here.
    let (off, on, drawn) =
        all_at_once(counted(Technique::off()), counted(Technique::layer("balanced", &settled)), || {
            Observed::picture_of(subject, effort, &Technique::layer("shading rates", &view))
        });
    let (off, on) = (off?, on?);
    strip::save(&folder.join(format!("{}.png", exhibit.name())), [&off.picture, &on.picture, &drawn?])?;
    progress.add(3 * work::rendering(exhibit, effort));

    progress.next(&format!("{}: comparing the images", exhibit.name()));
    let errors = off.judge(&on)?;
    progress.add(work::judging(exhibit));
    let finding = Finding {
        app: exhibit.name().to_owned(),
        frames: off_ms.len(),
        off: Cost { cpu_ms: off_ms.median(), samples: off.samples },
        on: Cost { cpu_ms: on_ms.median(), samples: on.samples },
        ratio,
        spread,
        fovea_max_error: off.fovea_max_error(&on, FOVEA_DEG)?,
        jnd: by_ring(&errors),
        jnd_view: mean(&errors.loss_by_frame()),
        jnd_detected: mean(&errors.detected_loss_by_frame()),
        decision,
    };
    Ok((finding, off))
}

/// Calls three functions, each on a thread of its own.
fn all_at_once<A: Send, B: Send, C: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
    third: impl FnOnce() -> C + Send,
) -> (A, B, C) {
    std::thread::scope(|scope| {
        let (first, second) = (scope.spawn(first), scope.spawn(second));
        let third = third();
        (join(first), join(second), third)
    })
}

/// The result of a thread; panics if that panicked.
fn join<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// The folder for pictures: `target/demo`, made if need be, without pictures of earlier demos.
///
/// # Errors
/// [`HarnessError::File`].
pub fn pictures_folder() -> Result<PathBuf, HarnessError> {
    let folder = artifacts::target_folder()?.join("demo");
    std::fs::create_dir_all(&folder).map_err(HarnessError::file(&folder))?;
    for entry in std::fs::read_dir(&folder).map_err(HarnessError::file(&folder))?.flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == "png") {
            std::fs::remove_file(&path).map_err(HarnessError::file(&path))?;
        }
    }
    Ok(folder)
}

/// The preset after the gate's decision, which no trial interrupts then.
fn settled(is_engaged: bool) -> String {
    format!("{PRESET}[rates]\ngate = \"{}\"\n", if is_engaged { "on" } else { "off" })
}

fn by_ring(errors: &Report) -> Vec<(&'static str, Option<f64>)> {
    let ring = |ring| errors.row(Metric::Sustained, ring);
    (0..RINGS).map(|index| (ring(index).ring, ring(index).mean)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
