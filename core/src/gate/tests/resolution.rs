//! Decisions at changing resolutions.

use super::game::{Control, Game};
use super::simulation::{Eyes, Simulation};
use super::{Gate, GateFrame, GateMode, SECOND};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// At a constant resolution the gate decides the same, bit for bit, whether or not it knows the pixels.
    #[test]
    fn a_constant_resolution_changes_nothing(
        seed: u64,
        ratio in 0.5f64..1.5,
        noise in 0.0f64..0.5,
        pixels in 1u32..,
        hz in prop::sample::select(vec![10.0, 90.0]),
        eyes in prop::sample::select(vec![Eyes::Rest, Eyes::Move, Eyes::Lost]),
    ) {
        let mut simulation = Simulation::new(seed).ratio(ratio).noise(noise).latency(1).rate(hz).eyes(eyes);
        simulation.set_pixels(pixels);
        let [mut knowing, mut unknowing] = [(); 2].map(|()| Gate::new(GateMode::Auto));
        while simulation.now() < 5 * 60 * SECOND {
            let frame = simulation.frame(knowing.is_on());
            let on = knowing.frame(&frame, true);
            prop_assert_eq!(on, unknowing.frame(&GateFrame { pixels: 0, ..frame }, true));
            prop_assert_eq!(knowing.evidence(), unknowing.evidence());
            prop_assert_eq!(knowing.wants_costs(), unknowing.wants_costs());
        }
    }

    /// With dynamic resolution, whatever its speed, steps and share of the cost, a clear saving is kept.
    #[test]
    fn dynamic_resolution_keeps_a_saving(
        seed: u64,
        gain in 0.2f64..0.4,
        share in 0.5f64..1.0,
        seconds in 0.03f64..3.0,
        has_steps: bool,
    ) {
        let control = if has_steps { Control::Steps(seconds) } else { Control::Smooth(seconds) };
        let game = Game { control, share, gain, noise: 0.05, ..Game::DEFAULT };
        let played = game.play(Eyes::Rest, seed, 120);
        prop_assert!(played.on > 0.8 && played.is_kept_at_30_s, "{:?}", played);
    }

    /// Pixels that no cost follows, as in a game that its CPU limits, make a slowdown no saving.
    #[test]
    fn idle_pixels_hide_no_slowdown(seed: u64, loss in 0.1f64..0.4, seconds in 0.05f64..10.0, jumps: bool) {
        let control = if jumps { Control::Jumps(seconds) } else { Control::Wander(seconds) };
        let game = Game { control, share: 0.0, gain: -loss, noise: 0.05, ..Game::DEFAULT };
        let played = game.play(Eyes::Rest, seed, 120);
        prop_assert!(played.on < 0.2 && !played.is_kept_at_30_s, "{:?}", played);
    }
}

/// A menu at the greatest resolution, with the passes of the game, where the technique costs time: a control finds that the game, which has
/// dynamic resolution, gets more pixels by it.
#[test]
fn a_slowdown_in_a_menu_is_not_the_game_s() {
    for eyes in [Eyes::Rest, Eyes::Move] {
        for seed in 0..12 {
            let game = Game { control: Control::Smooth(0.05), gain: 0.25, menu_s: 20, ..Game::DEFAULT };
            let played = game.play(eyes, seed, 120);
            assert!(played.on > 0.3 && played.is_kept, "{eyes:?}, seed {seed}: {played:?}");
            let played = Game { is_known: false, ..game }.play(eyes, seed, 120);
            assert!(!played.is_kept, "{eyes:?}, seed {seed}: the gate needs no pixels");
        }
    }
}

/// Pixels that ignore the cost hide a saving in the cost alone from one first trial in eight, but not in the cost per pixel: a second one
/// finds it without an eye tracker.
#[test]
fn a_saving_that_is_likely_per_pixel_has_a_second_trial() {
    let [mut early, mut late] = [0; 2];
    for share in [0.0, 0.9] {
        let game = Game { control: Control::Wander(1.0), share, gain: 0.1, ..Game::DEFAULT };
        for played in (0..60).map(|seed| game.play(Eyes::Rest, seed, 180)) {
            early += usize::from(!played.is_kept_at_30_s);
            late += usize::from(!played.is_kept);
        }
    }
    assert!(early > 8 && 4 * late <= early, "{early} of 120 missed at first, {late} still");
}
