use super::*;
use proptest::prelude::*;
use std::f32::consts::PI;

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_filter_map("too short", |(x, y, z)| Vec3::new(x, y, z).try_normalize())
}

fn cap() -> impl Strategy<Value = Cap> {
    (direction(), 0.0f32..PI).prop_map(|(centre, radius)| Cap { centre, radius })
}

/// Angle between a direction and a cap, radians; 0 within.
fn outside(cap: Cap, direction: Vec3) -> f32 {
    (eccentricity(cap.centre, direction) - cap.radius).max(0.0)
}

#[test]
fn a_jump_spans_a_cap_that_then_closes_around_its_end() {
    let (from, to) = (Vec3::NEG_Z, Vec3::X);
    let spanned = Cap { centre: from, radius: 0.0 }.including(to);
    assert!((spanned.radius - PI / 4.0).abs() < 1e-6);
    assert!((spanned.centre - Vec3::new(1.0, 0.0, -1.0).normalize()).length() < 1e-6);
    let half = spanned.contracted_to(to, PI / 4.0);
    assert!((half.radius - PI / 8.0).abs() < 1e-6, "{half:?}");
    let closed = half.contracted_to(to, PI / 4.0 + 1e-6);
    assert!(closed.radius < 1e-6 && (closed.centre - to).length() < 1e-6, "{closed:?}");
}

#[test]
fn the_opposite_direction_spans_half_of_the_sphere() {
    let half = Cap { centre: Vec3::NEG_Z, radius: 0.0 }.including(Vec3::Z);
    assert!((half.radius - PI / 2.0).abs() < 1e-6 && half.centre.z.abs() < 1e-6, "{half:?}");
}

proptest! {
    // 1e-5: between nearly opposite directions, which way is the shorter one is lost in rounding.
    #[test]
    fn a_grown_cap_holds_the_old_one_and_the_direction(cap in cap(), new in direction(), probe in direction()) {
        let grown = cap.including(new);
        prop_assert!(grown.centre.is_normalized() && (0.0..=PI).contains(&grown.radius));
        prop_assert!(outside(grown, new) < 1e-5);
        prop_assert!(outside(grown, probe) <= outside(cap, probe) + 1e-5);
    }

    #[test]
    fn a_contracted_cap_leaves_nothing_farther_away_than_said(
        cap in cap(), to in direction(), angle in 0.0f32..1.0, probe in direction(),
    ) {
        let cap = cap.including(to);
        let contracted = cap.contracted_to(to, angle);
        prop_assert!(contracted.centre.is_normalized() && (0.0..=PI).contains(&contracted.radius));
        prop_assert!(outside(contracted, to) < 1e-5, "{cap:?} to {contracted:?}");
        prop_assert!(outside(contracted, probe) <= outside(cap, probe) + angle + 1e-5, "{cap:?} to {contracted:?}");
        prop_assert!(contracted.radius <= cap.radius + 1e-6);
    }
}
