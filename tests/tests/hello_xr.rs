//! hello_xr, unmodified, under all validation that there is: nothing is found that is not found without us.

use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const FRAMES: u64 = 200;

#[test]
fn with_vulkan_enable() {
    check("Vulkan");
}

#[test]
fn with_vulkan_enable2() {
    check("Vulkan2");
}

fn check(graphics: &str) {
    let reference = run(graphics, None);
    // On with nothing to do, and on with images of ours, and work on them, in every frame.
    for config in ["", "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\n"] {
        let with_us = run(graphics, Some(config));
        let new = with_us.findings.beyond(&reference.findings);
        assert!(new.is_empty(), "{new:#?}");
        assert_eq!(with_us.exit_code, reference.exit_code);
        let errors = |outcome: &Outcome| outcome.record.errors.clone();
        assert_eq!(errors(&with_us), errors(&reference));
    }
}

fn run(graphics: &str, config: Option<&str>) -> Outcome {
    let application = Application::hello_xr(graphics).unwrap();
    let run = Run::new(&application, &Scenario::new(FRAMES).sized(256, 256)).validated();
    let run = match config {
        Some(config) => run.on(config),
        None => run,
    };
    let outcome = run.finish().unwrap().expect_frames(FRAMES).unwrap();
    let were_active = outcome.findings.vulkan_was_active && outcome.findings.openxr_was_active;
    assert!(were_active, "a validation layer was not there\n{}", outcome.output);
    outcome
}
