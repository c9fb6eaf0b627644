use super::cap::{PeriodCap, period_cap};
use super::*;
use crate::geometry::{Fov, eccentricity};
use glam::Vec2;
use proptest::prelude::*;

#[test]
fn configurations_read_back() {
    for configuration in UpdateConfiguration::PAPER {
        assert_eq!(UpdateConfiguration::new(configuration.factors()), Ok(configuration));
        assert_eq!(configuration.to_string().parse(), Ok(configuration));
    }
    assert_eq!("22345".parse::<UpdateConfiguration>().map(UpdateConfiguration::factors), Ok([2, 2, 3, 4, 5]));
}

#[test]
fn wrong_configurations_say_what_is_allowed() {
    for (text, named) in [
        ("1123", "not 4"),
        ("112233", "not 6"),
        ("1122x", "'x'"),
        ("11222 ", "' '"),
        ("1122３", "'３'"),
        ("01122", "factor 0"),
        ("11124", "factor 4 after 2"),
        ("12212", "factor 1 after 2"),
        ("", "not 0"),
    ] {
        let error = text.parse::<UpdateConfiguration>().expect_err(text).to_string();
        assert!(error.contains(named) && error.contains("such as 11223"), "{text}: {error}");
    }
    assert!(UpdateConfiguration::new([6, 7, 8, 9, 10]).is_err());
}

/// Every configuration that is allowed.
fn configurations() -> impl Strategy<Value = UpdateConfiguration> {
    (1u8..=5, [0u8..=1, 0u8..=1, 0u8..=1, 0u8..=1]).prop_map(|(first, steps)| {
        let mut factors = [first; REGIONS];
        for i in 1..REGIONS {
            factors[i] = factors[i - 1] + steps[i - 1];
        }
        UpdateConfiguration::new(factors).unwrap()
    })
}

proptest! {
    #[test]
    fn caps_and_steps_keep_the_rules(configuration in configurations(), cap in 0u8..12) {
        let capped = configuration.capped(cap);
        prop_assert!(UpdateConfiguration::new(capped.factors()).is_ok());
        prop_assert!(capped.factors().iter().all(|&factor| factor <= cap.max(1)));
        let faster = configuration.faster();
        prop_assert!(UpdateConfiguration::new(faster.factors()).is_ok());
        for (new, old) in faster.factors().into_iter().zip(configuration.factors()) {
            prop_assert!(new == old - 1 || new == 1 && old == 1);
        }
    }

    #[test]
    fn each_region_keeps_its_own_cap(configuration in configurations(), caps in proptest::array::uniform5(0u8..12)) {
        let limited = configuration.limited(caps);
        prop_assert!(UpdateConfiguration::new(limited.factors()).is_ok());
        let mut cap = 1;
        for ((new, old), own) in limited.factors().into_iter().zip(configuration.factors()).zip(caps) {
            cap = own.max(cap);
            prop_assert!(new <= cap && new <= old);
        }
        prop_assert_eq!(configuration.limited([9; REGIONS]), configuration);
    }

    #[test]
    fn a_direction_is_due_once_in_any_period(
        start in prop_oneof![0..u64::MAX - 9, 0..1000u64],
        x in -1f32..1.0, y in -1f32..1.0, z in -1f32..1.0,
        period in 1u8..=9,
        phase in prop_oneof![Just(Phase::Aligned), Just(Phase::Staggered), Just(Phase::AlternateEye)],
        eye in 0usize..2,
    ) {
        prop_assume!(Vec3::new(x, y, z) != Vec3::ZERO);
        let schedule = Schedule { phase, ..Schedule::default() };
        let due = |frame| schedule.is_due(frame, Vec3::new(x, y, z), period, eye);
        prop_assert_eq!((start..start + u64::from(period)).filter(|&frame| due(frame)).count(), 1);
    }
}

#[test]
fn regions_end_at_their_radii() {
    let schedule = Schedule { configuration: UpdateConfiguration::F12345, ..Schedule::default() };
    for (eccentricity_deg, period) in [
        (0.0, 1),
        (6.3, 1),
        (6.4, 2),
        (9.2, 3),
        (18.2, 4),
        (31.1, 4),
        (31.2, 5),
        (180.0, 5),
        (f32::INFINITY, 5),
        (f32::NAN, 1),
        (-1.0, 1),
    ] {
        assert_eq!(schedule.period_at(eccentricity_deg), period, "at {eccentricity_deg}");
    }
}

#[test]
fn directions_without_a_cell_are_always_due() {
    let schedule = Schedule::default();
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert!((0..9).all(|frame| schedule.is_due(frame, direction, 3, 0)));
    }
    assert!((0..9).all(|frame| schedule.is_due(frame, Vec3::X, 0, 0)));
    assert!((0..9).all(|frame| schedule.is_due(frame, Vec3::X, 10, 0)));
}

#[test]
fn the_eyes_alternate_only_when_asked_to() {
    for (phase, together) in [(Phase::Aligned, true), (Phase::Staggered, true), (Phase::AlternateEye, false)]
    {
        let schedule = Schedule { phase, ..Schedule::default() };
        let due = |frame, eye| schedule.is_due(frame, Vec3::new(0.7, 0.1, -1.0), 2, eye);
        assert!((0..4).all(|frame| (due(frame, 0) == due(frame, 1)) == together));
    }
}

#[test]
fn the_cap_keeps_the_periphery_at_30_hz() {
    for (rate, cap) in [
        (0.0, 1),
        (-90.0, 1),
        (29.0, 1),
        (30.0, 1),
        (59.9, 1),
        (60.0, 2),
        (72.0, 2),
        (89.9, 2),
        (89.95, 3),
        (90.0, 3),
        (120.0, 4),
        (144.0, 4),
        (1000.0, 9),
        (f32::NAN, 1),
        (f32::INFINITY, 1),
    ] {
        assert_eq!(period_cap(rate), cap, "at {rate}");
    }
}

#[test]
fn a_rate_that_hovers_does_not_move_the_cap() {
    let mut cap = PeriodCap::default();
    // Not reached yet: the safe side.
    assert_eq!([89.9, 89.8].map(|rate| cap.update(rate)), [2, 2]);
    assert_eq!([90.0, 89.9, 90.1, 89.2].map(|rate| cap.update(rate)), [3, 3, 3, 3]);
    assert_eq!([89.0, 89.9, 45.0, f32::NAN].map(|rate| cap.update(rate)), [2, 2, 1, 1]);
    assert_eq!(cap.update(1000.0), 9);
}

#[test]
fn pixels_are_counted_by_region() {
    let fov = Fov { left: -0.7, right: 0.8, up: 0.6, down: -0.5 };
    let (plane, extent) = (fov.tangents().plane([31, 23]), [31, 23]);
    let gaze = Vec3::new(0.2, -0.1, -1.0);
    let regions = Regions::default();
    let mut counted = [0; REGIONS];
    for y in 0..extent[1] {
        for x in 0..extent[0] {
            let direction = plane.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
            counted[regions.region_at(eccentricity(direction, gaze).to_degrees())] += 1;
        }
    }
    assert_eq!(regions.pixel_counts(&plane, extent, gaze), counted);
    assert!(counted.iter().all(|&count| count > 0));
    for gaze in [Vec3::ZERO, Vec3::NAN] {
        assert_eq!(regions.pixel_counts(&plane, extent, gaze), [31 * 23, 0, 0, 0, 0]);
    }
    assert_eq!(regions.pixel_counts(&plane, extent, Vec3::Z), [0, 0, 0, 0, 31 * 23]);
    let unbounded = Regions { radii_deg: [5.0, f32::NAN, 200.0, 200.0] };
    assert_eq!(unbounded.pixel_counts(&plane, extent, Vec3::Z), [0, 31 * 23, 0, 0, 0]);
    assert_eq!(unbounded.region_at(150.0), 1);
}

#[test]
fn pixel_rate_of_areas_without_a_meaning_is_full() {
    let rate = |areas| pixel_rate(areas, UpdateConfiguration::F12345);
    assert_eq!(rate([0.0; 5]), 1.0);
    assert_eq!(rate([f32::NAN, -1.0, f32::INFINITY, 0.0, 0.0]), 1.0);
    assert_eq!(rate([0.0, 0.0, 0.0, 0.0, 7.0]), 0.2);
    assert_eq!(rate([1.0, 1.0, 0.0, 0.0, 0.0]), 0.75);
}

#[test]
fn enlarged_regions_hold_more() {
    let regions = Regions::default().enlarged(2.0);
    assert_eq!(regions.radii_deg, [8.3, 11.1, 20.1, 33.1]);
    for nothing in [0.0, -3.0, f32::NAN] {
        assert_eq!(Regions::default().enlarged(nothing), Regions::default());
    }
}
