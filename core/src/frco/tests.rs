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
fn at_a_price_a_tile_stops_where_a_sample_is_worth_more_than_what_it_shows() {
    // Steps lose 4, 4, 2 and 2 for 1/2, 1/4, 1/8 and 1/16 of the samples.
    for (price, half_octaves) in
        [(7.9, 0), (8.0, 1), (15.9, 1), (16.0, 3), (31.9, 3), (32.0, 4), (-1.0, 0), (0.0, 0)]
    {
        assert_eq!(half_octaves_at([8.0, 4.0, 2.0, 1.0], price), half_octaves, "{price}");
    }
    // Nothing in the second octave: the loss of all of the first includes both.
    assert_eq!([0.9, 1.1, 1.2].map(|price| half_octaves_at([1.0, 0.0, 0.0, 0.0], price)), [0, 1, 4]);
    assert_eq!(half_octaves_at([0.0, 0.0, 3.0, 3.0], 0.0), 4, "nothing to see");
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(half_octaves_at([1.0; BANDS], bad), 0);
        for band in 0..BANDS {
            let mut bands = [0.0; BANDS];
            bands[band] = bad;
            assert_eq!(half_octaves_at(bands, f32::MAX), 0, "{bad} in band {band}");
        }
    }
}

#[test]
fn contrast_that_is_no_number_is_shaded_fully() {
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

    /// By both ways to spend a budget: more of it never gives a finer rate, more contrast never a coarser one, and no tile loses more than it.
    #[test]
    fn budgets_and_contrast_act_one_way_and_bound_the_loss(
        bands in bands(), budget in 0.0f32..1e4, more in 0.0f32..1e4, times in 1.0f32..8.0, band in 0..2usize,
    ) {
        for allocation in [Allocation::PerTile, Allocation::EqualMarginalLoss] {
            let given = allocation.half_octaves(bands, budget);
            prop_assert!(allocation.half_octaves(bands, budget + more) >= given);
            let mut seen_better = bands;
            seen_better[band] *= times;
            prop_assert!(allocation.half_octaves(seen_better, budget) <= given);
            let rate = by_half_octaves(&VULKAN_RATES)[usize::from(given)];
            prop_assert!(loss(bands, rate) <= budget * 1.000_001);
            if (bands[0] + bands[1]) * allocation.greatest_factor() <= budget * 0.999_99 {
                prop_assert_eq!(given, 4);
            }
        }
    }

    /// No map of a few tiles that shades as little loses less.
    #[test]
    fn equal_marginal_loss_is_the_least_for_its_samples(
        tiles in prop::collection::vec((0.0f32..4.0, 0.0f32..4.0), 4), price in 0.0f32..8.0,
    ) {
        let rates = by_half_octaves(&VULKAN_RATES);
        let of = |map: &[usize]| {
            let each = map.iter().zip(&tiles).map(|(half_octaves, (a, b))| {
                let rate = rates[*half_octaves];
                (loss([*a, *b, 0.0, 0.0], rate), rate.fraction())
            });
            each.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
        };
        let ours: Vec<usize> =
            tiles.iter().map(|(a, b)| usize::from(half_octaves_at([*a, *b, 0.0, 0.0], price))).collect();
        let (least, samples) = of(&ours);
        for other in 0..5usize.pow(4) {
            let map: Vec<usize> = (0..4).map(|tile| other / 5usize.pow(tile) % 5).collect();
            let (loss, shaded) = of(&map);
            prop_assert!(shaded > samples + 1e-6 || loss >= least - 1e-4, "{map:?} against {ours:?}");
        }
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
