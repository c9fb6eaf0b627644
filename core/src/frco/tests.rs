use super::*;
use crate::avpm::SensitivityUnit;
use crate::plan::Sensitivity;
use crate::rate::{PAPER_RATES, VULKAN_RATES};
use proptest::prelude::*;

fn bands() -> impl Strategy<Value = [f32; BANDS]> {
    // From castleCSF's scale to beyond Tursun's.
    prop::array::uniform4((-6.0f32..7.0, any::<bool>()).prop_map(
        |(log, zero)| {
            if zero { 0.0 } else { 10f32.powf(log) }
        },
    ))
}

#[test]
fn loss_is_the_sum_of_the_bands_that_a_rate_removes() {
    let bands = [8.0, 4.0, 2.0, 1.0];
    let by_rate = VULKAN_RATES.map(|rate| loss(bands, rate));
    assert_eq!(by_rate, [12.0, 10.0, 10.0, 8.0, 4.0, 4.0, 0.0]);
}

#[test]
fn the_coarsest_affordable_rate_wins_and_ties_are_within_the_budget() {
    let bands = [8.0, 4.0, 2.0, 1.0];
    for (alpha, rate) in [
        (12.0, ShadingRate::R4X4),
        (11.999_999, ShadingRate::R4X2),
        (10.0, ShadingRate::R4X2),
        (9.999_999, ShadingRate::R2X2),
        (8.0, ShadingRate::R2X2),
        (7.999_999_5, ShadingRate::R2X1),
        (4.0, ShadingRate::R2X1),
        (3.999_999_8, ShadingRate::R1X1),
        (0.0, ShadingRate::R1X1),
        (-1.0, ShadingRate::R1X1),
    ] {
        assert_eq!(coarsest(bands, alpha, &VULKAN_RATES), rate, "alpha {alpha}");
    }
    // Of 2x4 and 4x2 the paper's device had the former.
    assert_eq!(coarsest(bands, 10.0, &PAPER_RATES), ShadingRate::R2X4);
    // Nothing to see: nothing to lose, even for nothing.
    assert_eq!(coarsest([0.0, 0.0, 3.0, 3.0], 0.0, &VULKAN_RATES), ShadingRate::R4X4);
    assert_eq!(coarsest(bands, 100.0, &[]), ShadingRate::R1X1);
}

#[test]
fn what_is_no_number_is_shaded_fully() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(coarsest([1.0; BANDS], bad, &VULKAN_RATES), ShadingRate::R1X1);
        for band in 0..BANDS {
            let mut bands = [0.0; BANDS];
            bands[band] = bad;
            assert_eq!(coarsest(bands, f32::MAX, &VULKAN_RATES), ShadingRate::R1X1, "{bad} in band {band}");
            assert_eq!(loss(bands, ShadingRate::R1X1), 0.0);
            assert_eq!(loss(bands, ShadingRate::R2X1), f32::INFINITY);
        }
    }
    // The sum overflows.
    assert_eq!(coarsest([f32::MAX; BANDS], f32::MAX, &VULKAN_RATES), ShadingRate::R2X2);
    assert_eq!(coarsest([-8.0, -4.0, 0.0, 0.0], 4.0, &VULKAN_RATES), ShadingRate::R2X1);
}

#[test]
fn visual_loss_averages_over_pixels() {
    let block = |rate, pixels| Block { band_sensitivity: [8.0, 4.0, 2.0, 1.0], rate, pixels };
    let blocks = [block(ShadingRate::R4X4, 256), block(ShadingRate::R1X1, 256), block(ShadingRate::R2X2, 64)];
    let expected = (12.0 * 256.0 + 8.0 * 64.0) / 576.0;
    assert!((visual_loss(blocks) - expected).abs() < 1e-6);
    assert!((perceived_quality(blocks) - (15.0 - expected)).abs() < 1e-6);
    // A bad block takes nothing from, and adds nothing to, the others.
    let bad = Block { band_sensitivity: [1.0, f32::NAN, 1.0, 1.0], ..block(ShadingRate::R4X4, 1000) };
    assert_eq!(visual_loss(blocks.into_iter().chain([bad])), visual_loss(blocks));
    assert_eq!(visual_loss([bad]), 0.0);
    assert_eq!(perceived_quality([]), 0.0);
    assert_eq!(visual_loss([block(ShadingRate::R4X4, 0)]), 0.0);
    let huge = Block { band_sensitivity: [f32::MAX; BANDS], rate: ShadingRate::R2X2, pixels: 1 };
    assert_eq!(perceived_quality([huge]), f32::MAX);
}

#[test]
fn visual_loss_keeps_its_digits_over_many_blocks() {
    // Nine million blocks of which each loses a little: a sum in single precision would stop at a part of it.
    let block = Block { band_sensitivity: [0.1, 0.0, 1e4, 0.0], rate: ShadingRate::R2X2, pixels: 256 };
    let loss = visual_loss(std::iter::repeat_n(block, 9_000_000));
    assert!((loss - 0.1).abs() < 1e-7, "{loss}");
}

proptest! {
    #[test]
    fn loss_does_not_fall_towards_coarser_rates(bands in bands()) {
        for pair in VULKAN_RATES.windows(2) {
            prop_assert!(loss(bands, pair[0]) >= loss(bands, pair[1]));
        }
        prop_assert_eq!(loss(bands, ShadingRate::R1X1), 0.0);
    }

    #[test]
    fn a_larger_budget_never_gives_a_finer_rate(
        bands in bands(),
        alpha in prop::num::f32::NORMAL,
        more in 0.0f32..1e6,
        rates in prop::collection::vec(prop::sample::select(VULKAN_RATES.to_vec()), 0..8),
    ) {
        let (poor, rich) = (coarsest(bands, alpha, &rates), coarsest(bands, alpha + more, &rates));
        prop_assert!(rich.octaves() >= poor.octaves());
    }

    /// By either sensitivity function: contrast farther out is less visible, hence never shaded finer.
    #[test]
    fn equal_content_farther_out_never_gets_a_finer_rate(
        contrast in prop::array::uniform4(0.0f32..4.0),
        part in 0.0f32..1.0,
        pixels_per_degree in 4.0f32..60.0,
        luminance_cd_m2 in 0.01f32..1e3,
        eccentricity_deg in 0.0f32..90.0,
        farther_deg in 0.0f32..40.0,
    ) {
        for unit in [SensitivityUnit::CastleCsf, SensitivityUnit::Tursun] {
            let function = Sensitivity::new(unit);
            let visible = |eccentricity_deg| {
                let sensitivity = function.bands(pixels_per_degree, eccentricity_deg, luminance_cd_m2);
                [0, 1, 2, 3].map(|band: usize| contrast[band] * sensitivity[band])
            };
            // A budget that at the gaze is worth some rate between 1x1 and 4x4.
            let alpha = part * loss(visible(0.0), ShadingRate::R4X4);
            let rate = |eccentricity_deg| coarsest(visible(eccentricity_deg), alpha, &VULKAN_RATES);
            let (near, far) = (rate(eccentricity_deg), rate(eccentricity_deg + farther_deg));
            prop_assert!(far.octaves() >= near.octaves(), "{unit:?}: {near:?}, then {far:?}");
        }
    }

    #[test]
    fn the_answer_is_the_coarsest_whose_loss_is_within_the_budget(
        bands in prop::array::uniform4(prop::num::f32::ANY),
        alpha in prop::num::f32::ANY,
        part in prop::sample::select(vec![0.0f32, 0.5, 1.0, 1.5, 2.0]),
    ) {
        // Half of the budgets are ties.
        let tie = loss(bands, ShadingRate::R4X4) * 0.5 * part;
        for alpha in [alpha, tie] {
            let rate = coarsest(bands, alpha, &VULKAN_RATES);
            let affordable = |rate: &&ShadingRate| alpha.is_finite() && loss(bands, **rate) <= alpha;
            let expected = VULKAN_RATES.iter().find(affordable).copied().unwrap_or(ShadingRate::R1X1);
            prop_assert_eq!(rate, expected);
        }
    }
}
