//! An active session above the stand-ins for the runtime and for the Vulkan half: what is planned when, and who is told.

use super::fake::frames::{
    self, DISPLAY_TIME, EDGE, EYES, GAZE_LOCATED, HEAD, IMAGES, IN_LOCATE, SAMPLE_AGE_NS, fov, pose,
};
use super::fake::vulkan_half::{self, GPU_NS, PASSES, STALE_WORDS, Told, told};
use super::{create_instance, fake};
use crate::link::{BACKEND_ANY, NO_EYE, NO_IMAGE, ShownViewRecord};
use crate::xr::vulkan_device::VulkanDevice;
use crate::xr::{actions, frame, instance, plan, session, swapchain};
use ash::vk;
use glam::Quat;
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_core::rate::ShadingRate;
use parafovea_core::reuse::StaleTiles;
use std::ptr;
use std::sync::mpsc::channel;
use std::time::Duration;

const FRAME_NS: i64 = 11_111_111;
const SIDE: i32 = 512;

/// An application with a session, an action set and a double-wide swapchain.
struct Application {
    session: xr::Session,
    space: xr::Space,
    swapchain: xr::Swapchain,
}

/// Gives the layer its device, which stays where it is.
fn session_of_tests() -> xr::Session {
    let instance = create_instance(&[]).unwrap();
    let handle = xr::Session::from_raw(fake::new_handle());
    let device = VulkanDevice::of_table(vulkan_half::table(), vulkan_half::record());
    // SAFETY: nothing is done on this device: no swapchain is substituted.
    unsafe {
        session::track(instance::hooked(instance).unwrap(), xr::SystemId::from_raw(1), handle, Ok(device))
    };
    handle
}

impl Application {
    fn new() -> Self {
        let session = session_of_tests();
        let swapchain = create_swapchain(session, xr::SwapchainUsageFlags::COLOR_ATTACHMENT, SIDE as u32 * 2);
        let sets = [xr::ActionSet::from_raw(fake::new_handle())];
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: ptr::null(),
            count_action_sets: 1,
            action_sets: sets.as_ptr(),
        };
        // SAFETY: valid arguments.
        assert_eq!(unsafe { actions::attach(session, &info) }, xr::Result::SUCCESS);
        Self { session, space: xr::Space::from_raw(fake::new_handle()), swapchain }
    }

    fn begin(&self) {
        DISPLAY_TIME.set(DISPLAY_TIME.get() + FRAME_NS);
        // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
        unsafe {
            let mut state: xr::FrameState = std::mem::zeroed();
            assert_eq!(frame::wait(self.session, ptr::null(), &mut state), xr::Result::SUCCESS);
            assert_eq!(frame::begin(self.session, ptr::null()), xr::Result::SUCCESS);
        }
    }

    fn locate(&self) {
        locate(self.session, self.space);
    }

    fn view(&self, eye: i32) -> xr::CompositionLayerProjectionView {
        let offset = xr::Offset2Di { x: eye * SIDE, y: 0 };
        let extent = xr::Extent2Di { width: SIDE, height: SIDE };
        xr::CompositionLayerProjectionView {
            ty: xr::CompositionLayerProjectionView::TYPE,
            next: ptr::null(),
            pose: pose(HEAD.get()),
            fov: fov(),
            sub_image: xr::SwapchainSubImage {
                swapchain: self.swapchain,
                image_rect: xr::Rect2Di { offset, extent },
                image_array_index: 0,
            },
        }
    }

    fn end(&self, views: &[xr::CompositionLayerProjectionView], quad: Option<xr::Swapchain>) {
        let layer = xr::CompositionLayerProjection {
            ty: xr::CompositionLayerProjection::TYPE,
            next: ptr::null(),
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: self.space,
            view_count: views.len() as u32,
            views: views.as_ptr(),
        };
        // SAFETY: the structure is plain data, for which all zero is a valid value.
        let mut flat: xr::CompositionLayerQuad = unsafe { std::mem::zeroed() };
        flat.ty = xr::CompositionLayerQuad::TYPE;
        flat.sub_image.swapchain = quad.unwrap_or_default();
        let layers: [*const xr::CompositionLayerBaseHeader; 2] =
            [ptr::from_ref(&layer).cast(), ptr::from_ref(&flat).cast()];
        let info = xr::FrameEndInfo {
            ty: xr::FrameEndInfo::TYPE,
            next: ptr::null(),
            display_time: xr::Time::from_nanos(DISPLAY_TIME.get()),
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: 1 + u32::from(quad.is_some()),
            layers: layers.as_ptr(),
        };
        // SAFETY: valid arguments. The stand-in answers with an error, which is not ours to judge.
        unsafe { frame::end(self.session, &info) };
    }

    fn frame(&self) {
        self.begin();
        self.locate();
        self.end(&[self.view(0), self.view(1)], None);
    }

    /// Frames until the gaze is trusted and nothing becomes coarser any more.
    fn settle(&self) {
        for _ in 0..90 {
            self.frame();
        }
        told();
    }
}

fn locate(session: xr::Session, space: xr::Space) {
    let info = xr::ViewLocateInfo {
        ty: xr::ViewLocateInfo::TYPE,
        next: ptr::null(),
        view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        display_time: xr::Time::from_nanos(DISPLAY_TIME.get()),
        space,
    };
    // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
    unsafe {
        let mut state: xr::ViewState = std::mem::zeroed();
        let mut views: [xr::View; 2] = std::mem::zeroed();
        let mut count = 0;
        let result = plan::locate_views(session, &info, &mut state, 2, &mut count, views.as_mut_ptr());
        assert_eq!((result, count), (xr::Result::SUCCESS, 2));
        assert_eq!(views[1].fov.angle_right, EDGE, "what the runtime said");
    }
}

fn create_swapchain(session: xr::Session, usage: xr::SwapchainUsageFlags, width: u32) -> xr::Swapchain {
    let info = xr::SwapchainCreateInfo {
        ty: xr::SwapchainCreateInfo::TYPE,
        next: ptr::null(),
        create_flags: xr::SwapchainCreateFlags::EMPTY,
        usage_flags: usage,
        format: i64::from(vk::Format::R8G8B8A8_SRGB.as_raw()),
        sample_count: 1,
        width,
        height: SIDE as u32,
        face_count: 1,
        array_size: 1,
        mip_count: 1,
    };
    let mut handle = xr::Swapchain::NULL;
    // SAFETY: valid arguments.
    assert_eq!(unsafe { swapchain::create(session, &info, &mut handle) }, xr::Result::SUCCESS);
    handle
}

fn look(yaw_deg: f32) {
    EYES.set(Some(Quat::from_rotation_y(yaw_deg.to_radians())));
}

/// The plans among what was told since the last call: serial and rates of the left eye.
fn plans() -> Vec<(u64, Vec<u8>)> {
    let plan = |told| match told {
        Told::Plan { serial, rates: [left, _], .. } => Some((serial, left)),
        _ => None,
    };
    told().into_iter().filter_map(plan).collect()
}

#[test]
fn the_vulkan_half_learns_what_is_wanted_before_the_first_frame() {
    session_of_tests();
    let settings = Told::Settings { is_on: 1, backend: BACKEND_ANY, passes: String::new() };
    assert_eq!(told(), [Told::Active(true), settings]);
}

#[test]
fn a_steady_frame_hands_over_nothing_new() {
    let application = Application::new();
    look(5.0);
    application.settle();
    application.frame();
    assert_eq!(plans(), []);
}

#[test]
fn a_plan_has_the_size_of_what_is_shown_and_serials_rise() {
    let application = Application::new();
    look(0.0);
    application.begin();
    application.locate();
    assert_eq!(plans(), [], "nothing was shown yet");
    application.end(&[application.view(0), application.view(1)], None);
    let first = told();
    let Some(Told::Plan { serial, extents, rates }) =
        first.iter().find(|told| matches!(told, Told::Plan { .. }))
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

#[test]
fn a_gaze_that_moves_between_begin_and_locate_is_in_the_plan_before_the_application_draws() {
    let application = Application::new();
    look(-30.0);
    application.settle();
    let left_edge = 16 * 32;
    application.begin();
    let before = plans();
    assert!(before.is_empty(), "the gaze has not moved");
    look(35.0);
    application.locate();
    let after = plans();
    assert_eq!(after.len(), 1);
    assert_eq!(after[0].1[left_edge], ShadingRate::R1X1.texel(), "where the eyes look now");
    look(-30.0);
    application.locate();
    assert_eq!(plans(), [], "once a frame");
}

#[test]
fn gaze_is_located_at_begin_and_with_the_views_and_nowhere_else() {
    let application = Application::new();
    look(0.0);
    application.settle();
    GAZE_LOCATED.set(0);
    application.begin();
    assert_eq!(GAZE_LOCATED.get(), 1);
    application.locate();
    application.locate();
    assert_eq!(GAZE_LOCATED.get(), 2);
    application.end(&[application.view(0), application.view(1)], None);
    assert_eq!(GAZE_LOCATED.get(), 2);
}

#[test]
fn a_turning_head_with_resting_eyes_changes_no_plan() {
    let application = Application::new();
    look(8.0);
    application.settle();
    for step in 0..50 {
        HEAD.set(Quat::from_euler(glam::EulerRot::YXZ, step as f32 * 0.04, step as f32 * 0.01, 0.1));
        // Never the same to the last bit, as from a tracker that works.
        look(8.0 + 1e-4 * (step % 3) as f32);
        application.frame();
    }
    assert_eq!(plans(), []);
}

#[test]
fn a_tracker_that_has_stopped_is_noticed_when_the_head_turns() {
    let application = Application::new();
    look(8.0);
    application.settle();
    for step in 0..100 {
        HEAD.set(Quat::from_rotation_y(step as f32 * 0.01));
        application.frame();
    }
    let plans = plans();
    let (_, last) = plans.last().expect("wide rates instead");
    let coarsest = last.iter().max().copied();
    assert!(coarsest < Some(ShadingRate::R4X4.texel()), "{coarsest:?}");
}

/// How wide and how high the region at full rate is where the eyes look ahead, tiles, after frames with these views.
fn full(application: &Application, views: &[xr::CompositionLayerProjectionView]) -> [usize; 2] {
    let frames = |count: u32, yaw_deg: f32| {
        look(yaw_deg);
        for _ in 0..count {
            application.begin();
            application.locate();
            application.end(views, None);
        }
    };
    frames(90, 0.0);
    // Something new, so that the map at the end is told.
    frames(20, -20.0);
    frames(90, 0.0);
    let map = plans().pop().unwrap().1;
    let is_full = |at: &usize| map[*at] == ShadingRate::R1X1.texel();
    let row = (16 * 32..17 * 32).filter(is_full).count();
    let column = (0..32).map(|row| row * 32 + 16).filter(is_full).count();
    [row, column]
}

#[test]
fn the_fovea_reaches_to_where_either_eye_looks_at_something_near() {
    let application = Application::new();
    let plain = [application.view(0), application.view(1)];
    let [row, column] = full(&application, &plain);
    assert!(row > column + 2, "4.5 degrees to either side: {row} {column}");
}

#[test]
fn depth_says_that_nothing_is_near() {
    let width = |near_z, far_z| {
        let application = Application::new();
        let depth = xr::CompositionLayerDepthInfoKHR {
            ty: xr::CompositionLayerDepthInfoKHR::TYPE,
            next: ptr::null(),
            sub_image: application.view(0).sub_image,
            min_depth: 0.0,
            max_depth: 1.0,
            near_z,
            far_z,
        };
        let mut views = [application.view(0), application.view(1)];
        views.iter_mut().for_each(|view| view.next = ptr::from_ref(&depth).cast());
        let [row, column] = full(&application, &views);
        row - column
    };
    let near = width(0.1, 100.0);
    assert!(width(3.0, f32::INFINITY) < near && width(50.0, 3.0) < near, "{near}");
    assert_eq!(width(f32::NAN, 100.0), near);
    assert_eq!(width(0.0, 100.0), near);
}

#[test]
fn the_time_of_a_sample_reaches_the_model() {
    // A gaze that follows something evenly is led on to the time when the frame is shown, if its own time is known.
    let map = |age_ns: Option<i64>| {
        let application = Application::new();
        SAMPLE_AGE_NS.set(age_ns);
        for step in 0..120 {
            look(-15.0 + 0.25 * step as f32);
            application.frame();
        }
        plans().pop().unwrap().1
    };
    let (known, old) = (map(Some(0)), map(Some(100_000_000)));
    assert_ne!(known, old, "a sample of 100 ms ago leads on further");
    assert_ne!(map(None), old, "50 ms are taken where it is not known");
}

#[test]
fn a_gaze_that_cannot_be_is_no_gaze() {
    let application = Application::new();
    look(0.0);
    application.settle();
    look(180.0);
    (0..80).for_each(|_| application.frame());
    let (_, map) = plans().pop().expect("wide rates instead");
    assert!(map.iter().all(|rate| *rate < ShadingRate::R4X4.texel()));
}

#[test]
fn the_actions_of_the_application_are_as_they_were() {
    let application = Application::new();
    let made = frames::ACTIONS.take();
    assert_eq!(made, ["xrCreateActionSet", "xrCreateAction", "xrSuggestInteractionProfileBindings"]);
    application.settle();
    assert_eq!(frames::ACTIONS.take(), [""; 0], "frames synchronise nothing: the application does");
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
    assert!(IN_LOCATE.take().is_none(), "nothing was located");
}

#[test]
fn images_are_told_once_and_their_end_before_it_comes() {
    let application = Application::new();
    told();
    // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
    unsafe {
        let mut count = 0;
        let swapchain = application.swapchain;
        swapchain::enumerate_images(swapchain, 0, &mut count, ptr::null_mut());
        assert_eq!(told(), [], "only counted");
        let mut images: [xr::SwapchainImageVulkanKHR; 3] = std::mem::zeroed();
        images.iter_mut().for_each(|image| image.ty = xr::SwapchainImageVulkanKHR::TYPE);
        for expected in [true, false] {
            swapchain::enumerate_images(swapchain, 3, &mut count, images.as_mut_ptr().cast());
            let told = told();
            assert_eq!(!told.is_empty(), expected, "{told:?}");
            let record = Told::Swapchain {
                swapchain: swapchain.into_raw(),
                images: IMAGES.to_vec(),
                extent: [SIDE as u32 * 2, SIDE as u32],
                usage: vk::ImageUsageFlags::COLOR_ATTACHMENT,
            };
            assert!(told.iter().all(|told| *told == record), "{told:?}");
        }
        assert_eq!(swapchain::destroy(swapchain), xr::Result::SUCCESS);
        let told = told();
        let [Told::Swapchain { images, .. }] = &told[..] else { panic!("{told:?}") };
        assert!(images.is_empty());
    }
}

#[test]
fn what_is_shown_is_told_with_the_image_that_was_released_last() {
    let application = Application::new();
    let ui = create_swapchain(application.session, xr::SwapchainUsageFlags::COLOR_ATTACHMENT, 64);
    let depth_usage = xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    let depth = create_swapchain(application.session, depth_usage, SIDE as u32);
    let mut depth_info = xr::CompositionLayerDepthInfoKHR {
        ty: xr::CompositionLayerDepthInfoKHR::TYPE,
        next: ptr::null(),
        sub_image: application.view(0).sub_image,
        min_depth: 0.0,
        max_depth: 1.0,
        near_z: 0.1,
        far_z: 100.0,
    };
    depth_info.sub_image.swapchain = depth;
    let mut views: Vec<_> = (0..4).map(|index| application.view(index % 2)).collect();
    views[1].next = ptr::from_ref(&depth_info).cast();
    views[1].fov = xr::Fovf { angle_up: -EDGE, angle_down: EDGE, ..fov() };
    let shown = || {
        told().into_iter().find_map(|told| match told {
            Told::Shown { views, flat, depth } => Some((views, flat, depth)),
            _ => None,
        })
    };
    application.begin();
    application.end(&views, Some(ui));
    let (told_views, flat, depths) = shown().unwrap();
    assert_eq!((flat, depths), (vec![ui.into_raw()], vec![depth.into_raw()]));
    let side = SIDE as u32;
    let expected = |eye, x, is_upside_down| ShownViewRecord {
        eye,
        swapchain: application.swapchain.into_raw(),
        image_index: NO_IMAGE,
        layer: 0,
        rect: [x, 0, side, side],
        is_upside_down,
    };
    let eyes = [expected(0, 0, 0), expected(1, side, 1), expected(NO_EYE, 0, 0), expected(NO_EYE, side, 0)];
    assert_eq!(told_views, eyes);

    let swapchain = application.swapchain;
    let mut index = 0;
    // SAFETY: valid arguments.
    unsafe {
        for _ in 0..2 {
            swapchain::acquire_image(swapchain, ptr::null(), &mut index);
        }
        swapchain::release_image(swapchain, ptr::null());
    }
    application.begin();
    application.end(&views[..2], None);
    assert_eq!(shown().unwrap().0[0].image_index, 0, "acquired first, released first");
    // SAFETY: valid arguments.
    unsafe { swapchain::release_image(swapchain, ptr::null()) };
    application.begin();
    application.end(&views[..2], None);
    assert_eq!(shown().unwrap().0[0].image_index, 1);
}

#[test]
fn a_session_that_ends_takes_its_images_along() {
    let application = Application::new();
    // SAFETY: valid arguments; the structures are plain data, for which all zero is a valid value.
    unsafe {
        let mut count = 0;
        let mut images: [xr::SwapchainImageVulkanKHR; 3] = std::mem::zeroed();
        images.iter_mut().for_each(|image| image.ty = xr::SwapchainImageVulkanKHR::TYPE);
        swapchain::enumerate_images(application.swapchain, 3, &mut count, images.as_mut_ptr().cast());
        told();
        assert_eq!(session::destroy(application.session), xr::Result::SUCCESS);
    }
    let told = told();
    assert!(matches!(&told[..], [Told::Swapchain { images, .. }, Told::Active(false)] if images.is_empty()));
}

/// The gate looks how frames are without rates, and only where there are passes that have them.
#[test]
fn rates_are_left_off_for_a_look() {
    let application = Application::new();
    let looks = |frames: u32| -> Vec<u32> {
        told();
        (0..frames).for_each(|_| application.frame());
        let settings = told().into_iter().filter_map(|told| match told {
            Told::Settings { is_on, .. } => Some(is_on),
            _ => None,
        });
        settings.collect()
    };
    assert_eq!(looks(100), [0; 0]);
    PASSES.set(2);
    let looks = looks(100);
    assert!(looks.len() >= 2, "{looks:?}");
    assert!(looks.iter().enumerate().all(|(index, is_on)| *is_on == index as u32 % 2), "{looks:?}");
}

/// On a GPU the gate hears what passes took, two frames later.
#[test]
fn rates_that_take_a_gpu_longer_are_dropped() {
    for (ns, is_on) in [([5_000_000, 7_000_000], 0), ([5_000_000, 3_000_000], 1)] {
        GPU_NS.set(Some(ns));
        PASSES.set(2);
        let application = Application::new();
        told();
        (0..400).for_each(|_| application.frame());
        let settings = told().into_iter().filter_map(|told| match told {
            Told::Settings { is_on, .. } => Some(is_on),
            _ => None,
        });
        let settings: Vec<u32> = settings.collect();
        assert!(settings.len() > 2, "it never looked: {settings:?}");
        assert_eq!(settings.last(), Some(&is_on), "{ns:?}: {settings:?}");
    }
    GPU_NS.set(None);
}

#[test]
fn what_passes_left_out_is_asked_of_each_eye() {
    let device = VulkanDevice::of_table(vulkan_half::table(), vulkan_half::record());
    let (mut words, mut stale) = (Vec::new(), StaleTiles::default());
    device.stale(1, &mut words, &mut stale);
    assert!(stale.is_empty());
    for rows in [vec![0, 1 << 31, 5], vec![2]] {
        STALE_WORDS.set(rows.clone());
        device.stale(1, &mut words, &mut stale);
        assert_eq!((stale.words(), stale.tiles()), (&rows[..], [32, rows.len() as u32]));
        device.stale(0, &mut words, &mut stale);
        assert!(stale.is_empty(), "of the left eye nothing");
    }
}
