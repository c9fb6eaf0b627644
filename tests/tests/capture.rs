//! The capturing layer sits below ours: it saves the images that the runtime gets.

use parafovea_test_layers::{CAPTURE_FOLDER_VARIABLE, CAPTURE_LAYER, CapturedView, capture_manifest};
use parafovea_tests::artifacts::Library;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::fs;

#[test]
fn captured_pictures_are_those_that_the_runtime_gets() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = capture_manifest(&Library::TestLayers.path().unwrap());
    fs::write(folder.path().join("capture.json"), manifest).unwrap();
    fs::write(folder.path().join("next"), "first").unwrap();
    let application = Application::ours("parafovea-scene", &[]).unwrap();
    let scenario = Scenario::new(2).sized(96, 64).saving(&[0, 1]);
    let run = Run::new(&application, &scenario)
        .on("preset = \"none\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n")
        .env("XR_API_LAYER_PATH", folder.path())
        .env("XR_ENABLE_API_LAYERS", CAPTURE_LAYER)
        .env(CAPTURE_FOLDER_VARIABLE, folder.path());
    let outcome = run.finish().unwrap().expect_frames(2).unwrap();
    for view in 0..2 {
        let captured = Picture::load(&folder.path().join(format!("first-{view}.png"))).unwrap();
        assert!(captured == outcome.submitted(view, 0).unwrap(), "view {view}");
        assert!(captured != outcome.submitted(view, 1).unwrap(), "frames differ");
    }
    let views = fs::read_to_string(folder.path().join("first.json")).unwrap();
    let views: Vec<CapturedView> = serde_json::from_str(&views).unwrap();
    assert!(views.len() == 2 && views[0].fov[0] < 0.0 && views[0].fov[1] > 0.0, "{views:?}");
    assert!(!folder.path().join("next").exists(), "one frame alone is asked for");
}
