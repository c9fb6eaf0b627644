//! Direct3D 11 games by DXVK itself, on lavapipe: masks, and rates by the stand-in, in each way of drawing; the centre of the picture is as
//! without the layer, bit for bit, and no validation message is new.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/noted.rs"]
mod noted;

use libtest_mimic::{Arguments, Completion, Failed, Trial};
use noted::Noted;
use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::drivers::Folder;
use parafovea_tests::drivers::direct3d::{self, LOOKS};
use parafovea_tests::installation::Driver;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_trial::Lack;
use std::path::Path;
use std::process::ExitCode;

const FRAMES: u64 = 14;

/// Side of an eye buffer, pixels.
const SIZE: u32 = 192;

/// The compared picture.
const SAVED: u64 = FRAMES - 1;

/// From this frame on each pass of the scene is known.
const KNOWN_FROM: u64 = 9;

/// Half the side of the compared centre, pixels: 5 degrees of 90 across.
const CENTRE: u32 = 8;

/// The look without masks, and the reason: an early return needs a descriptor set beside the application's, which would end DXVK's heaps.
const REFUSED: (&str, &str) = ("multisampled", "the graphics state could not be restored after it");

/// Largest mean difference of a picture with a coarse periphery, code values.
const FILLED: f64 = 20.0;

/// Rings at the centre of the view, never dropped, in full colour.
const FIXED_RINGS: &str = "[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n";

const EVERYTHING: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n[reuse]\nmode = \"on\"\n\
                          [chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

fn main() -> ExitCode {
    let trials = LOOKS.into_iter().flat_map(|look| {
        [
            trial(format!("{look}, masks"), move || masks(look)),
            trial(format!("{look}, rates"), move || rates(look)),
            trial(format!("{look}, everything"), move || everything(look)),
        ]
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}

/// A trial that is ignored without sid's drivers, which `cargo dev drivers` unpacks with DXVK.
fn trial(name: String, check: impl FnOnce() -> Result<(), Failed> + Send + 'static) -> Trial {
    Trial::ignorable_test(name, || match Folder::Sid.version("libdxvk-d3d11-0") {
        Ok(_) => check().map(|()| Completion::Completed),
        Err(error) => Ok(Completion::ignored_with(Lack::machine(error))),
    })
}

fn scenario() -> Scenario {
    Scenario::new(FRAMES).sized(SIZE, SIZE).saving(&[SAVED])
}

fn on_lavapipe(look: &str) -> Result<Run, Failed> {
    Ok(direct3d::run(look, SIZE, &scenario())?.driver(Driver::UnpackedLavapipe(Folder::Sid)).validated())
}

fn without_layer(look: &str) -> Result<Outcome, Failed> {
    Ok(on_lavapipe(look)?.finish()?.expect_frames(FRAMES)?)
}

/// Asserts that validation and runtime find no more with the layer than without it.
fn assert_nothing_new(on: &Outcome, off: &Outcome) {
    let new = on.findings.beyond(&off.findings);
    assert!(new.is_empty(), "{new:#?}\n{}", on.log);
    assert!(on.record.errors.is_empty(), "{:#?}", on.record.errors);
}

/// The passes of the scene from [`KNOWN_FROM`] on.
fn scene_of(file: &Path) -> Result<Vec<Noted>, Failed> {
    let noted = Noted::read(file)?;
    Ok(noted.into_iter().filter(|pass| pass.frame >= KNOWN_FROM && pass.eyes != "none").collect())
}

/// The pixels at the centre, and the mean difference of all others in code values.
fn compare(on: &Outcome, off: &Outcome, eye: usize) -> Result<f64, Failed> {
    let (on, off) = (on.submitted(eye, SAVED)?, off.submitted(eye, SAVED)?);
    let is_centre = |x: u32, y: u32| x.abs_diff(on.width / 2) < CENTRE && y.abs_diff(on.height / 2) < CENTRE;
    let different = on.enumerate().find(|&(x, y, pixel)| is_centre(x, y) && pixel != off.at(x, y));
    assert_eq!(different, None, "eye {eye} differs at its centre");
    Ok(difference(&on, &off))
}

fn difference(on: &Picture, off: &Picture) -> f64 {
    let pairs = on.pixels.iter().zip(&off.pixels);
    let sum: u64 = pairs.flat_map(|(on, off)| (0..3).map(|i| u64::from(on[i].abs_diff(off[i])))).sum();
    sum as f64 / (3 * on.pixels.len()) as f64
}

fn masks(look: &str) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("passes.jsonl");
    let off = without_layer(look)?;
    let on = on_lavapipe(look)?.env("PARAFOVEA_PASSES_FILE", &file).on(FIXED_RINGS).finish()?;
    let on = on.expect_frames(FRAMES)?;
    assert_nothing_new(&on, &off);
    let scene = scene_of(&file)?;
    let reasons: Vec<_> = scene.iter().filter_map(|pass| pass.unmasked.as_deref()).collect();
    let is_refused = REFUSED == (look, *reasons.first().unwrap_or(&"none"));
    assert!(is_refused || reasons.len() < scene.len(), "no pass has a mask: {reasons:?}\n{}", on.log);
    for eye in 0..2 {
        let difference = compare(&on, &off, eye)?;
        assert_eq!(difference > 0.0, !is_refused, "eye {eye}: {difference}");
        assert!(difference < FILLED, "eye {eye}: {difference}");
    }
    Ok(())
}

fn rates(look: &str) -> Result<(), Failed> {
    let off = without_layer(look)?;
    let on = on_lavapipe(look)?.shading_rates(ShadingRateProfile::Navi31).on(FIXED_RINGS).finish()?;
    let on = on.expect_frames(FRAMES)?;
    let new = on.findings.beyond(&off.findings);
    let new: Vec<_> = new.into_iter().filter(|message| !message.is_of_stand_in()).collect();
    assert!(new.is_empty(), "{new:#?}\n{}", on.log);
    assert!(on.record.errors.is_empty(), "{:#?}", on.record.errors);
    let mut is_coarse = false;
    for line in on.shading_rates()? {
        match line {
            ShadingRateLine::Finding(finding) => return Err(format!("{finding:?}").into()),
            ShadingRateLine::Pass(pass) => {
                is_coarse |= pass.map.is_some_and(|map| map.histogram.keys().any(|rate| rate != "1x1"));
            }
        }
    }
    assert!(is_coarse, "no pass is coarse\n{}", on.log);
    // The stand-in shades each pixel.
    for eye in 0..2 {
        assert!(on.submitted(eye, SAVED)? == off.submitted(eye, SAVED)?, "eye {eye} differs");
    }
    Ok(())
}

fn everything(look: &str) -> Result<(), Failed> {
    let off = without_layer(look)?;
    let on = on_lavapipe(look)?.on(EVERYTHING).finish()?.expect_frames(FRAMES)?;
    assert_nothing_new(&on, &off);
    for eye in 0..2 {
        let difference = compare(&on, &off, eye)?;
        assert!(difference > 0.0 && difference < FILLED, "eye {eye}: {difference}");
    }
    Ok(())
}
