use super::*;
use proptest::prelude::*;

const SPEECH: (f32, f32) = (12.0, 1.5);

#[test]
fn one_loudness_unit_is_worth_the_same_everywhere() {
    // 10000 / 0.19 * 0.05.
    for gamma_ld in [0.0, 7.0, 24.0] {
        let more = PAPER.alpha(gamma_ld + 1.0, 2.0) - PAPER.alpha(gamma_ld, 2.0);
        assert!((more - 2631.58).abs() < 0.02, "{more}");
    }
    // Frequency alone, from 6 kHz to 1 kHz: 9.3e3 to 2.4e4.
    assert!((PAPER.alpha(0.0, 2.5457) - 9303.6).abs() < 0.1);
    assert!((PAPER.alpha(0.0, 1.0) - 23_684.2).abs() < 0.1);
}

#[test]
fn the_budget_is_the_visual_loss_that_brings_the_score_to_the_threshold() {
    let own = Coefficients { a: 0.02, b: 0.3, c: 0.4, d: 3.0 };
    for coefficients in [PAPER, own] {
        for threshold in [coefficients.d, 2.5, 3.9] {
            let alpha = coefficients.alpha_above(threshold, SPEECH.0, SPEECH.1);
            let score = coefficients.score(SPEECH.0, SPEECH.1, alpha);
            assert!((score - threshold).abs() < 1e-5, "{coefficients:?}: {score}, not {threshold}");
        }
    }
    assert!(PAPER.alpha_above(5.0, SPEECH.0, SPEECH.1) < 0.0);
}

#[test]
fn features_outside_of_any_sound_give_no_budget() {
    for (gamma_ld, gamma_fq) in [
        (12.0, 0.0),
        (12.0, -1.0),
        (12.0, f32::NAN),
        (12.0, f32::INFINITY),
        (f32::NAN, 1.5),
        (f32::INFINITY, 1.5),
        (f32::NEG_INFINITY, 1.5),
    ] {
        assert_eq!(PAPER.alpha(gamma_ld, gamma_fq), 0.0, "{gamma_ld} {gamma_fq}");
    }
    for c in [0.0, -0.19, f32::NAN, f32::MIN_POSITIVE / 1e6] {
        assert_eq!(Coefficients { c, ..PAPER }.alpha(12.0, 1.5), 0.0, "c = {c}");
    }
    // Beyond the range counts as its end.
    assert_eq!(PAPER.alpha(1e30, 0.05), PAPER.alpha(25.0, 1.0));
    assert_eq!(PAPER.alpha(-3.0, 1e30), PAPER.alpha(0.0, 2.5457));
}

#[test]
fn silence_follows_its_rule() {
    let with = |silence| BudgetSettings { silence, ..BudgetSettings::default() };
    for silent in [(0.0, 0.0, true), (12.0, 1.5, true), (0.0, 0.0, false), (f32::NAN, 1.5, false)] {
        let budget = |silence| with(silence).budget(silent.0, silent.1, silent.2);
        assert_eq!(budget(SilenceRule::FixedFoveation), Budget::FixedFoveation, "{silent:?}");
        assert_eq!(budget(SilenceRule::Strict), Budget::Alpha(0.0));
        assert_eq!(budget(SilenceRule::Alpha(0.3)), Budget::Alpha(0.3));
        assert_eq!(budget(SilenceRule::Alpha(f32::NAN)), Budget::Alpha(0.0));
        assert_eq!(budget(SilenceRule::Alpha(f32::INFINITY)), Budget::Alpha(0.0));
    }
    // Audible, however quiet: the rule does not matter.
    for rule in [SilenceRule::FixedFoveation, SilenceRule::Strict, SilenceRule::Alpha(9.0)] {
        let Budget::Alpha(alpha) = with(rule).budget(0.0, 1.0, false) else { panic!("{rule:?}") };
        assert!((alpha - 23_684.2 / 5e4).abs() < 1e-5);
    }
}

#[test]
fn the_budget_is_in_the_units_of_the_sensitivity() {
    // A divisor of 10 000 in Tursun's units is one of 0.2 in castleCSF's.
    assert_eq!(VISUAL_LOSS_SCALE / SensitivityUnit::CastleCsf.kappa(), 0.2);
    let paper = BudgetSettings::PAPER.budget(SPEECH.0, SPEECH.1, false);
    assert_eq!(paper, Budget::Alpha(PAPER.alpha(SPEECH.0, SPEECH.1)));
    let default = BudgetSettings::default().budget(SPEECH.0, SPEECH.1, false);
    assert_eq!(default, Budget::Alpha(PAPER.alpha(SPEECH.0, SPEECH.1) / 5.0e4));
}

proptest! {
    #[test]
    fn louder_and_lower_sound_pays_for_more(
        gamma_ld in 0.0f32..25.0,
        louder in 0.0f32..25.0,
        gamma_fq in 0.01f32..4.0,
        higher in 0.0f32..4.0,
    ) {
        let alpha = PAPER.alpha(gamma_ld, gamma_fq);
        prop_assert!(PAPER.alpha(gamma_ld + louder, gamma_fq) >= alpha);
        prop_assert!(PAPER.alpha(gamma_ld, gamma_fq + higher) <= alpha);
    }

    #[test]
    fn any_input_gives_a_finite_budget(
        coefficients in prop::array::uniform4(prop::num::f32::ANY),
        threshold in prop::num::f32::ANY,
        gamma_ld in prop::num::f32::ANY,
        gamma_fq in prop::num::f32::ANY,
        silent: bool,
    ) {
        let [a, b, c, d] = coefficients;
        let settings = BudgetSettings {
            coefficients: Coefficients { a, b, c, d },
            threshold,
            silence: SilenceRule::Strict,
            unit: SensitivityUnit::CastleCsf,
        };
        let budget = settings.budget(gamma_ld, gamma_fq, silent);
        prop_assert!(matches!(budget, Budget::Alpha(alpha) if alpha.is_finite()), "{:?}", budget);
    }
}
