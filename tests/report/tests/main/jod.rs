//! The judge in JOD, with a program in place of Python.

use crate::made_up::{results, results_with_jod};
use parafovea_models::errors::fvvdp::Fvvdp;
use parafovea_report::page::{contests, page};
use parafovea_report::pictures::Pictures;
use parafovea_report::plan::Plan;
use parafovea_report::points::{Extent, Sweep, points};
use parafovea_report::results::Results;
use parafovea_report::statistics::Bootstrap;
use parafovea_report::verdict::{EVERYTHING, Measure, Verdict, contest, tallies};
use parafovea_report::{measure, table};
use parafovea_scene::scene::SceneName;
use parafovea_tests::measure::Effort;
use std::path::PathBuf;
use std::process::Command;
use tempfile::TempDir;

/// The program by another name, which is that of its defect.
fn python(name: &str) -> (TempDir, PathBuf) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/src/errors/fvvdp/fake_python.sh");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::os::unix::fs::symlink(script, &path).unwrap();
    (folder, path)
}

#[test]
fn a_python_without_the_package_is_refused_before_any_measurement() {
    let (_folder, path) = python("without-pyfvvdp");
    let mut report = Command::new(env!("CARGO_BIN_EXE_parafovea-report"));
    let output = report.arg("--quick").arg("--jod").arg(&path).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let reason = "cannot import pyfvvdp: ModuleNotFoundError: No module named 'pyfvvdp'";
    assert_eq!(said, format!("error: --jod {}: {reason}\n", path.display()));
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn pictures_and_maps_are_judged_in_every_gaze_script() {
    let (_folder, path) = python("python3");
    let wanted = ["off", "render scale 0.5"];
    let points =
        points(Extent::All).into_iter().filter(|point| wanted.contains(&point.technique.name.as_str()));
    let timed = Effort { turns: 1, run_up: 10, frames: 4, size: 64 };
    let mut plan = Plan {
        scenes: vec![SceneName::Courtyard],
        points: points.collect(),
        scripts: 2,
        timed,
        judged: timed,
        fvvdp: Some(Fvvdp::of(&path).unwrap()),
        ..Plan::quick()
    };
    plan.points.iter_mut().for_each(|point| point.is_timed = false);
    plan.hardware.retain(|point| point.sweep == Sweep::FixedFoveation);
    let folder = tempfile::tempdir().unwrap();
    let mut pictures = Pictures::new(folder.path()).unwrap();
    let (results, _) = measure(&plan, "cargo dev report", &mut pictures).unwrap();

    assert_eq!(results.conditions.fvvdp.as_deref(), Some("1.2.2"));
    let differences = |scene: &parafovea_report::results::SceneResults, name: &str| {
        scene.point(name).unwrap().errors.as_ref().unwrap().fvvdp.clone().unwrap().by_frame
    };
    let once = [1.0, 0.25, 1.0 / 9.0, 1.0 / 16.0];
    let near = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}");
    };
    near(&differences(&results.scenes[0], "render scale 0.5"), &once);
    assert!(results.scenes[0].off().unwrap().jod().is_none());
    for name in ["render scale 0.5", "FR L3-C3 of the paper"] {
        near(&differences(&results.hardware[0], name), &[once, once].concat());
    }
}

#[test]
fn the_frames_of_saccades_are_not_in_it() {
    let mut scene = results_with_jod().scenes.remove(0);
    let point = scene.points.iter_mut().find(|point| point.technique == EVERYTHING).unwrap();
    let before = point.jod().unwrap();
    let errors = point.errors.as_mut().unwrap();
    errors.fvvdp.as_mut().unwrap().by_frame[7] = 1e6;
    errors.in_flight = (0..errors.loss.len()).map(|frame| frame == 7).collect();
    let after = point.jod().unwrap();
    assert!((before - after).abs() < 0.05, "{before} became {after}");
}

/// Ours loses less by one measure, and more by another.
#[test]
fn a_win_by_jod_is_told_apart() {
    let mut scene = results_with_jod().scenes.remove(0);
    let verdict = |scene: &_, measure| {
        let found = contest(scene, EVERYTHING, Sweep::FixedFoveation, measure, &Bootstrap::default());
        found.map(|contest| contest.verdict)
    };
    assert_eq!(Measure::ALL.map(|measure| verdict(&scene, measure)), [Some(Verdict::Wins); 3]);
    let errors = scene.points.iter_mut().find(|point| point.technique == EVERYTHING).unwrap();
    let fvvdp = errors.errors.as_mut().unwrap().fvvdp.as_mut().unwrap();
    fvvdp.by_frame.iter_mut().for_each(|difference| *difference *= 100.0);
    let expected = [Some(Verdict::Wins), Some(Verdict::Wins), Some(Verdict::Loses)];
    assert_eq!(Measure::ALL.map(|measure| verdict(&scene, measure)), expected);
    assert_eq!(verdict(&results().scenes[0], Measure::Jod), None, "nobody asked for it");
}

#[test]
fn it_is_in_every_output_that_was_asked_for_and_in_no_other() {
    let html = |results: &Results| {
        let folder = tempfile::tempdir().unwrap();
        page(results, &[], &Pictures::new(folder.path()).unwrap()).unwrap()
    };
    let [mut without, mut with] = [results(), results_with_jod()];
    for results in [&mut without, &mut with] {
        results.hardware = results.scenes.clone();
    }
    let written = |results: &Results| {
        let json =
            table::json_rows(results).iter().map(|row| format!("{} {}\n", row.metric, row.unit)).collect();
        [table::markdown(results, &[]), table::csv(results).unwrap(), html(results), json]
    };
    for text in written(&without).iter().chain([&serde_json::to_string(&without).unwrap()]) {
        assert!(!["JOD", "jod", "fvvdp", "FovVideoVDP"].iter().any(|word| text.contains(word)), "{text}");
    }

    let [markdown, csv, page, json] = written(&with);
    // Contrast loss of 0.4, of which the differences are squares.
    let is_of_it = |row: &&str| row.starts_with("| preset balanced | ") && row.ends_with(" | 9.60 |");
    assert_eq!(markdown.lines().filter(is_of_it).count(), 4, "by rates, the mean and two scenes: {markdown}");
    assert!(
        markdown.contains(" | detected in saccades, JND | JOD |\n|---|---:|---:|---:|---:|---:|\n"),
        "{markdown}"
    );
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(reader.headers().unwrap().iter().next_back(), Some("jod"));
    let last: Vec<String> = reader.records().map(|record| record.unwrap()[19].to_owned()).collect();
    assert_eq!(last[0], "", "the application alone");
    assert!((last[5].parse::<f64>().unwrap() - 9.6).abs() < 0.01, "{last:?}");
    assert!(page.contains("<th>JOD</th>") && page.contains("by FovVideoVDP 1.2.2"), "{page}");
    assert!(json.contains("jod JOD\n"), "{json}");
    let tallies = tallies(&contests(&with.scenes));
    assert!(tallies.iter().any(|tally| tally.measure == Measure::Jod) && page.contains(", by JOD</th>"));
}
