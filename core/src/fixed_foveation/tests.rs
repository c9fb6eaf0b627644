use super::*;
use crate::geometry::{Fov, ImagePlane};
use crate::rate::{PAPER_RATES, VULKAN_RATES};
use glam::Vec3;
use proptest::prelude::*;

const EXTENT: [u32; 2] = [2160; 2];

/// PICO 4: 105 degrees, one image of 2160 x 2160 (paper A, section 3.2.1).
fn pico_4() -> ImagePlane {
    let half = 52.5f32.to_radians();
    Fov { left: -half, right: half, up: half, down: -half }.tangents().plane(EXTENT)
}

fn tiles() -> Vec<f32> {
    eccentricities_deg(&pico_4(), EXTENT, [16, 16], Vec3::NEG_Z)
}

#[test]
fn the_rate_falls_linearly_between_the_radii() {
    let map = FixedFoveation { foveal_deg: 10.0, transitional_deg: 30.0, peripheral: ShadingRate::R2X2 };
    for (eccentricity, rate) in [
        (0.0, 1.0),
        (10.0, 1.0),
        (20.0, 0.625),
        (30.0, 0.25),
        (180.0, 0.25),
        (f32::INFINITY, 0.25),
        (-5.0, 1.0),
        (f32::NAN, 1.0),
    ] {
        assert_eq!(map.rate_at(eccentricity), rate, "{eccentricity} degrees");
    }
    assert_eq!(map.reaches_deg(0.625), 20.0);
    assert_eq!(map.reaches_deg(0.25), 30.0);
    assert_eq!(map.reaches_deg(1.0), 0.0);
    assert_eq!(map.reaches_deg(0.125), f32::INFINITY);
}

#[test]
fn rates_are_rounded_to_the_finer_one() {
    let map = FixedFoveation { foveal_deg: 10.0, transitional_deg: 25.0, peripheral: ShadingRate::R4X4 };
    // One degree is 1/16 of the rate.
    for (eccentricity, paper, vulkan) in [
        (10.0, ShadingRate::R1X1, ShadingRate::R1X1),
        (17.9, ShadingRate::R1X1, ShadingRate::R1X1),
        (18.1, ShadingRate::R1X1, ShadingRate::R2X1),
        (22.1, ShadingRate::R2X2, ShadingRate::R2X2),
        (24.1, ShadingRate::R2X4, ShadingRate::R4X2),
        (25.0, ShadingRate::R4X4, ShadingRate::R4X4),
    ] {
        assert_eq!(map.shading_rate(eccentricity), paper, "{eccentricity} degrees");
        assert_eq!(map.shading_rate_of(eccentricity, &VULKAN_RATES), vulkan, "{eccentricity} degrees");
    }
    assert_eq!(map.shading_rate_of(90.0, &[]), ShadingRate::R1X1);
    assert_eq!(map.shading_rate_of(90.0, &[ShadingRate::R2X2]), ShadingRate::R2X2);
}

#[test]
fn radii_without_a_meaning_shade_fully() {
    for (foveal_deg, transitional_deg) in
        [(f32::NAN, 30.0), (10.0, f32::NAN), (f32::INFINITY, 30.0), (10.0, f32::INFINITY)]
    {
        let map = FixedFoveation { foveal_deg, transitional_deg, peripheral: ShadingRate::R4X4 };
        assert_eq!(map.rate_at(90.0), 1.0, "{map:?}");
    }
    // A transition that ends before it begins is a step.
    let step = FixedFoveation { foveal_deg: 20.0, transitional_deg: 5.0, peripheral: ShadingRate::R4X4 };
    assert_eq!([step.rate_at(20.0), step.rate_at(20.001)], [1.0, 0.0625]);
    assert_eq!(step.reaches_deg(0.5), 20.0);
}

#[test]
fn the_pilot_study_has_nine_pairs() {
    let pairs = FixedFoveation::PILOT.map(|map| (map.foveal_deg, map.transitional_deg));
    assert_eq!(pairs[0], (14.34, 27.08));
    assert_eq!(pairs[5], (12.26, 18.39));
    assert_eq!(pairs[6], (9.44, 27.08));
    assert!(FixedFoveation::PILOT.iter().all(|map| map.peripheral == ShadingRate::R4X4));
    let shaded = FixedFoveation::PILOT.map(|map| map.mean_rate(&tiles()));
    for level in shaded.chunks(3) {
        assert!(level.is_sorted_by(|a, b| a > b), "{level:?}");
    }
    for condition in 0..3 {
        assert!(shaded[condition] > shaded[condition + 3] && shaded[condition + 3] > shaded[condition + 6]);
    }
}

/// Shading of FR on the paper's headset, which any speed-up against it depends on: with its periphery of 1/16, and
/// of 1/4.
#[test]
fn mean_rates_on_the_papers_headset() {
    let pixels = eccentricities_deg(&pico_4(), EXTENT, [1, 1], Vec3::NEG_Z);
    let tiles = tiles();
    assert_eq!((pixels.len(), tiles.len()), (2160 * 2160, 135 * 135));
    for (peripheral, continuous, paper, vulkan) in
        [(ShadingRate::R4X4, 0.1274, 0.1617, 0.1477), (ShadingRate::R2X2, 0.3019, 0.3444, 0.3250)]
    {
        let map = FixedFoveation::L1_C1.with_peripheral(peripheral);
        let found = [
            map.mean_rate(&pixels),
            map.mean_shading_rate(&tiles, &PAPER_RATES),
            map.mean_shading_rate(&tiles, &VULKAN_RATES),
        ];
        for (found, expected) in found.into_iter().zip([continuous, paper, vulkan]) {
            assert!((found - expected).abs() < 1e-4, "{peripheral:?}: {found}, expected {expected}");
        }
    }
}

#[test]
fn eccentricities_are_those_of_the_nearest_point() {
    let plane = pico_4();
    // An odd size: the last tile of each row and column is cut.
    let tiles = eccentricities_deg(&plane, [33, 17], [16, 16], plane.direction([0.0, 0.0].into()));
    assert_eq!(tiles.len(), 6);
    assert_eq!(tiles[0], 0.0);
    assert!(tiles[1] > 0.0 && tiles[2] > tiles[1] && tiles[5] > tiles[3]);
    assert_eq!(eccentricities_deg(&plane, [3, 2], [0, 0], Vec3::NEG_Z).len(), 6);
    assert_eq!(eccentricities_deg(&plane, [0, 2], [16, 16], Vec3::NEG_Z), []);
    assert_eq!(eccentricities_deg(&plane, [3, 2], [1, 1], Vec3::ZERO), [0.0; 6]);
}

fn map() -> impl Strategy<Value = FixedFoveation> {
    let peripheral = prop::sample::select(VULKAN_RATES.to_vec());
    (0.0f32..90.0, 0.0f32..90.0, peripheral).prop_map(|(foveal_deg, transitional_deg, peripheral)| {
        FixedFoveation { foveal_deg, transitional_deg, peripheral }
    })
}

/// Infinity less infinity was not a number.
#[test]
fn a_fovea_without_end_is_never_left() {
    let map =
        FixedFoveation { foveal_deg: f32::INFINITY, transitional_deg: 0.0, peripheral: ShadingRate::R4X4 };
    assert_eq!(map.reaches_deg(0.5), f32::INFINITY);
    assert_eq!(map.rate_at(180.0), 1.0);
}

proptest! {
    #[test]
    fn the_rate_does_not_rise_with_eccentricity(map in map(), at in 0.0f32..180.0, further in 0.0f32..10.0) {
        let (near, far) = (map.rate_at(at), map.rate_at(at + further));
        prop_assert!(far <= near && far >= map.peripheral.fraction() && near <= 1.0);
        let rate = |at| map.shading_rate_of(at, &VULKAN_RATES).fraction();
        prop_assert!(rate(at + further) <= rate(at));
        prop_assert!(rate(at) >= near);
    }

    #[test]
    fn a_ring_begins_where_its_rate_is_reached(map in map(), rate in prop::sample::select(VULKAN_RATES.to_vec())) {
        let radius = map.reaches_deg(rate.fraction());
        if radius.is_finite() {
            prop_assert!(map.rate_at(radius + 1e-3) <= rate.fraction() + 1e-4);
            // Where the fall is steeper than rounding in the radius allows for, the rate before it is arbitrary.
            prop_assert!(radius < 1e-3 || map.rate_at(radius - 1e-3) >= rate.fraction() - 1e-4);
        } else {
            prop_assert!(map.rate_at(180.0) > rate.fraction());
        }
    }

    #[test]
    fn any_input_gives_a_rate(
        foveal_deg in prop::num::f32::ANY,
        transitional_deg in prop::num::f32::ANY,
        at in prop::num::f32::ANY,
        fraction in prop::num::f32::ANY,
    ) {
        let map = FixedFoveation { foveal_deg, transitional_deg, peripheral: ShadingRate::R4X4 };
        prop_assert!((0.0625..=1.0).contains(&map.rate_at(at)));
        prop_assert!(!map.reaches_deg(fraction).is_nan());
    }
}
