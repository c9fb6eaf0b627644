//! Frames, views, spaces and swapchains of the stand-in: a headset of two views, as this thread has set it up.

use super::actions::GAZE_SPACES;
use super::{new_handle, table};
use glam::Quat;
use openxr_sys as xr;
use openxr_sys::{Handle, pfn};
use std::cell::{Cell, RefCell};

thread_local! {
    /// The next frame's display time.
    pub static DISPLAY_TIME: Cell<i64> = const { Cell::new(1_000_000_000) };
    /// Orientation of the head in every space but its own.
    pub static HEAD: Cell<Quat> = const { Cell::new(Quat::IDENTITY) };
    /// Orientation of the views in the space of the head.
    pub static VIEWS: Cell<Quat> = const { Cell::new(Quat::IDENTITY) };
    /// Number of times that the head was located.
    pub static HEAD_LOCATED: Cell<usize> = const { Cell::new(0) };
    /// Orientation of the eyes in the space of the head; `None` if they are not tracked.
    pub static EYES: Cell<Option<Quat>> = const { Cell::new(None) };
    /// Age of the located gaze, nanoseconds; `None` if it has no time.
    pub static SAMPLE_AGE_NS: Cell<Option<i64>> = const { Cell::new(None) };
    /// Runs inside xrLocateSpace.
    pub static IN_LOCATE: RefCell<Option<Box<dyn FnMut()>>> = const { RefCell::new(None) };
    /// Number of times that the gaze was located.
    pub static GAZE_LOCATED: Cell<usize> = const { Cell::new(0) };
    static HEAD_SPACES: RefCell<Vec<xr::Space>> = const { RefCell::new(Vec::new()) };
}

/// Each view's angle of each edge, radians.
pub const EDGE: f32 = std::f32::consts::FRAC_PI_4;

/// The images of every swapchain.
pub const IMAGES: [u64; 3] = [501, 502, 503];

/// The function of that name, if it is here.
pub fn function(name: &str) -> Option<pfn::VoidFunction> {
    table! { name;
        "xrGetSystemProperties" GetSystemProperties get_system_properties;
        "xrWaitFrame" WaitFrame wait_frame;
        "xrBeginFrame" BeginFrame begin_frame;
        "xrLocateViews" LocateViews locate_views;
        "xrLocateSpace" LocateSpace locate_space;
        "xrCreateReferenceSpace" CreateReferenceSpace create_reference_space;
        "xrDestroySpace" DestroySpace destroy_space;
        "xrCreateSwapchain" CreateSwapchain create_swapchain;
        "xrDestroySwapchain" DestroySwapchain destroy_swapchain;
        "xrEnumerateSwapchainImages" EnumerateSwapchainImages enumerate_images;
        "xrAcquireSwapchainImage" AcquireSwapchainImage acquire_image;
        "xrReleaseSwapchainImage" ReleaseSwapchainImage release_image;
        "xrDestroySession" DestroySession destroy_session;
        "xrBeginSession" BeginSession begin_session;
        "xrEndSession" EndSession end_session;
    }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn get_system_properties(
    _: xr::Instance,
    _: xr::SystemId,
    properties: *mut xr::SystemProperties,
) -> xr::Result {
    // SAFETY: the layer chains this structure.
    unsafe {
        let gaze = (*properties).next.cast::<xr::SystemEyeGazeInteractionPropertiesEXT>();
        (*gaze).supports_eye_gaze_interaction = xr::TRUE;
    }
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn wait_frame(
    _: xr::Session,
    _: *const xr::FrameWaitInfo,
    state: *mut xr::FrameState,
) -> xr::Result {
    // SAFETY: the tests pass a valid structure.
    unsafe { (*state).predicted_display_time = xr::Time::from_nanos(DISPLAY_TIME.get()) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn begin_frame(_: xr::Session, _: *const xr::FrameBeginInfo) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn locate_views(
    _: xr::Session,
    info: *const xr::ViewLocateInfo,
    state: *mut xr::ViewState,
    capacity: u32,
    count: *mut u32,
    views: *mut xr::View,
) -> xr::Result {
    // SAFETY: the tests pass an array of `capacity` views, and valid structures.
    unsafe {
        *count = 2;
        let is_head = HEAD_SPACES.with_borrow(|spaces| spaces.contains(&(*info).space));
        let turn = if is_head { VIEWS.get() } else { HEAD.get() * VIEWS.get() };
        (*state).view_state_flags = xr::ViewStateFlags::ORIENTATION_VALID;
        for at in 0..capacity.min(2) as usize {
            let [x, y, z] = (HEAD.get() * glam::Vec3::X * [-0.032, 0.032][at]).to_array();
            (*views.add(at)).pose = xr::Posef { position: xr::Vector3f { x, y, z }, ..pose(turn) };
            (*views.add(at)).fov = fov();
        }
    }
    xr::Result::SUCCESS
}

/// Of every view.
pub fn fov() -> xr::Fovf {
    xr::Fovf { angle_left: -EDGE, angle_right: EDGE, angle_up: EDGE, angle_down: -EDGE }
}

/// At the origin.
pub fn pose(orientation: Quat) -> xr::Posef {
    let [x, y, z, w] = orientation.to_array();
    xr::Posef { orientation: xr::Quaternionf { x, y, z, w }, ..xr::Posef::IDENTITY }
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn locate_space(
    space: xr::Space,
    base: xr::Space,
    time: xr::Time,
    location: *mut xr::SpaceLocation,
) -> xr::Result {
    let in_locate = IN_LOCATE.take();
    if let Some(mut run) = in_locate {
        run();
    }
    let is_head = |space| HEAD_SPACES.with_borrow(|spaces| spaces.contains(&space));
    let is_gaze = GAZE_SPACES.with_borrow(|spaces| spaces.contains(&space));
    let turned = match (is_gaze, is_head(space)) {
        (true, _) => {
            GAZE_LOCATED.set(GAZE_LOCATED.get() + 1);
            EYES.get().map(|eyes| if is_head(base) { eyes } else { HEAD.get() * eyes })
        }
        (_, true) => {
            HEAD_LOCATED.set(HEAD_LOCATED.get() + 1);
            Some(if is_head(base) { Quat::IDENTITY } else { HEAD.get() })
        }
        _ => Some(Quat::IDENTITY),
    };
    // SAFETY: the layer passes a valid structure, which for the gaze one extends that takes its time.
    unsafe {
        if is_gaze && let Some(age) = SAMPLE_AGE_NS.get() {
            let sample = (*location).next.cast::<xr::EyeGazeSampleTimeEXT>();
            assert_eq!((*sample).ty, xr::EyeGazeSampleTimeEXT::TYPE);
            (*sample).time = xr::Time::from_nanos(time.as_nanos() - age);
        }
        (*location).pose = pose(turned.unwrap_or_default());
        (*location).location_flags = match turned {
            Some(_) => {
                xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::ORIENTATION_TRACKED
            }
            None => xr::SpaceLocationFlags::EMPTY,
        };
    }
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_reference_space(
    _: xr::Session,
    info: *const xr::ReferenceSpaceCreateInfo,
    space: *mut xr::Space,
) -> xr::Result {
    let made = xr::Space::from_raw(new_handle());
    // SAFETY: the layer passes a valid structure and a place for the handle.
    unsafe {
        if (*info).reference_space_type == xr::ReferenceSpaceType::VIEW {
            HEAD_SPACES.with_borrow_mut(|spaces| spaces.push(made));
        }
        *space = made;
    }
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_space(_: xr::Space) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn create_swapchain(
    _: xr::Session,
    _: *const xr::SwapchainCreateInfo,
    swapchain: *mut xr::Swapchain,
) -> xr::Result {
    // SAFETY: the layer passes a place for the handle.
    unsafe { *swapchain = xr::Swapchain::from_raw(new_handle()) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_swapchain(_: xr::Swapchain) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn enumerate_images(
    _: xr::Swapchain,
    capacity: u32,
    count: *mut u32,
    images: *mut xr::SwapchainImageBaseHeader,
) -> xr::Result {
    // SAFETY: the tests pass an array of `capacity` images.
    unsafe {
        *count = IMAGES.len() as u32;
        let images = images.cast::<xr::SwapchainImageVulkanKHR>();
        for (at, image) in IMAGES.into_iter().enumerate().take(capacity as usize) {
            (*images.add(at)).image = image;
        }
    }
    xr::Result::SUCCESS
}

thread_local! {
    static TURN: Cell<u32> = const { Cell::new(0) };
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn acquire_image(
    _: xr::Swapchain,
    _: *const xr::SwapchainImageAcquireInfo,
    index: *mut u32,
) -> xr::Result {
    // SAFETY: the tests pass a place for the index.
    unsafe { *index = TURN.replace((TURN.get() + 1) % IMAGES.len() as u32) };
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn release_image(
    _: xr::Swapchain,
    _: *const xr::SwapchainImageReleaseInfo,
) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn destroy_session(_: xr::Session) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn begin_session(_: xr::Session, _: *const xr::SessionBeginInfo) -> xr::Result {
    xr::Result::SUCCESS
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn end_session(_: xr::Session) -> xr::Result {
    xr::Result::SUCCESS
}
