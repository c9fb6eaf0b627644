//! An active session above the stand-ins for the runtime and for the Vulkan half: times and messages of plans.

mod application;
mod gate;
mod gaze;
mod head;
mod input;
mod swapchains;
mod unseen;

use super::fake::actions::ACTIONS;
use super::fake::frames::{
    DISPLAY_TIME, EDGE, EYES, GAZE_LOCATED, HEAD, HEAD_LOCATED, IMAGES, IN_LOCATE, SAMPLE_AGE_NS, VIEWS, fov,
    pose,
};
use super::fake::vulkan_half::{
    self, Crossing, DECISIONS, EYE_PIXELS, GPU_NS, PASSES, STALE_WORDS, UNTRACKED_FRAMES, calls, crossings,
};
use super::{create_instance, fake};
use crate::config::{Config, ConfigSnapshot, RatesBackend, RatesGate, ReuseMode};
use crate::link::{BACKEND_ANY, BACKEND_NONE, NO_EYE, NO_IMAGE, ShownRecord, ShownViewRecord};
use crate::status::StatusSnapshot;
use crate::status::{Topic, all_decisions};
use crate::xr::vulkan_device::{FrameReport, VulkanDevice};
use crate::xr::{actions, frame, instance, plan, session, spaces, swapchain};
use application::{
    Application, FRAME_NS, SIDE, create_swapchain, locate, look, plans, session_of, session_of_tests,
};
use ash::vk;
use glam::Quat;
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_core::rate::ShadingRate;
use std::ptr;
use std::sync::mpsc::channel;
use std::time::Duration;

#[test]
fn the_vulkan_half_learns_what_is_wanted_before_the_first_frame() {
    session_of_tests();
    let settings = Crossing::Settings { is_on: 1, backend: BACKEND_ANY, passes: String::new() };
    assert_eq!(crossings(), [Crossing::Active(true), settings]);
}

#[test]
fn a_session_that_does_not_run_has_no_rates() {
    let session = session_of_tests();
    crossings();
    let settings = |is_on| [Crossing::Settings { is_on, backend: BACKEND_ANY, passes: String::new() }];
    let info = xr::SessionBeginInfo {
        ty: xr::SessionBeginInfo::TYPE,
        next: ptr::null(),
        primary_view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
    };
    for _ in 0..2 {
        // SAFETY: a live session.
        assert_eq!(unsafe { session::end_session(session) }, xr::Result::SUCCESS);
        assert_eq!(crossings(), settings(0));
        // SAFETY: as above, and a valid structure.
        assert_eq!(unsafe { session::begin_session(session, &info) }, xr::Result::SUCCESS);
        assert_eq!(crossings(), settings(1));
    }
}

#[test]
fn a_steady_frame_hands_over_nothing_new() {
    let application = Application::new();
    look(5.0);
    application.settle();
    calls();
    application.frame();
    assert_eq!(plans(), []);
    // Of xrBeginFrame and xrEndFrame: they enter and leave a section of the runtime.
    const SECTION: &str = "runtime_section";
    assert_eq!(calls(), [SECTION, SECTION, SECTION, "end_frame", SECTION]);
    look(15.0);
    application.frame();
    assert_eq!(calls(), [SECTION, SECTION, "begin_frame", SECTION, "end_frame", SECTION], "a new plan");
}

/// An edit between xrBeginFrame and xrEndFrame is the next frame's.
#[test]
fn a_frame_has_one_configuration() {
    let application = Application::new();
    look(0.0);
    application.settle();
    application.begin();
    let mut edited = Config::default();
    edited.rates.backend = RatesBackend::Off;
    session::find(application.session).unwrap().instance.config.set(edited);
    look(15.0);
    application.locate();
    assert_eq!(plans().len(), 1, "rates are on in this frame");
    application.end(&[application.view(0), application.view(1)], None);
    let is_off =
        |received: &Crossing| matches!(received, Crossing::Settings { is_on: 0, backend: BACKEND_NONE, .. });
    assert!(!crossings().iter().any(is_off));
    look(-15.0);
    application.begin();
    application.locate();
    let received = crossings();
    assert!(received.iter().any(is_off), "{received:?}");
    assert!(!received.iter().any(|received| matches!(received, Crossing::Plan { .. })), "{received:?}");
}

#[test]
fn a_plan_has_the_size_of_what_is_shown_and_serials_rise() {
    let application = Application::new();
    look(0.0);
    application.begin();
    application.locate();
    assert_eq!(plans(), [], "nothing was shown yet");
    application.end(&[application.view(0), application.view(1)], None);
    let first = crossings();
    let Some(Crossing::Plan { serial, extents, rates }) =
        first.iter().find(|received| matches!(received, Crossing::Plan { .. }))
    else {
        panic!("no plan: {first:?}")
    };
    assert_eq!(*extents, [[SIDE as u32; 2]; 2]);
    assert!(rates.iter().all(|rates| rates.len() == 32 * 32));
    let mut last = *serial;
    for yaw in [10.0, -10.0, 20.0] {
        application.settle();
        look(yaw);
        application.frame();
        let plans = plans();
        assert!(plans[0].0 > last && plans.windows(2).all(|pair| pair[0].0 < pair[1].0), "{yaw}");
        last = plans[plans.len() - 1].0;
    }
}

/// The stand-in is another copy of the library, with a list of its own.
#[test]
fn decisions_of_the_other_half_are_known_to_this_one() {
    let is_known = |line: &str| all_decisions().iter().any(|decision| decision.line == line);
    DECISIONS.set(vec![(Topic::Quirk.number(), "a quirk, before the session", "")]);
    let application = Application::new();
    application.frame();
    assert!(is_known("a quirk, before the session"));
    DECISIONS.with_borrow_mut(|decisions| decisions.push((5, "left alone, in a frame", "it blends")));
    assert!(!is_known("left alone, in a frame"));
    application.frame();
    let left_alone = all_decisions().into_iter().find(|decision| decision.line == "left alone, in a frame");
    assert_eq!(left_alone.unwrap().topic, Topic::NoMask("it blends".to_owned()));
}

#[test]
fn the_actions_of_the_application_are_as_they_were() {
    let application = Application::new();
    let made = ACTIONS.take();
    assert_eq!(made, ["xrCreateActionSet", "xrCreateAction", "xrSuggestInteractionProfileBindings"]);
    application.settle();
    assert_eq!(ACTIONS.take(), [""; 0], "frames synchronise nothing: the application does");
}

#[test]
fn a_runtime_that_blocks_in_a_locate_blocks_nobody_else() {
    let application = Application::new();
    look(0.0);
    application.settle();
    let (session, space, time) = (application.session, application.space, DISPLAY_TIME.get());
    let (sender, receiver) = channel();
    IN_LOCATE.set(Some(Box::new(move || {
        let sender = sender.clone();
        std::thread::spawn(move || {
            DISPLAY_TIME.set(time + 2 * FRAME_NS);
            locate(session, space);
            sender.send(()).unwrap();
        });
        receiver.recv_timeout(Duration::from_secs(30)).expect("another thread waits for a lock of ours");
    })));
    application.begin();
    application.locate();
    assert!(IN_LOCATE.take().is_none(), "nothing was located");
}
