//! The newest gaze is in the map of the same frame.

use parafovea_test_layers::{ShadingRateLine, ShadingRateProfile};
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Gaze, Scenario, ScenarioExt};

const FRAMES: u64 = 60;

/// 90 Hz.
const FRAME_S: f64 = 1.0 / 90.0;

/// The frame in which the eyes jump between xrBeginFrame and xrLocateViews.
const JUMP: usize = 50;

fn at(t: f64, yaw_deg: f32, tracked: bool) -> Gaze {
    Gaze { t, yaw_deg, pitch_deg: 0.0, tracked }
}

/// The maps of the left eye's passes, a frame each.
fn maps(scenario: &Scenario) -> Vec<String> {
    let frames = scenario.session.frames;
    let application = Application::ours("parafovea-scene", &["--lights", "0"]).unwrap();
    let run = Run::new(&application, scenario).shading_rates(ShadingRateProfile::NvkTuring);
    let outcome = run.on("[rates]\ngate = \"on\"\n").finish().unwrap().expect_frames(frames).unwrap();
    let maps: Vec<String> = outcome
        .shading_rates()
        .unwrap()
        .into_iter()
        .filter_map(|line| match line {
            ShadingRateLine::Pass(pass) => pass.map.unwrap().texels,
            ShadingRateLine::Finding(finding) => panic!("{finding:?}"),
        })
        .collect();
    assert_eq!(maps.len() % frames as usize, 0, "passes of {frames} frames");
    assert_eq!(maps[0].len(), 2 * 8 * 8, "tiles of 16 by 16 pixels");
    let passes = maps.len() / frames as usize;
    maps.into_iter().step_by(passes).collect()
}

/// The texel at the right edge, half way down, of 8 by 8.
fn right_edge(map: &str) -> &str {
    let at = (4 * 8 + 7) * 2;
    &map[at..at + 2]
}

/// Maps where the eyes jump from left to right, and the tracker has something newer after xrBeginFrame or not.
fn jump(newer_at_views_s: f64) -> Vec<String> {
    let mut scenario = Scenario::new(FRAMES).sized(128, 128);
    // The newest gaze is a frame old at xrBeginFrame.
    scenario.tracker.latency_ms = FRAME_S * 1000.0;
    scenario.tracker.newer_at_views_ms = newer_at_views_s * 1000.0;
    let between = (JUMP as f64 - 0.5) * FRAME_S;
    scenario.gaze = vec![at(0.0, 25.0, true), at(between, 25.0, true), at(between, -25.0, true)];
    maps(&scenario)
}

#[test]
fn a_gaze_that_moves_between_begin_and_locate_is_in_the_map_of_that_frame() {
    let newer = jump(FRAME_S);
    let [before, then] = [&newer[JUMP - 1], &newer[JUMP]];
    assert_ne!(right_edge(before), "00", "coarse as long as the eyes look to the left: {before}");
    assert_eq!(right_edge(then), "00", "1x1 in the frame in which they look there: {then}");

    // With nothing newer at xrLocateViews it is one frame later.
    let older = jump(0.0);
    assert_ne!(right_edge(&older[JUMP]), "00", "{}", older[JUMP]);
    assert_eq!(right_edge(&older[JUMP + 1]), "00", "{}", older[JUMP + 1]);
}

/// `gaze.hold_ms` is half a second, and trust takes another fifth to go.
#[test]
fn a_blink_holds_the_map_and_a_longer_loss_ends_in_wide_rates() {
    let mut scenario = Scenario::new(200).sized(128, 128);
    let frame = |number: f64| number * FRAME_S;
    scenario.gaze = vec![
        at(0.0, 25.0, true),
        at(frame(79.5), 25.0, false),
        at(frame(99.5), 25.0, true),
        at(frame(119.5), 25.0, false),
    ];
    let maps = maps(&scenario);
    let seen = &maps[78];
    assert!(seen.contains("0a"), "4x4 far from the gaze: {seen}");
    for blinking in &maps[80..99] {
        assert_eq!(blinking, seen, "held for 20 frames");
    }
    let lost = &maps[199];
    let texels =
        |map: &str| -> Vec<String> { (0..64).map(|at| map[2 * at..2 * at + 2].to_owned()).collect() };
    let full = |map: &str| texels(map).iter().filter(|texel| *texel == "00").count();
    assert!(texels(lost).iter().all(|texel| texel.as_str() <= "05"), "2x2 at most: {lost}");
    assert!((full(seen)..64).contains(&full(lost)), "and only far out: {lost}");
}
