//! Every style whose passes have masks shades its share of samples in the table of backends, in all its passes together, with fixed rings:
//! at most 0.6 of its samples without the layer, or the table has a reason. CPU time is printed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/effort.rs"]
#[allow(dead_code, reason = "each test uses a part of it")]
mod effort;
#[path = "common/expected.rs"]
#[allow(dead_code, reason = "each test uses a part of it")]
mod expected;

use effort::is_full;
use expected::{Expected, column, expected};
#[path = "common/trial.rs"]
mod trial;

use libtest_mimic::{Arguments, Failed};
use parafovea_tests::record::median;
use parafovea_tests::run::{Application, LayerMode, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_trial::{Lack, skip};
use parafovea_zoo::Style;
use std::process::ExitCode;
use trial::{driver, skip_unless_run, trial};

/// Side of an eye buffer, pixels. Rings are rounded up to blocks of 16, which are wider than rings in much smaller pictures.
const SIZE: u32 = 768;

/// Counted frames: those in which every eligible pass has a mask.
const RUN_UP: u64 = 10;
const FRAMES: u64 = RUN_UP + 4;

/// Greatest part of the samples without the layer, unless the table gives a reason.
const LIMIT: f64 = 0.6;

/// Allowed difference of a share from the table's.
const CLOSE: f64 = 0.02;

/// The number of the table's column of shares.
const SAMPLES: usize = 3;

/// Entry of the table for samples that cannot be counted.
const NOT_SAID: &str = "–";

/// Styles without a count: lavapipe counts nothing in secondary command buffers.
const NOT_COUNTED: &str = "the device has no inheritedQueries";

/// Rings at the centre of the view, never dropped.
const FIXED_RINGS: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n[chroma]\nmode = \"off\"\n";

/// Styles of every test: the most and the least that is saved, and one whose shaders return early.
const FEW: [&str; 3] = ["render-pass", "upscaled", "visibility"];

fn main() -> ExitCode {
    let wanted = expected().into_iter().filter(|(style, _)| is_full() || FEW.contains(&style.name));
    let table = column(SAMPLES);
    let engaged =
        wanted.filter(|(_, expected)| !matches!(expected, Ok(Expected::Refused(_) | Expected::NotRun)));
    let trials = engaged.filter_map(|(style, expected)| {
        let said = table.get(style.name).cloned().unwrap_or_default();
        let check = move || expected.map_err(Failed::from).and_then(|_| check(style, &said));
        (!table[style.name].starts_with(NOT_SAID))
            .then(|| trial(format!("{} shades less", style.name), check))
    });
    let trials = trials.collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn check(style: &Style, said: &str) -> Result<(), Failed> {
    let run = |layer: LayerMode| -> Result<Outcome, Failed> {
        let (size, frames) = (SIZE.to_string(), FRAMES.to_string());
        let arguments = ["--style", style.name, "--size", &size, "--frames", &frames];
        let application = Application::ours("parafovea-zoo", &arguments)?;
        let run = Run::new(&application, &Scenario::new(FRAMES).sized(SIZE, SIZE))
            .driver(driver(style))
            .two_queues(style.needs.queues.are_two())
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
    let (expected, reason) = match said.split_once(": ") {
        Some((expected, reason)) => (expected, Some(reason)),
        None => (said, None),
    };
    let expected: f64 = expected.parse()?;
    assert!(
        (share - expected).abs() < CLOSE,
        "{share:.3} of the samples, {expected} in the table\n{}",
        on.log
    );
    assert!(expected <= LIMIT || reason.is_some(), "the table does not say why {expected} is so much");
    Ok(())
}
