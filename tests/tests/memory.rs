//! Memory that frames leave behind in the process.

use crate::configuration::wait_until;
use parafovea_test_layers::{BUDGET_VARIABLE, ShadingRateProfile};
#[cfg(target_arch = "x86_64")]
use parafovea_tests::artifacts::Library;
use parafovea_tests::run::{Application, Run, complaints};
use parafovea_tests::scenario::{Gaze, Head, Scenario, ScenarioExt};

/// Until passes are known, all kernels are compiled, and everything was used once.
const RUN_UP: usize = 40;
const FRAMES: usize = 120;

/// A head that turns and a gaze that jumps: kernels' parameters change in every frame.
fn scenario(frames: u64) -> Scenario {
    let head = |t: f64, yaw_deg: f32| Head { t, position: [0.0; 3], yaw_deg, pitch_deg: 0.0, roll_deg: 0.0 };
    let gaze = |t: f64, yaw_deg: f32| Gaze { t, yaw_deg, pitch_deg: 0.0, tracked: true };
    Scenario {
        head: vec![head(0.0, 0.0), head(4.0, 40.0)],
        gaze: vec![gaze(0.0, -10.0), gaze(0.5, 15.0), gaze(1.0, -10.0)],
        ..Scenario::new(frames).sized(128, 128)
    }
}

/// KiB for each frame after the run-up.
fn growth_kib(config: &str) -> f64 {
    let application = Application::ours("parafovea-scene", &[]).unwrap();
    let outcome = Run::new(&application, &scenario(FRAMES as u64)).on(config).finish().unwrap();
    let frames = outcome.expect_frames(FRAMES as u64).unwrap().record.frames;
    let grown = frames[FRAMES - 1].peak_memory_kib - frames[RUN_UP].peak_memory_kib;
    assert!(frames[RUN_UP].peak_memory_kib > 0, "nothing was recorded");
    grown as f64 / (FRAMES - RUN_UP) as f64
}

/// lavapipe of Mesa 22.3 compiles a shader that branches on uniforms alone whenever they were written, and keeps the code: that was 5 MB a
/// frame for re-use, and 1 MB for rates by contrast.
#[test]
fn stays_as_it_is_however_long_a_run() {
    for rest in ["", "[chroma]\nmode = \"default\"", "mode = \"audio-visual\"", "mode = \"paper\""] {
        let (rates, other) = if rest.starts_with('m') { (rest, "") } else { ("", rest) };
        let config =
            format!("preset = \"none\"\n[rates]\ngate = \"on\"\n{rates}\n[reuse]\nmode = \"on\"\n{other}\n");
        let grown = growth_kib(&config);
        assert!(grown < 64.0, "{grown} KiB a frame with {rest:?}");
    }
}

/// The most device memory of the layer in a run with re-use, bytes, and its log, where the system has so much left for the process.
fn memory_with(remaining: u64) -> (u64, String) {
    const FRAMES: u64 = 40;
    let application =
        Application::ours("parafovea-zoo", &["--style", "render-pass", "--size", "128", "--frames", "40"])
            .unwrap();
    let config = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nbackend = \"mask\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";
    let run = Run::new(&application, &Scenario::new(FRAMES).sized(128, 128)).on(config).live_counted();
    let run = run.env(BUDGET_VARIABLE, remaining.to_string());
    let outcome = run.finish().unwrap().expect_frames(FRAMES).unwrap();
    let most = outcome.live_objects().unwrap().iter().map(|live| live.own.most_memory).max();
    (most.unwrap(), outcome.log)
}

/// The history of an eye is an image of 64 KiB or more, which an eighth of 256 KiB is less than.
#[test]
fn re_use_keeps_no_pictures_where_memory_is_short() {
    let [(ample, told), (scarce, refused)] = [1 << 30, 1 << 18].map(memory_with);
    assert!(ample >= scarce + 2 * 128 * 128 * 4, "{scarce} bytes instead of {ample}");
    let reason = "no re-use in a swapchain: its history would take";
    assert!(refused.contains(reason) && refused.contains("VK_EXT_memory_budget"), "{refused}");
    assert!(!told.contains(reason), "{told}");
    assert!(complaints(&refused).is_empty(), "{refused}");
}

/// The most device memory of the layer, bytes, in a run with rates of that mode, which are turned off and on so many times.
fn memory_of_rates(mode: &str, switches: u64) -> u64 {
    /// The configuration is read twice a second.
    const BETWEEN: u64 = 60;
    let frames = (2 * switches + 1) * BETWEEN + BETWEEN / 2;
    let config = |mode| {
        format!(
            "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"{mode}\"\nsilence = \"contrast\"\ngate = \"on\"\n"
        )
    };
    let arguments = ["--style", "render-pass", "--size", "512", "--frames", &frames.to_string()];
    let application = Application::ours("parafovea-zoo", &arguments).unwrap();
    let edits: Vec<u64> = (1..=2 * switches).map(|edit| edit * BETWEEN).collect();
    let scenario = Scenario::new(frames).sized(512, 512).in_real_time().saving(&edits);
    let run = Run::new(&application, &scenario).shading_rates(ShadingRateProfile::NvkTuring).live_counted();
    let running = run.on(&config(mode)).start().unwrap();
    for (&frame, mode) in edits.iter().zip(["off", mode].into_iter().cycle()) {
        wait_until(|| running.has_submitted(1, frame));
        std::fs::write(running.config_file(), config(mode)).unwrap();
    }
    let outcome = running.finish().unwrap().expect_frames(frames).unwrap();
    assert_eq!(outcome.log.matches("configuration changed").count() as u64, 2 * switches, "{}", outcome.log);
    outcome.live_objects().unwrap().iter().map(|live| live.own.most_memory).max().unwrap()
}

/// While rates are turned on again, work with the former tiles may be pending, so that there are twice the tiles for a moment. Other memory of
/// the layer grows with its pending work, by far less than the tiles of a picture of this size.
#[test]
fn contrast_frees_its_tiles_with_each_switch() {
    let rings = memory_of_rates("fixed", 0);
    let [once, again] = [0, 2].map(|switches| memory_of_rates("audio-visual", switches));
    let contrast = once - rings;
    assert!(contrast > 512 * 512, "contrast takes {contrast} bytes");
    let grown = again.saturating_sub(once);
    assert!(2 * grown < 3 * contrast, "{grown} bytes more, where contrast takes {contrast}");
}

/// Number of allocations of the layer in a run of `frames` frames of an application that creates nothing in them.
#[cfg(target_arch = "x86_64")]
fn allocations(config: &str, frames: u64) -> f64 {
    let count = frames.to_string();
    let arguments = ["--style", "render-pass", "--size", "128", "--frames", &count];
    let application = Application::ours("parafovea-zoo", &arguments).unwrap();
    let file = tempfile::NamedTempFile::new().unwrap();
    let counter = Library::TestAllocations.path().unwrap();
    let run = Run::new(&application, &scenario(frames)).on(config);
    let run = run.env("LD_PRELOAD", counter).env("PARAFOVEA_TEST_ALLOCATIONS_OF", "libparafovea.so");
    let run = run.env("PARAFOVEA_TEST_ALLOCATIONS_FILE", file.path());
    // The thread of the status allocates once a second, regardless of the number of frames.
    let run = run.env("PARAFOVEA_TEST_ALLOCATIONS_EXCEPT", "parafovea-state");
    run.finish().unwrap().expect_frames(frames).unwrap();
    let count: f64 = std::fs::read_to_string(file.path()).unwrap().parse().unwrap();
    assert!(count > 100.0, "only {count}: the layer was not found");
    count
}

/// On all threads of the layer but the one of the status.
#[test]
#[cfg(target_arch = "x86_64")]
fn a_steady_frame_asks_for_none() {
    for rates in ["mode = \"fixed\"", "mode = \"audio-visual\"\nsilence = \"contrast\""] {
        let config = format!(
            "preset = \"balanced\"\n[rates]\ngate = \"on\"\n{rates}\n[reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n"
        );
        let [short, long] = [120, 360].map(|frames| allocations(&config, frames));
        let each = (long - short) / 240.0;
        assert!(each < 0.25, "{each} a frame with {rates}");
    }
}
