//! Every style with the layer on: the passes that the layer noted match the style's ground truth, and from frame 4 on each is
//! recognised as its kind.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/effort.rs"]
#[allow(dead_code, reason = "each test uses a part of it")]
mod effort;
#[path = "common/noted.rs"]
mod noted;
#[path = "common/trial.rs"]
mod trial;

use effort::Effort;
use libtest_mimic::{Arguments, Failed};
use noted::Noted;
use parafovea_tests::run::{Application, Run};
use parafovea_zoo::{Eyes, PassTruth, STYLES, Style};
use std::process::ExitCode;
use trial::{driver, skip_unless_run, trial};

/// From this frame on the passes are known; nothing is taken for the scene before that is not.
const KNOWN_FROM: u64 = 4;

fn main() -> ExitCode {
    let trials = STYLES.iter().map(|style| {
        let style: &'static Style = style;
        trial(style.name, || check(style))
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}

fn check(style: &Style) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("passes.jsonl");
    let effort = Effort::or_share(8, 64);
    let (size, frames) = (effort.size.to_string(), effort.frames.to_string());
    let arguments = ["--style", style.name, "--size", &size, "--frames", &frames];
    let application = Application::ours("parafovea-zoo", &arguments)?;
    let scenario = effort.scenario();
    let outcome = Run::new(&application, &scenario)
        .driver(driver(style))
        .validated_from(style.headers)
        .two_queues(style.needs.queues.are_two())
        .on("")
        .env("PARAFOVEA_PASSES_FILE", &file)
        .finish()?;
    skip_unless_run(&outcome);
    let outcome = outcome.expect_frames(effort.frames)?;
    assert!(outcome.findings.vulkan.is_empty(), "{:#?}", outcome.findings.vulkan);
    assert!(outcome.record.errors.is_empty(), "{:#?}", outcome.record.errors);

    let noted = Noted::read(&file)?;
    let truth: Vec<(u64, PassTruth)> = (0..effort.frames)
        .flat_map(|frame| (style.passes)([effort.size; 2], frame).into_iter().map(move |pass| (frame, pass)))
        .filter(|(_, pass)| !is_elsewhere(pass))
        .collect();
    assert_eq!(noted.len(), truth.len(), "passes");
    for (noted, (frame, truth)) in noted.iter().zip(&truth) {
        let is_this = (noted.frame, noted.extent, noted.area) == (*frame, truth.extent, truth.area)
            && (noted.layers, noted.samples) == (truth.layers, truth.samples)
            && noted.format == format!("{:?}", truth.format);
        assert!(is_this, "noted {noted:?}\nis {truth:?}");
        assert!(is_right(noted, truth), "frame {frame}: taken for {noted:?}\nis {truth:?}");
    }
    Ok(())
}

/// Whether a pass is on a device without a session, which the layer does not follow.
fn is_elsewhere(pass: &PassTruth) -> bool {
    pass.why == "on another device"
}

/// Whether a pass is recognised as its kind. An image that serves one eye after the other is both eyes': the finer rate of both
/// applies. Passes without colours that could be coarser (depth, numbers) are left alone for any eye.
fn is_right(noted: &Noted, truth: &PassTruth) -> bool {
    let is_left_alone = noted.why.starts_with("no colour") || noted.why.contains("is not a colour format");
    let expected: &[&str] = match truth.eyes {
        Eyes::Left => &["left", "both"],
        Eyes::Right => &["right", "both"],
        Eyes::Both => &["both"],
        Eyes::None => &["none"],
    };
    // A pass that hands the picture on and shades nothing stays at 1x1, once that is known.
    let is_passed_on = truth.is_passed_on() && noted.why.starts_with("a full-screen pass");
    expected.contains(&noted.eyes.as_str())
        || is_passed_on
        || (noted.eyes == "none" && (is_left_alone || noted.frame < KNOWN_FROM))
}
