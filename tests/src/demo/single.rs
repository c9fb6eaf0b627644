//! The techniques that the default preset leaves off, each alone: temporal re-use and chroma attenuation.

use super::observed::Observed;
use super::{Exhibit, chroma, overlay, strip, timed, work};
use crate::HarnessError;
use crate::measure::{Effort, LAYER_RUN_UP, RUN_UP_ALONE, Technique};
use crate::progress::Progress;
use parafovea_core::chroma::ChromaSettings;
use serde::Serialize;
use std::path::Path;

const REUSE: &str = "preset = \"balanced\"\n[rates]\nmode = \"off\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";

/// Colour goes at once, so that few frames show the steady state.
const CHROMA: &str = "preset = \"none\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

/// What one technique alone saves on one application.
#[derive(Clone, Debug, Serialize)]
pub struct Saving {
    /// The application.
    pub app: String,
    /// The technique.
    pub technique: &'static str,
    /// What it saves.
    pub saves: &'static str,
    /// How much is left of that, in units of it without the layer.
    pub left: Option<f64>,
    /// CPU time, in units of that without the layer.
    pub ratio: f64,
}

/// Runs re-use and chroma attenuation alone, and saves a strip of pictures for each, named for what it saves.
///
/// # Errors
/// Those of the harness, and an application that does not come to its end.
pub fn savings(
    exhibit: &Exhibit,
    folder: &Path,
    progress: &mut Progress,
) -> Result<[Saving; 2], HarnessError> {
    let reuse = Technique::layer("re-use alone", REUSE);
    let chroma = Technique::layer("chroma attenuation alone", CHROMA);
    let techniques = [Technique::off(), reuse.clone(), chroma.clone()];
    let timed = timed::time(exhibit, &techniques, effort(exhibit), progress)?;
    let ratio = |index: usize| timed[index].cpu_ms.ratio_to(&timed[0].cpu_ms).value;

    let off = Observed::of(exhibit, &techniques[0], progress)?;
    let reused = Observed::of(exhibit, &reuse, progress)?;
    let ages = Technique::layer("tile ages", &format!("{REUSE}[debug]\nview = \"age\"\n"));
    let ages = Observed::picture_of(exhibit, &ages, progress)?;
    strip::save(&folder.join("reuse_saves_shading.png"), [&off.picture, &reused.picture, &ages])?;

    let faded = Observed::of(exhibit, &chroma, progress)?;
    let plateau_deg = ChromaSettings::default().plateau_deg;
    let rings = overlay::eccentricity(&faded.picture, &off.view(0), plateau_deg);
    strip::save(&folder.join("chroma_saves_bits.png"), [&off.picture, &faded.picture, &rings])?;

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
    let effort = effort(exhibit);
    let alone = Effort { run_up: RUN_UP_ALONE, ..effort };
    let timed = work::rendering(exhibit, alone) + 2 * work::rendering(exhibit, effort);
    timed + 4 * work::rendering(exhibit, exhibit.counted)
}

fn effort(exhibit: &Exhibit) -> Effort {
    Effort { turns: 1, run_up: LAYER_RUN_UP, ..exhibit.timed }
}
