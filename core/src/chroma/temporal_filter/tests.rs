use super::super::Gains;
use super::*;
use crate::geometry::eccentricity;
use proptest::prelude::*;

const SECOND: i64 = 1_000_000_000;

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_filter_map("too short", |(x, y, z)| Vec3::new(x, y, z).try_normalize())
}

fn right(degrees: f32) -> Vec3 {
    glam::Quat::from_rotation_y(-degrees.to_radians()) * Vec3::NEG_Z
}

/// Chroma gains in a direction.
fn gains(focus: Option<Focus>, direction: Vec3, settings: &ChromaSettings) -> Gains {
    focus.map_or(Gains::FULL, |focus| {
        let angle = (eccentricity(focus.direction, direction) - focus.radius).max(0.0);
        Curves::new(settings).gains(angle).at_strength(focus.strength)
    })
}

#[test]
fn after_a_saccade_the_goal_is_clear_at_once_and_the_start_fades_within_seconds() {
    let settings = ChromaSettings::default();
    let (from, to) = (right(-15.0), right(15.0));
    let mut filter = ChromaTemporalFilter::default();
    let first = filter.update(Some(from), 0, &settings).unwrap();
    assert!(
        first.direction.distance(from) < 1e-6 && first.radius == 0.0 && first.strength == 1.0,
        "{first:?}"
    );
    let landed = filter.update(Some(to), SECOND / 90, &settings);
    assert_eq!(gains(landed, to, &settings), Gains::FULL);
    assert!(gains(landed, from, &settings).cr > 0.99);
    let mut time = SECOND / 90;
    let closed = loop {
        time += SECOND / 90;
        let focus = filter.update(Some(to), time, &settings).unwrap();
        if focus.radius < 1e-6 {
            break focus;
        }
        assert!(time < 10 * SECOND, "never closed");
    };
    assert!((closed.direction - to).length() < 1e-5);
    // 30 degrees at 0.5 / s through a descent of 2.2 over 48.7 degrees.
    assert!((2 * SECOND..3 * SECOND).contains(&time), "{time} ns");
}

#[test]
fn a_lost_gaze_gives_colour_back_at_once_and_takes_it_slowly() {
    let settings = ChromaSettings::default();
    let far = right(60.0);
    let mut filter = ChromaTemporalFilter::default();
    let before = gains(filter.update(Some(Vec3::NEG_Z), 0, &settings), far, &settings);
    assert!(before.cr < 0.3);
    assert_eq!(filter.update(None, SECOND, &settings), None);
    assert_eq!(filter.update(Some(Vec3::NAN), SECOND, &settings), None);
    let back = filter.update(Some(Vec3::NEG_Z), SECOND + SECOND / 10, &settings).unwrap();
    assert!((back.strength - 0.05).abs() < 1e-6, "{back:?}");
    for tenth in 2..=20 {
        filter.update(Some(Vec3::NEG_Z), SECOND + tenth * SECOND / 10, &settings);
    }
    let after = gains(filter.update(Some(Vec3::NEG_Z), 3 * SECOND + 1, &settings), far, &settings);
    assert_eq!(after, before, "two seconds later");
}

#[test]
fn switching_on_and_other_settings_begin_with_full_colour() {
    let settings = ChromaSettings::default();
    let mut filter = ChromaTemporalFilter::default();
    filter.show_full_color(0);
    assert_eq!(filter.update(Some(Vec3::NEG_Z), 0, &settings).unwrap().strength, 0.0);
    let mut filter = ChromaTemporalFilter::default();
    assert_eq!(filter.update(Some(Vec3::NEG_Z), 0, &settings).unwrap().strength, 1.0);
    let other = ChromaSettings { plateau_deg: 3.0, ..settings };
    assert_eq!(filter.update(Some(Vec3::NEG_Z), 1, &other).unwrap().strength, 5e-10);
}

#[test]
fn paper_mode_follows_at_once() {
    let settings = ChromaSettings { mode: Mode::Paper, ..ChromaSettings::default() };
    let mut filter = ChromaTemporalFilter::default();
    for (frame, gaze) in [right(-40.0), right(40.0), right(0.0)].into_iter().enumerate() {
        let focus = filter.update(Some(gaze), frame as i64, &settings).unwrap();
        assert!(focus.direction.distance(gaze) < 1e-6 && focus.radius == 0.0 && focus.strength == 1.0);
    }
}

fn settings() -> impl Strategy<Value = ChromaSettings> {
    (0.70f32..=0.85, 0.35f32..=0.55, 1.1f32..30.0, 20.0f32..110.0, 0.25f32..1.0, 0.1f32..100.0).prop_map(
        |(cb_bound, cr_bound, plateau_deg, max_eccentricity_deg, rim_fade, max_change_per_s)| {
            ChromaSettings {
                cb_bound,
                cr_bound,
                plateau_deg,
                max_eccentricity_deg,
                rim_fade,
                max_change_per_s,
                ..ChromaSettings::default()
            }
        },
    )
}

/// Jumps, drifts, losses and clocks that stand still or go back: gaze and time since the frame before.
fn path() -> impl Strategy<Value = Vec<(Option<Vec3>, i64)>> {
    let jump = direction().prop_map(Some);
    let near = (-0.1f32..0.1, -0.1f32..0.1).prop_map(|(x, y)| Some(Vec3::new(x, y, -1.0)));
    let gaze = prop_oneof![2 => jump, 4 => near, 1 => Just(None)];
    let step = prop_oneof![8 => 1_000_000..100_000_000i64, 1 => Just(0), 1 => -SECOND..20 * SECOND];
    proptest::collection::vec((gaze, step), 1..40)
}

proptest! {
    #[test]
    fn no_gain_falls_faster_than_the_limit_and_the_gaze_is_always_clear(
        settings in settings(), path in path(), probes in proptest::collection::vec(direction(), 8),
    ) {
        let mut filter = ChromaTemporalFilter::default();
        let mut time = 0;
        let mut before: Option<Vec<Gains>> = None;
        for (gaze, step) in path {
            time += step;
            let focus = filter.update(gaze, time, &settings);
            if let Some(gaze) = gaze {
                prop_assert_eq!(gains(focus, gaze, &settings), Gains::FULL);
            }
            let now: Vec<Gains> = probes.iter().map(|probe| gains(focus, *probe, &settings)).collect();
            let allowed = settings.max_change_per_s * step.max(0) as f32 * 1e-9;
            for (before, now) in before.iter().flatten().zip(&now) {
                // 3e-5: directions are known to 1e-6 rad, and gains fall by up to 15 per radian.
                prop_assert!(before.cb - now.cb <= allowed + 3e-5, "{before:?} to {now:?} in {step} ns");
                prop_assert!(before.cr - now.cr <= allowed + 3e-5, "{before:?} to {now:?} in {step} ns");
            }
            before = Some(now);
        }
    }

    #[test]
    fn a_steady_gaze_ends_up_alone(settings in settings(), path in path(), gaze in direction()) {
        let mut filter = ChromaTemporalFilter::default();
        let mut time = 0;
        for (gaze, step) in path {
            time += step;
            filter.update(gaze, time, &settings);
        }
        // Ten seconds for the strength, and for a half turn at 0.1 / s through the steepest of descents.
        for _ in 0..3 {
            time += 1000 * SECOND;
            filter.update(Some(gaze), time, &settings);
        }
        let focus = filter.update(Some(gaze), time, &settings).unwrap();
        prop_assert!(focus.strength == 1.0 && focus.radius < 1e-5, "{focus:?}");
        prop_assert!(focus.direction.distance(gaze) < 1e-5);
    }

    #[test]
    fn any_input_gives_a_usable_focus(
        x: f32, y: f32, z: f32, from: i64, to: i64, limit: f32, plateau_deg: f32, max_eccentricity_deg: f32,
    ) {
        let settings =
            ChromaSettings { max_change_per_s: limit, plateau_deg, max_eccentricity_deg, ..ChromaSettings::default() };
        let mut filter = ChromaTemporalFilter::default();
        filter.update(Some(Vec3::NEG_Z), from, &settings);
        if let Some(focus) = filter.update(Some(Vec3::new(x, y, z)), to, &settings) {
            prop_assert!(focus.direction.is_normalized(), "{focus:?}");
            prop_assert!((0.0..=std::f32::consts::PI).contains(&focus.radius), "{focus:?}");
            prop_assert!((0.0..=1.0).contains(&focus.strength), "{focus:?}");
        }
    }
}
