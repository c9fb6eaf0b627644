//! The benefit gate, with planted costs: a share of `cargo dev bench planted`.

use parafovea_tests::planted::decide;

/// Gains with a seed each: one to be kept, one to be dropped.
const PLANTED: [(f64, u64); 2] = [(0.1, 1), (-0.05, 1)];

#[test]
fn planted_gains_are_kept_and_planted_losses_dropped() {
    for (gain, seed) in PLANTED {
        let decision = decide(gain, seed).unwrap();
        assert!(decision.is_right, "gain {gain}, seed {seed}: {decision:?}");
        assert!((1..=4).contains(&decision.switches), "gain {gain}, seed {seed}: {decision:?}");
        // Off for short trials, or for good.
        let is_off = decision.off > 0.5;
        assert_eq!(is_off, gain < 0.0, "gain {gain}, seed {seed}: {decision:?}");
    }
}
