//! Head, gaze and the spaces of OpenXR 1.1.

use super::{SUCCESS, empty_frame};
use crate::application::{Application, ENABLE, V1_0, V1_1, call, structure};
use openxr_sys as xr;
use std::ffi::c_void;

const GAZE: &str = "XR_EXT_eye_gaze_interaction";

/// Location of a space in the VIEW space, with the time of the gaze sample.
pub fn in_view(app: &Application, space: xr::Space, time: xr::Time) -> (xr::SpaceLocation, i64) {
    let mut sample = structure!(EyeGazeSampleTimeEXT {});
    let mut location = structure!(SpaceLocation { next: std::ptr::from_mut(&mut sample).cast() });
    let view = app.space(xr::ReferenceSpaceType::VIEW);
    assert_eq!(call!(app, LocateSpace(space, view, time, &mut location)), SUCCESS);
    (location, sample.time.as_nanos())
}

pub fn gaze() {
    let app = Application::ready_with(V1_0, &[ENABLE, GAZE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let mut eyes = structure!(SystemEyeGazeInteractionPropertiesEXT {});
    let mut system = structure!(SystemProperties { next: std::ptr::from_mut(&mut eyes).cast::<c_void>() });
    assert_eq!(call!(app, GetSystemProperties(app.instance, app.system, &mut system)), SUCCESS);
    assert_eq!(eyes.supports_eye_gaze_interaction, xr::TRUE);

    let set = app.action_set("play");
    let action = app.action(set, "gaze", xr::ActionType::POSE_INPUT);
    let (profile, source) =
        ("/interaction_profiles/ext/eye_gaze_interaction", "/user/eyes_ext/input/gaze_ext/pose");
    assert_eq!(app.suggest(profile, &[(action, source)]), SUCCESS);
    assert_eq!(app.attach(&[set]), SUCCESS);
    let space = app.action_space(action);

    // Before any sync, and while another frame's sync leaves the set out, there is no gaze.
    let first = app.begin_frame().predicted_display_time;
    assert_eq!(in_view(&app, space, first).0.location_flags, xr::SpaceLocationFlags::EMPTY);
    assert_eq!(app.sync(&[]), SUCCESS);
    assert_eq!(in_view(&app, space, first).0.location_flags, xr::SpaceLocationFlags::EMPTY);

    let mut seen = Vec::new();
    let mut time = first;
    for _ in 0..4 {
        assert_eq!(app.sync(&[set]), SUCCESS);
        let info = structure!(ActionStateGetInfo { action: action });
        let mut state = structure!(ActionStatePose {});
        assert_eq!(call!(app, GetActionStatePose(app.session, &info, &mut state)), SUCCESS);
        let (location, sample) = in_view(&app, space, time);
        let tracked = !location.location_flags.is_empty();
        assert_eq!(bool::from(state.is_active), tracked);
        assert_eq!(sample, if tracked { time.as_nanos() } else { 0 });
        // Sine of half the yaw.
        seen.push(tracked.then(|| (location.pose.orientation.y.asin().to_degrees() * 2.0).round()));
        assert_eq!(app.end_frame(time, &[]), SUCCESS);
        time = app.begin_frame().predicted_display_time;
    }
    assert_eq!(seen, [Some(30.0), Some(30.0), None, Some(-30.0)]);
}

pub fn no_eye_tracker() {
    let app = Application::ready_with(V1_0, &[ENABLE, GAZE]);
    let mut eyes = structure!(SystemEyeGazeInteractionPropertiesEXT {});
    let mut system = structure!(SystemProperties { next: std::ptr::from_mut(&mut eyes).cast::<c_void>() });
    assert_eq!(call!(app, GetSystemProperties(app.instance, app.system, &mut system)), SUCCESS);
    assert_eq!(eyes.supports_eye_gaze_interaction, xr::FALSE);
}

pub fn head() {
    let app = Application::running();
    empty_frame(&app);
    let info = structure!(ViewLocateInfo {
        view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        display_time: empty_frame(&app).predicted_display_time,
        space: app.space(xr::ReferenceSpaceType::LOCAL),
    });
    let (mut state, mut count, mut views) = (structure!(ViewState {}), 0, [structure!(View {}); 2]);
    let result = call!(app, LocateViews(app.session, &info, &mut state, 2, &mut count, views.as_mut_ptr()));
    assert_eq!((result, count), (SUCCESS, 2));
    // After one second of two: a metre ahead, half-way to the left, where the left eye is behind the right one.
    let [left, right] = views.map(|view| view.pose.position);
    let close = |a: f32, b: f32| (a - b).abs() < 1e-5;
    let offset = 0.032 * 45_f32.to_radians().cos();
    assert!(close(left.x, -offset) && close(left.z, -1.0 + offset), "{left:?}");
    assert!(close(right.x, offset) && close(right.z, -1.0 - offset), "{right:?}");
}

pub fn openxr_1_1() {
    let app = Application::ready_with(V1_1, &[ENABLE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let time = empty_frame(&app).predicted_display_time;
    let spaces = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::VIEW].map(|ty| app.space(ty));
    let info = structure!(SpacesLocateInfo {
        base_space: app.space(xr::ReferenceSpaceType::LOCAL),
        time: time,
        space_count: 2,
        spaces: spaces.as_ptr(),
    });
    let nowhere =
        xr::SpaceLocationData { location_flags: xr::SpaceLocationFlags::EMPTY, pose: xr::Posef::IDENTITY };
    let mut found = [nowhere; 2];
    let mut locations = structure!(SpaceLocations { location_count: 2, locations: found.as_mut_ptr() });
    assert_eq!(call!(app, LocateSpaces(app.session, &info, &mut locations)), SUCCESS);
    assert_eq!(found.map(|found| found.pose.position.y), [-1.6, 0.0]);
    assert!(
        found.iter().all(|found| found.location_flags.contains(xr::SpaceLocationFlags::POSITION_TRACKED))
    );
}
