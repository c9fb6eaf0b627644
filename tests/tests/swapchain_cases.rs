//! Every case of `parafovea-cases`, four times: without the layer, with the layer and nothing to do, with pictures analysed for their
//! contrast, and with chroma attenuation. The first run is the reference: the application must observe the same, and the images must
//! be the same or differ exactly as in the CPU reference of the kernel.

#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in test functions; these are their helpers")]

mod judge;
mod runs;

use parafovea_core::kernels::compose::PixelFormat;
use parafovea_tests::scenario as mock;
use parafovea_tests::scenario::{Head, Input, InputValue, Scenario};
use runs::{Finished, run};

/// The layer with every technique off.
const OFF: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"off\"\n";

/// The layer with rates by contrast, which are 1x1 all over the picture.
const ANALYZED: &str = "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"contrast\"\ngate = \"on\"\nfoveal_deg = 110\ntransitional_deg = 110\n";

/// A case with its expectations of the layer.
struct Case {
    name: &'static str,
    arguments: &'static [&'static str],
    gaze: Gaze,
    format: PixelFormat,
    /// Whether the application's colour swapchains get images of ours where chroma attenuation is on.
    substituted: bool,
    /// Whether pictures are analysed where rates go by contrast.
    analyzed: bool,
    /// Width of the images that keep the runtime's swapchain, because of a structure in the chain of their creation; 0: none.
    left_alone: u32,
    /// Frame of the image that each frame shows; empty: its own. If the runtime is not ready for another image, the
    /// layer submits the last one again instead of making the application wait.
    shows: &'static [u64],
    /// Whether OpenXR's core validation is below the layer. Where it is not, it is too old for an extension of the
    /// case, or answers a mistake itself.
    openxr_validation: bool,
    /// Whether both validation layers are below the layer. Khronos' Vulkan validation of 1.3.239 crashed once in 53 runs of a case with
    /// threads that create devices at once, in a search of a hash map.
    validated: bool,
    /// Whether the application makes its swapchains in the same order in each run.
    in_order: bool,
    /// The runtime's additional behaviour.
    scenario: fn(&mut Scenario),
}

/// Source of the layer's gaze.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gaze {
    /// `gaze.source = "centre"`: known from the first frame.
    Centre,
    /// `gaze.source = "eyes"`: from the tracker, some frames after the start.
    Tracker,
}

impl Case {
    const fn new(name: &'static str) -> Self {
        Self {
            name,
            arguments: &[],
            gaze: Gaze::Centre,
            format: PixelFormat::Rgba8Srgb,
            substituted: true,
            analyzed: true,
            left_alone: 0,
            shows: &[],
            openxr_validation: true,
            validated: true,
            in_order: true,
            scenario: |_| {},
        }
    }

    fn config(&self) -> &'static str {
        match self.gaze {
            Gaze::Centre => {
                "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n"
            }
            Gaze::Tracker => {
                "preset = \"none\"\n[gaze]\nsource = \"eyes\"\nattach_alone_after_s = 1\n[chroma]\nmode = \"default\"\nmax_change_per_s = 100\n"
            }
        }
    }

    /// Runs the case four times and judges.
    fn check(&self) {
        let reference = run(self, None);
        judge::reference(self, &reference);
        judge::unchanged(self, &reference, &run(self, Some(OFF)));
        judge::analyzed_in_place(self, &reference, &run(self, Some(ANALYZED)));
        judge::processed(self, &reference, &run(self, Some(self.config())));
    }
}

macro_rules! cases {
    ($($name:ident $({ $($field:ident: $value:expr),* $(,)? })?,)*) => {
        /// Names of the cases that have a test here.
        const TESTED: &[&str] = &[$(stringify!($name)),*];

        $(#[test]
        fn $name() {
            Case { $($($field: $value,)*)? ..Case::new(stringify!($name)) }.check();
        })*
    };
}

cases! {
    separate_swapchains,
    double_wide,
    array_swapchain,
    several_rectangles,
    unorm { format: PixelFormat::Rgba8Unorm },
    srgb_viewed_as_unorm { openxr_validation: false },
    mip_levels { substituted: false },
    static_image { substituted: false, analyzed: false },
    release_without_submit,
    two_releases_before_end_frame,
    resubmit_without_acquire,
    should_render_false { scenario: |scenario| scenario.session.should_render_off = vec![0, 1, 4, 5] },
    release_on_another_thread,
    two_swapchains_a_view,
    resolution_change,
    projection_and_quad,
    quad_only { analyzed: false },
    overlays_before_the_eyes { left_alone: 24 },
    alpha_patterns,
    depth_layer,
    acquire_all,
    acquire_beyond_the_count,
    wait_without_acquire,
    release_without_wait,
    wait_with_timeout {
        scenario: |scenario| scenario.swapchain.wait_timeouts = vec![1, 4, 5],
        shows: &[0, 0, 2, 3, 3, 3, 6, 7],
    },
    end_frame_with_unreleased_swapchain,
    rectangle_outside_the_image,
    destroy_before_end_frame { openxr_validation: false },
    destroyed_handle,
    enumerate_images,
    two_sessions,
    two_sessions_at_once,
    forks,
    swapchains_on_threads { in_order: false },
    devices_on_threads { validated: false },
    unknown_structures { openxr_validation: false, left_alone: 64 },
    no_actions { gaze: Gaze::Tracker },
    own_actions { gaze: Gaze::Tracker, scenario: press_select },
    own_actions_and_resubmission { gaze: Gaze::Tracker, scenario: glance, analyzed: false },
    own_eye_gaze { gaze: Gaze::Tracker },
}

#[test]
fn vulkan_enable() {
    Case { arguments: &["--enable", "1"], ..Case::new("separate_swapchains") }.check();
}

#[test]
fn vulkan_enable_with_vulkan_first() {
    Case { arguments: &["--enable", "1", "--vulkan-first"], ..Case::new("separate_swapchains") }.check();
}

#[test]
fn vulkan_1_0_application() {
    Case { arguments: &["--vulkan", "1.0"], ..Case::new("separate_swapchains") }.check();
}

/// As [`ANALYZED`], with temporal re-use.
const REUSED: &str =
    "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\ngate = \"on\"\n[reuse]\nmode = \"on\"\n";

/// xrgears and xrdesktop leave `type` and `next` of the images uninitialised.
#[test]
fn untyped_images() {
    let case = Case {
        arguments: &["--untyped-images"],
        openxr_validation: false,
        scenario: |scenario| scenario.swapchain.unread_images = true,
        ..Case::new("separate_swapchains")
    };
    case.check();
    let outcome = run(&case, Some(REUSED));
    assert_eq!(outcome.report.unexpected, Vec::<String>::new(), "{}", outcome.outcome.log);
    assert!(outcome.outcome.log.contains("6 images of the layer"), "{}", outcome.outcome.log);
}

/// LÖVR enumerates once, with room for four images, which are fewer than re-use needs and more than the runtime has.
#[test]
fn one_array_of_four_images() {
    let case = Case { arguments: &["--image-capacity", "4"], ..Case::new("separate_swapchains") };
    let Finished { outcome, report, .. } = run(&case, Some(REUSED));
    assert_eq!(report.unexpected, Vec::<String>::new(), "{}", outcome.log);
    assert_eq!((outcome.exit_code, report.image_counts), (Some(0), vec![4, 4]), "{}", outcome.log);
    assert!(outcome.findings.beyond(&Default::default()).is_empty(), "{:#?}", outcome.findings);
    let told = "less room for re-use in a swapchain: the application takes 4 of 6 images";
    assert_eq!(outcome.log.matches(told).count(), 2, "{}", outcome.log);
    // Room for three is that of the runtime's number, and room for two is too little for either.
    let three = Case { arguments: &["--image-capacity", "3"], ..Case::new("separate_swapchains") };
    let Finished { outcome, report, .. } = run(&three, Some(REUSED));
    assert_eq!(report.image_counts, [3, 3]);
    assert!(outcome.log.contains("no re-use in a swapchain: the application takes 3 of 6 images"));
    let two = Case { arguments: &["--image-capacity", "2"], ..Case::new("separate_swapchains") };
    let refused = run(&two, Some(REUSED)).report.unexpected;
    assert!(refused.iter().any(|failure| failure.contains("SIZE_INSUFFICIENT")), "{refused:?}");
}

/// Overlays get no images for re-use.
#[test]
fn the_eyes_alone_keep_pictures() {
    let Finished { outcome, report, .. } = run(&Case::new("overlays_before_the_eyes"), Some(REUSED));
    assert_eq!(report.unexpected, Vec::<String>::new(), "{}", outcome.log);
    assert_eq!(report.image_counts, [3, 3, 3, 3, 3, 3, 3, 3, 6, 6], "{}", outcome.log);
}

/// Translated applications, whose draws may be submitted after the image was returned: their pictures are analysed when the frame ends.
#[test]
fn direct3d_applications() {
    let cases = [
        "separate_swapchains",
        "acquire_all",
        "several_rectangles",
        "resubmit_without_acquire",
        "two_sessions_at_once",
    ];
    for name in cases {
        let case = Case { arguments: &["--engine", "DXVK"], ..Case::new(name) };
        judge::analyzed_in_place(&case, &run(&case, None), &run(&case, Some(ANALYZED)));
    }
}

/// The left select button goes down in the application's third frame or so, and up two later.
fn press_select(scenario: &mut Scenario) {
    let path = "/user/hand/left/input/select/click".to_owned();
    let input = |t, down| Input { t, path: path.clone(), value: InputValue::Boolean(down) };
    scenario.input = vec![input(0.02, true), input(0.045, false)];
}

/// The gaze jumps through the picture, so that even one that is submitted again has to be processed again.
fn glance(scenario: &mut Scenario) {
    let at = |t, yaw_deg| mock::Gaze { t, yaw_deg, ..scenario.gaze[0] };
    scenario.gaze = vec![at(0.0, -10.0), at(0.03, -10.0), at(0.045, 5.0)];
}

/// Displays that point outwards, on a head that turns: the gaze goes with the head, not with the displays.
#[test]
fn canted_views_and_a_turning_head() {
    let scenario = |scenario: &mut Scenario| {
        for (view, degrees) in scenario.views.iter_mut().zip([8_f32, -8.0]) {
            view.orientation = glam::Quat::from_rotation_y(degrees.to_radians()).to_array();
        }
        let turned = Head { t: 0.1, yaw_deg: 30.0, ..scenario.head[0] };
        scenario.head.push(turned);
        // The eyes rest on the world.
        let before = mock::Gaze { yaw_deg: 15.0, pitch_deg: 0.0, ..scenario.gaze[0] };
        scenario.gaze = vec![before, mock::Gaze { t: 0.1, yaw_deg: -15.0, ..before }];
    };
    Case { gaze: Gaze::Tracker, scenario, ..Case::new("own_actions") }.check();
}

#[test]
fn every_case_of_the_application_is_tested() {
    let program = parafovea_tests::artifacts::program("parafovea-cases").unwrap();
    let list = std::process::Command::new(program).arg("--list").output().unwrap();
    let list = String::from_utf8(list.stdout).unwrap();
    let tested = [TESTED, crate::input::TESTED, crate::offer::TESTED, crate::conformance::TESTED].concat();
    assert_eq!(list.lines().collect::<Vec<_>>(), tested);
}
