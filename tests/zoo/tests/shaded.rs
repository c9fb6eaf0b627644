//! Every style whose passes have masks shades less than nine tenths of what it shades without the layer, in all its passes
//! together, with rings that stay where they are. Where fragment shaders return early instead of failing depth tests, as many samples
//! pass as without: what that saves is printed as CPU time.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/effort.rs"]
#[allow(dead_code, reason = "each test uses a part of it")]
mod effort;
#[path = "common/expected.rs"]
#[allow(dead_code, reason = "each test uses a part of it")]
mod expected;

use effort::is_full;
use expected::{Expected, expected};
#[path = "common/trial.rs"]
mod trial;

use libtest_mimic::{Arguments, Failed};
use parafovea_tests::record::median;
use parafovea_tests::run::{Application, LayerMode, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_trial::{Lack, skip};
use parafovea_zoo::{Queues, Style};
use std::process::ExitCode;
use trial::{skip_unless_run, trial};

/// Side of an eye's picture, pixels. Rings are rounded up to blocks of 16, which are wider than rings in much smaller pictures.
const SIZE: u32 = 768;

/// What is counted: frames in which all passes that can have a mask have one.
const RUN_UP: u64 = 10;
const FRAMES: u64 = RUN_UP + 4;

/// Of what is shaded without the layer.
const LIMIT: f64 = 0.9;

/// What cannot be counted: lavapipe counts nothing in secondary command buffers.
const NOT_COUNTED: &str = "the device has no inheritedQueries";

/// What counts samples itself, and so cannot be counted.
const COUNTS_ITSELF: &str = "occlusion";

/// What the log says where a template keeps fragments out, and where shaders return early.
const TEMPLATE: &str = ": masked";
const EARLY_RETURN: &str = "masked in their fragment shaders";

/// Looking straight ahead, never dropped.
const FIXED_RINGS: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n";

/// Styles of every test: the most and the least that is saved, and one whose shaders return early.
const FEW: [&str; 3] = ["render-pass", "upscaled", "visibility"];

fn main() -> ExitCode {
    let wanted = expected().into_iter().filter(|(style, _)| is_full() || FEW.contains(&style.name));
    let wanted = wanted.filter(|(style, _)| style.name != COUNTS_ITSELF);
    let engaged =
        wanted.filter(|(_, expected)| !matches!(expected, Ok(Expected::Refused(_) | Expected::NotRun)));
    let trials = engaged.map(|(style, expected)| {
        trial(format!("{} shades less", style.name), move || {
            expected.map_err(Failed::from).and_then(|_| check(style))
        })
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}

fn check(style: &Style) -> Result<(), Failed> {
    let run = |layer: LayerMode| -> Result<Outcome, Failed> {
        let (size, frames) = (SIZE.to_string(), FRAMES.to_string());
        let arguments = ["--style", style.name, "--size", &size, "--frames", &frames];
        let application = Application::ours("parafovea-zoo", &arguments)?;
        let run = Run::new(&application, &Scenario::new(FRAMES).sized(SIZE, SIZE))
            .two_queues(style.needs.queues == Queues::Two)
            .layer(layer)
            .counted();
        Ok(run.finish()?)
    };
    let off = run(LayerMode::Off)?;
    skip_unless_run(&off);
    let cpu_ms = |run: &Outcome| median(run.record.cpu_ms_of_frames(RUN_UP)).unwrap();
    let off_ms = cpu_ms(&off);
    let off = match off.expect_frames(FRAMES)?.samples_after(RUN_UP) {
        Ok(samples) => samples,
        // Only where the device cannot: a count that is missing otherwise is a failure.
        Err(reason) if reason.to_string().contains(NOT_COUNTED) => {
            skip(&Lack::machine(format_args!("a device that counts samples: {reason}")))
        }
        Err(reason) => return Err(reason.into()),
    };
    let on = run(LayerMode::On(FIXED_RINGS.to_owned()))?.expect_frames(FRAMES)?;
    let share = on.samples_after(RUN_UP)? as f64 / off as f64;
    let time = cpu_ms(&on) / off_ms;
    println!("{}: {share:.3} of {off} samples, {time:.2} of the CPU time", style.name);
    if on.log.contains(EARLY_RETURN) && !on.log.lines().any(|line| line.ends_with(TEMPLATE)) {
        assert!((share - 1.0).abs() < 1e-3, "{share:.4} of the samples, which all pass\n{}", on.log);
        return Ok(());
    }
    assert!(share < LIMIT, "{share:.3} of {off} samples\n{}", on.log);
    Ok(())
}
