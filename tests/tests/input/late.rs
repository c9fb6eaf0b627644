//! The newest gaze is in the map of the same frame.

use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Gaze, Scenario, ScenarioExt};

const FRAMES: u64 = 60;
/// The frame in which the eyes jump between xrBeginFrame and xrLocateViews.
const JUMP: usize = 50;

/// The maps of the left eye's passes, a frame each, where the tracker has something newer after xrBeginFrame or not.
fn maps(newer_at_views_ms: f64) -> Vec<String> {
    let mut scenario = Scenario::new(FRAMES).sized(128, 128);
    // The newest gaze is a frame old at xrBeginFrame.
    let frame_ms = 1000.0 / 90.0;
    (scenario.tracker.latency_ms, scenario.tracker.newer_at_views_ms) = (frame_ms, newer_at_views_ms);
    let between = (JUMP as f64 - 0.5) * frame_ms / 1000.0;
    let at = |t, yaw_deg| Gaze { t, yaw_deg, pitch_deg: 0.0, tracked: true };
    scenario.gaze = vec![at(0.0, 25.0), at(between, 25.0), at(between, -25.0)];
    let application = Application::ours("parafovea-scene", &["--lights", "0"]).unwrap();
    let run = Run::new(&application, &scenario).shading_rates(ShadingRateProfile::Layered16);
    let outcome = run.on("[rates]\ngate = \"on\"\n").finish().unwrap().expect_frames(FRAMES).unwrap();
    let maps: Vec<String> = outcome
        .shading_rates()
        .unwrap()
        .into_iter()
        .filter_map(|line| match line {
            ShadingRateLine::Pass(pass) => pass.map.unwrap().texels,
            ShadingRateLine::Finding(finding) => panic!("{finding:?}"),
        })
        .collect();
    assert_eq!(maps.len() % FRAMES as usize, 0, "passes of {FRAMES} frames");
    let passes = maps.len() / FRAMES as usize;
    maps.into_iter().step_by(passes).collect()
}

/// The texel at the right edge, half way down, of 8 by 8.
fn right_edge(map: &str) -> &str {
    let at = (4 * 8 + 7) * 2;
    &map[at..at + 2]
}

#[test]
fn a_gaze_that_moves_between_begin_and_locate_is_in_the_map_of_that_frame() {
    let newer = maps(1000.0 / 90.0);
    let [before, then] = [&newer[JUMP - 1], &newer[JUMP]];
    assert_eq!(before.len(), 2 * 8 * 8, "tiles of 16 by 16 pixels");
    assert_ne!(right_edge(before), "00", "coarse as long as the eyes look to the left: {before}");
    assert_eq!(right_edge(then), "00", "1x1 in the frame in which they look there: {then}");

    // With nothing newer at xrLocateViews it is one frame later.
    let older = maps(0.0);
    assert_ne!(right_edge(&older[JUMP]), "00", "{}", older[JUMP]);
    assert_eq!(right_edge(&older[JUMP + 1]), "00", "{}", older[JUMP + 1]);
}
