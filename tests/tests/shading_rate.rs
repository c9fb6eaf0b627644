//! Applications that know nothing of shading rates, on a device that looks as if it had them: the test layer below
//! changes nothing for them, and reports nothing.

use parafovea_test_layers::ShadingRateProfile;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const FRAMES: u64 = 30;

fn finish(run: Run) -> Outcome {
    let outcome = run.validated().finish().unwrap().expect_frames(FRAMES).unwrap();
    assert!(outcome.findings.vulkan_was_active, "validation was not there\n{}", outcome.output);
    outcome
}

fn check(application: &Application) {
    let run = Run::new(application, &Scenario::new(FRAMES).sized(128, 128));
    let reference = finish(run.clone());
    let over = finish(run.shading_rates(ShadingRateProfile::NvkTuring));
    let new = over.findings.beyond(&reference.findings);
    assert!(new.is_empty(), "{new:#?}");
    assert_eq!(over.shading_rates().unwrap(), []);
}

#[test]
fn hello_xr_is_as_on_a_device_without() {
    check(&Application::hello_xr("Vulkan2").unwrap());
}

#[test]
fn a_scene_is_as_on_a_device_without() {
    check(&Application::ours("parafovea-scene", &[]).unwrap());
}
