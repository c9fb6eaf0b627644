//! The cases: each a short function, named for what it does.

mod actions;
mod errors;
mod order;
mod sessions;
mod shapes;
mod stereo;
mod submission;

use crate::app::App;
use crate::failure::Failure;
use std::ffi::CStr;

/// Frames that a case runs.
const FRAMES: u32 = 8;

/// What a case returns: only what keeps it from going on is a failure.
type Outcome = Result<(), Failure>;

/// One case.
pub struct Case {
    pub name: &'static str,
    /// OpenXR extensions that it needs beside the one for Vulkan.
    pub extensions: &'static [&'static CStr],
    pub run: fn(&App) -> Outcome,
}

macro_rules! cases {
    ($($module:ident::$name:ident $([$($extension:literal),*])?,)*) => {
        /// All cases, in the order of `--list`.
        pub const CASES: &[Case] = &[
            $(Case {
                name: stringify!($name),
                extensions: &[$($($extension),*)?],
                run: $module::$name,
            },)*
        ];
    };
}

cases! {
    shapes::separate_swapchains,
    shapes::double_wide,
    shapes::array_swapchain,
    shapes::several_rectangles,
    shapes::unorm,
    shapes::srgb_viewed_as_unorm [c"XR_KHR_vulkan_swapchain_format_list"],
    shapes::mip_levels,
    shapes::static_image,
    submission::release_without_submit,
    submission::two_releases_before_end_frame,
    submission::resubmit_without_acquire,
    submission::should_render_false,
    submission::release_on_another_thread,
    submission::two_swapchains_a_view,
    submission::resolution_change,
    submission::projection_and_quad,
    submission::quad_only,
    submission::alpha_patterns,
    submission::depth_layer [c"XR_KHR_composition_layer_depth"],
    order::acquire_all,
    order::acquire_beyond_the_count,
    order::wait_without_acquire,
    order::release_without_wait,
    order::wait_with_timeout,
    errors::end_frame_with_unreleased_swapchain,
    errors::rectangle_outside_the_image,
    errors::destroy_before_end_frame,
    errors::destroyed_handle,
    errors::enumerate_images,
    sessions::two_sessions,
    actions::no_actions,
    actions::own_actions,
    actions::own_actions_and_resubmission,
    actions::own_eye_gaze [c"XR_EXT_eye_gaze_interaction"],
}
