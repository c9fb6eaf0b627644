//! Parafovea's Vulkan half under a real loader, implicit as users install it.

use crate::process::{Ended, Process, install_implicit, library};
use parafovea_test_layers::{COUNT_FILE_VARIABLE, DROP_FILE_VARIABLE, SHADING_RATE_FILE_VARIABLE, TestLayer};

const PARAFOVEA: &str = "VK_LAYER_PARAFOVEA_foveation";

fn manifest() -> String {
    serde_json::json!({
        "file_format_version": "1.1.2",
        "layer": {
            "name": PARAFOVEA,
            "type": "GLOBAL",
            "library_path": library("libparafovea.so"),
            "api_version": "1.3.0",
            "implementation_version": "1",
            "description": "Parafovea",
            "functions": {
                "vkNegotiateLoaderLayerInterfaceVersion":
                    "parafovea_vkNegotiateLoaderLayerInterfaceVersion",
            },
            "enable_environment": { "PARAFOVEA": "1" },
            "disable_environment": { "DISABLE_PARAFOVEA": "1" },
        },
    })
    .to_string()
}

fn with_parafovea(program: &str) -> Process {
    let process = Process::new(program);
    install_implicit(&process.path("data"), "parafovea.json", &manifest());
    process.env("PARAFOVEA", "1")
}

#[test]
fn devices_are_armed_above_validation() {
    let ended = with_parafovea("ask_for_link").validated().run();
    assert_eq!(ended.result, "1.0 1.1");
    assert_eq!(ended.findings, [""; 0]);
}

/// On a device that looks as if it had shading rates, Parafovea is no other than on one without.
#[test]
fn devices_are_armed_above_shading_rates() {
    let process = with_parafovea("ask_for_link").layer(TestLayer::ShadingRate.name());
    let ended = process.file(SHADING_RATE_FILE_VARIABLE, "rates.json").validated().run();
    assert_eq!(ended.result, "1.0 1.1");
    assert_eq!(ended.findings, [""; 0]);
    assert_eq!(ended.read_if_there("rates.json"), "");
}

#[test]
fn without_the_request_or_against_it_there_is_no_link() {
    let process = Process::new("ask_for_link");
    install_implicit(&process.path("data"), "parafovea.json", &manifest());
    assert_eq!(process.run().result, "none none");
    assert_eq!(with_parafovea("ask_for_link").env("DISABLE_PARAFOVEA", "1").run().result, "none none");
}

/// The loader honours `DISABLE_PARAFOVEA` for an implicit layer only; a layer that is named is loaded, and must
/// be inert by itself.
#[test]
fn named_but_disabled_it_passes_calls_and_offers_nothing() {
    let explicit = |program| {
        let process = Process::new(program);
        std::fs::write(process.path("data/vulkan/explicit_layer.d/parafovea.json"), manifest_explicit())
            .unwrap();
        process.layer(PARAFOVEA)
    };
    assert_eq!(explicit("ask_for_link").run().result, "1.0 1.1");
    assert_eq!(explicit("ask_for_link").env("DISABLE_PARAFOVEA", "1").run().result, "none none");
    let own = explicit("triangle_with_own_query").env("DISABLE_PARAFOVEA", "1").run().result;
    assert_eq!(own, Process::new("triangle_with_own_query").run().result);
}

fn manifest_explicit() -> String {
    let mut manifest: serde_json::Value = serde_json::from_str(&manifest()).unwrap();
    let layer = manifest["layer"].as_object_mut().unwrap();
    layer.remove("enable_environment");
    layer.remove("disable_environment");
    manifest.to_string()
}

/// The layers of a process, from the application down, from the loader's output.
fn order(ended: &Ended) -> Vec<String> {
    let chain = ended.output.split_once("<Application>").unwrap().1;
    let chain = chain.split_once("<Drivers>").unwrap().0;
    let words = chain.split_whitespace().filter(|word| word.starts_with("VK_LAYER_"));
    words.filter(|word| !word.contains("MESA")).map(str::to_owned).collect()
}

#[test]
fn named_layers_are_below_and_a_layer_of_the_configuration_folder_is_above() {
    let process = with_parafovea("triangle_once").env("VK_LOADER_DEBUG", "layer");
    let count = TestLayer::Count;
    let above = count.implicit_manifest(&library("libparafovea_test_layers.so"));
    install_implicit(&process.path("config"), "count.json", &above);
    let ended = process
        .env(&count.implicit_variable(), "1")
        .file(COUNT_FILE_VARIABLE, "count.json")
        .file(DROP_FILE_VARIABLE, "dropped.json")
        .layer(TestLayer::DropBarrier.name())
        .validated()
        .run();
    let names = [count.name(), PARAFOVEA.to_owned(), TestLayer::DropBarrier.name()];
    assert_eq!(order(&ended)[..3], names);
    assert!(order(&ended)[3].contains("validation"));
    assert!(ended.read("count.json").contains("\"draws\":1"));
    assert_eq!(ended.findings, [""; 0]);
}

#[test]
fn a_loader_that_closes_the_library_does_not_unload_it() {
    let path = library("libparafovea.so");
    // SAFETY: the initialisation of the library has no preconditions.
    drop(unsafe { libloading::Library::new(&path) }.unwrap());
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    assert!(maps.contains("libparafovea.so"));
}
