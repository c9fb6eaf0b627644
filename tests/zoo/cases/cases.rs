//! The cases: short functions, each named for its calls.

mod actions;
mod chains;
mod conformance;
mod errors;
mod input;
mod order;
mod process;
mod sessions;
mod shapes;
pub mod stereo;
mod submission;
mod threads;

use crate::app::App;
use crate::failure::Failure;
use std::ffi::CStr;

/// Frames that a case runs.
const FRAMES: u32 = 8;

/// Result of a case: an error only if it cannot go on.
type Outcome = Result<(), Failure>;

/// One case.
pub struct Case {
    pub name: &'static str,
    /// OpenXR extensions that it needs beside the one for Vulkan.
    pub extensions: &'static [&'static CStr],
    pub run: fn(&App) -> Outcome,
}

macro_rules! cases {
    ($($module:ident $(:: $inner:ident)? => $name:ident $([$($extension:literal),*])?,)*) => {
        /// All cases, in the order of `--list`.
        pub const CASES: &[Case] = &[
            $(Case {
                name: stringify!($name),
                extensions: &[$($($extension),*)?],
                run: $module $(:: $inner)? :: $name,
            },)*
        ];
    };
}

cases! {
    shapes => separate_swapchains,
    shapes => double_wide,
    shapes => array_swapchain,
    shapes => several_rectangles,
    shapes => unorm,
    shapes => srgb_viewed_as_unorm [c"XR_KHR_vulkan_swapchain_format_list"],
    shapes => mip_levels,
    shapes => static_image,
    submission => release_without_submit,
    submission => two_releases_before_end_frame,
    submission => resubmit_without_acquire,
    submission => should_render_false,
    submission => release_on_another_thread,
    submission => two_swapchains_a_view,
    submission => resolution_change,
    submission => projection_and_quad,
    submission => quad_only,
    submission => overlays_before_the_eyes,
    submission => alpha_patterns,
    submission => depth_layer [c"XR_KHR_composition_layer_depth"],
    order => acquire_all,
    order => acquire_beyond_the_count,
    order => wait_without_acquire,
    order => release_without_wait,
    order => wait_with_timeout,
    errors => end_frame_with_unreleased_swapchain,
    errors => rectangle_outside_the_image,
    errors => destroy_before_end_frame,
    errors => destroyed_handle,
    errors => enumerate_images,
    sessions => two_sessions,
    sessions => two_sessions_at_once,
    process => forks,
    threads => swapchains_on_threads,
    threads => devices_on_threads,
    chains => unknown_structures,
    actions => no_actions,
    actions => own_actions,
    actions => own_actions_and_resubmission,
    actions => own_eye_gaze [c"XR_EXT_eye_gaze_interaction"],
    input::attaching => attaches_early,
    input::attaching => attaches_after_a_loading_screen,
    input::attaching => has_no_input_before_all_is_loaded,
    input::attaching => asks_for_paths_and_waits,
    input::attaching => never_attaches,
    input::attaching => has_no_input,
    input::attaching => attaches_twice,
    input::attaching => attaches_nothing_first,
    input::attaching => makes_spaces_before_attaching,
    input::attaching => adds_to_an_attached_set,
    input::synchronising => never_synchronises,
    input::synchronising => synchronises_late,
    input::synchronising => synchronises_before_attaching,
    input::synchronising => synchronises_nothing,
    input::synchronising => has_sets_of_different_priority,
    input::synchronising => has_sets_of_the_same_priority,
    input::synchronising => tells_hands_apart,
    input::synchronising => synchronises_on_another_thread,
    input::synchronising => locates_views_on_another_thread,
    input::sessions => attaches_the_same_sets_to_each_session,
    input::sessions => makes_new_sets_for_each_session,
    input::sessions => drops_sessions_unused,
    input::gaze => looks_at_the_gaze_itself [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => looks_at_the_gaze_with_priority [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => looks_at_the_gaze_in_two_sets [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => finds_the_gaze_in_every_space [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => tells_eyes_from_hands [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => suggests_gaze_without_its_extension,
    input::gaze => suggests_gaze_in_each_session [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => finds_the_gaze_among_many_spaces [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => shows_layers_in_the_gaze [c"XR_EXT_eye_gaze_interaction"],
    input::gaze => sees_the_gaze_come_and_go [c"XR_EXT_eye_gaze_interaction"],
    conformance::enumeration => conforms_before_a_session [c"XR_EXT_eye_gaze_interaction"],
    conformance::actions => conforms_in_suggestions [c"XR_EXT_eye_gaze_interaction"],
    conformance::actions => conforms_in_attaching [c"XR_EXT_eye_gaze_interaction"],
    conformance::states => conforms_in_states [c"XR_EXT_eye_gaze_interaction"],
    conformance::states => conforms_with_two_profiles [c"XR_EXT_eye_gaze_interaction"],
    conformance::states => keeps_states_until_it_synchronises [c"XR_EXT_eye_gaze_interaction"],
    conformance::without => conforms_without_eye_gaze,
}
