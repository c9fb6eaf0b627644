//! Conditions under which the layer is loaded or not, and its complete absence if not.

use parafovea_manifest::json::{Activation, Half};
use parafovea_manifest::loader_filters;
use parafovea_tests::artifacts::Library;
use parafovea_tests::run::{Application, LayerMode, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const CHROMA: &str = "preset = \"none\"\n[chroma]\nmode = \"default\"\n";
const FRAMES: u64 = 30;
const SAVED: u64 = 25;

fn run(change: impl FnOnce(Run) -> Run) -> Outcome {
    let scenario = Scenario::new(FRAMES).sized(256, 256).gazing(-20.0, 0.0).saving(&[SAVED]);
    let run = Run::new(&Application::hello_xr("Vulkan2").unwrap(), &scenario);
    change(run).finish().unwrap().expect_frames(FRAMES).unwrap()
}

fn assert_untouched(outcome: &Outcome) {
    let reference = run(|run| run);
    for view in 0..2 {
        assert_eq!(reference.submitted(view, SAVED).unwrap(), outcome.submitted(view, SAVED).unwrap());
    }
    assert_eq!(reference.record.created(), outcome.record.created());
}

fn assert_attenuated(outcome: &Outcome) {
    let reference = run(|run| run);
    assert_ne!(
        reference.submitted(0, SAVED).unwrap(),
        outcome.submitted(0, SAVED).unwrap(),
        "{}",
        outcome.log
    );
}

#[test]
fn chroma_attenuation_is_seen_where_it_is_enabled() {
    assert_attenuated(&run(|run| run.on(CHROMA)));
}

#[test]
fn nothing_happens_unless_enabled() {
    let outcome = run(|run| run.layer(LayerMode::Off));
    assert_untouched(&outcome);
    assert_eq!(outcome.log, "");
}

#[test]
fn the_variable_that_disables_wins() {
    let outcome = run(|run| run.on(CHROMA).env("DISABLE_PARAFOVEA", "1"));
    assert_untouched(&outcome);
    assert_eq!(outcome.log, "");
}

/// Blender sets this variable in its own process, ahead of its Vulkan instance; `parafovea run` sets the other one.
#[test]
fn an_application_without_the_layers_of_others_gets_ours_by_name() {
    let filtered = |run: Run| run.on(CHROMA).env("VK_LOADER_LAYERS_DISABLE", "~implicit~");
    let outcome = run(filtered);
    assert_untouched(&outcome);
    assert!(outcome.log.contains("session inert: VK_LOADER_LAYERS_DISABLE"), "{}", outcome.log);
    assert_attenuated(&run(|run| {
        filtered(run).env(loader_filters::ENABLE_LAYERS, loader_filters::enabling(None))
    }));
}

#[test]
fn the_configuration_disables() {
    assert_untouched(&run(|run| run.on(&format!("enabled = false\n{CHROMA}"))));
}

#[test]
fn the_vulkan_half_alone_is_inert() {
    assert_untouched(&run(|run| run.layer(LayerMode::VulkanHalf(CHROMA.to_owned()))));
}

#[test]
fn the_openxr_half_alone_is_inert_and_says_so() {
    let outcome = run(|run| run.layer(LayerMode::OpenXrHalf(CHROMA.to_owned())));
    assert_untouched(&outcome);
    assert!(outcome.log.contains("Vulkan"), "{}", outcome.log);
}

#[test]
fn halves_loaded_from_two_copies_of_the_library_meet() {
    assert_attenuated(&run(|run| run.on(CHROMA).from_copies()));
}

/// OpenXR's loader loads a layer for each manifest that it finds, and two entries of one library would call each other for ever.
#[test]
fn two_installations_are_one_layer() {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("libparafovea.so");
    std::fs::copy(Library::Parafovea.path().unwrap(), &copy).unwrap();
    let manifest = Half::OpenXr.manifest_path(folder.path());
    std::fs::create_dir_all(manifest.parent().unwrap()).unwrap();
    let folders = format!("{}:/usr/local/share:/usr/share", folder.path().display());
    for library in [Library::Parafovea.path().unwrap(), copy] {
        let text = Half::OpenXr.manifest(library.to_str().unwrap(), Activation::Implicit);
        std::fs::write(&manifest, text).unwrap();
        let outcome = run(|run| run.on(CHROMA).env("XDG_DATA_DIRS", &folders));
        assert_attenuated(&outcome);
        assert!(outcome.log.contains("lists this layer more than once"), "{}", outcome.log);
    }
}

#[test]
fn the_openxr_half_named_explicitly_switches_the_vulkan_half_on() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let library = file("libparafovea.so");
    std::fs::copy(Library::Parafovea.path().unwrap(), &library).unwrap();
    let library = library.to_str().unwrap();
    // The Vulkan loader is given no path to this folder.
    std::fs::write(file("vulkan.json"), Half::Vulkan.manifest(library, Activation::Explicit)).unwrap();
    std::fs::create_dir(file("openxr")).unwrap();
    std::fs::write(file("openxr/layer.json"), Half::OpenXr.manifest(library, Activation::Explicit)).unwrap();
    std::fs::write(file("config.toml"), CHROMA).unwrap();

    let named = |run: Run| {
        run.env("XR_API_LAYER_PATH", file("openxr"))
            .env("XR_ENABLE_API_LAYERS", Half::OpenXr.layer_name())
            .env("PARAFOVEA_CONFIG", file("config.toml"))
    };
    let outcome = run(named);
    assert_attenuated(&outcome);
    assert!(outcome.log.contains("Vulkan half enabled"), "{}", outcome.log);
    assert_untouched(&run(|run| named(run).env("DISABLE_PARAFOVEA", "1")));
}
