//! A barrier of ours that is left out is noticed: by validation, or because the picture is another one. Otherwise
//! validation that finds nothing would mean nothing.

use parafovea::gpu::barrier::{ALL, ImageBarrier};
use parafovea_tests::run::{Application, Outcome, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};

const CHROMA: &str =
    "preset = \"none\"\n[gaze]\nsource = \"eyes\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n";
/// In the first frames the gaze is not known yet, and images are only copied.
const FRAMES: u64 = 20;
const SAVED: [u64; 2] = [1, 18];

fn run(change: impl FnOnce(Run) -> Run) -> Outcome {
    let scenario = Scenario::new(FRAMES).sized(128, 128).gazing(-25.0, 0.0).saving(&SAVED);
    let run = Run::new(&Application::hello_xr("Vulkan2").unwrap(), &scenario).on(CHROMA).validated();
    change(run).finish().unwrap().expect_frames(FRAMES).unwrap()
}

/// As the layer that drops barriers identifies one.
fn pattern(barrier: &ImageBarrier) -> String {
    let layouts = (barrier.old_layout.as_raw(), barrier.new_layout.as_raw());
    let stages = (barrier.src_stage.as_raw(), barrier.dst_stage.as_raw());
    format!("{},{},{},{}", layouts.0, layouts.1, stages.0, stages.1)
}

fn is_noticed(reference: &Outcome, outcome: &Outcome) -> bool {
    let differs = |frame| outcome.submitted(0, frame).unwrap() != reference.submitted(0, frame).unwrap();
    !outcome.findings.beyond(&reference.findings).is_empty() || SAVED.into_iter().any(differs)
}

#[test]
fn a_missing_barrier_is_noticed() {
    let reference = run(|run| run);
    for barrier in ALL {
        let outcome = run(|run| run.without_barrier(&pattern(&barrier)));
        assert!(is_noticed(&reference, &outcome), "{} is not missed, or does not occur", barrier.name);
    }
}

#[test]
fn the_layer_that_drops_barriers_does_nothing_else() {
    let reference = run(|run| run);
    // Layouts that no barrier has.
    let outcome = run(|run| run.without_barrier("0,0,1,1"));
    assert!(!is_noticed(&reference, &outcome));
}
