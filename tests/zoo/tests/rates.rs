//! Every style on a device that looks as if it had shading rates, with rings that stay where they are: the passes of an
//! eye buffer have coarser texels once they are known, all others none, and all that is done is right for the extension.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/drawn.rs"]
mod drawn;
#[path = "common/effort.rs"]
mod effort;
#[path = "common/trial.rs"]
mod trial;

use drawn::{AS_PUBLISHED, PERIOD, check_history, compare};
use effort::{Effort, is_full, moving_gaze};
use libtest_mimic::{Arguments, Failed};
use parafovea_test_layers::{
    SHADING_RATE_TEXELS_VARIABLE, ShadingRateFinding, ShadingRateLine, ShadingRateMap, ShadingRatePass,
    ShadingRateProfile,
};
use parafovea_tests::run::{Application, Message, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use parafovea_zoo::{Eyes, History, PassTruth, STYLES, Style};
use std::process::ExitCode;
use trial::{driver, skip_unless_run, trial};

/// Arguments of every test.
const SHARE: Effort = Effort { frames: 8, size: 96 };

/// From this frame on all passes are known, and their maps are resolved from the plan.
const COARSE_FROM: u64 = 4;

/// Greatest shaded part of the pixels of an eye's image in an engaged style: texels of the map by their rates.
const LIMIT: f64 = 0.9;

/// Rings at the centre of the view, never dropped: the same rates in every run.
const FIXED_RINGS: &str = "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n";

fn main() -> ExitCode {
    let profiles = ShadingRateProfile::ALL.into_iter().cycle();
    let trials = STYLES.iter().zip(profiles).flat_map(|(style, profile)| {
        let style: &'static Style = style;
        let run_on = |gaze: MapOf, profile: ShadingRateProfile| {
            trial(format!("{} on {}, {gaze:?}", style.name, profile.name()), move || {
                check(style, profile, gaze)
            })
        };
        if is_full() {
            let all = ShadingRateProfile::ALL.into_iter();
            all.flat_map(|profile| [MapOf::StillGaze, MapOf::MovingGaze].map(|gaze| run_on(gaze, profile)))
                .collect()
        } else {
            vec![run_on(MapOf::StillGaze, profile)]
        }
    });
    // One style keeps rates of its own.
    let of_reuse = STYLES.iter().filter(|style| match is_full() {
        true => style.name != "own-vrs",
        false => REUSED.contains(&style.name),
    });
    let reused = of_reuse.zip(ShadingRateProfile::ALL.into_iter().cycle()).map(|(style, profile)| {
        trial(format!("{} on {}, re-used", style.name, profile.name()), move || check_reuse(style, profile))
    });
    let left_alone = WITHOUT_RATES.into_iter().map(|case| trial(case.0, move || check_left_alone(case)));
    let matched = ATTACHED_ONCE_MATCHED.into_iter().map(|name| {
        trial(format!("{name}, attached once matched"), move || check_attached_once_matched(name))
    });
    let off = trial("dynamic-rendering, not attached while rates are off", check_not_attached_while_off);
    let with_holes = WITH_HOLES
        .into_iter()
        .map(|case| trial(format!("{}, draws with holes", case.0), move || check_holes(case)));
    let at_full_rate = AT_FULL_RATE
        .into_iter()
        .map(|case| trial(format!("{}, at full rate", case.0), move || check_full_rate(case)));
    let by_viewport = trial("viewport-scale, around the gaze", check_viewport_scale);
    let all = trials
        .chain([by_viewport])
        .chain(reused)
        .chain(left_alone)
        .chain(matched)
        .chain([off])
        .chain(with_holes)
        .chain(at_full_rate);
    libtest_mimic::run(&Arguments::from_args(), all.collect()).exit_code()
}

/// Styles whose periphery is re-used in every test: on this backend all take the same way.
const REUSED: [&str; 6] = [
    "render-pass",
    "dynamic-rendering",
    "multiview",
    "double-wide",
    "offscreen-tonemap",
    "dynamic-resolution",
];

/// In a part of a target, the rates go around the middle of that part, wherever it is.
fn check_viewport_scale() -> Result<(), Failed> {
    const EFFORT: Effort = Effort { frames: 14, size: 384 };
    let style = parafovea_zoo::style("viewport-scale").ok_or("no such style")?;
    let outcome = Run::new(&application(style, EFFORT)?, &EFFORT.scenario())
        .shading_rates(ShadingRateProfile::NvkTuring)
        .env(SHADING_RATE_TEXELS_VARIABLE, "1")
        .on(FIXED_RINGS)
        .finish()?
        .expect_frames(EFFORT.frames)?;
    let (findings, seen) = lines(outcome.shading_rates()?);
    assert_eq!(findings, []);
    let truth = (0..EFFORT.frames)
        .flat_map(|frame| (style.passes)([EFFORT.size; 2], frame).into_iter().map(move |pass| (frame, pass)));
    for (seen, (frame, truth)) in seen.iter().zip(truth) {
        if frame < COARSE_FROM || truth.is_passed_on() {
            continue;
        }
        let map = seen.map.as_ref().ok_or("a map that was not read in time")?;
        let texels = map.texels.as_ref().ok_or("texels that were not kept")?;
        let is_fine = |[x, y]: [u32; 2]| {
            let at = 2 * (y * map.extent[0] + x) as usize;
            &texels[at..at + 2] == "00"
        };
        let [columns, rows] = truth.viewport.map(|side| side / 16);
        assert!(is_fine([columns / 2, rows / 2]), "frame {frame}, {truth:?}: coarse in the middle");
        for corner in [[0, 0], [columns - 1, 0], [0, rows - 1], [columns - 1, rows - 1]] {
            assert!(!is_fine(corner), "frame {frame}, {truth:?}: fine at {corner:?}");
        }
    }
    Ok(())
}

/// Tiles that are left out are shaded as coarsely as can be, and shown as they were drawn before.
fn check_reuse(style: &Style, profile: ShadingRateProfile) -> Result<(), Failed> {
    let effort = Effort::or_share(12, SHARE.size);
    // As for masks.
    let last = effort.frames - 2;
    let saved: Vec<u64> = (last + 1 - PERIOD..=last).collect();
    let scenario = effort.scenario().saving(&saved);
    let on = run(style, effort, profile, AS_PUBLISHED, scenario.clone())?;
    skip_unless_run(&on);
    let on = on.expect_frames(effort.frames)?;
    let is_new = |found: &&Message| !found.is_of_stand_in();
    let messages: Vec<&Message> = on.findings.vulkan.iter().filter(is_new).collect();
    assert!(messages.is_empty(), "{messages:#?}");
    assert!(on.record.errors.is_empty(), "{:#?}", on.record.errors);
    let (findings, seen) = lines(on.shading_rates()?);
    assert_eq!(findings, []);
    let is_left_out = seen.iter().filter_map(|pass| pass.map.as_ref()).any(is_coarse);
    assert!(is_left_out || style.history != History::None, "nothing was left out\n{}", on.log);
    check_history(style, &on.log);
    let has_two = style.needs.queues.are_two();
    let off = Run::new(&application(style, effort)?, &scenario)
        .driver(driver(style))
        .two_queues(has_two)
        .finish()?;
    let off = off.expect_frames(effort.frames)?;
    for eye in 0..2 {
        let off =
            saved.iter().rev().map(|frame| off.submitted(eye, *frame)).collect::<Result<Vec<_>, _>>()?;
        compare(style, eye, &on.submitted(eye, last)?, &off);
    }
    Ok(())
}

/// Gaze of the rate map.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum MapOf {
    /// The centre of the view.
    StillGaze,
    /// A direction that changes all the time.
    MovingGaze,
}

/// Settings of a user with which nothing becomes coarser by a rate attachment; whether passes have one all the same, and the lines of the
/// log.
const WITHOUT_RATES: [(&str, &str, bool, &str); 3] = [
    ("passes that the profile excludes", "passes = \"exclude 96x96\"", true, "session active"),
    ("another backend", "backend = \"mask\"", false, "scene passes of 96x96: masked"),
    ("no rates", "mode = \"off\"", false, "inert: the configuration enables nothing"),
];

fn check_left_alone((_, option, has_attachments, says): (&str, &str, bool, &str)) -> Result<(), Failed> {
    let style = parafovea_zoo::style("render-pass").ok_or("no such style")?;
    let config = format!("{FIXED_RINGS}{option}\n");
    let outcome = run(style, SHARE, ShadingRateProfile::NvkTuring, &config, SHARE.scenario())?;
    let outcome = outcome.expect_frames(SHARE.frames)?;
    assert!(outcome.log.contains(says), "{}", outcome.log);
    let (findings, seen) = lines(outcome.shading_rates()?);
    assert_eq!(findings, []);
    assert_eq!(seen.len() as u64, if has_attachments { 2 * SHARE.frames } else { 0 });
    assert!(!seen.iter().filter_map(|pass| pass.map.as_ref()).any(is_coarse), "{seen:#?}");
    Ok(())
}

/// Styles with draws that cut holes, by discard or by alpha to coverage; all draws of the scene's pass, and draws without holes.
const WITH_HOLES: [(&str, [u32; 2]); 3] =
    [("foliage", [3, 2]), ("taa", [3, 2]), ("alpha-to-coverage", [2, 1])];

/// Draws with holes stay at 1x1 in coarse passes, the others do not, and the log reports it.
fn check_holes((name, [draws, obeying]): (&str, [u32; 2])) -> Result<(), Failed> {
    let style = parafovea_zoo::style(name).ok_or("no such style")?;
    let outcome = run(style, SHARE, ShadingRateProfile::NvkTuring, FIXED_RINGS, SHARE.scenario())?;
    skip_unless_run(&outcome);
    let outcome = outcome.expect_frames(SHARE.frames)?;
    assert!(outcome.log.contains("draws with alpha test (discard) or alpha to coverage: shaded at 1x1"));
    let (findings, seen) = lines(outcome.shading_rates()?);
    assert_eq!(findings, []);
    let coarse: Vec<_> = seen.iter().filter(|pass| pass.map.as_ref().is_some_and(is_coarse)).collect();
    assert!(coarse.len() as u64 >= 2 * (SHARE.frames - COARSE_FROM), "{} passes are coarse", coarse.len());
    for pass in coarse {
        assert_eq!([pass.draws, pass.draws_obeying], [draws, obeying], "{pass:#?}");
    }
    Ok(())
}

/// Styles with draws at full rate, and the cause in the log.
const AT_FULL_RATE: [(&str, &str); 2] = [
    ("frag-depth", "depth or stencil from the fragment shader"),
    ("visibility", "integers in colour attachments"),
];

/// The log names the cause once, and causes of depth passes, which have no rates, never.
fn check_full_rate((name, draws): (&str, &str)) -> Result<(), Failed> {
    let style = parafovea_zoo::style(name).ok_or("no such style")?;
    let outcome = run(style, SHARE, ShadingRateProfile::NvkTuring, FIXED_RINGS, SHARE.scenario())?;
    skip_unless_run(&outcome);
    let outcome = outcome.expect_frames(SHARE.frames)?;
    let lines = |text: &str| outcome.log.matches(text).count();
    let named = lines(&format!("draws with {draws}: shaded at 1x1, as "));
    assert_eq!([named, lines(": shaded at 1x1, as ")], [1; 2], "{}", outcome.log);
    Ok(())
}

/// Styles of dynamic rendering.
const ATTACHED_ONCE_MATCHED: [&str; 2] = ["dynamic-rendering", "proton"];

/// On a device where an attachment alone costs time, passes have one from the frame on in which they are known.
fn check_attached_once_matched(name: &str) -> Result<(), Failed> {
    let style = parafovea_zoo::style(name).ok_or("no such style")?;
    let outcome = run_attached_once_matched(style, FIXED_RINGS)?;
    for says in [
        "quirk attach-only-matched: ",
        "PARAFOVEA_QUIRKS: unknown quirk none-such; allowed: attach-only-matched",
    ] {
        assert!(outcome.log.contains(says), "{}", outcome.log);
    }
    let messages: Vec<&Message> =
        outcome.findings.vulkan.iter().filter(|found| !found.is_of_stand_in()).collect();
    assert!(messages.is_empty(), "{messages:#?}");
    let (findings, seen) = lines(outcome.shading_rates()?);
    assert_eq!(findings, []);
    let coarse = seen.iter().filter_map(|pass| pass.map.as_ref()).filter(|map| is_coarse(map)).count() as u64;
    let frames_known = SHARE.frames - COARSE_FROM;
    assert!(coarse >= 2 * frames_known, "{coarse} passes are coarse\n{}", outcome.log);
    let scene_passes = 2 * SHARE.frames;
    assert!((seen.len() as u64) < scene_passes, "{} passes have an attachment", seen.len());
    Ok(())
}

/// On such a device, recognised passes have none either while rates are off.
fn check_not_attached_while_off() -> Result<(), Failed> {
    let style = parafovea_zoo::style("dynamic-rendering").ok_or("no such style")?;
    let outcome = run_attached_once_matched(style, "[gaze]\nsource = \"centre\"\n[rates]\ngate = \"off\"\n")?;
    assert!(outcome.log.contains("session active"), "{}", outcome.log);
    let (findings, seen) = lines(outcome.shading_rates()?);
    assert_eq!(findings, []);
    assert_eq!(seen.len(), 0, "passes with an attachment: {seen:#?}");
    Ok(())
}

/// On a device where an attachment alone costs time.
fn run_attached_once_matched(style: &Style, config: &str) -> Result<Outcome, Failed> {
    let outcome = Run::new(&application(style, SHARE)?, &SHARE.scenario())
        .driver(driver(style))
        .validated_from(style.headers)
        .shading_rates(ShadingRateProfile::NvkTuring)
        .env("PARAFOVEA_QUIRKS", "attach-only-matched,none-such")
        .on(config)
        .finish()?;
    skip_unless_run(&outcome);
    Ok(outcome.expect_frames(SHARE.frames)?)
}

fn run(
    style: &Style,
    effort: Effort,
    profile: ShadingRateProfile,
    config: &str,
    scenario: Scenario,
) -> Result<Outcome, Failed> {
    let run = Run::new(&application(style, effort)?, &scenario)
        .driver(driver(style))
        .validated_from(style.headers)
        .two_queues(style.needs.queues.are_two())
        .shading_rates(profile);
    Ok(run.on(config).finish()?)
}

fn application(style: &Style, effort: Effort) -> Result<Application, Failed> {
    let (size, frames) = (effort.size.to_string(), effort.frames.to_string());
    Ok(Application::ours("parafovea-zoo", &["--style", style.name, "--size", &size, "--frames", &frames])?)
}

fn check(style: &Style, profile: ShadingRateProfile, gaze: MapOf) -> Result<(), Failed> {
    let effort = Effort::or_share(SHARE.frames, SHARE.size);
    let folder = tempfile::tempdir()?;
    let config = match gaze {
        MapOf::StillGaze => FIXED_RINGS.to_owned(),
        MapOf::MovingGaze => format!("{}[rates]\ngate = \"on\"\n", moving_gaze(folder.path(), 0.0)?),
    };
    let outcome = run(style, effort, profile, &config, effort.scenario())?;
    skip_unless_run(&outcome);
    let outcome = outcome.expect_frames(effort.frames)?;
    let is_new = |found: &&Message| !found.is_of_stand_in();
    let messages: Vec<&Message> = outcome.findings.vulkan.iter().filter(is_new).collect();
    assert!(messages.is_empty(), "{messages:#?}");
    assert!(outcome.record.errors.is_empty(), "{:#?}", outcome.record.errors);

    let (findings, seen) = lines(outcome.shading_rates()?);
    assert_eq!(findings, []);
    let truth: Vec<(u64, PassTruth)> = (0..effort.frames)
        .flat_map(|frame| (style.passes)([effort.size; 2], frame).into_iter().map(move |pass| (frame, pass)))
        .filter(|(_, pass)| has_rates(pass))
        .collect();
    assert_eq!(seen.len(), truth.len(), "passes with a rate attachment");
    if truth.iter().any(|(_, pass)| is_elsewhere(pass)) {
        // Which of two devices writes its lines first is chance.
        assert!(seen.iter().filter_map(|pass| pass.map.as_ref()).any(is_coarse), "no pass became coarser");
        return Ok(());
    }
    assert!(seen.iter().filter_map(|pass| pass.map.as_ref()).any(is_coarse), "no pass became coarser");
    for (seen, (frame, truth)) in seen.iter().zip(&truth) {
        let map = seen.map.as_ref().ok_or("a map that was not read in time")?;
        let is_coarse = is_coarse(map);
        let is_eyes = truth.eyes != Eyes::None && !holds_numbers(truth) && !truth.is_passed_on();
        // Where the eyes look elsewhere, coarseness comes and goes.
        let may_be_fine = *frame < COARSE_FROM || gaze == MapOf::MovingGaze;
        let is_right = if is_eyes { is_coarse || may_be_fine } else { !is_coarse };
        if !is_right {
            return Err(format!("frame {frame}, {truth:?}: {map:#?}\n{}", outcome.log).into());
        }
        if is_eyes && !may_be_fine {
            let share = shaded_share(map)?;
            assert!(share < LIMIT, "frame {frame}, {truth:?}: {share} is shaded");
        }
    }
    Ok(())
}

fn lines(lines: Vec<ShadingRateLine>) -> (Vec<ShadingRateFinding>, Vec<ShadingRatePass>) {
    let (mut findings, mut passes) = (Vec::new(), Vec::new());
    for line in lines {
        match line {
            ShadingRateLine::Finding(finding) => findings.push(finding),
            ShadingRateLine::Pass(pass) => passes.push(pass),
        }
    }
    (findings, passes)
}

fn is_coarse(map: &ShadingRateMap) -> bool {
    map.histogram.keys().any(|rate| rate != "1x1")
}

/// Fragments for each pixel, where every texel of the map is covered once.
fn shaded_share(map: &ShadingRateMap) -> Result<f64, Failed> {
    let (mut shaded, mut texels) = (0.0, 0.0);
    for (rate, &count) in &map.histogram {
        let (width, height) = rate.split_once('x').ok_or("not a rate")?;
        shaded += f64::from(count) / (width.parse::<f64>()? * height.parse::<f64>()?);
        texels += f64::from(count);
    }
    Ok(shaded / texels)
}

/// Whether a pass is on a device without a session.
fn is_elsewhere(pass: &PassTruth) -> bool {
    pass.why == "on another device"
}

/// Passes that draw colour have a rate attachment.
fn has_rates(pass: &PassTruth) -> bool {
    !format!("{:?}", pass.format).starts_with('D')
}

/// A coarse number would be another object's.
fn holds_numbers(pass: &PassTruth) -> bool {
    format!("{:?}", pass.format).ends_with("UINT")
}
