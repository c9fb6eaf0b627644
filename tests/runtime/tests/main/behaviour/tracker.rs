//! Eye trackers with faults, and a runtime whose answers wait for others.

use super::space::in_view;
use super::{SUCCESS, empty_frame};
use crate::application::{Application, ENABLE, V1_0, call, structure};
use openxr_sys as xr;
use parafovea_mock_runtime::SCENARIO_VARIABLE;
use std::ffi::c_void;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const GAZE: &str = "XR_EXT_eye_gaze_interaction";

/// An application in its first frame that has synchronised a set with the gaze: its space, and when the frame is shown.
fn looking() -> (Application, xr::Space, xr::Time) {
    let app = Application::ready_with(V1_0, &[ENABLE, GAZE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let set = app.action_set("play");
    let action = app.action(set, "gaze", xr::ActionType::POSE_INPUT);
    let (profile, source) =
        ("/interaction_profiles/ext/eye_gaze_interaction", "/user/eyes_ext/input/gaze_ext/pose");
    assert_eq!(app.suggest(profile, &[(action, source)]), SUCCESS);
    assert_eq!(app.attach(&[set]), SUCCESS);
    let space = app.action_space(action);
    empty_frame(&app);
    let time = app.begin_frame().predicted_display_time;
    assert_eq!(app.sync(&[set]), SUCCESS);
    (app, space, time)
}

fn locate_views(app: &Application, time: xr::Time) {
    let info = structure!(ViewLocateInfo {
        view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        display_time: time,
        space: app.space(xr::ReferenceSpaceType::LOCAL),
    });
    let mut state = structure!(ViewState {});
    let mut views = [structure!(View {}), structure!(View {})];
    let mut count = 0;
    let result = call!(app, LocateViews(app.session, &info, &mut state, 2, &mut count, views.as_mut_ptr()));
    assert_eq!((result, count), (SUCCESS, 2));
}

/// Degrees to the left.
fn yaw(location: &xr::SpaceLocation) -> f32 {
    (location.pose.orientation.y.asin().to_degrees() * 2.0).round()
}

pub fn late_and_newer_at_the_views() {
    let (app, space, time) = looking();
    let (before, sampled) = in_view(&app, space, time);
    assert_eq!((sampled, yaw(&before)), (time.as_nanos() - 20_000_000, 0.0));
    locate_views(&app, time);
    let (after, sampled) = in_view(&app, space, time);
    assert_eq!((sampled, yaw(&after)), (time.as_nanos() - 5_000_000, 40.0));
    // Of another time nothing newer is known.
    let later = xr::Time::from_nanos(time.as_nanos() + 1);
    assert_eq!(in_view(&app, space, later).1, later.as_nanos() - 20_000_000);
}

pub fn backwards_and_without_times() {
    let (app, space, time) = looking();
    let (location, sampled) = in_view(&app, space, time);
    assert!(!location.location_flags.is_empty());
    assert_eq!(sampled, 0);
    assert_eq!(yaw(&location).abs(), 180.0);
}

pub fn not_reported() {
    let (app, space, time) = looking();
    let mut eyes = structure!(SystemEyeGazeInteractionPropertiesEXT {});
    let mut system = structure!(SystemProperties { next: std::ptr::from_mut(&mut eyes).cast::<c_void>() });
    assert_eq!(call!(app, GetSystemProperties(app.instance, app.system, &mut system)), SUCCESS);
    assert_eq!(eyes.supports_eye_gaze_interaction, xr::FALSE);
    assert!(!in_view(&app, space, time).0.location_flags.is_empty(), "and it works");
}

pub fn never_active() {
    let (app, space, time) = looking();
    assert!(in_view(&app, space, time).0.location_flags.is_empty());
}

pub fn only_the_last_set_works() {
    let app = Application::ready_with(V1_0, &[ENABLE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let sets = [app.action_set("first"), app.action_set("last")];
    let buttons = sets.map(|set| app.action(set, "button", xr::ActionType::BOOLEAN_INPUT));
    let source = "/user/hand/left/input/select/click";
    let bindings = buttons.map(|button| (button, source));
    assert_eq!(app.suggest("/interaction_profiles/khr/simple_controller", &bindings), SUCCESS);
    assert_eq!(app.attach(&sets), SUCCESS);
    empty_frame(&app);
    assert_eq!(app.sync(&sets), SUCCESS);
    let active = buttons.map(|action| {
        let info = structure!(ActionStateGetInfo { action: action });
        let mut state = structure!(ActionStateBoolean {});
        assert_eq!(call!(app, GetActionStateBoolean(app.session, &info, &mut state)), SUCCESS);
        bool::from(state.is_active)
    });
    assert_eq!(active, [false, true]);
}

/// As with Monado.
pub fn active_from_attachment() {
    let app = Application::ready_with(V1_0, &[ENABLE]);
    assert_eq!(app.begin_session(), SUCCESS);
    let sets = [app.action_set("first"), app.action_set("second")];
    let buttons = sets.map(|set| app.action(set, "button", xr::ActionType::BOOLEAN_INPUT));
    let bindings = [
        (buttons[0], "/user/hand/left/input/select/click"),
        (buttons[1], "/user/hand/right/input/select/click"),
    ];
    assert_eq!(app.suggest("/interaction_profiles/khr/simple_controller", &bindings), SUCCESS);
    let active = || buttons.map(|action| bool::from(app.boolean(action).unwrap().is_active));
    assert_eq!(app.attach(&sets), SUCCESS);
    assert_eq!(active(), [true, true]);
    assert_eq!(app.sync(&[]), xr::Result::SESSION_NOT_FOCUSED);
    empty_frame(&app);
    assert_eq!(app.sync(&[]), SUCCESS);
    assert_eq!(active(), [true, true]);
    assert_eq!(app.sync(&sets[..1]), SUCCESS);
    assert_eq!(active(), [true, false]);
    assert_eq!(app.sync(&[]), SUCCESS);
    assert_eq!(active(), [true, false]);
}

pub fn waits_for_a_lock() {
    let (app, space, time) = looking_with_lock();
    let scenario = std::env::var_os(SCENARIO_VARIABLE).unwrap();
    let lock = std::fs::File::open(Path::new(&scenario).with_file_name("queue.lock")).unwrap();
    let is_free = AtomicBool::new(false);
    lock.lock().unwrap();
    std::thread::scope(|threads| {
        threads.spawn(|| {
            std::thread::sleep(Duration::from_millis(100));
            is_free.store(true, Ordering::SeqCst);
            lock.unlock().unwrap();
        });
        assert!(!in_view(&app, space, time).0.location_flags.is_empty());
        assert!(is_free.load(Ordering::SeqCst), "it did not wait");
    });
}

fn looking_with_lock() -> (Application, xr::Space, xr::Time) {
    let scenario = std::env::var_os(SCENARIO_VARIABLE).unwrap();
    std::fs::write(Path::new(&scenario).with_file_name("queue.lock"), "").unwrap();
    looking()
}
