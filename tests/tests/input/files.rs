//! A gaze from a file drives a run, the same in every one; and a recording can be played.

use super::{following, run, scenario};
use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Gaze, Scenario, ScenarioExt};
use std::path::Path;

const FRAMES: u64 = 120;

/// Rates that follow the gaze of a file.
fn rates(source: &str) -> String {
    format!("[gaze]\nsource = {source}\n[rates]\ngate = \"on\"\n")
}

fn scene(config: &str, scenario: &Scenario) -> Outcome {
    let application = Application::ours("parafovea-scene", &["--lights", "0"]).unwrap();
    let run = Run::new(&application, scenario).shading_rates(ShadingRateProfile::NvkTuring).on(config);
    run.finish().unwrap().expect_frames(FRAMES).unwrap()
}

/// The maps of all passes, in order.
fn maps(outcome: &Outcome) -> Vec<String> {
    let lines = outcome.shading_rates().unwrap();
    let passes = lines.into_iter().map(|line| match line {
        ShadingRateLine::Pass(pass) => pass,
        ShadingRateLine::Finding(finding) => panic!("{finding:?}"),
    });
    passes.map(|pass| pass.map.unwrap().texels.unwrap()).collect()
}

fn looking_around() -> Scenario {
    let mut scenario = Scenario::new(FRAMES).sized(128, 128);
    let at = |t, yaw_deg, tracked| Gaze { t, yaw_deg, pitch_deg: 3.0, tracked };
    scenario.gaze = vec![
        at(0.0, -20.0, true),
        at(0.7, -20.0, true),
        at(0.73, 15.0, true),
        at(1.0, 15.0, false),
        at(1.1, 15.0, true),
    ];
    scenario
}

fn played(file: &Path) -> String {
    rates(&format!("\"file\"\nfile = {file:?}"))
}

#[test]
fn a_gaze_by_hand_drives_a_run_the_same_way_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gaze.csv");
    std::fs::write(&file, "# a look to the left, then to the right\n0,25,0\n0.75,25,0\n0.78,-25,0\n")
        .unwrap();
    // The gaze of the headset's own tracker moves differently, and has no effect.
    let runs = [looking_around(), Scenario::new(FRAMES).sized(128, 128)]
        .map(|scenario| maps(&scene(&played(&file), &scenario)));
    assert_eq!(runs[0], runs[1]);
    let half = runs[0].len() / 2;
    let is_coarse = |map: &String| map.contains("0a");
    let [first, last] = [runs[0][half].clone(), runs[0][runs[0].len() - 1].clone()];
    assert!(is_coarse(&first) && is_coarse(&last), "{first} {last}");
    assert_ne!(first, last, "the gaze moved");
    std::fs::write(&file, "0,-25,0\n").unwrap();
    let other = maps(&scene(&played(&file), &looking_around()));
    assert!(is_coarse(&other[half]) && other[half] != first, "{first} {}", other[half]);
}

#[test]
fn a_recording_drives_a_run_as_the_eyes_did() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gaze.csv");
    let eyes = scene(&rates(&format!("\"eyes\"\nrecord = {file:?}")), &looking_around());
    assert!(eyes.log.contains("recording the gaze"), "{}", eyes.log);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.lines().count() > FRAMES as usize / 2, "{text}");

    let copy = folder.path().join("again.csv");
    let play = |record: &Path| {
        maps(&scene(
            &rates(&format!("\"file\"\nfile = {file:?}\nrecord = {record:?}")),
            &Scenario::new(FRAMES).sized(128, 128),
        ))
    };
    let again = play(&copy);
    assert_eq!(again, play(&folder.path().join("third.csv")));
    // The played gaze is recorded unchanged, where the eyes were tracked.
    let seen = |path: &Path| -> Vec<[f64; 3]> {
        let text = std::fs::read_to_string(path).unwrap();
        let line = |line: &str| {
            let numbers: Vec<f64> = line.split(',').filter_map(|number| number.parse().ok()).collect();
            <[f64; 3]>::try_from(numbers).ok()
        };
        text.lines().filter_map(line).collect()
    };
    let (recorded, replayed) = (seen(&file), seen(&copy));
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
    let known = recorded.iter().filter(|line| replayed.iter().any(|other| near(line, other))).count();
    assert!(recorded.len() > 30 && known * 10 >= recorded.len() * 9, "{recorded:?}\n{replayed:?}");
}

#[test]
fn without_a_file_that_can_be_used_there_is_no_gaze_and_the_log_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gaze.csv");
    std::fs::write(&file, "left,right\n").unwrap();
    let application = Application::ours("parafovea-cases", &["attaches_early"]).unwrap();
    let config = following("").replace("\"eyes\"", &format!("\"file\"\nfile = {file:?}"));
    let outcome = run(&application, &scenario(1000), Some(&config));
    assert_eq!(outcome.exit_code, Some(0), "{}", outcome.output);
    assert!(outcome.log.contains("gaze.csv") && outcome.log.contains("line 1"), "{}", outcome.log);
}
