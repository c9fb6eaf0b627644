//! What frames leave behind in the process.

use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Gaze, Head, Scenario, ScenarioExt};

/// Until passes are known, all kernels are compiled, and everything was used once.
const RUN_UP: usize = 40;
const FRAMES: usize = 120;

/// A head that turns and a gaze that jumps: what kernels are given changes in every frame.
fn scenario() -> Scenario {
    let head = |t: f64, yaw_deg: f32| Head { t, position: [0.0; 3], yaw_deg, pitch_deg: 0.0, roll_deg: 0.0 };
    let gaze = |t: f64, yaw_deg: f32| Gaze { t, yaw_deg, pitch_deg: 0.0, tracked: true };
    Scenario {
        head: vec![head(0.0, 0.0), head(4.0, 40.0)],
        gaze: vec![gaze(0.0, -10.0), gaze(0.5, 15.0), gaze(1.0, -10.0)],
        ..Scenario::new(FRAMES as u64).sized(128, 128)
    }
}

/// KiB for each frame after the run-up.
fn growth_kib(config: &str) -> f64 {
    let application = Application::ours("parafovea-scene", &[]).unwrap();
    let outcome = Run::new(&application, &scenario()).on(config).finish().unwrap();
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
