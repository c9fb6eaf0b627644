//! The demo: unmodified applications, with the layer and without, on the mock runtime.
//!
//! Each application runs six times. Two runs, off and on, save one frame's pictures and count fragments; four more,
//! off and on by turns, only measure time, so that neither saving nor counting is in it.

mod overlay;
mod report;
mod view;

pub use report::{print_json, print_table};
pub use view::EyeView;

use crate::compare::{chroma_kept, difference_times_8, max_difference, psnr_db};
use crate::picture::Picture;
use crate::record::median;
use crate::run::{Application, LayerMode, Outcome, Run};
use crate::scenario::{Scenario, ScenarioExt};
use crate::{HarnessError, artifacts};
use parafovea_core::chroma::ChromaSettings;
use serde::Serialize;
use std::path::Path;

/// The configuration of the runs with the layer on: colour goes at once, so that few frames show the steady state.
const CONFIG: &str = "preset = \"none\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

/// Where the eyes rest, in degrees to the left and upwards: not the centre, so that following them shows.
const GAZE_DEG: (f32, f32) = (-12.0, 4.0);

/// Timed runs of each kind.
const ROUNDS: usize = 2;

/// One application of the demo.
pub struct Subject {
    /// The application.
    pub application: Application,
    /// Frames of each run.
    pub frames: u64,
}

/// What one application costs in one mode.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// CPU time of the whole process for a frame, in milliseconds, the median of all frames of all timed runs.
    pub cpu_ms: f64,
    /// Fragment shader invocations of a frame that the application caused; the layer's own are not among them.
    pub fragments: u64,
    /// Samples of a frame that passed the depth test in the application's render passes; none where it has occlusion
    /// queries itself.
    pub samples: Option<u64>,
}

impl Cost {
    fn new(subject: &Subject, cpu_ms: f64, counted: &Outcome) -> Result<Self, HarnessError> {
        let samples = counted.samples().ok().map(|samples| samples / subject.frames);
        Ok(Self { cpu_ms, fragments: counted.fragments()? / subject.frames, samples })
    }
}

/// What the demo found for one application.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// The application.
    pub app: String,
    /// Frames of each run.
    pub frames: u64,
    /// Without the layer.
    pub off: Cost,
    /// With it.
    pub on: Cost,
    /// Largest difference inside the plateau around the gaze, in code values (0..=255), of both eyes.
    pub fovea_max_error: u8,
    /// Peak signal-to-noise ratio outside the plateau, in dB, of the worse eye; infinite (`null` in JSON) where the
    /// pictures are equal.
    pub outside_psnr_db: f64,
    /// Part of the chroma that is left outside the plateau (see [`chroma_kept`]), mean of both eyes.
    pub chroma_kept: f64,
}

/// hello_xr where it is installed, and our scene.
///
/// # Errors
/// [`HarnessError::NotBuilt`].
pub fn subjects() -> Result<Vec<Subject>, HarnessError> {
    let mut subjects = Vec::new();
    match Application::hello_xr("Vulkan2") {
        Ok(application) => subjects.push(Subject { application, frames: 100 }),
        Err(missing) => eprintln!("only our own scene: {missing}"),
    }
    subjects.push(Subject { application: Application::ours("parafovea-scene", &[])?, frames: 40 });
    Ok(subjects)
}

/// Runs one application, saves its pictures into `pictures`, and measures.
///
/// # Errors
/// Those of the harness, and an application that does not come to its end.
pub fn run(subject: &Subject, pictures: &Path) -> Result<Finding, HarnessError> {
    let off = observe(subject, LayerMode::Absent)?;
    let on = observe(subject, LayerMode::On(CONFIG.to_owned()))?;
    let [off_ms, on_ms] = time(subject)?;
    let mut finding = Finding {
        app: subject.application.name().to_owned(),
        frames: subject.frames,
        off: Cost::new(subject, off_ms, &off)?,
        on: Cost::new(subject, on_ms, &on)?,
        fovea_max_error: 0,
        outside_psnr_db: f64::INFINITY,
        chroma_kept: 0.0,
    };
    let settings = ChromaSettings::default();
    let views = EyeView::of_scenario(&scenario(subject));
    for (eye, view) in views.iter().enumerate() {
        let (before, after) =
            (off.submitted(eye, saved_frame(subject))?, on.submitted(eye, saved_frame(subject))?);
        let inside = |x, y| view.eccentricity_deg(&before, x, y) <= settings.plateau_deg;
        finding.fovea_max_error = finding.fovea_max_error.max(max_difference(&before, &after, inside));
        let outside = |x, y| !inside(x, y);
        finding.outside_psnr_db = finding.outside_psnr_db.min(psnr_db(&before, &after, outside));
        finding.chroma_kept += chroma_kept(&before, &after, outside) / views.len() as f64;
        save(&finding.app, eye, view, &settings, [&before, &after], pictures)?;
    }
    Ok(finding)
}

/// The folder for pictures: `target/demo`, made if need be.
///
/// # Errors
/// [`HarnessError::File`].
pub fn pictures_folder() -> Result<std::path::PathBuf, HarnessError> {
    let folder = artifacts::target_folder()?.join("demo");
    std::fs::create_dir_all(&folder).map_err(HarnessError::file(&folder))?;
    Ok(folder)
}

fn scenario(subject: &Subject) -> Scenario {
    Scenario::new(subject.frames).gazing(GAZE_DEG.0, GAZE_DEG.1)
}

fn saved_frame(subject: &Subject) -> u64 {
    subject.frames / 2
}

/// A run that is looked at: pictures and fragments.
fn observe(subject: &Subject, mode: LayerMode) -> Result<Outcome, HarnessError> {
    let scenario = scenario(subject).saving(&[saved_frame(subject)]);
    let run = Run::new(&subject.application, &scenario).layer(mode).counted();
    run.finish()?.expect_frames(subject.frames)
}

/// Runs that are timed, off and on by turns: milliseconds a frame of each.
fn time(subject: &Subject) -> Result<[f64; 2], HarnessError> {
    let modes = [LayerMode::Absent, LayerMode::On(CONFIG.to_owned())];
    let mut frames: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        for (mode, frames) in modes.iter().zip(&mut frames) {
            let outcome = Run::new(&subject.application, &scenario(subject)).layer(mode.clone()).finish()?;
            frames
                .extend(outcome.expect_frames(subject.frames)?.record.cpu_ms_of_frames(subject.frames / 10));
        }
    }
    Ok(frames.map(|frames| median(frames).unwrap_or(f64::NAN)))
}

fn save(
    app: &str,
    eye: usize,
    view: &EyeView,
    settings: &ChromaSettings,
    [before, after]: [&Picture; 2],
    folder: &Path,
) -> Result<(), HarnessError> {
    let save =
        |what: &str, picture: &Picture| picture.save(&folder.join(format!("{app}_eye{eye}_{what}.png")));
    save("off", before)?;
    save("on", after)?;
    save("difference_x8", &difference_times_8(before, after))?;
    let rings = overlay::eccentricity(after, view, settings.plateau_deg);
    save("eccentricity", &rings)?;
    save("overview", &before.halved().beside(&rings.halved()))
}
