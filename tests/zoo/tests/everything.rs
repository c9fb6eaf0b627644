//! Every style with everything on at once, on both backends, while head and eyes move: validation, with synchronization validation
//! across submits, finds nothing, and neither does the runtime.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/effort.rs"]
mod effort;
#[path = "common/trial.rs"]
mod trial;

use effort::{Effort, is_full, moving_gaze};
use libtest_mimic::{Arguments, Failed};
use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::run::{Application, Message, Run};
use parafovea_tests::scenario::ScenarioExt;
use parafovea_zoo::{STYLES, Style};
use std::process::ExitCode;
use trial::{driver, skip_unless_run, trial};

/// Arguments of every test.
const SHARE: Effort = Effort { frames: 54, size: 96 };

/// Duration of the first fixation, seconds: decisions by contrast take a quarter of a second for an octave, once the gaze is trusted.
const REST_S: f64 = 0.5;

/// Styles of every test: the most different ones in the order of the layer's work among their own.
const FEW: [&str; 8] = [
    "subpasses",
    "multiview",
    "imageless",
    "taa-exposure",
    "second-queue",
    "second-family",
    "render-thread",
    "dynamic-resolution",
];

/// Rates by contrast, re-use and chroma: every kernel has work, and every picture of ours is drawn to.
const EVERYTHING: &str = "[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
    [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n[debug]\nview = \"eccentricity\"\n";

/// Stand-in for a device with shading rates; None: the device unchanged, for masks.
type Device = Option<ShadingRateProfile>;

fn main() -> ExitCode {
    let profiles = ShadingRateProfile::ALL.into_iter().cycle();
    let trials = STYLES.iter().zip(profiles).flat_map(|(style, profile)| {
        let style: &'static Style = style;
        let is_wanted = is_full() || FEW.contains(&style.name);
        let devices: &[Device] = if is_wanted { &[None, Some(profile)] } else { &[] };
        devices
            .iter()
            .map(|&device| {
                let on = device.map_or("a mask", |profile| profile.name());
                trial(format!("{} on {on}, everything", style.name), move || check(style, device))
            })
            .collect::<Vec<_>>()
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}

fn check(style: &Style, device: Device) -> Result<(), Failed> {
    let effort = Effort::or_share(SHARE.frames, SHARE.size);
    let (size, frames) = (effort.size.to_string(), effort.frames.to_string());
    let application =
        Application::ours("parafovea-zoo", &["--style", style.name, "--size", &size, "--frames", &frames])?;
    let last = effort.frames - 1;
    let plain = Run::new(&application, &effort.scenario_of_moving_head().saving(&[last]))
        .driver(driver(style))
        .two_queues(style.needs.queues.are_two());
    let plain = match device {
        Some(profile) => plain.shading_rates(profile),
        None => plain,
    };
    let folder = tempfile::tempdir()?;
    let config = format!("{}{EVERYTHING}", moving_gaze(folder.path(), REST_S)?);
    let run = plain.clone().on(&config).validated_from(style.headers);
    let is_validated = run.is_validated();
    let on = run.finish()?;
    skip_unless_run(&on);
    let on = on.expect_frames(effort.frames)?;
    assert!(on.findings.vulkan_was_active || !is_validated, "validation was not there\n{}", on.output);
    let is_new = |found: &&Message| !found.is_of_stand_in();
    let found: Vec<&Message> = on.findings.vulkan.iter().filter(is_new).collect();
    assert!(found.is_empty(), "{found:#?}\n{}", on.log);
    assert!(on.findings.openxr.is_empty(), "{:#?}", on.findings.openxr);
    assert!(on.record.errors.is_empty(), "{:#?}", on.record.errors);
    assert!(on.complaints().is_empty(), "{}", on.log);
    let mut coarse = 0;
    for line in on.shading_rates()? {
        match line {
            ShadingRateLine::Finding(finding) => return Err(format!("{finding:?}").into()),
            ShadingRateLine::Pass(pass) => {
                let is_coarse = pass.map.is_some_and(|map| map.histogram.keys().any(|rate| rate != "1x1"));
                coarse += usize::from(is_coarse);
            }
        }
    }
    assert!(coarse > 0 || device.is_none(), "no pass became coarser\n{}", on.log);
    let off = plain.finish()?.expect_frames(effort.frames)?;
    for eye in 0..2 {
        assert!(off.submitted(eye, last)? != on.submitted(eye, last)?, "eye {eye}: nothing was done");
    }
    Ok(())
}
