//! The same with the OpenXR loader 1.1: the distribution's is the first one, 1.0.20, which all other tests use.

use parafovea_tests::artifacts::target_folder;
use parafovea_tests::openxr_loader;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const FRAMES: u64 = 30;
const LAST: u64 = FRAMES - 1;
const CHROMA: &str =
    "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";

#[test]
fn hello_xr_with_vulkan_enable() {
    check(&Application::hello_xr("Vulkan").unwrap());
}

#[test]
fn hello_xr_with_vulkan_enable2() {
    check(&Application::hello_xr("Vulkan2").unwrap());
}

#[test]
fn our_scene() {
    check(&Application::ours("parafovea-scene", &[]).unwrap());
}

/// Works with the new loader, with the same images as with the old one.
fn check(application: &Application) {
    let scenario = Scenario::new(FRAMES).sized(256, 256).gazing(14.0, -6.0).saving(&[LAST]);
    let run = || Run::new(application, &scenario).validated();
    let finish = |run: Run| run.finish().unwrap().expect_frames(FRAMES).unwrap();
    let loader = openxr_loader::build(&target_folder().unwrap()).unwrap();
    let with_new_loader = |run: Run| {
        let outcome = finish(run.env("LD_LIBRARY_PATH", &loader).env("LD_DEBUG", "libs"));
        let initialised = format!("calling init: {}", loader.join(openxr_loader::FILE_NAME).display());
        assert!(outcome.output.contains(&initialised), "the loader is another one\n{}", outcome.output);
        outcome
    };

    let reference = with_new_loader(run());
    let old = finish(run().on(CHROMA));
    let new = with_new_loader(run().on(CHROMA));

    let findings = new.findings.beyond(&reference.findings);
    assert!(findings.is_empty(), "{findings:#?}");
    assert_eq!(new.exit_code, reference.exit_code);
    for view in 0..2 {
        let picture = |outcome: &Outcome| outcome.submitted(view, LAST).unwrap();
        assert!(picture(&new) != picture(&reference), "nothing was processed");
        assert!(picture(&new) == picture(&old), "the loader changed the picture");
    }
}
