use super::*;

const SPACE: Option<u64> = Some(7);

const FOV: Fov = Fov { left: -0.9, right: 0.7, up: 0.8, down: -0.8 };

fn canted(head: Quat) -> [View; 2] {
    [0.1f32, -0.1].map(|cant| View {
        orientation: head * Quat::from_rotation_y(cant),
        position: Vec3::new(1.0, 2.0, 3.0) - head * Vec3::X * (0.3 * cant),
        fov: FOV,
    })
}

fn shown(views: [View; 2], extent: [u32; 2]) -> [ShownView; 2] {
    views.map(|view| ShownView { view, extent })
}

fn known() -> Views {
    let mut views = Views::default();
    views.located(&canted(Quat::IDENTITY));
    views.shown(SPACE, &shown(canted(Quat::IDENTITY), [1000, 900]));
    views
}

fn fov(views: &Views) -> Fov {
    views.eyes().unwrap()[0].fov
}

#[test]
fn nothing_is_known_before_something_was_shown() {
    let mut views = Views::default();
    assert!(views.eyes().is_none());
    views.located(&canted(Quat::IDENTITY));
    assert!(views.eyes().is_none());
    views.shown(SPACE, &[]);
    assert!(views.eyes().is_none());
    views.shown(SPACE, &shown(canted(Quat::IDENTITY), [1000, 900]));
    assert_eq!(views.eyes().unwrap()[1].extent, [1000, 900]);
}

#[test]
fn a_turning_head_that_trembles_leaves_the_eyes_as_they_are() {
    let mut views = known();
    let before = views.eyes().unwrap();
    for step in 1..200 {
        let head = Quat::from_euler(glam::EulerRot::YXZ, step as f32 * 0.031, step as f32 * 0.007, 0.2);
        let mut located = canted(if step % 2 == 0 { head } else { -head });
        located[0].fov.left += 1e-4 * (step as f32).sin();
        views.located(&located);
        views.shown(SPACE, &shown(located, [1000, 900]));
    }
    for (before, after) in before.iter().zip(views.eyes().unwrap()) {
        assert_eq!((before.fov, before.orientation), (after.fov, after.orientation));
    }
    let angle = views.orientation(0).angle_between(Quat::from_rotation_y(0.1));
    assert!(angle < 2e-3, "the left display is turned left by {angle} too much");
}

#[test]
fn eyes_are_beside_the_middle_of_the_head_wherever_it_is() {
    let mut views = Views::default();
    assert_eq!(views.seen(), None);
    for step in 0..50 {
        let head = Quat::from_euler(glam::EulerRot::YXZ, step as f32 * 0.1, 0.3, step as f32 * 0.05);
        views.located(&canted(head));
        let [left, right] = views.positions();
        assert!(left.abs_diff_eq(Vec3::X * -0.03, TREMOR_M) && right.abs_diff_eq(Vec3::X * 0.03, TREMOR_M));
    }
    let before = views.positions();
    views.located(&canted(Quat::from_rotation_y(1e-3)));
    assert_eq!(views.positions(), before, "to the last bit");
    assert_eq!(views.seen().unwrap().map(|(fov, _)| fov), [FOV; 2]);
    views.located(&canted(Quat::IDENTITY)[..1]);
    assert_eq!(views.positions()[0], Vec3::ZERO, "one view is the head");
}

#[test]
fn a_head_that_moves_makes_what_is_near_drift() {
    let mut views = Views::default();
    let at =
        |x: f32| canted(Quat::IDENTITY).map(|view| View { position: view.position + Vec3::X * x, ..view });
    views.frame_begins();
    assert_eq!(views.drift_arcmin(), 0.0, "nothing is known");
    let show = |views: &mut Views, space, x: f32| views.shown(space, &shown(at(x), [1000, 900]));
    for frame in 0..4 {
        // An application may locate its views relative to the head.
        views.located(&at(0.0));
        show(&mut views, SPACE, 0.002 * frame as f32);
        views.frame_begins();
    }
    // 2 mm at 0.4 m.
    assert!((views.drift_arcmin() - 17.19).abs() < 0.01, "{}", views.drift_arcmin());
    views.set_nearest(Some(2.0));
    assert!((views.drift_arcmin() - 3.44).abs() < 0.01, "{}", views.drift_arcmin());
    views.frame_begins();
    assert_eq!(views.drift_arcmin(), 0.0, "where it was");
    for (x, is_followed, expected) in
        [(0.046, true, 0.0), (0.086, false, 68.75), (0.126, true, 0.0), (0.226, true, 171.7)]
    {
        show(&mut views, SPACE, x);
        views.set_followed(is_followed);
        views.frame_begins();
        assert!((views.drift_arcmin() - expected).abs() < 0.1, "{} at {x}", views.drift_arcmin());
    }
    views.set_followed(false);
    for (space, x) in [(Some(8), 1.0), (None, 2.0), (SPACE, 3.0)] {
        show(&mut views, space, x);
        views.frame_begins();
        assert_eq!(views.drift_arcmin(), 0.0, "in another space");
    }
}

#[test]
fn only_larger_distances_are_believed() {
    let mut views = Views::default();
    for (told, nearest) in [(None, 0.4), (Some(0.05), 0.4), (Some(2.0), 2.0), (Some(f32::NAN), 0.4)] {
        views.set_nearest(told);
        assert_eq!(views.nearest_m(), nearest, "{told:?}");
    }
}

#[test]
fn drift_is_followed() {
    let mut views = known();
    let mut located = canted(Quat::IDENTITY);
    for _ in 0..100 {
        located[0].fov.left -= 1e-4;
        views.located(&located);
    }
    assert!((fov(&views).left - located[0].fov.left).abs() <= TREMOR);
}

#[test]
fn an_application_that_shows_another_field_of_view_is_believed() {
    let mut views = known();
    let narrow = Fov { left: -0.5, ..FOV };
    views.shown(SPACE, &shown(canted(Quat::IDENTITY).map(|view| View { fov: narrow, ..view }), [1000, 900]));
    views.located(&canted(Quat::IDENTITY));
    assert_eq!(fov(&views), narrow);
    let wider = Fov { left: -1.0, ..FOV };
    views.located(&canted(Quat::IDENTITY).map(|view| View { fov: wider, ..view }));
    assert_eq!(fov(&views), wider, "until the headset has another one");
}

#[test]
fn an_application_that_shows_canted_views_parallel_is_believed() {
    let mut views = known();
    for step in 0..10 {
        let head = Quat::from_rotation_y(0.2 * step as f32);
        views.located(&canted(head));
        let parallel = canted(head).map(|view| View { orientation: head, ..view });
        views.shown(SPACE, &shown(parallel, [1000, 900]));
        views.located(&canted(head * Quat::from_rotation_x(0.1)));
        let is_parallel = angle(views.orientation(0), Quat::IDENTITY) < TREMOR;
        assert_eq!(is_parallel, step >= STEADY_FRAMES, "frame {step}");
    }
    // Each eye is drawn in every other frame, while the head turns.
    let mut views = known();
    for step in 0..10 {
        let [now, last] = [step, step - 1].map(|step| canted(Quat::from_rotation_y(0.05 * step as f32)));
        views.located(&now);
        let alternate = if step % 2 == 0 { [now[0], last[1]] } else { [last[0], now[1]] };
        views.shown(SPACE, &shown(alternate, [1000, 900]));
        assert!(angle(views.orientation(0), Quat::from_rotation_y(0.1)) < 2.0 * TREMOR, "frame {step}");
    }
    let mut views = known();
    views.located(&[0.2f32, -0.2].map(|cant| View {
        orientation: Quat::from_rotation_y(cant),
        position: Vec3::ZERO,
        fov: FOV,
    }));
    let angle = angle(views.orientation(0), Quat::from_rotation_y(0.2));
    assert!(angle < TREMOR, "until the headset has another cant");
}

#[test]
fn pictures_that_are_upside_down_have_the_same_plan() {
    let mut views = known();
    let flipped = Fov { up: FOV.down, down: FOV.up, ..FOV };
    views.shown(SPACE, &shown(canted(Quat::IDENTITY).map(|view| View { fov: flipped, ..view }), [1000, 900]));
    assert_eq!(fov(&views), FOV);
}

#[test]
fn dynamic_resolution_keeps_the_tiles() {
    let mut views = known();
    for (extent, expected) in [
        ([700, 630], [1000, 900]),
        ([1900, 1700], [1000, 900]),
        ([500, 450], [500, 450]),
        ([900, 800], [500, 450]),
        ([1000, 900], [1000, 900]),
    ] {
        views.shown(SPACE, &shown(canted(Quat::IDENTITY), extent));
        assert_eq!(views.eyes().unwrap()[0].extent, expected, "{extent:?}");
    }
}

/// An application sets its render scale after its first frames.
#[test]
fn an_extent_that_stays_is_planned_with() {
    let mut views = known();
    let mut show = |extent| {
        views.shown(SPACE, &shown(canted(Quat::IDENTITY), extent));
        views.eyes().unwrap()[0].extent
    };
    for frame in 0..600 {
        let extent = [[900, 800], [910, 810]][frame / 20 % 2];
        assert_eq!(show(extent), [1000, 900], "dynamic resolution, frame {frame}");
    }
    let last = (0..90).map(|_| show([950, 850])).collect::<Vec<_>>();
    assert_eq!((last[30], last[89]), ([1000, 900], [950, 850]));
}

#[test]
fn one_view_is_the_left_eye() {
    let mut views = known();
    views.shown(SPACE, &shown(canted(Quat::IDENTITY), [1000, 900])[..1]);
    assert_eq!(views.eyes().unwrap().map(|eye| eye.extent), [[1000, 900], [0, 0]]);
}

#[test]
fn opposite_views_have_no_head() {
    assert_eq!(head_of([]), None);
    let half_turn = Quat::from_rotation_y(std::f32::consts::PI);
    assert!(head_of([Quat::IDENTITY, half_turn]).is_none_or(|head| head.is_finite()));
    let head = Quat::from_rotation_x(0.4);
    let mean = head_of(canted(head).map(|view| view.orientation)).unwrap();
    assert!(mean.angle_between(head) < 1e-3);
}
