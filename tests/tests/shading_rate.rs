//! Applications that know nothing of shading rates, on a device that looks as if it had them: the test layer below
//! changes nothing for them, and has nothing to say.

use parafovea_test_layers::{SHADING_RATE_FILE_VARIABLE, TestLayer};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const FRAMES: u64 = 30;

/// What the application did, and what the test layer wrote.
fn run(application: &Application, over: bool) -> (Outcome, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rates.json");
    let run = Run::new(application, &Scenario::new(FRAMES).sized(128, 128)).validated();
    let run = if over {
        run.test_layer(TestLayer::ShadingRate).env(SHADING_RATE_FILE_VARIABLE, &file)
    } else {
        run
    };
    let outcome = run.finish().unwrap().expect_frames(FRAMES).unwrap();
    assert!(outcome.findings.vulkan_was_active, "validation was not there\n{}", outcome.output);
    (outcome, std::fs::read_to_string(&file).unwrap_or_default())
}

fn check(application: &Application) {
    let (reference, _) = run(application, false);
    let (over, written) = run(application, true);
    let new = over.findings.beyond(&reference.findings);
    assert!(new.is_empty(), "{new:#?}");
    assert_eq!(over.exit_code, reference.exit_code);
    assert_eq!(written, "");
}

#[test]
fn hello_xr_is_as_on_a_device_without() {
    check(&Application::hello_xr("Vulkan2").unwrap());
}

#[test]
fn a_scene_is_as_on_a_device_without() {
    check(&Application::ours("parafovea-scene", &[]).unwrap());
}
