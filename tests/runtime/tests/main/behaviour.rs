//! Behaviour for applications without mistakes, under various scenarios.

#[path = "behaviour/extension.rs"]
mod extension;
#[path = "behaviour/input.rs"]
mod input;
#[path = "behaviour/session.rs"]
mod session;
#[path = "behaviour/space.rs"]
mod space;
#[path = "behaviour/tracker.rs"]
mod tracker;
#[path = "behaviour/vulkan.rs"]
mod vulkan;

use crate::application::{Application, V1_0, V1_1};
use crate::case::{Case, Mistake, Output, Run};
use openxr_sys as xr;

const SUCCESS: xr::Result = xr::Result::SUCCESS;

pub fn cases() -> Vec<Case> {
    let good = |name: &str, scenario: &str, run: fn(), check: fn(&Output)| Case {
        name: format!("behaviour::{name}"),
        scenario: format!("{scenario}\n[output]\ncomposite=false\n"),
        run: Run::Good { run, check },
    };
    let refused =
        |name: &str, scenario: &str, make: fn(&mut Application) -> xr::Result, result, section| Case {
            name: format!("behaviour::{name}"),
            scenario: format!("{scenario}\n"),
            run: Run::Mistake(Mistake {
                start: Application::without_loader,
                make,
                call: "xrCreateInstance",
                result,
                section,
            }),
        };
    let gaps = "[[gaze]]\nyaw_deg=30\n[[gaze]]\nt=0.015\ntracked=false\n[[gaze]]\nt=0.025\nyaw_deg=-30";
    vec![
        good(
            "two_sessions_one_after_the_other",
            "[session]\nframes=2",
            session::two_sessions,
            session::two_sessions_recorded,
        ),
        good(
            "visible_and_focused_later",
            "[session]\nvisible_from=1\nfocused_from=2",
            session::late_focus,
            |_| {},
        ),
        good(
            "frames_that_need_no_rendering",
            "[session]\nshould_render_off=[1]",
            session::should_render,
            |_| {},
        ),
        good("discarded_frame", "", session::discarded_frame, |_| {}),
        good("frames_that_wait_for_their_turn", "[clock]\nturns='turns'", session::turns, |_| {}),
        good("real_time", "[clock]\nmode='real'\nrefresh_hz=50", session::real_time, |_| {}),
        good(
            "gaze_that_is_late_and_newer_at_the_views",
            "[clock]\nrefresh_hz=100\n[tracker]\nlatency_ms=20\nnewer_at_views_ms=15\n\
             [[gaze]]\n[[gaze]]\nt=0.001\n[[gaze]]\nt=0.001\nyaw_deg=40",
            tracker::late_and_newer_at_the_views,
            |_| {},
        ),
        good(
            "gaze_that_looks_back_and_has_no_time",
            "[tracker]\nsample_time=false\nbackwards=true",
            tracker::backwards_and_without_times,
            |_| {},
        ),
        good("eye_tracker_that_is_not_reported", "[tracker]\nreported=false", tracker::not_reported, |_| {}),
        good("eye_tracker_that_is_never_active", "[tracker]\nactive=false", tracker::never_active, |_| {}),
        good(
            "only_the_last_action_set_works",
            "[quirks]\nonly_last_set=true",
            tracker::only_the_last_set_works,
            |_| {},
        ),
        good(
            "actions_that_are_active_from_their_attachment",
            "[quirks]\nactive_from_attachment=true",
            tracker::active_from_attachment,
            |_| {},
        ),
        good(
            "locating_waits_for_a_lock",
            "[quirks]\nlocate_lock='queue.lock'",
            tracker::waits_for_a_lock,
            |_| {},
        ),
        good("gaze_with_a_gap", &format!("[clock]\nrefresh_hz=100\n{gaps}"), space::gaze, |_| {}),
        good("no_eye_tracker", "[system]\neye_gaze=false", space::no_eye_tracker, |_| {}),
        good(
            "head_moves",
            "[clock]\nrefresh_hz=1\n[[head]]\n[[head]]\nt=2\nposition=[0,0,-2]\nyaw_deg=90",
            space::head,
            |_| {},
        ),
        good(
            "select_is_pressed",
            "[clock]\nrefresh_hz=100\n[[input]]\nt=0.01\npath='/user/hand/right/input/select/click'\nvalue=true",
            input::select,
            |_| {},
        ),
        good(
            "higher_priority_takes_the_source",
            "[[input]]\npath='/user/hand/right/input/select/click'\nvalue=true",
            input::priority,
            |_| {},
        ),
        good(
            "wait_times_out_and_succeeds",
            "[swapchain]\nwait_timeouts=[1]\nimages=2",
            vulkan::wait_timeouts,
            |_| {},
        ),
        good("kinds_of_swapchains", "", vulkan::swapchains, vulkan::swapchains_recorded),
        good("openxr_1_1", "", space::openxr_1_1, |_| {}),
        good("vulkan_enable2", "", vulkan::enable2, |_| {}),
        good("functions_of_extensions", "", extension::functions, |_| {}),
        good("visibility_mask", "", extension::visibility_mask, |_| {}),
        good("timespec", "", extension::timespec, |_| {}),
        good(
            "unknown_structure_in_a_chain",
            "",
            extension::unknown_structure,
            extension::unknown_structure_recorded,
        ),
        refused(
            "extension_off",
            "[system]\nextensions_off=['XR_EXT_eye_gaze_interaction']",
            |app| app.create_instance(V1_0, &["XR_EXT_eye_gaze_interaction"]),
            xr::Result::ERROR_EXTENSION_NOT_PRESENT,
            "Instance Lifecycle",
        ),
        refused(
            "only_openxr_1_0",
            "[system]\nmax_api='1.0'",
            |app| app.create_instance(V1_1, &[]),
            xr::Result::ERROR_API_VERSION_UNSUPPORTED,
            "API Version Numbers and Semantics",
        ),
        Case {
            name: "behaviour::messenger_hears_of_mistakes".to_owned(),
            scenario: "\n".to_owned(),
            run: Run::Mistake(Mistake {
                start: || Application::with_instance(V1_0, &["XR_EXT_debug_utils"]),
                make: extension::messenger,
                call: "xrPathToString",
                result: xr::Result::ERROR_PATH_INVALID,
                section: "Semantic Paths",
            }),
        },
        Case {
            name: "behaviour::broken_scenario".to_owned(),
            scenario: "[output]\nspeed=1\n".to_owned(),
            run: Run::Good {
                run: || {
                    assert_eq!(
                        Application::nothing().create_instance(V1_0, &[]),
                        xr::Result::ERROR_RUNTIME_FAILURE
                    )
                },
                check: |_| {},
            },
        },
    ]
}

/// A frame without layers.
fn empty_frame(app: &Application) -> xr::FrameState {
    let state = app.begin_frame();
    assert_eq!(app.end_frame(state.predicted_display_time, &[]), SUCCESS);
    state
}
