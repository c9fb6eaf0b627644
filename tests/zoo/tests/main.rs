//! Every style on the mock runtime, under validation: no messages, the passes of its ground truth, the same images
//! in every run, and images like `render-pass`'s if it has a `likeness`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/trial.rs"]
mod trial;

use libtest_mimic::{Arguments, Failed};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_zoo::{PassSeen, STYLES, Style};
use std::process::ExitCode;
use std::sync::OnceLock;
use trial::{driver, skip_unless_run, trial};

const FRAMES: u64 = 8;
const SIZE: u32 = 64;
const SAVED: [u64; 3] = [0, 3, 7];

fn main() -> ExitCode {
    let trials = STYLES.iter().map(|style| {
        let style: &'static Style = style;
        trial(style.name, || check(style))
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}

fn check(style: &Style) -> Result<(), Failed> {
    let (outcome, is_validated) = run(style);
    skip_unless_run(&outcome);
    assert!(
        outcome.findings.vulkan_was_active || !is_validated,
        "validation was not there\n{}",
        outcome.output
    );
    let outcome = outcome.expect_frames(FRAMES)?;
    assert!(outcome.findings.vulkan.is_empty(), "{:#?}", outcome.findings.vulkan);
    assert!(outcome.findings.openxr.is_empty(), "{:#?}", outcome.findings.openxr);
    assert!(outcome.record.errors.is_empty(), "{:#?}", outcome.record.errors);
    let seen: Vec<PassSeen> =
        outcome.output.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let truth = |frame| (style.passes)([SIZE; 2], frame).into_iter().map(move |pass| pass.seen(frame));
    assert_eq!(seen, (0..FRAMES).flat_map(truth).collect::<Vec<_>>(), "passes");
    let shown = pictures(&outcome);
    assert!(shown == pictures(&run(style).0), "two runs differ");
    if let Some(bound) = style.likeness {
        static REFERENCE: OnceLock<Vec<Picture>> = OnceLock::new();
        let reference = REFERENCE.get_or_init(|| pictures(&run(STYLES[0]).0));
        let difference = mean_difference(reference, &shown);
        assert!(difference <= bound, "{difference} code values away from render-pass");
        println!("{}: {difference:.4} code values from render-pass", style.name);
    }
    for picture in &shown {
        assert!(variance(picture) > 300.0, "nearly nothing is shown: variance {}", variance(picture));
    }
    Ok(())
}

/// Also whether it was validated.
fn run(style: &Style) -> (Outcome, bool) {
    let (size, frames) = (SIZE.to_string(), FRAMES.to_string());
    let arguments = ["--style", style.name, "--size", &size, "--frames", &frames, "--passes"];
    let application = Application::ours("parafovea-zoo", &arguments).unwrap();
    let scenario = Scenario::new(FRAMES).sized(SIZE, SIZE).saving(&SAVED);
    let run = Run::new(&application, &scenario)
        .driver(driver(style))
        .validated_from(style.headers)
        .two_queues(style.needs.queues.are_two());
    // The one extension that there is a stand-in for.
    let run = if style.needs.extensions.contains(&c"VK_KHR_fragment_shading_rate") {
        run.shading_rates(ShadingRateProfile::NvkTuring)
    } else {
        run
    };
    let is_validated = run.is_validated();
    (run.finish().unwrap(), is_validated)
}

/// Submitted images of both eyes in the saved frames.
fn pictures(outcome: &Outcome) -> Vec<Picture> {
    let saved = SAVED.into_iter().flat_map(|frame| [(0, frame), (1, frame)]);
    saved.map(|(view, frame)| outcome.submitted(view, frame).unwrap()).collect()
}

/// Over all pixels and colour channels, in code values.
fn mean_difference(a: &[Picture], b: &[Picture]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        assert_eq!((a.width, a.height), (b.width, b.height));
        for (a, b) in a.pixels.iter().zip(&b.pixels) {
            for channel in 0..3 {
                sum += f64::from(a[channel].abs_diff(b[channel]));
                count += 1.0;
            }
        }
    }
    sum / count
}

/// Of the green channel, in square code values.
fn variance(picture: &Picture) -> f64 {
    let values: Vec<f64> = picture.pixels.iter().map(|pixel| f64::from(pixel[1])).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
}
