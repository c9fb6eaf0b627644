//! The gaze of the layer's own sources for applications that ask for it (`gaze.offer`): an application on a runtime without eye gaze sees
//! what it would see on one that has it, and nothing of that without the option.

use crate::osc::{Sender, free_address, message, told};
use parafovea_cases::report::Report;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Gaze, Head, Scenario, ScenarioExt};
use std::path::Path;
use std::time::Duration;

/// Where the eyes look in the space of the head, degrees.
const LEFT: f32 = 17.0;
const UP: f32 = -8.5;

/// Angles and positions that are less apart are the same: 0.1 degrees, as parts of a quaternion, and as metres at arm's length.
const TOLERANCE: f64 = 0.000_87;

const EXTENSION: &str = "XR_EXT_eye_gaze_interaction";

/// A turned head, and eyes that look to one side.
fn with_eye_gaze() -> Scenario {
    let mut scenario = Scenario::new(1000).sized(64, 64).gazing(LEFT, UP);
    scenario.head = vec![Head {
        position: [0.3, 1.2, -0.4],
        yaw_deg: 40.0,
        pitch_deg: -12.0,
        roll_deg: 5.0,
        ..Head::default()
    }];
    scenario
}

fn without_eye_gaze() -> Scenario {
    let mut scenario = with_eye_gaze();
    scenario.system.eye_gaze = false;
    scenario.system.extensions_off = vec![EXTENSION.to_owned()];
    scenario
}

/// The gaze from a file, and nothing else that the layer does.
fn config(folder: &Path, script: &str, offer: bool) -> String {
    let file = folder.join("gaze.csv");
    std::fs::write(&file, script).unwrap();
    format!("preset = \"none\"\n[gaze]\noffer = {offer}\nsource = \"file\"\nfile = {file:?}\n")
}

fn constant() -> String {
    format!("0,{LEFT},{UP}\n")
}

fn run(case: &str, scenario: &Scenario, config: Option<&str>) -> Outcome {
    let application = Application::ours("parafovea-cases", &[case]).unwrap();
    let run = Run::new(&application, scenario).timeout(Duration::from_secs(60)).listing_eye_gaze();
    match config {
        Some(config) => run.on(config),
        None => run,
    }
    .finish()
    .unwrap()
}

fn report(outcome: &Outcome) -> Report {
    let report = outcome.output.lines().find_map(|line| serde_json::from_str(line).ok());
    report.unwrap_or_else(|| panic!("no report:\n{}\n{}", outcome.output, outcome.log))
}

/// Whether two lines are the same, up to the last digits of numbers. An orientation has two quaternions.
fn is_same(line: &str, other: &str) -> bool {
    let [words, others] = [line, other].map(|line| line.split(' ').collect::<Vec<_>>());
    let parts = |words: &[&str]| -> Vec<f64> { words.iter().filter_map(|word| word.parse().ok()).collect() };
    let texts = |words: &[&str]| -> Vec<String> {
        words.iter().filter(|word| word.parse::<f64>().is_err()).map(|word| (*word).to_owned()).collect()
    };
    let (numbers, other_numbers) = (parts(&words), parts(&others));
    let is_near = |sign: f64| {
        numbers.iter().zip(&other_numbers).enumerate().all(|(at, (a, b))| {
            let b = if at % 7 < 4 { b * sign } else { *b };
            (a - b).abs() < TOLERANCE
        })
    };
    texts(&words) == texts(&others) && numbers.len() == other_numbers.len() && (is_near(1.0) || is_near(-1.0))
}

#[test]
fn lines_with_other_numbers_differ() {
    let line = "gaze in VIEW: XR_SUCCESS 3 0.1 0.2 0.3 0.9 1 2 3";
    assert!(is_same(line, line) && is_same(line, "gaze in VIEW: XR_SUCCESS 3 0.1003 0.2 0.3 0.9 1 2 3"));
    for other in ["gaze in VIEW: XR_SUCCESS 3 0.102 0.2 0.3 0.9 1 2 3", "gaze in LOCAL: XR_SUCCESS 3 0.1 0.2"]
    {
        assert!(!is_same(line, other), "{other}");
    }
}

/// The trace of a case on a runtime with eye gaze is the trace on one without, with the layer.
fn check(case: &str, change: fn(&mut Scenario)) {
    let folder = tempfile::tempdir().unwrap();
    let (mut reference, mut scenario) = (with_eye_gaze(), without_eye_gaze());
    [&mut reference, &mut scenario].into_iter().for_each(change);
    let reference = run(case, &reference, None);
    let outcome = run(case, &scenario, Some(&config(folder.path(), &constant(), true)));
    let (expected, seen) = (report(&reference), report(&outcome));
    for (at, (line, other)) in expected.trace.iter().zip(&seen.trace).enumerate() {
        assert!(
            is_same(line, other),
            "{case} {at}:\n{line}\n{other}\nafter {:#?}\n{}",
            &seen.trace[at.saturating_sub(12)..at],
            outcome.log
        );
    }
    assert_eq!(expected.trace.len(), seen.trace.len());
    assert_eq!(expected.events, seen.events);
    assert_eq!(seen.unexpected, Vec::<String>::new());
    assert_eq!(outcome.exit_code, Some(0), "{}\n{}", outcome.output, outcome.log);
    // One case attaches its sets twice.
    assert_eq!(outcome.record.errors, reference.record.errors);
}

#[test]
fn an_application_finds_the_gaze_in_every_space() {
    check("finds_the_gaze_in_every_space", |_| {});
}

#[test]
fn an_application_looks_at_the_gaze_as_on_a_runtime_that_has_it() {
    for case in [
        "looks_at_the_gaze_itself",
        "looks_at_the_gaze_with_priority",
        "looks_at_the_gaze_in_two_sets",
        "tells_eyes_from_hands",
        "suggests_gaze_in_each_session",
        "own_eye_gaze",
    ] {
        check(case, |_| {});
    }
}

#[test]
fn without_focus_there_is_no_gaze() {
    check("looks_at_the_gaze_itself", |scenario| scenario.session.focused_from = 6);
}

#[test]
fn a_runtime_that_lists_the_extension_and_has_no_eye_tracker_is_helped_too() {
    let folder = tempfile::tempdir().unwrap();
    let case = "finds_the_gaze_in_every_space";
    let mut scenario = with_eye_gaze();
    scenario.system.eye_gaze = false;
    let expected = report(&run(case, &with_eye_gaze(), None));
    let outcome = run(case, &scenario, Some(&config(folder.path(), &constant(), true)));
    let seen = report(&outcome);
    let is_same = |(line, other): (&String, &String)| is_same(line, other);
    assert!(expected.trace.iter().zip(&seen.trace).all(is_same), "{:#?}\n{}", seen.trace, outcome.log);
    assert_eq!(expected.trace.len(), seen.trace.len());
}

#[test]
fn eyes_that_are_not_seen_have_no_pose() {
    let folder = tempfile::tempdir().unwrap();
    let case = "finds_the_gaze_in_every_space";
    let mut scenario = with_eye_gaze();
    scenario.gaze = vec![Gaze { tracked: false, ..scenario.gaze[0] }];
    let expected = report(&run(case, &scenario, None));
    let outcome = run(case, &without_eye_gaze(), Some(&config(folder.path(), "0\n", true)));
    let seen = report(&outcome);
    let poses = |report: &Report| -> Vec<String> {
        // Without a valid pose the numbers mean nothing.
        let lines =
            report.trace.iter().filter(|line| line.contains(" in ") && !line.contains("gaze in gaze"));
        lines.filter_map(|line| Some(line.split_once(" sampled")?.0.to_owned())).collect()
    };
    assert!(poses(&seen).len() > 30, "{:#?}\n{}", seen.trace, outcome.log);
    assert_eq!(poses(&expected), poses(&seen), "{}", outcome.log);
    // The action stays active through a blink.
    assert!(seen.trace.iter().any(|line| line.starts_with("pose:") && line.contains("active true")));
}

#[test]
fn nobody_gets_the_gaze_who_was_not_given_it() {
    let folder = tempfile::tempdir().unwrap();
    let case = "finds_the_gaze_in_every_space";
    let settings = config(folder.path(), &constant(), true);
    let centre = settings.replace("\"file\"", "\"centre\"");
    for config in [config(folder.path(), &constant(), false), centre, format!("enabled = false\n{settings}")]
    {
        let outcome = run(case, &without_eye_gaze(), Some(&config));
        let seen = report(&outcome);
        assert_eq!(outcome.exit_code, Some(0), "{config}\n{}\n{}", outcome.output, outcome.log);
        let tells = |line: &String| {
            let is_there = line.contains("eye gaze: true") || line.contains("active true");
            is_there || (line.starts_with("gaze in ") && line.contains("VALID"))
        };
        assert!(!seen.trace.iter().any(tells), "{config}\n{:#?}", seen.trace);
    }
}

#[test]
fn the_extension_is_listed_only_where_the_layer_is_installed_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let application = Application::ours("parafovea-cases", &["own_eye_gaze"]).unwrap();
    let config = config(folder.path(), &constant(), true);
    let plain = Run::new(&application, &without_eye_gaze()).on(&config).finish().unwrap();
    assert_ne!(plain.exit_code, Some(0), "{}", plain.output);
    let listing = Run::new(&application, &without_eye_gaze()).on(&config).listing_eye_gaze();
    assert_eq!(listing.finish().unwrap().exit_code, Some(0));
}

#[test]
fn an_application_that_does_not_ask_sees_and_causes_the_same_calls() {
    let folder = tempfile::tempdir().unwrap();
    let calls = |offer| {
        let mut scenario = without_eye_gaze();
        scenario.output.input = true;
        let config = config(folder.path(), &constant(), offer);
        let outcome = run("tells_hands_apart", &scenario, Some(&config));
        assert_eq!(outcome.exit_code, Some(0), "{}\n{}", outcome.output, outcome.log);
        let errors: Vec<_> = outcome.record.errors.iter().map(|error| error.call.clone()).collect();
        (report(&outcome), outcome.record.input, errors)
    };
    assert_eq!(calls(false), calls(true));
}

#[test]
fn packets_reach_the_application_and_the_status_says_so() {
    let address = free_address();
    let application =
        Application::ours("parafovea-scene", &["--lights", "0", "--foveation", "20,30,1/4"]).unwrap();
    let mut scenario = without_eye_gaze();
    scenario.session.frames = 1_000_000;
    let config = format!("[gaze]\noffer = true\nosc_listen = \"{address}\"\n[rates]\ngate = \"on\"\n");
    let running = Run::new(&application, &scenario).on(&config).listing_eye_gaze().start().unwrap();
    let before = told(&running, |status| status.frames > 3);
    assert!(!before.gaze.is_given, "{before:#?}");
    let sender = Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-UP, -LEFT])]);
    let given = told(&running, |status| status.gaze.is_given);
    assert!(given.gaze.to_string().contains("given to the application"), "{}", given.gaze);
    drop(sender);
    told(&running, |status| !status.gaze.is_given);
}
