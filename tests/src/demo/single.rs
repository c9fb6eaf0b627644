//! The techniques that the default preset leaves off, each alone: temporal re-use and chroma attenuation.

use super::observed::Observed;
use super::{Exhibit, all_at_once, chroma, overlay, strip, timed, work};
use crate::HarnessError;
use crate::measure::{Effort, RUN_UP_ALONE, Technique};
use crate::progress::Progress;
use parafovea_core::chroma::ChromaSettings;
use serde::Serialize;
use std::path::Path;

const REUSE: &str = "preset = \"balanced\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";

/// Frames until both techniques are steady: passes are recognised, and history is complete.
const RUN_UP: u64 = 36;

/// Chroma is attenuated at once, so that few frames show the steady state.
const CHROMA: &str = "preset = \"none\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

/// Saving of one technique alone on one application.
#[derive(Clone, Debug, Serialize)]
pub struct Saving {
    /// The application.
    pub app: String,
    /// The technique.
    pub technique: &'static str,
    /// Quantity that it saves.
    pub saves: &'static str,
    /// Remaining share of that quantity, relative to the run without the layer.
    pub left: Option<f64>,
    /// CPU time, in units of that without the layer.
    pub ratio: f64,
}

/// Runs re-use and chroma attenuation alone, and saves a strip of images for each, named for its saving. `off` is the counted run
/// without the layer.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn savings(
    exhibit: &Exhibit,
    off: &Observed,
    folder: &Path,
    progress: &mut Progress,
) -> Result<[Saving; 2], HarnessError> {
    let reuse = Technique::layer("re-use alone", REUSE);
    let chroma = Technique::layer("chroma attenuation alone", CHROMA);
    let techniques = [Technique::off(), reuse.clone(), chroma.clone()];
    let later = later(exhibit);
    let timed = timed::time(&later, &techniques, later.timed, progress)?;
    let ratio = |index: usize| timed[index].cpu_ms.ratio_to(&timed[0].cpu_ms).value;

    progress.next(&format!("{}: re-use, tile ages and chroma attenuation, each alone", exhibit.name()));
    let Exhibit { subject, counted: effort, .. } = &later;
    let ages = Technique::layer("tile ages", &format!("{REUSE}[debug]\nview = \"age\"\n"));
    let (reused, faded, ages) = all_at_once(
        || Observed::of(subject, *effort, &reuse),
        || Observed::of(subject, *effort, &chroma),
        || Observed::picture_of(subject, *effort, &ages),
    );
    let (reused, faded) = (reused?, faded?);
    strip::save(&folder.join("reuse_saves_shading.png"), [&off.picture, &reused.picture, &ages?])?;

    let plateau_deg = ChromaSettings::default().plateau_deg;
    let rings = overlay::eccentricity(&faded.picture, &off.view(0), plateau_deg);
    strip::save(&folder.join("chroma_saves_bits.png"), [&off.picture, &faded.picture, &rings])?;
    progress.add(3 * work::rendering(exhibit, *effort));

    let share = |part: f64, all: f64| part / all;
    let samples = reused.samples.zip(off.samples).map(|(left, all)| share(left as f64, all as f64));
    let bytes = [&faded.picture, &off.picture].map(chroma::encoded_bytes);
    let [less, all] = bytes;
    Ok([
        Saving {
            app: exhibit.name().to_owned(),
            technique: "temporal re-use",
            saves: "shaded samples",
            left: samples,
            ratio: ratio(1),
        },
        Saving {
            app: exhibit.name().to_owned(),
            technique: "chroma attenuation",
            saves: "bits of the picture as a JPEG (quality 80, 4:2:0)",
            left: Some(share(less? as f64, all? as f64)),
            ratio: ratio(2),
        },
    ])
}

/// Work of all of it, as [`super::work()`] counts.
pub fn work_of(exhibit: &Exhibit) -> u64 {
    let Exhibit { timed, counted, .. } = later(exhibit);
    let alone = Effort { run_up: RUN_UP_ALONE, ..timed };
    let timed = work::rendering(exhibit, alone) + 2 * work::rendering(exhibit, timed);
    timed + 3 * work::rendering(exhibit, counted)
}

/// The same frames after a shorter run-up, half as many of them timed: no spread is shown.
fn later(exhibit: &Exhibit) -> Exhibit {
    let shorter = |effort: Effort| Effort { run_up: effort.run_up.min(RUN_UP), ..effort };
    let timed = shorter(exhibit.timed);
    let skipped = exhibit.counted.run_up.saturating_sub(RUN_UP);
    Exhibit {
        subject: exhibit.subject.later(skipped),
        timed: Effort { frames: timed.frames / 2, ..timed },
        counted: shorter(exhibit.counted),
        warming: exhibit.warming,
        weight: exhibit.weight,
    }
}
