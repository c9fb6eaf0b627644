//! The safety limits on synthetic gaze with known truth: the figures of `cargo dev bench safety`, asserted of shorter scripts.

use parafovea_models::safety::{Case, When, cases, follow};

const SEEDS: [u64; 1] = [42];
const DURATION_S: f64 = 12.0;

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).expect("a case of this name")
}

/// Less is shaded, and hardly more is lost where the eyes are once they have landed.
#[test]
fn coarsening_in_saccades_saves_and_costs_little_after_landing() {
    // With rates by contrast, the region left behind gets as coarse as 4x4 within a saccade, so a landing farther than predicted loses more.
    for (name, most_ratio, most_share, most_lost) in [
        ("moving, 120 Hz", 0.98, 0.245, 1.15),
        ("moving, 60 Hz", 0.995, 0.252, 1.15),
        ("contrast, moving, 120 Hz", 0.95, 0.18, 1.4),
    ] {
        let [before, after] = [false, true].map(|at_once| follow(&case(name), at_once, &SEEDS, DURATION_S));
        let (share, ratio) = (after.all.share(), after.all.share() / before.all.share());
        assert!(share < most_share, "{name}: {share} is shaded");
        assert!(ratio < most_ratio, "{name}: {ratio} of the samples without");
        let lost = |when: When| [before, after].map(|score| score.when[when as usize].central_loss());
        let [before, after] = lost(When::Looking);
        assert!(after < 1e-4 && before < 1e-4, "{name}: {before} and {after} lost while looking");
        let [before, after] = lost(When::Landing);
        assert!(after < most_lost * before + 1e-4, "{name}: {before} and {after} lost at landing");
    }
}

/// Bare rings around the true gaze lose nothing there: the measure is worth no more than that.
#[test]
fn the_true_gaze_loses_nothing_in_its_own_rings() {
    let score = follow(&case("moving, true gaze, no safety limits"), true, &SEEDS, 3.0);
    for when in When::ALL {
        assert_eq!(score.when[when as usize].central_loss(), 0.0, "{when:?}");
    }
    assert!(score.all.loss() > 0.0 && score.all.share() < 0.3, "{score:?}");
}
