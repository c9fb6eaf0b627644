//! The gaze of the layer's own sources for applications that ask for it (`gaze.offer`): an application on a runtime without eye gaze gets
//! the same results as on one with it, and no part of it without the option.

use crate::osc::{free_address, told};
use glam::{EulerRot, Quat};
use parafovea_manifest::gaze_correction::GazeCorrection;
use parafovea_manifest::paths::Environment;
use parafovea_tests::artifacts::target_folder;
use parafovea_tests::openxr_loader;
use parafovea_tests::osc::{Sender, message};
use parafovea_tests::run::{Application, LayerMode, Outcome, Run};
use parafovea_tests::scenario::{Gaze, Head, Picture, Scenario, ScenarioExt};
use parafovea_zoo::cases::report::Report;
use std::net::SocketAddr;
use std::path::Path;
use std::time::{Duration, Instant};

/// Direction of the gaze in the space of the head, degrees.
const LEFT: f32 = 17.0;
const UP: f32 = -8.5;

/// Angles and positions that are less apart are the same: 0.1 degrees, as parts of a quaternion, and as metres at arm's length.
const TOLERANCE: f64 = 0.000_87;

const EXTENSION: &str = "XR_EXT_eye_gaze_interaction";

/// A turned head, and eyes that look to one side.
pub fn with_eye_gaze() -> Scenario {
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

pub fn without_eye_gaze() -> Scenario {
    let mut scenario = with_eye_gaze();
    scenario.system.eye_gaze = false;
    scenario.system.extensions_off = vec![EXTENSION.to_owned()];
    scenario
}

/// The gaze from a file, and nothing else that the layer does.
pub fn config(folder: &Path, script: &str, offer: bool) -> String {
    let file = folder.join("gaze.csv");
    std::fs::write(&file, script).unwrap();
    format!("preset = \"none\"\n[gaze]\noffer = {offer}\nsource = \"file\"\nfile = {file:?}\n")
}

pub fn constant() -> String {
    format!("0,{LEFT},{UP}\n")
}

/// Cases of the application that are tested here alone.
pub const TESTED: &[&str] =
    &["finds_the_gaze_among_many_spaces", "shows_layers_in_the_gaze", "sees_the_gaze_come_and_go"];

fn run(case: &str, scenario: &Scenario, config: Option<&str>) -> Outcome {
    start(&[case], scenario, config).finish().unwrap()
}

pub fn start(arguments: &[&str], scenario: &Scenario, config: Option<&str>) -> Run {
    let application = Application::ours("parafovea-cases", arguments).unwrap();
    let run = Run::new(&application, scenario).timeout(Duration::from_secs(120)).listing_eye_gaze();
    match config {
        Some(config) => run.on(config),
        None => run,
    }
}

pub fn report(outcome: &Outcome) -> Report {
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
    check_run(&[case], change, |run| run);
}

fn check_run(arguments: &[&str], change: fn(&mut Scenario), way: impl Fn(Run) -> Run) -> [Outcome; 2] {
    let folder = tempfile::tempdir().unwrap();
    let (mut reference, mut scenario) = (with_eye_gaze(), without_eye_gaze());
    [&mut reference, &mut scenario].into_iter().for_each(change);
    let case = arguments[0];
    let reference = way(start(arguments, &reference, None)).finish().unwrap();
    let config = config(folder.path(), &constant(), true);
    let outcome = way(start(arguments, &scenario, Some(&config))).finish().unwrap();
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
    [reference, outcome]
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
fn an_application_finds_the_gaze_among_many_spaces() {
    let loader = openxr_loader::build(&target_folder().unwrap()).unwrap();
    let arguments = ["finds_the_gaze_among_many_spaces", "--openxr", "1.1"];
    let [_, outcome] = check_run(&arguments, |_| {}, |run| run.env("LD_LIBRARY_PATH", &loader));
    let lines = report(&outcome).trace;
    let is_found = |line: &&String| line.starts_with("one of many: XR_SUCCESS") && line.contains("Flags(15)");
    assert!(lines.iter().filter(is_found).count() > 30, "{lines:#?}");
}

#[test]
fn layers_in_the_gaze_are_shown_where_the_eyes_look() {
    // Both pictures of both kinds of frames, after the first ones.
    const SHOWN: [u64; 2] = [8, 9];
    let change = |scenario: &mut Scenario| {
        scenario.views.iter_mut().for_each(|view| (view.width, view.height) = (128, 128));
        scenario.output.save_frames = SHOWN.to_vec();
        scenario.output.save = vec![Picture::Eye];
    };
    let [reference, outcome] = check_run(&["shows_layers_in_the_gaze"], change, |run| run);
    let mut elsewhere = without_eye_gaze();
    change(&mut elsewhere);
    let folder = tempfile::tempdir().unwrap();
    let ahead = run("shows_layers_in_the_gaze", &elsewhere, Some(&config(folder.path(), "0,0,0\n", true)));
    for (frame, eye) in SHOWN.into_iter().flat_map(|frame| [(frame, 0), (frame, 1)]) {
        let differs_from_reference = |outcome: &Outcome| {
            let [expected, seen] = [&reference, outcome].map(|outcome| outcome.eye(eye, frame).unwrap());
            expected.enumerate().filter(|(x, y, pixel)| seen.at(*x, *y) != *pixel).count()
        };
        // Edges fall on other pixels where a pose differs by the rounding of its numbers.
        assert!(differs_from_reference(&outcome) < 100, "{frame} {eye}: {}", outcome.log);
        assert!(differs_from_reference(&ahead) > 1000, "{frame} {eye}");
    }
}

/// Gaze direction in the packets; the correction turns it to [`LEFT`] and [`UP`].
const SENT: [f32; 2] = [LEFT - 4.0, UP + 2.5];

fn offers_packets(address: SocketAddr) -> String {
    format!("[gaze]\noffer = true\nosc_listen = \"{address}\"\noffset_deg = \"1, 0.5\"\n")
}

/// A folder of state with a correction of packets by the rest of the way.
fn corrected(scenario: &Scenario) -> tempfile::TempDir {
    let state = tempfile::tempdir().unwrap();
    let environment = Environment::new(false, |name| (name == "XDG_STATE_HOME").then(|| state.path().into()));
    let correction = GazeCorrection::new(&scenario.system.name, "osc", [3.0, -3.0], 0.1);
    correction.write(&GazeCorrection::file(&environment, &scenario.system.name).unwrap()).unwrap();
    state
}

/// The orientation that the application saw when the gaze came is that of the eyes.
fn assert_corrected(outcome: &Outcome) {
    let report = report(outcome);
    let come = report.trace.iter().find(|line| line.starts_with("come: XR_SUCCESS"));
    let come = come.unwrap_or_else(|| panic!("{:#?}\n{}", report.trace, outcome.log));
    let numbers: Vec<f32> = come.split(' ').filter_map(|word| word.parse().ok()).collect();
    let expected = Quat::from_euler(EulerRot::YXZ, LEFT.to_radians(), UP.to_radians(), 0.0);
    let seen = Quat::from_slice(&numbers[..4]);
    assert!(seen.angle_between(expected).to_degrees() < 0.1, "{come}");
    let gone = report.trace.iter().find(|line| line.starts_with("gone: ")).unwrap();
    assert!(gone.starts_with("gone: XR_SUCCESS SpaceLocationFlags(0) "), "{gone}");
    assert_eq!(outcome.exit_code, Some(0), "{}\n{}", outcome.output, outcome.log);
}

#[test]
fn the_offered_gaze_is_corrected_and_can_be_withdrawn_at_any_time() {
    let address = free_address();
    let mut scenario = without_eye_gaze();
    scenario.session.frames = 1_000_000;
    let state = corrected(&scenario);
    let config = offers_packets(address);
    let run = start(&["sees_the_gaze_come_and_go"], &scenario, Some(&config));
    let running = run.env("XDG_STATE_HOME", state.path()).start().unwrap();
    let _sender =
        Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-SENT[1], -SENT[0]])])
            .unwrap();
    told(&running, |status| status.gaze.is_given);
    // The sender goes on.
    std::fs::write(running.config_file(), config.replace("offer = true", "offer = false")).unwrap();
    assert_corrected(&running.finish().unwrap());
}

#[test]
fn a_session_that_is_inert_has_the_correction_too() {
    let address = free_address();
    let mut scenario = without_eye_gaze();
    scenario.session.frames = 1_000_000;
    let state = corrected(&scenario);
    let application = Application::ours("parafovea-cases", &["sees_the_gaze_come_and_go"]).unwrap();
    let run = Run::new(&application, &scenario).timeout(Duration::from_secs(120)).listing_eye_gaze();
    let run = run.layer(LayerMode::OpenXrHalf(offers_packets(address))).env("XDG_STATE_HOME", state.path());
    let running = run.start().unwrap();
    // A tracker that comes and goes by itself: an inert session does not report whether it gives the gaze.
    let begun = Instant::now();
    let _sender = Sender::moving(address, move || match begun.elapsed().as_secs() % 6 {
        0..3 => message("/tracking/eye/CenterPitchYaw", &[-SENT[1], -SENT[0]]),
        _ => message("/jawOpen", &[1.0]),
    })
    .unwrap();
    let inert =
        told(&running, |status| !status.inert.is_empty() && status.gaze_correction.correction.is_some());
    assert_eq!(inert.frames, 0);
    assert_corrected(&running.finish().unwrap());
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
    let sender =
        Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-UP, -LEFT])]).unwrap();
    let given = told(&running, |status| status.gaze.is_given);
    assert!(given.gaze.to_string().contains("given to the application"), "{}", given.gaze);
    drop(sender);
    told(&running, |status| !status.gaze.is_given);
}

/// The contents of all files below a folder, as far as they are text.
fn written(folder: &Path, into: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        match path.is_dir() {
            true => written(&path, into),
            false => {
                into.extend(std::fs::read(&path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
            }
        }
    }
}

/// The gaze goes to the application alone, at the most talkative level of the log.
#[test]
fn no_file_has_the_gaze_that_an_application_gets() {
    // Digits that are found nowhere else.
    let [left, up] = [17.329_41f32, -6.813_27];
    let turned = Quat::from_euler(EulerRot::YXZ, left.to_radians(), up.to_radians(), 0.0);
    let direction = turned * glam::Vec3::NEG_Z;
    let numbers = [left, up, left.to_radians(), up.to_radians(), direction.x, direction.y, direction.z];
    let signs: Vec<String> = numbers.iter().map(|number| format!("{:.4}", number.abs())).collect();
    let address = free_address();
    let mut scenario = without_eye_gaze();
    scenario.session.frames = 1_000_000;
    let state = tempfile::tempdir().unwrap();
    let config = format!("[gaze]\noffer = true\nosc_listen = \"{address}\"\n[log]\nlevel = \"debug\"\n");
    let run = start(&["keeps_states_until_it_synchronises"], &scenario, Some(&config));
    let running = run.env("XDG_STATE_HOME", state.path()).start().unwrap();
    let sender =
        Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-up, -left])]).unwrap();
    let status = told(&running, |status| status.gaze.is_given);
    let mut texts = vec![running.log(), format!("{status:?}"), status.gaze.to_string()];
    written(&running.runtime_folder(), &mut texts);
    drop(sender);
    let outcome = running.finish().unwrap();
    written(state.path(), &mut texts);
    texts.push(outcome.log);
    assert!(texts.len() > 4 && texts.iter().any(|text| text.contains("OSC")), "{}", texts.len());
    for (sign, text) in signs.iter().flat_map(|sign| texts.iter().map(move |text| (sign, text))) {
        assert!(!text.contains(sign.as_str()), "{sign} is in:\n{text}");
    }
}
