//! `parafovea gaze recentre`: the offset of an eye tracker is measured in a running application, stored, and removed from the gaze.

use crate::osc::{FRAMES, Sender, config, free_address, last_map, long, message, start, told};
use parafovea_manifest::gaze_correction::GazeCorrection;
use parafovea_manifest::paths::Environment;
use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::artifacts::program;
use parafovea_tests::run::{Application, Run, Running};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The offset of the tracker, degrees to the left and upwards.
const OFFSET: [f32; 2] = [3.0, -1.0];

fn parafovea(running: &Running, state: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(program("parafovea").unwrap());
    command.arg("gaze").args(arguments);
    command.env("XDG_RUNTIME_DIR", running.runtime_folder()).env("XDG_STATE_HOME", state);
    command.output().unwrap()
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
    let file = PathBuf::from(told(&running, |status| !status.recentre.file.is_empty()).recentre.file);
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
    assert!(shown.contains("  recentred by 3.0 degrees to the right"), "{shown}");

    let output = parafovea(&running, state, &["recentre", "--reset"]);
    assert_eq!(text(&output.stdout), format!("removed {}\n", file.display()));
    told(&running, |status| status.recentre.correction.is_none());

    std::fs::write(&file, "{").unwrap();
    let before = told(&running, |_| running.log().contains("correction of the eye tracker ignored: "));
    let after = told(&running, |status| status.frames > before.frames && status.gaze.is_valid);
    assert_eq!(after.recentre.correction, None);
    assert_eq!(running.log().matches("correction of the eye tracker ignored: ").count(), 1);
}

#[test]
fn a_gaze_far_from_the_dot_is_refused_with_the_reason() {
    let running = follows_the_eyes(&long().gazing(12.0, 5.0));
    let file = PathBuf::from(told(&running, |status| !status.recentre.file.is_empty()).recentre.file);
    let output = parafovea(&running, file.ancestors().nth(3).unwrap(), &["recentre"]);
    assert!(!output.status.success());
    let errors = text(&output.stderr);
    assert!(errors.contains("unchanged: the gaze was 13 degrees from the dot"), "{errors}");
    assert!(!file.exists());
}

#[test]
fn a_stored_correction_moves_the_rates_of_its_source_alone() {
    let [left, up] = OFFSET;
    let rates_of = |stored_for: Option<&str>, [left, up]: [f32; 2]| {
        let state = tempfile::tempdir().unwrap();
        let scenario = Scenario::new(FRAMES).sized(128, 128);
        if let Some(source) = stored_for {
            let environment =
                Environment::new(false, |name| (name == "XDG_STATE_HOME").then(|| state.path().into()));
            let headset = &scenario.system.name;
            let correction = GazeCorrection::new(headset, source, OFFSET.map(|angle| -angle), 0.1);
            correction.write(&GazeCorrection::file(&environment, headset).unwrap()).unwrap();
        }
        let address = free_address();
        let _sender = Sender::tracker(address, vec![message("/tracking/eye/CenterPitchYaw", &[-up, -left])]);
        let application = Application::ours("parafovea-scene", &["--lights", "0"]).unwrap();
        let run = Run::new(&application, &scenario).shading_rates(ShadingRateProfile::NvkTuring);
        let run = run.env("XDG_STATE_HOME", state.path()).on(&config("osc", address));
        last_map(&run.finish().unwrap().expect_frames(FRAMES).unwrap())
    };
    let look = [-18.0, 9.0];
    let off = [look[0] + left, look[1] + up];
    let expected = rates_of(None, look);
    assert_eq!(rates_of(Some("osc"), off), expected);
    let uncorrected = rates_of(None, off);
    assert_ne!(uncorrected, expected);
    assert_eq!(rates_of(Some("eyes"), off), uncorrected);
}
