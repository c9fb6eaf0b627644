//! Every style on a device without shading rates, with fixed rings: the passes with and without masks, with reasons, as in the table of
//! backends; shaded pixels are the same as without the layer, bit for bit, and skipped ones match the CPU's prediction.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/drawn.rs"]
mod drawn;
#[path = "common/effort.rs"]
mod effort;
#[path = "common/expected.rs"]
mod expected;
#[path = "masks/history.rs"]
mod history;
#[path = "common/noted.rs"]
mod noted;
#[path = "masks/reuse.rs"]
mod reuse;
#[path = "common/trial.rs"]
mod trial;

use drawn::mean;
use effort::{Effort, is_full, moving_gaze};
use expected::{Expected, expected};
use glam::{Quat, Vec3};
use libtest_mimic::{Arguments, Failed};
use noted::Noted;
use parafovea::config::{Config, GazeSource, Preset};
use parafovea::link::{BACKEND_MASK, CapabilitiesRecord};
use parafovea::planner::{Capabilities, SessionPlanner, ShownView, View};
use parafovea_core::geometry::Fov;
use parafovea_core::kernels::fill::FillFormat;
use parafovea_core::mask::{Mask, MaskView, TileRates, predict};
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, LayerMode, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_zoo::Style;
use std::path::Path;
use std::process::ExitCode;
use trial::{driver, skip_unless_run, trial};

/// Arguments of every test.
const SHARE: Effort = Effort { frames: 12, size: 96 };

/// From this frame on every eligible pass has a mask: each of a swapchain's three images was drawn to and shown, and drawn to again.
const MASKED_FROM: u64 = 9;

/// Rings at the centre of the view, never dropped, in full colour: the same map in every run.
const FIXED_RINGS: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n";

/// A pass that reads the image around a pixel spreads filled pixels by this many at most: blooms and filters of the styles are smaller.
const REACH: u32 = 12;

/// Most mean difference of skipped pixels of the style `deferred`, code values: 9 at 96 pixels a side, with its small boxes. A surface
/// without its motion would be black.
const MOST_OF_DEFERRED: f64 = 16.0;

fn main() -> ExitCode {
    let trials = expected().into_iter().flat_map(|(style, expected)| {
        let (moving, reused) = (expected.clone(), expected.clone());
        let mut trials = vec![
            trial(style.name, move || check(style, &expected?)),
            trial(format!("{}, re-used", style.name), move || reuse::check(style, &reused?)),
        ];
        if is_full() {
            trials.push(trial(format!("{}, moving gaze", style.name), move || check_moving(style, &moving?)));
        }
        trials
    });
    let of_history = trial("taa, history after a gaze step", history::check);
    libtest_mimic::run(&Arguments::from_args(), trials.chain([of_history]).collect()).exit_code()
}

fn run(
    style: &Style,
    effort: Effort,
    scenario: Scenario,
    layer: LayerMode,
    passes: Option<&Path>,
) -> Result<Outcome, Failed> {
    let (size, frames) = (effort.size.to_string(), effort.frames.to_string());
    let arguments = ["--style", style.name, "--size", &size, "--frames", &frames];
    let application = Application::ours("parafovea-zoo", &arguments)?;
    let run = Run::new(&application, &scenario)
        .driver(driver(style))
        .validated_from(style.headers)
        .two_queues(style.needs.queues.are_two())
        .layer(layer);
    let run = match passes {
        Some(file) => run.env("PARAFOVEA_PASSES_FILE", file),
        None => run,
    };
    Ok(run.finish()?)
}

/// Output of a run with masks.
fn masked(
    style: &Style,
    effort: Effort,
    scenario: Scenario,
    config: &str,
) -> Result<(Outcome, Vec<Noted>), Failed> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("passes.jsonl");
    let on = run(style, effort, scenario, LayerMode::On(config.to_owned()), Some(&file))?;
    skip_unless_run(&on);
    let on = on.expect_frames(effort.frames)?;
    assert!(on.findings.vulkan.is_empty(), "{:#?}\n{}", on.findings.vulkan, on.log);
    assert!(on.record.errors.is_empty(), "{:#?}", on.record.errors);
    let noted = Noted::read(&file)?;
    // A pre-pass has a template for the passes that go on with its depth, where that has several samples.
    let is_prepass = |pass: &Noted| pass.samples > 1 && pass.format.starts_with('D');
    let others = noted.iter().filter(|pass| pass.eyes == "none" && !is_prepass(pass));
    assert_eq!(
        others.filter(|pass| pass.unmasked.is_none()).count(),
        0,
        "passes that are not the scene have masks"
    );
    Ok((on, noted))
}

/// Asserts that masks agree with the table.
fn assert_expected(expected: &Expected, on: &Outcome, noted: &[Noted]) {
    let scene: Vec<&Noted> =
        noted.iter().filter(|pass| pass.frame >= MASKED_FROM && pass.eyes != "none").collect();
    let masked = scene.iter().filter(|pass| pass.unmasked.is_none()).count();
    let reasons: Vec<&str> = scene.iter().filter_map(|pass| pass.unmasked.as_deref()).collect();
    match expected {
        Expected::Engaged => assert!(masked > 0, "no pass has a mask: {reasons:?}\n{}", on.log),
        Expected::Refused(reason) => {
            assert_eq!(masked, 0, "passes have masks");
            assert!(reasons.contains(&reason.as_str()), "{reasons:?} for {reason:?}\n{}", on.log);
        }
        Expected::NotRun => {}
    }
}

fn check_moving(style: &Style, expected: &Expected) -> Result<(), Failed> {
    let effort = Effort::or_share(SHARE.frames, SHARE.size);
    let folder = tempfile::tempdir()?;
    let config =
        format!("{}[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n", moving_gaze(folder.path(), 0.0)?);
    let (on, noted) = masked(style, effort, effort.scenario(), &config)?;
    assert_expected(expected, &on, &noted);
    Ok(())
}

fn check(style: &Style, expected: &Expected) -> Result<(), Failed> {
    let effort = Effort::or_share(SHARE.frames, SHARE.size);
    let saved = effort.frames - 1;
    let scenario = effort.scenario().saving(&[saved]);
    let (on, noted) = masked(style, effort, scenario.clone(), FIXED_RINGS)?;
    assert_expected(expected, &on, &noted);
    let off = run(style, effort, scenario, LayerMode::Off, None)?.expect_frames(effort.frames)?;
    let rings = Rings::new(effort.size);
    for eye in 0..2 {
        let (off, on) = (off.submitted(eye, saved)?, on.submitted(eye, saved)?);
        match expected {
            Expected::Refused(_) => assert!(off == on, "eye {eye} differs"),
            Expected::Engaged => rings.check(style, eye, &off, &on),
            Expected::NotRun => {}
        }
    }
    Ok(())
}

/// Skipped pixels in the image of an eye: both see the same rings.
struct Rings {
    mask: Mask,
    size: u32,
}

impl Rings {
    /// The plan that the layer makes of these views and this gaze.
    fn new(size: u32) -> Self {
        let mut config = Config::of_preset(Preset::Balanced);
        config.gaze.source = GazeSource::Centre;
        let mut offer = CapabilitiesRecord {
            backend: BACKEND_MASK,
            texel: [16; 2],
            rate_count: VULKAN_RATES.len() as u32,
            rates: [0; 16],
            is_cpu: 1,
        };
        for (texel, rate) in offer.rates.iter_mut().zip(VULKAN_RATES) {
            *texel = rate.texel();
        }
        let edge = std::f32::consts::FRAC_PI_4;
        let fov = Fov { left: -edge, right: edge, up: edge, down: -edge };
        let view = View { position: Vec3::ZERO, orientation: Quat::IDENTITY, fov };
        let mut planner = SessionPlanner::new(Capabilities::from(&offer));
        planner.views.located(&[view; 2]);
        planner.views.shown(Some(1), &[ShownView { view, extent: [size; 2] }; 2]);
        planner.frame_begins(0, 1);
        assert!(planner.plan(&config, false, Quat::IDENTITY, 0));
        let record = planner.new_rates(&config, || 1).unwrap();
        let eye = record.eyes[0];
        // SAFETY: the record has a rate for each tile until `planner` is used again.
        let rates = unsafe { std::slice::from_raw_parts(eye.rates, (eye.tiles[0] * eye.tiles[1]) as usize) };
        assert!(
            rates.contains(&ShadingRate::R1X1.texel()) && rates.iter().any(|rate| *rate != 0),
            "{rates:?}"
        );
        let tiles = TileRates { texel: eye.texel, first: [0; 2], columns: eye.tiles[0], rates };
        let mut mask = Mask::new([size; 2], 1);
        mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent: [size; 2], tiles }]);
        Self { mask, size }
    }

    /// Whether a pixel, and everything within so many pixels of it, is shaded.
    fn is_shaded(&self, [x, y]: [u32; 2], reach: u32) -> bool {
        let around = |at: u32| at.saturating_sub(reach)..=(at + reach).min(self.size - 1);
        around(y).all(|y| around(x).all(|x| !self.mask.skips(0, [x, y])))
    }

    fn check(&self, style: &Style, eye: usize, off: &Picture, on: &Picture) {
        assert!(off != on, "eye {eye}: nothing was done");
        if style.global.is_some() {
            let (before, after) = (mean(off), mean(on));
            assert!((after / before - 1.0).abs() < 0.01, "eye {eye}: from {before} to {after}");
            return;
        }
        // The plan is made for the size that was shown last, and this picture has another.
        let is_resized = off.width != self.size;
        let is_predicted = style.direct && !is_resized;
        let reach = if is_predicted { 0 } else { REACH };
        let mut predicted: Vec<u8> = off.pixels.as_flattened().to_vec();
        predict(&mut predicted, FillFormat::Srgb8, &self.mask, 0);
        let mut compared = 0;
        for (x, y, was) in off.enumerate() {
            let is = on.at(x, y);
            let [column, row] =
                if is_resized { [x * self.size / off.width, y * self.size / off.height] } else { [x, y] };
            if self.is_shaded([column, row], reach) {
                assert_eq!(is, was, "eye {eye}, {x}, {y}: shaded, but not as without");
                compared += 1;
            } else if is_predicted {
                let at = (y * self.size + x) as usize * 4;
                let by = is.iter().zip(&predicted[at..at + 4]).map(|(is, was)| is.abs_diff(*was)).max();
                assert!(by <= Some(1), "eye {eye}, {x}, {y}: {is:?}, predicted {:?}", &predicted[at..at + 4]);
            }
        }
        assert!(compared > 100, "eye {eye}: only {compared} pixels were compared");
        if style.name == "deferred" {
            let by = self.mean_of_skipped(off, on);
            assert!(by < MOST_OF_DEFERRED, "eye {eye}: skipped pixels differ by {by} code values");
            let is_black = |picture: &Picture| picture.enumerate().any(|(.., rgba)| rgba[..3] == [0; 3]);
            assert!(!is_black(off) && !is_black(on), "eye {eye}: surfaces have lost their motion");
        }
    }

    /// Mean difference of the skipped pixels of two pictures, code values.
    fn mean_of_skipped(&self, off: &Picture, on: &Picture) -> f64 {
        let skipped = off.enumerate().filter(|&(x, y, _)| self.mask.skips(0, [x, y]));
        let by = skipped.map(|(x, y, was)| {
            let is = on.at(x, y);
            was.iter().zip(&is).map(|(was, is)| f64::from(was.abs_diff(*is))).sum::<f64>() / 4.0
        });
        let (count, sum) = by.fold((0, 0.0), |(count, sum), by| (count + 1, sum + by));
        sum / f64::from(count.max(1))
    }
}
