//! Whole applications that were not written for this test: hello_xr, our scene, and the zoo.

use super::{assert_ours_is_first, following, gaze_reads, input_at_the_runtime, new_errors, run, scenario};
use parafovea_tests::run::{Application, Outcome, is_of_late_hello_xr};
use parafovea_tests::scenario::Scenario;

const FRAMES: u64 = 40;

/// Its output, without parts that differ in every run: times of day and addresses; and without messages of loaders about layers.
fn printed(outcome: &Outcome) -> Vec<String> {
    let without_numbers_of_a_run = |line: &str| -> String {
        let rest =
            line.strip_prefix('[').and_then(|line| line.split_once(']')).map_or(line, |(_, rest)| rest);
        rest.split(' ').filter(|word| !word.contains("0x")).collect::<Vec<_>>().join(" ")
    };
    let is_of_layers = |line: &&str| {
        ["Validation", "Layer", "LAYER", "libparafovea.so", "Loader Message"]
            .iter()
            .any(|word| line.contains(word))
    };
    let is_told = |line: &&str| !is_of_layers(line) && !is_of_late_hello_xr(line);
    let of_input = outcome.output.lines().filter(is_told);
    // A thread of hello_xr prints this line at no fixed time.
    of_input.filter(|line| !line.contains("Press any key")).map(without_numbers_of_a_run).collect()
}

fn check(application: &Application, is_followed: bool, errors: &[&str], change: fn(&mut Scenario)) {
    let mut scenario = scenario(FRAMES);
    change(&mut scenario);
    let reference = run(application, &scenario, None).expect_frames(FRAMES).unwrap();
    let outcome = run(application, &scenario, Some(&following(""))).expect_frames(FRAMES).unwrap();
    assert_eq!(printed(&reference), printed(&outcome), "{}", outcome.log);
    assert_eq!(input_at_the_runtime(&reference), input_at_the_runtime(&outcome));
    assert_eq!(new_errors(&reference, &outcome), errors, "{}", outcome.log);
    assert_ours_is_first(&outcome);
    assert_eq!(gaze_reads(&outcome) > gaze_reads(&reference), is_followed, "{}", outcome.log);
}

fn hello_xr(graphics: &str) -> Application {
    Application::hello_xr(graphics).unwrap()
}

fn scene(arguments: &[&str]) -> Application {
    Application::ours("parafovea-scene", arguments).unwrap()
}

fn zoo(style: &str) -> Application {
    let frames = FRAMES.to_string();
    let arguments = ["--style", style, "--size", "64", "--frames", &frames];
    Application::ours("parafovea-zoo", &arguments).unwrap()
}

#[test]
fn hello_xr_keeps_its_hands() {
    check(&hello_xr("Vulkan2"), true, &[], |_| {});
    // The runtime reports its mistakes to it: there are none more.
    check(&hello_xr("Vulkan"), true, &[], |scenario| scenario.session.focused_from = 9);
}

#[test]
fn hello_xr_on_a_runtime_that_refuses_the_extension() {
    let refused = ["xrCreateInstance XR_ERROR_EXTENSION_NOT_PRESENT"];
    check(&hello_xr("Vulkan2"), false, &refused, |scenario| {
        scenario.quirks.refused_extensions = vec!["XR_EXT_eye_gaze_interaction".to_owned()];
    });
}

#[test]
fn our_scene_keeps_its_hands() {
    check(&scene(&["--lights", "0"]), true, &[], |_| {});
}

#[test]
fn our_scene_follows_the_gaze_itself() {
    check(&scene(&["--lights", "0", "--foveation", "20,30,1/4"]), true, &[], |_| {});
}

#[test]
fn our_scene_without_actions_is_left_alone_at_first() {
    check(&scene(&["--lights", "0", "--no-actions"]), false, &[], |_| {});
}

#[test]
fn the_zoo_has_no_input_and_learns_of_none() {
    for style in ["render-pass", "render-thread"] {
        check(&zoo(style), false, &[], |_| {});
    }
}

#[test]
fn a_gaze_at_the_centre_misses_no_eye_tracker() {
    let config = following("").replace("\"eyes\"", "\"centre\"");
    let outcome = run(&hello_xr("Vulkan2"), &scenario(FRAMES), Some(&config)).expect_frames(FRAMES).unwrap();
    assert!(outcome.log.contains("gaze fixed around the axis of each lens ("), "{}", outcome.log);
    assert!(!outcome.log.contains("no eye tracker"), "{}", outcome.log);
}
