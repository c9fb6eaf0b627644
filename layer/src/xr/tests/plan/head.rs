//! The head, by the views that the application located.

use super::*;

/// An application whose views are located in a reference space of that kind.
fn application_in(kind: xr::ReferenceSpaceType) -> Application {
    let mut application = Application::new();
    application.space = reference_space(application.session, kind);
    application
}

fn reference_space(session: xr::Session, kind: xr::ReferenceSpaceType) -> xr::Space {
    let info = xr::ReferenceSpaceCreateInfo {
        ty: xr::ReferenceSpaceCreateInfo::TYPE,
        next: ptr::null(),
        reference_space_type: kind,
        pose_in_reference_space: xr::Posef::IDENTITY,
    };
    let mut space = xr::Space::default();
    // SAFETY: valid arguments.
    assert_eq!(unsafe { spaces::create_reference(session, &info, &mut space) }, xr::Result::SUCCESS);
    space
}

/// Runs frames while the head turns; returns the number of its locations, and the largest difference of the plan's head, degrees.
fn turning_frames(application: &Application, count: i32) -> (usize, f32) {
    HEAD_LOCATED.set(0);
    let session = session::find(application.session).unwrap();
    let mut worst_deg = 0.0f32;
    for frame in 0..count {
        HEAD.set(Quat::from_rotation_y(0.02 * frame as f32) * Quat::from_rotation_x(0.2));
        application.frame();
        let planner = session.active.as_ref().unwrap().plan.planner();
        let planned = planner.head_at(DISPLAY_TIME.get()).unwrap();
        worst_deg = worst_deg.max(planned.angle_between(HEAD.get()).to_degrees());
    }
    (HEAD_LOCATED.get(), worst_deg)
}

#[test]
fn a_steady_frame_locates_no_head() {
    for kind in
        [xr::ReferenceSpaceType::LOCAL, xr::ReferenceSpaceType::STAGE, xr::ReferenceSpaceType::LOCAL_FLOOR]
    {
        let application = application_in(kind);
        look(5.0);
        application.settle();
        let (located, worst_deg) = turning_frames(&application, 900);
        assert!(worst_deg < 0.05, "{worst_deg} degrees in {kind:?}");
        // In ten seconds two or three comparisons, each in two spaces.
        assert!((4..=6).contains(&located), "{located} times in {kind:?}");
    }
}

/// A thread of the application locates the next frame's views before the render thread ends this frame and begins that one.
#[test]
fn views_located_ahead_of_their_frame_replace_locations_too() {
    let application = application_in(xr::ReferenceSpaceType::LOCAL);
    look(5.0);
    application.settle();
    HEAD_LOCATED.set(0);
    let session = session::find(application.session).unwrap();
    let planned = || {
        let planner = session.active.as_ref().unwrap().plan.planner();
        planner.head_at(DISPLAY_TIME.get()).unwrap()
    };
    application.begin();
    for frame in 0..900 {
        let shown = [application.view(0), application.view(1)];
        HEAD.set(Quat::from_rotation_y(0.02 * frame as f32) * Quat::from_rotation_x(0.2));
        application.begin_ahead(|| application.end(&shown, None));
        assert!(planned().angle_between(HEAD.get()).to_degrees() < 0.05, "frame {frame}");
    }
    let located = HEAD_LOCATED.get();
    assert!((4..=6).contains(&located), "{located} times");
}

#[test]
fn a_head_that_is_not_the_mean_of_its_views_is_located_in_each_frame() {
    let application = application_in(xr::ReferenceSpaceType::LOCAL);
    VIEWS.set(Quat::from_rotation_x(0.1));
    look(5.0);
    application.settle();
    let (located, worst_deg) = turning_frames(&application, 90);
    assert!(worst_deg < 0.05, "{worst_deg} degrees");
    assert!(located >= 90, "{located} times");
    VIEWS.set(Quat::IDENTITY);
}

#[test]
fn spaces_that_may_move_are_not_taken_for_the_world() {
    let application = application_in(xr::ReferenceSpaceType::VIEW);
    look(5.0);
    application.settle();
    let (_, worst_deg) = turning_frames(&application, 90);
    assert!(worst_deg < 0.05, "{worst_deg} degrees");

    let application = Application::new();
    application.settle();
    let (located, worst_deg) = turning_frames(&application, 90);
    assert!(worst_deg < 0.05 && located >= 90, "{worst_deg} degrees, {located} times");
}

#[test]
fn spaces_of_the_application_are_forgotten_with_it() {
    let application = application_in(xr::ReferenceSpaceType::STAGE);
    let other = reference_space(application.session, xr::ReferenceSpaceType::LOCAL);
    assert!(spaces::rests(application.space) && spaces::rests(other));
    // SAFETY: the space is not used any more.
    assert_eq!(unsafe { spaces::destroy(other) }, xr::Result::SUCCESS);
    assert!(!spaces::rests(other));
    // SAFETY: as above.
    assert_eq!(unsafe { session::destroy(application.session) }, xr::Result::SUCCESS);
    assert!(!spaces::rests(application.space));
}
