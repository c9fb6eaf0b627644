//! Status of running applications, as `parafovea status` reads it.

use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Decision, Found, Status, Topic, read_all};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::artifacts::program;
use parafovea_tests::run::{Application, Run, Running};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// More frames than any of these renders meanwhile.
const FRAMES: u64 = 100_000;

/// Long enough on a machine that does much else.
const PATIENCE: Duration = Duration::from_secs(120);

fn run(application: &Application) -> Run {
    let scenario = Scenario::new(FRAMES).sized(256, 256).gazing(-10.0, 0.0);
    let config = "preset = \"none\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n[gaze]\nsource = \"centre\"\n";
    Run::new(application, &scenario).on(config)
}

fn start(application: &Application) -> Running {
    run(application).start().unwrap()
}

/// Its status, once it meets the condition; panics if it never does.
fn told(running: &Running, is_so: impl Fn(&Status) -> bool) -> Status {
    let begin = Instant::now();
    let environment =
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| running.runtime_folder().into()));
    loop {
        let found = read_all(&environment, SystemTime::now()).found;
        match found.as_slice() {
            [Found { status, .. }] if is_so(status) => return status.clone(),
            other => assert!(begin.elapsed() < PATIENCE, "{other:#?}\n{}", running.log()),
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn is_decided(status: &Status, topic: Topic) -> bool {
    status.decided(topic).next().is_some()
}

fn tells_what_it_does(application: &Application) {
    let running = start(application);
    let status = told(&running, |status| status.passes_matched > 0 && status.rates.shaded < 1.0);
    assert_eq!((status.inert.as_str(), status.backend.as_str()), ("", "mask"), "{status:#?}");
    assert!(is_decided(&status, Topic::Scene) && is_decided(&status, Topic::Mask), "{status:#?}");
    assert!(status.frames > 0 && status.frame_rate_hz > 0.0, "{status:#?}");
    assert!(status.gaze.is_valid && status.gaze.source == "centre", "{status:#?}");
    assert_eq!(status.sound.source, "off");
    let all: f32 = status.rates.tiles.iter().map(|(_, share)| share).sum();
    assert!((all - 1.0).abs() < 0.05 && status.rates.tiles.len() > 1, "{status:#?}");
    assert_eq!((status.rates_gate.mode.as_str(), status.rates_gate.is_kept), ("on", true));
    assert_eq!(status.reuse_gate.mode, "off");
    // It goes on: another second, other numbers.
    told(&running, |later| later.frames > status.frames);
    let folder = running.runtime_folder().join("parafovea");
    let file = folder.join(format!("{}.json", status.pid));
    assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);

    let mut command = Command::new(program("parafovea").unwrap());
    command.args(["status", "--once"]).env("XDG_RUNTIME_DIR", running.runtime_folder());
    let output = String::from_utf8(command.output().unwrap().stdout).unwrap();
    for expected in [
        &*status.application,
        "backend   mask",
        "gaze      fixed around the axis of each lens",
        "rates     on, because of rates.gate",
    ] {
        assert!(output.contains(expected), "{expected} in\n{output}");
    }
    // It ends with this.
    drop(running);
}

#[test]
fn hello_xr_of_vulkan_1_0_has_masks() {
    let running = start(&Application::hello_xr("Vulkan2").unwrap());
    let status = told(&running, |status| is_decided(status, Topic::Mask));
    assert_eq!((status.application.as_str(), status.backend.as_str()), ("HelloXR", "mask"), "{status:#?}");
    let is_left = |decision: &Decision| decision.line.contains("left eye");
    assert!(status.decided(Topic::Scene).any(is_left), "{status:#?}");
}

/// The decisions of one copy's Vulkan half are in the status of the other copy's OpenXR half.
#[test]
fn halves_of_two_copies_of_the_library_tell_their_decisions() {
    let running = run(&Application::hello_xr("Vulkan2").unwrap()).from_copies().start().unwrap();
    told(&running, |status| is_decided(status, Topic::Scene) && is_decided(status, Topic::Mask));
}

#[test]
fn our_scene_tells() {
    tells_what_it_does(&Application::ours("parafovea-scene", &[]).unwrap());
}

#[test]
fn styles_of_the_zoo_tell() {
    for style in ["render-pass", "dynamic-rendering", "double-wide"] {
        let frames = FRAMES.to_string();
        let arguments = ["--style", style, "--size", "256", "--frames", &frames];
        tells_what_it_does(&Application::ours("parafovea-zoo", &arguments).unwrap());
    }
}

/// Output of `parafovea status` for an application, second after second, until it has shown three other numbers of frames.
fn refreshed(running: &Running) -> String {
    let mut command = Command::new(program("parafovea").unwrap());
    command.arg("status").env("XDG_RUNTIME_DIR", running.runtime_folder()).stdout(Stdio::piped());
    let mut shows = command.spawn().unwrap();
    let (mut text, mut frames) = (String::new(), Vec::new());
    for line in BufReader::new(shows.stdout.take().unwrap()).lines() {
        let line = line.unwrap();
        if let Some((_, count)) = line.strip_suffix(" in total").and_then(|line| line.rsplit_once(", ")) {
            frames.push(count.parse::<u64>().unwrap());
        }
        text += &line;
        text.push('\n');
        frames.dedup();
        if frames.len() > 3 {
            break;
        }
    }
    shows.kill().unwrap();
    shows.wait().unwrap();
    assert!(frames.is_sorted() && frames.len() > 3, "{frames:?} in\n{text}");
    text
}

/// hello_xr, for which the device is made to look as if it had rates, our scene, and three styles of rendering.
#[test]
fn savings_are_measured_and_updated_every_second() {
    const AUTO: &str = "preset = \"none\"\n[rates]\nmode = \"fixed\"\n[gaze]\nsource = \"centre\"\n";
    let scenario = Scenario::new(FRAMES).sized(128, 128);
    let start = |application: Application| Run::new(&application, &scenario).on(AUTO);
    let frames = FRAMES.to_string();
    let style = |style| {
        let arguments = ["--style", style, "--size", "128", "--frames", &frames];
        (start(Application::ours("parafovea-zoo", &arguments).unwrap()), "mask")
    };
    let hello_xr = start(Application::hello_xr("Vulkan2").unwrap());
    for (run, backend) in [
        (hello_xr.shading_rates(ShadingRateProfile::NvkTuring), "rate attachment"),
        (start(Application::ours("parafovea-scene", &[]).unwrap()), "mask"),
        style("render-pass"),
        style("dynamic-rendering"),
        style("double-wide"),
    ] {
        let running = run.start().unwrap();
        // The gate may have dropped rates before the first status: flat shading gains nothing.
        let has_effect = |status: &Status| status.passes_matched > 0 || !status.rates_gate.is_kept;
        let status = told(&running, |status| status.rates_gate.ratio.is_some() && has_effect(status));
        assert_eq!(status.backend, backend, "{status:#?}");
        let text = refreshed(&running);
        let has = |line: &str| text.lines().any(|found| found.trim_start().starts_with(line));
        assert!(has(&format!("backend   {backend}")), "{text}");
        assert!(
            ["on", "dropped"]
                .iter()
                .any(|state| ["a", "no"].iter().any(|effect| has(&format!("rates     {state}: {effect} ")))),
            "{text}"
        );
        assert!(
            text.contains(" with shading rates in the last frame") && text.contains(": the scene: "),
            "{text}"
        );
    }
}

#[test]
fn ended_applications_are_not_listed() {
    let scenario = Scenario::new(30).sized(256, 256);
    let application = Application::hello_xr("Vulkan2").unwrap();
    let running = Run::new(&application, &scenario).on("[rates]\ngate = \"off\"\n").start().unwrap();
    let folder = running.runtime_folder().join("parafovea");
    let outcome = running.finish().unwrap().expect_frames(30).unwrap();
    assert!(outcome.log.contains("session active"), "{}", outcome.log);
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 0, "files that are left");
}
