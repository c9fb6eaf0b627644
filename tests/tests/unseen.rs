//! The log and the status of an active application without visible effect give the reason, once.

use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

/// Two seconds after the last decision, and more.
const FRAMES: u64 = 240;
const NOTHING: &str = "preset = \"none\"\n";
const LINE: &str = "active, but without visible effect";

fn run(application: &Application, config: &str) -> Run {
    Run::new(application, &Scenario::new(FRAMES).sized(128, 128)).on(config)
}

fn log(application: &Application, config: &str) -> Vec<String> {
    lines(run(application, config), config)
}

fn lines(run: Run, config: &str) -> Vec<String> {
    let log = run.finish().unwrap().expect_frames(FRAMES).unwrap().log;
    let state = if config == NOTHING { "session inert" } else { "session active" };
    assert!(log.contains(state), "{log}");
    log.lines().filter(|line| line.contains(LINE)).map(str::to_owned).collect()
}

const RATES: &str =
    "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n";

#[test]
fn an_application_that_cannot_have_rates_says_why() {
    let lines = log(&prerecorded(), RATES);
    assert!(lines.len() == 1 && lines[0].contains("recorded before recognition"), "{lines:?}");
}

fn prerecorded() -> Application {
    Application::ours("parafovea-zoo", &["--style", "prerecorded", "--size", "128", "--frames", "240"])
        .unwrap()
}

/// The reason depends on the decisions of the Vulkan half, which is another copy of the library.
#[test]
fn halves_of_two_copies_of_the_library_say_why_too() {
    let lines = lines(run(&prerecorded(), RATES).from_copies(), RATES);
    assert!(lines.len() == 1 && lines[0].contains("recorded before recognition"), "{lines:?}");
}

/// Vulkan 1.0 has all that masks need.
#[test]
fn an_application_of_vulkan_1_0_has_masks() {
    assert_eq!(log(&Application::hello_xr("Vulkan2").unwrap(), RATES), [""; 0]);
}

/// The device is inert, which is logged when it is made.
#[test]
fn no_requested_technique_needs_no_line() {
    assert_eq!(log(&Application::hello_xr("Vulkan2").unwrap(), NOTHING), [""; 0]);
}

#[test]
fn coarse_rates_need_no_line() {
    let scene = Application::ours("parafovea-scene", &["--still"]).unwrap();
    assert_eq!(log(&scene, RATES), [""; 0]);
}
