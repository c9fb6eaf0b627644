//! Pipelines of the layer: compiled on a thread of its own, and kept on disk.

use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// All kernels: chroma, re-use, a mask that is filled, rates by contrast.
const EVERYTHING: &str = "preset = \"balanced\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\n\
    [reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n[log]\nlevel = \"debug\"\n";

/// Two seconds at 90 Hz, however fast frames are: most pipelines are compiled before the end.
const FRAMES: u64 = 180;

/// So many that pipelines are being compiled when the device goes.
const FEW: u64 = 3;

fn scene(frames: u64) -> Run {
    let application = Application::ours("parafovea-scene", &[]).unwrap();
    let scenario = Scenario::new(frames).sized(64, 64).gazing(-20.0, 0.0).in_real_time();
    Run::new(&application, &scenario).validated()
}

fn run(cache: &Path, frames: u64) -> Outcome {
    let run = scene(frames).on(EVERYTHING).compiling_in_background().env("XDG_CACHE_HOME", cache);
    run.faulted(None).finish().unwrap().expect_frames(frames).unwrap()
}

/// Number of pipelines that the layer created, on the application's threads and on its own.
fn made(outcome: &Outcome) -> [u64; 2] {
    let mut made = [0; 2];
    for report in outcome.faults().unwrap() {
        for call in ["vkCreateComputePipelines", "vkCreateGraphicsPipelines"] {
            let of = |counts: &BTreeMap<String, u64>| counts.get(call).copied().unwrap_or(0);
            made[1] += of(&report.own_on_threads);
            made[0] += of(&report.own) - of(&report.own_on_threads);
        }
    }
    made
}

/// The bytes of earlier launches that the layer began with.
fn bytes_read(outcome: &Outcome) -> usize {
    let line = outcome
        .log
        .lines()
        .find_map(|line| line.split_once("pipeline cache: ")?.1.split_once(" bytes from earlier"));
    line.unwrap_or_else(|| panic!("nothing is said of the cache\n{}", outcome.log)).0.parse().unwrap()
}

fn cache_file(cache: &Path) -> PathBuf {
    let files: Vec<_> =
        fs::read_dir(cache.join("parafovea")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let is_its = |path: &&PathBuf| path.file_name().unwrap().to_string_lossy().starts_with("pipelines-");
    let [file] = files.iter().filter(is_its).collect::<Vec<_>>()[..] else { panic!("{files:?}") };
    file.clone()
}

/// The application's own messages of validation aside.
fn assert_clean(outcome: &Outcome, off: &Outcome) {
    let new = outcome.findings.beyond(&off.findings);
    assert!(new.is_empty(), "{new:#?}");
}

/// A launch without a cache that compiles most pipelines, and the folder of its cache. On a busy machine it takes longer.
fn first_launch() -> (tempfile::TempDir, Outcome) {
    let mut compiled = Vec::new();
    for times in [1, 2, 4] {
        let cache = tempfile::tempdir().unwrap();
        let first = run(cache.path(), times * FRAMES);
        let [on_applications, on_own] = made(&first);
        assert_eq!(on_applications, 0);
        if on_own > 20 {
            return (cache, first);
        }
        compiled.push(on_own);
    }
    panic!("all kernels' entry points: {compiled:?}");
}

#[test]
fn no_pipeline_is_compiled_on_the_applications_thread_and_a_second_launch_begins_with_them() {
    let off = scene(1).finish().unwrap();
    let (cache, first) = first_launch();
    assert_eq!(bytes_read(&first), 0);
    assert_clean(&first, &off);
    let written = fs::read(cache_file(cache.path())).unwrap();
    let second = run(cache.path(), FEW);
    let read = bytes_read(&second);
    assert!(read > 0 && read < written.len(), "{read} bytes of {}", written.len());
    assert_eq!(made(&second)[0], 0);
    assert_clean(&second, &off);
    // Damaged, it is as if it were not there.
    let mut damaged = written.clone();
    damaged[written.len() / 2] ^= 1;
    fs::write(cache_file(cache.path()), damaged).unwrap();
    let third = run(cache.path(), FEW);
    assert_eq!((bytes_read(&third), made(&third)[0]), (0, 0));
    assert_clean(&third, &off);
}

/// The device goes while its pipelines are being compiled.
#[test]
fn an_application_may_end_before_all_is_compiled() {
    let off = scene(1).finish().unwrap();
    for frames in [1, FEW] {
        let cache = tempfile::tempdir().unwrap();
        let outcome = run(cache.path(), frames);
        assert_eq!(made(&outcome)[0], 0);
        assert_clean(&outcome, &off);
    }
}

/// Masks of multisampled depth have a pipeline of their own, and depth that is loaded has kernels.
#[test]
fn masks_of_all_kinds_of_depth_compile_nothing_on_the_applications_thread() {
    for style in ["msaa-resolve", "loaded-depth"] {
        // Passes have masks once the kernels are compiled, which takes longer on a busy machine.
        let mut logs = [400, 1600, 6400].into_iter().map(|frames| with_masks(style, frames));
        let found = logs.find(|(log, _)| log.contains(": masked"));
        let (_, on_own) = found.unwrap_or_else(|| panic!("{style}: no pass is masked"));
        // Five of the fill, two of texels that are copied.
        assert!(on_own >= 7, "{style}: {on_own}");
    }
}

/// The log of a style with masks in real time, and the number of pipelines that the layer created on its own threads; there are none on the
/// application's.
fn with_masks(style: &str, frames: u64) -> (String, u64) {
    let cache = tempfile::tempdir().unwrap();
    let arguments = ["--style", style, "--size", "64", "--frames", &frames.to_string()];
    let application = Application::ours("parafovea-zoo", &arguments).unwrap();
    let scenario = Scenario::new(frames).sized(64, 64).gazing(-20.0, 0.0).in_real_time();
    let run = Run::new(&application, &scenario)
        .on("preset = \"balanced\"\n[rates]\ngate = \"on\"\n")
        .compiling_in_background()
        .env("XDG_CACHE_HOME", cache.path());
    let outcome = run.faulted(None).finish().unwrap().expect_frames(frames).unwrap();
    let [on_applications, on_own] = made(&outcome);
    assert_eq!(on_applications, 0, "{style}");
    (outcome.log, on_own)
}
