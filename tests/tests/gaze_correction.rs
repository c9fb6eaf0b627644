//! `parafovea gaze recentre` and `calibrate`: the offset or the distortion of an eye tracker is measured in a running application, stored,
//! and removed from the gaze.

use crate::osc::{FRAMES, config, free_address, last_map, long, start, told};
use parafovea_core::gaze::{DOTS_DEG, GazePolynomial};
use parafovea_manifest::gaze_correction::{GazeCalibration, GazeCorrection};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::read_all;
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::artifacts::program;
use parafovea_tests::osc::{Sender, message};
use parafovea_tests::run::{Application, Run, Running};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::SystemTime;

/// A tracker with a scale of 1.1, turned by 2 degrees and off by 3 degrees, of eyes that look so far to the left and upwards.
fn distorted([left, up]: [f32; 2]) -> [f32; 2] {
    let (sin, cos) = 2f32.to_radians().sin_cos();
    [1.1 * (cos * left - sin * up) + 3.0, 1.1 * (sin * left + cos * up)]
}

/// The offset of the tracker, degrees to the left and upwards.
const OFFSET: [f32; 2] = [3.0, -1.0];

fn parafovea(running: &Running, state: &Path, arguments: &[&str]) -> Output {
    command(running, state, arguments).output().unwrap()
}

fn command(running: &Running, state: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(program("parafovea").unwrap());
    command.arg("gaze").args(arguments);
    command.env("XDG_RUNTIME_DIR", running.runtime_folder()).env("XDG_STATE_HOME", state);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// An application on a headset with an eye tracker that is off by [`OFFSET`].
fn follows_the_eyes(scenario: &Scenario) -> Running {
    let config = config("auto", free_address()).replace("[gaze]\n", "[gaze]\nattach_alone_after_s = 1\n");
    let running = start(&config, scenario);
    told(&running, |status| status.gaze.holder == "eyes" && status.frames > 0);
    running
}

#[test]
fn an_offset_is_measured_stored_shown_and_reset() {
    let [left, up] = OFFSET;
    let running = follows_the_eyes(&long().gazing(left, up));
    let file =
        PathBuf::from(told(&running, |status| !status.gaze_correction.file.is_empty()).gaze_correction.file);
    let state = file.ancestors().nth(3).unwrap();
    let output = parafovea(&running, state, &["recentre"]);
    let (shown, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{shown}{errors}{}", running.log());
    assert!(shown.contains("corrected by 3.0 degrees to the right and 1.0 degrees upwards"), "{shown}");
    assert!(shown.contains(&*file.to_string_lossy()) && shown.contains("--reset"), "{shown}");
    let stored = GazeCorrection::read(&file).unwrap().unwrap();
    assert_eq!((stored.offset_deg, stored.source.as_str()), ([-left, -up], "eyes"));
    // The dot goes.
    told(&running, |status| status.debug_view.name == "none" && !status.debug_view.is_asked);
    let shown = text(&parafovea(&running, state, &["--once"]).stdout);
    assert!(shown.contains("  corrected by 3.0 degrees to the right"), "{shown}");

    let output = parafovea(&running, state, &["recentre", "--reset"]);
    assert_eq!(text(&output.stdout), format!("removed {}\n", file.display()));
    told(&running, |status| status.gaze_correction.correction.is_none());

    std::fs::write(&file, "{").unwrap();
    let before = told(&running, |_| running.log().contains("correction of the eye tracker ignored: "));
    let after = told(&running, |status| status.frames > before.frames && status.gaze.is_valid);
    assert_eq!(after.gaze_correction.correction, None);
    assert_eq!(running.log().matches("correction of the eye tracker ignored: ").count(), 1);
}

#[test]
fn a_gaze_far_from_the_dot_is_refused_with_the_reason() {
    let running = follows_the_eyes(&long().gazing(12.0, 5.0));
    let file =
        PathBuf::from(told(&running, |status| !status.gaze_correction.file.is_empty()).gaze_correction.file);
    let output = parafovea(&running, file.ancestors().nth(3).unwrap(), &["recentre"]);
    assert!(!output.status.success());
    let errors = text(&output.stderr);
    assert!(errors.contains("unchanged: the gaze was 13 degrees from the dot"), "{errors}");
    assert!(!file.exists());
}

#[test]
fn a_distortion_is_measured_with_nine_dots_and_removed() {
    let address = free_address();
    let running = start(&config("osc", address), &long().in_real_time());
    let runtime = running.runtime_folder().to_owned();
    let environment =
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| runtime.clone().into()));
    // The eyes follow the dot.
    let _sender = Sender::moving(address, move || {
        let found = read_all(&environment, SystemTime::now()).found;
        let dot = found.first().map_or(0, |found| found.status.gaze_correction.dot);
        let [left, up] = distorted(DOTS_DEG[dot.saturating_sub(1) as usize]);
        message("/tracking/eye/CenterPitchYaw", &[-up, -left])
    })
    .unwrap();
    told(&running, |status| status.gaze.holder == "osc" && status.gaze.is_valid);
    let file = told(&running, |status| !status.gaze_correction.file.is_empty()).gaze_correction.file;
    let (file, state) = (Path::new(&file), Path::new(&file).ancestors().nth(3).unwrap());
    let output = parafovea(&running, state, &["calibrate"]);
    let (shown, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{shown}{errors}{}", running.log());
    assert!(
        shown.contains("dot 9 of 9\n") && shown.contains("The gaze is now calibrated: expected error 0."),
        "{shown}"
    );
    let stored = GazeCorrection::read(file).unwrap().unwrap();
    let calibration = stored.calibration.unwrap();
    assert_eq!((stored.offset_deg, stored.source.as_str()), ([0.0; 2], "osc"));
    assert!(calibration.error_before_deg > 2.5, "{calibration:?}");
    let polynomial = GazePolynomial::new(calibration.coefficients_deg, calibration.area_deg).unwrap();
    for eyes in [[0.0, 0.0], [11.0, 8.0], [-7.0, 5.0], [4.0, -8.0]] {
        let [left, up] = polynomial.corrected(distorted(eyes));
        assert!((left - eyes[0]).hypot(up - eyes[1]) < 0.5, "{eyes:?}: {left} {up}");
    }
    let shown = text(&parafovea(&running, state, &["--once"]).stdout);
    assert!(shown.contains("  corrected calibrated: expected error 0."), "{shown}");
    // The present correction is as good.
    let output = parafovea(&running, state, &["calibrate"]);
    assert!(
        text(&output.stderr).contains("unchanged: a new correction would be off by 0.0 degrees"),
        "{output:?}"
    );
    // Nothing of the gaze.
    let log = running.log();
    assert!(log.contains("the eye tracker was calibrated") && !log.contains("degrees"), "{log}");
    let output = parafovea(&running, state, &["calibrate", "--reset"]);
    assert_eq!(text(&output.stdout), format!("removed {}\n", file.display()));
    told(&running, |status| status.gaze_correction.correction.is_none());
}

#[test]
fn an_interrupted_measurement_changes_nothing_and_removes_the_dot() {
    let [left, up] = OFFSET;
    let running = follows_the_eyes(&long().in_real_time().gazing(left, up));
    let file =
        PathBuf::from(told(&running, |status| !status.gaze_correction.file.is_empty()).gaze_correction.file);
    let mut command = command(&running, file.ancestors().nth(3).unwrap(), &["recentre"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    told(&running, |status| status.gaze_correction.is_measuring);
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    let errors = text(&output.stderr);
    assert!(
        !output.status.success() && errors.contains("interrupted: the correction is unchanged"),
        "{errors}"
    );
    let status = told(&running, |status| !status.gaze_correction.is_measuring && !status.debug_view.is_asked);
    assert_eq!((status.gaze_correction.correction, file.exists()), (None, false));
}

#[test]
fn eyes_that_do_not_follow_the_dots_change_nothing() {
    let running = follows_the_eyes(&long().gazing(2.0, 1.0));
    let file =
        PathBuf::from(told(&running, |status| !status.gaze_correction.file.is_empty()).gaze_correction.file);
    let output = parafovea(&running, file.ancestors().nth(3).unwrap(), &["calibrate"]);
    assert!(!output.status.success());
    let errors = text(&output.stderr);
    assert!(errors.contains("unchanged: the gaze was more than 10 degrees from the dots at"), "{errors}");
    assert!(!file.exists());
}

#[test]
fn a_stored_correction_moves_the_rates_of_its_source_alone() {
    let [left, up] = OFFSET;
    // Inverse of the distortion, in units of 10 degrees.
    let (sin, cos) = 2f32.to_radians().sin_cos();
    let calibration = || GazeCalibration {
        coefficients_deg: [
            [-3.0 * cos / 1.1, 10.0 * (cos / 1.1 - 1.0), 10.0 * sin / 1.1, 0.0, 0.0, 0.0],
            [3.0 * sin / 1.1, -10.0 * sin / 1.1, 10.0 * (cos / 1.1 - 1.0), 0.0, 0.0, 0.0],
        ],
        area_deg: [[-20.0, -20.0], [20.0, 20.0]],
        error_deg: 0.1,
        error_before_deg: 3.0,
        dots_deg: [[0.1; 2]; 9],
    };
    let rates_of = |stored_for: Option<(&str, Option<GazeCalibration>)>, [left, up]: [f32; 2]| {
        let state = tempfile::tempdir().unwrap();
        let scenario = Scenario::new(FRAMES).sized(128, 128);
        if let Some((source, calibration)) = stored_for {
            let environment =
                Environment::new(false, |name| (name == "XDG_STATE_HOME").then(|| state.path().into()));
            let headset = &scenario.system.name;
            let offset = OFFSET.map(|angle| -angle);
            let correction = GazeCorrection::new(headset, source, offset, 0.1).with_calibration(calibration);
            correction.write(&GazeCorrection::file(&environment, headset).unwrap()).unwrap();
        }
        let address = free_address();
        let _sender =
            Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-up, -left])]).unwrap();
        let application = Application::ours("parafovea-scene", &["--lights", "0"]).unwrap();
        let run = Run::new(&application, &scenario).shading_rates(ShadingRateProfile::NvkTuring);
        let run = run.env("XDG_STATE_HOME", state.path()).on(&config("osc", address));
        last_map(&run.finish().unwrap().expect_frames(FRAMES).unwrap())
    };
    let look = [-12.0, 9.0];
    let off = [look[0] + left, look[1] + up];
    let expected = rates_of(None, look);
    assert_eq!(rates_of(Some(("osc", None)), off), expected);
    assert_eq!(rates_of(Some(("osc", Some(calibration()))), distorted(off)), expected);
    let uncorrected = rates_of(None, off);
    assert_ne!(uncorrected, expected);
    assert_eq!(rates_of(Some(("eyes", Some(calibration()))), off), uncorrected);
}
