//! Libraries that the layer loads into games: ALSA's only with the capture library, and that only on request.

use parafovea_sound::stage::configuration;
use parafovea_tests::artifacts::Library;
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::collections::BTreeSet;
use std::process::Command;

const FRAMES: u64 = 100;

/// Libraries that the dynamic loader has to load for a library, by `readelf`.
fn needed(library: Library) -> BTreeSet<String> {
    let output = Command::new("readelf").arg("-d").arg(library.path().unwrap()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let name =
        |line: &str| Some(line.split_once("(NEEDED)")?.1.split_once('[')?.1.split_once(']')?.0.to_owned());
    text.lines().filter_map(name).collect()
}

#[test]
fn the_layer_needs_nothing_that_is_not_everywhere() {
    let layer = needed(Library::Parafovea);
    let everywhere = ["libc.so.6", "libm.so.6", "libgcc_s.so.1"];
    // The dynamic loader itself is named where thread-local storage is used.
    let others: Vec<_> = layer
        .iter()
        .filter(|name| !everywhere.contains(&name.as_str()) && !name.starts_with("ld-linux"))
        .collect();
    assert!(others.is_empty() && !layer.is_empty(), "{others:?}");
    assert!(needed(Library::Audio).contains("libasound.so.2"));
}

fn run(change: impl FnOnce(Run) -> Run) -> Outcome {
    let scenario = Scenario::new(FRAMES).sized(96, 96).in_real_time().saving(&[90]);
    let run = Run::new(&Application::hello_xr("Vulkan2").unwrap(), &scenario);
    change(run).finish().unwrap().expect_frames(FRAMES).unwrap()
}

#[test]
fn without_the_sound_capture_library_everything_else_works() {
    let config = configuration("source = \"system\"");
    let untouched = run(|run| run);
    // Copies of the layer, and nothing beside them.
    let deaf = run(|run| run.on(&config).from_copies());
    assert_ne!(
        untouched.submitted(0, 90).unwrap(),
        deaf.submitted(0, 90).unwrap(),
        "colour is removed all the same"
    );
    let lines: Vec<&str> = deaf.log.lines().filter(|line| line.contains("sound")).collect();
    assert_eq!(lines.len(), 1, "{lines:#?}");
    assert!(lines[0].contains("not captured: libparafovea_audio.so could not be loaded"), "{lines:#?}");
}

#[test]
fn nothing_listens_by_itself() {
    let outcome = run(|run| run.with_audio_library().unwrap().on("[chroma]\nmode = \"default\"\n"));
    assert!(!outcome.log.contains("sound"), "{}", outcome.log);
}
