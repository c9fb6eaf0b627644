//! An OpenXR layer that saves the pictures which the application, or a layer above, submits: for runtimes that keep none. Named in
//! `XR_ENABLE_API_LAYERS` it is below implicit layers (OpenXR loader specification, "API Layer Ordering").
//!
//! It looks for a file `next` in its folder at each xrEndFrame, takes it away, and saves each view of the first projection layer as
//! `<content of next>-<view>.png`: 8-bit codes as they are in the swapchain. The angles of the views' edges go to `<content of next>.json`.

mod images;

use images::Images;
use openxr_sys as xr;
use openxr_sys::{Handle as _, pfn};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, VecDeque};
use std::ffi::{CStr, c_char};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Names the folder. Without it nothing is saved.
pub const CAPTURE_FOLDER_VARIABLE: &str = "PARAFOVEA_TEST_CAPTURE_FOLDER";

/// The layer's name, for `XR_ENABLE_API_LAYERS`.
pub const CAPTURE_LAYER: &str = "XR_APILAYER_PARAFOVEA_TEST_capture";

/// The layer's manifest, for a folder in `XR_API_LAYER_PATH`.
pub fn capture_manifest(library: &Path) -> String {
    let manifest = serde_json::json!({
        "file_format_version": "1.0.0",
        "api_layer": {
            "name": CAPTURE_LAYER,
            "library_path": library,
            "api_version": "1.0",
            "implementation_version": "1",
            "description": "For Parafovea's own tests",
            "functions": { "xrNegotiateLoaderApiLayerInterface": "capture_xrNegotiateLoaderApiLayerInterface" },
        },
    });
    manifest.to_string()
}

/// One view of a saved frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CapturedView {
    /// Angles of the left, right, upper and lower edge, radians.
    pub fov: [f32; 4],
    /// Position, metres, in the layer's space.
    pub position: [f32; 3],
    /// Orientation, a unit quaternion: x, y, z, w.
    pub orientation: [f32; 4],
}

/// The functions of the next layer.
#[derive(Clone, Copy)]
struct Next {
    get_instance_proc_addr: pfn::GetInstanceProcAddr,
    create_session: pfn::CreateSession,
    destroy_session: pfn::DestroySession,
    create_swapchain: pfn::CreateSwapchain,
    destroy_swapchain: pfn::DestroySwapchain,
    enumerate_swapchain_images: pfn::EnumerateSwapchainImages,
    acquire_swapchain_image: pfn::AcquireSwapchainImage,
    release_swapchain_image: pfn::ReleaseSwapchainImage,
    end_frame: pfn::EndFrame,
}

/// A swapchain and its images.
struct Swapchain {
    images: Vec<u64>,
    acquired: VecDeque<u32>,
    released: Option<u32>,
}

/// Loaders have one instance at a time, and instances of Vulkan runtimes one session.
#[derive(Default)]
struct State {
    next: Option<Next>,
    device: Option<Images>,
    swapchains: HashMap<u64, Swapchain>,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

/// A test without its pictures fails by the panics here.
#[allow(clippy::expect_used, reason = "a layer of tests")]
fn with<T>(use_it: impl FnOnce(&mut State, &Next) -> T) -> T {
    let mut state = state();
    let state = state.get_or_insert_default();
    let next = state.next.expect("calls come after xrCreateInstance");
    use_it(state, &next)
}

fn state() -> MutexGuard<'static, Option<State>> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The OpenXR loader's first call.
///
/// # Safety
///
/// Called by an OpenXR loader, with valid structures.
#[unsafe(export_name = "capture_xrNegotiateLoaderApiLayerInterface")]
pub unsafe extern "system" fn negotiate(
    _loader: *const xr::NegotiateLoaderInfo,
    _name: *const c_char,
    request: *mut xr::NegotiateApiLayerRequest,
) -> xr::Result {
    // SAFETY: the loader vouches for it.
    let request = unsafe { &mut *request };
    request.layer_interface_version = 1;
    request.layer_api_version = xr::Version::new(1, 0, 0);
    request.get_instance_proc_addr = Some(get_instance_proc_addr);
    request.create_api_layer_instance = Some(create_instance);
    xr::Result::SUCCESS
}

/// # Safety
/// As `xrCreateApiLayerInstance`.
unsafe extern "system" fn create_instance(
    info: *const xr::InstanceCreateInfo,
    layer_info: *const xr::ApiLayerCreateInfo,
    instance: *mut xr::Instance,
) -> xr::Result {
    // SAFETY: the loader vouches for its list, which names the next layer, or itself; and the application for the rest.
    unsafe {
        let below = &*(*layer_info).next_info;
        let list = xr::ApiLayerCreateInfo { next_info: below.next, ..*layer_info };
        let (Some(create), Some(get)) =
            (below.next_create_api_layer_instance, below.next_get_instance_proc_addr)
        else {
            return xr::Result::ERROR_INITIALIZATION_FAILED;
        };
        let result = create(info, &list, instance);
        if result == xr::Result::SUCCESS {
            *state() = Some(State { next: Some(Next::load(get, *instance)), ..State::default() });
        }
        result
    }
}

impl Next {
    /// # Safety
    ///
    /// The function belongs to the instance, which is live.
    unsafe fn load(get: pfn::GetInstanceProcAddr, instance: xr::Instance) -> Self {
        macro_rules! load {
            ($name:literal, $kind:ty) => {{
                let mut found = None;
                // SAFETY: the caller vouches for the function and the instance; the name determines the type.
                unsafe {
                    let result = get(instance, $name.as_ptr(), &mut found);
                    assert_eq!(result, xr::Result::SUCCESS, "{:?}", $name);
                    std::mem::transmute::<Option<pfn::VoidFunction>, $kind>(found)
                }
            }};
        }
        Self {
            get_instance_proc_addr: get,
            create_session: load!(c"xrCreateSession", pfn::CreateSession),
            destroy_session: load!(c"xrDestroySession", pfn::DestroySession),
            create_swapchain: load!(c"xrCreateSwapchain", pfn::CreateSwapchain),
            destroy_swapchain: load!(c"xrDestroySwapchain", pfn::DestroySwapchain),
            enumerate_swapchain_images: load!(c"xrEnumerateSwapchainImages", pfn::EnumerateSwapchainImages),
            acquire_swapchain_image: load!(c"xrAcquireSwapchainImage", pfn::AcquireSwapchainImage),
            release_swapchain_image: load!(c"xrReleaseSwapchainImage", pfn::ReleaseSwapchainImage),
            end_frame: load!(c"xrEndFrame", pfn::EndFrame),
        }
    }
}

/// # Safety
/// As `xrGetInstanceProcAddr`.
unsafe extern "system" fn get_instance_proc_addr(
    instance: xr::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> xr::Result {
    /// A function of this layer's, by its type.
    macro_rules! own {
        ($own:expr, $kind:ty) => {{
            let own: $kind = $own;
            // SAFETY: a function, which who asked for it by name calls by that type.
            Some(unsafe { std::mem::transmute::<$kind, pfn::VoidFunction>(own) })
        }};
    }
    // SAFETY: the caller vouches for the name.
    let own = match unsafe { CStr::from_ptr(name) }.to_bytes() {
        b"xrGetInstanceProcAddr" => own!(get_instance_proc_addr, pfn::GetInstanceProcAddr),
        b"xrCreateSession" => own!(create_session, pfn::CreateSession),
        b"xrDestroySession" => own!(destroy_session, pfn::DestroySession),
        b"xrCreateSwapchain" => own!(create_swapchain, pfn::CreateSwapchain),
        b"xrDestroySwapchain" => own!(destroy_swapchain, pfn::DestroySwapchain),
        b"xrAcquireSwapchainImage" => own!(acquire_swapchain_image, pfn::AcquireSwapchainImage),
        b"xrReleaseSwapchainImage" => own!(release_swapchain_image, pfn::ReleaseSwapchainImage),
        b"xrEndFrame" => own!(end_frame, pfn::EndFrame),
        _ => None,
    };
    if own.is_some() {
        // SAFETY: the caller vouches for the result.
        unsafe { *function = own };
        return xr::Result::SUCCESS;
    }
    let next = with(|_, next| next.get_instance_proc_addr);
    // SAFETY: the caller's own arguments.
    unsafe { next(instance, name, function) }
}

/// # Safety
/// As `xrCreateSession`.
unsafe extern "system" fn create_session(
    instance: xr::Instance,
    info: *const xr::SessionCreateInfo,
    session: *mut xr::Session,
) -> xr::Result {
    let next = with(|_, next| next.create_session);
    // SAFETY: the application's own arguments; every structure of a chain begins with its type and the next.
    unsafe {
        let result = next(instance, info, session);
        let mut at = (*info).next.cast::<xr::BaseInStructure>();
        while result == xr::Result::SUCCESS && !at.is_null() {
            if (*at).ty == xr::GraphicsBindingVulkanKHR::TYPE {
                let images = Images::of(&*at.cast::<xr::GraphicsBindingVulkanKHR>());
                with(|state, _| state.device = Some(images));
            }
            at = (*at).next;
        }
        result
    }
}

/// # Safety
/// As `xrDestroySession`.
unsafe extern "system" fn destroy_session(session: xr::Session) -> xr::Result {
    let next = with(|state, next| {
        state.device = None;
        state.swapchains.clear();
        next.destroy_session
    });
    // SAFETY: the application's own arguments.
    unsafe { next(session) }
}

/// # Safety
/// As `xrCreateSwapchain`.
unsafe extern "system" fn create_swapchain(
    session: xr::Session,
    info: *const xr::SwapchainCreateInfo,
    swapchain: *mut xr::Swapchain,
) -> xr::Result {
    let (create, enumerate) = with(|_, next| (next.create_swapchain, next.enumerate_swapchain_images));
    // SAFETY: the application's own arguments; more usage changes nothing for it.
    unsafe {
        let info = xr::SwapchainCreateInfo {
            usage_flags: (*info).usage_flags | xr::SwapchainUsageFlags::TRANSFER_SRC,
            ..*info
        };
        let result = create(session, &info, swapchain);
        if result != xr::Result::SUCCESS {
            return result;
        }
        let mut count = 0;
        enumerate(*swapchain, 0, &mut count, std::ptr::null_mut());
        let empty = xr::SwapchainImageVulkanKHR {
            ty: xr::SwapchainImageVulkanKHR::TYPE,
            next: std::ptr::null_mut(),
            image: 0,
        };
        let mut images = vec![empty; count as usize];
        enumerate(*swapchain, count, &mut count, images.as_mut_ptr().cast());
        let images = images.iter().map(|image| image.image).collect();
        let new = Swapchain { images, acquired: VecDeque::new(), released: None };
        with(|state, _| state.swapchains.insert((*swapchain).into_raw(), new));
        result
    }
}

/// # Safety
/// As `xrDestroySwapchain`.
unsafe extern "system" fn destroy_swapchain(swapchain: xr::Swapchain) -> xr::Result {
    let next = with(|state, next| {
        state.swapchains.remove(&swapchain.into_raw());
        next.destroy_swapchain
    });
    // SAFETY: the application's own arguments.
    unsafe { next(swapchain) }
}

/// # Safety
/// As `xrAcquireSwapchainImage`.
unsafe extern "system" fn acquire_swapchain_image(
    swapchain: xr::Swapchain,
    info: *const xr::SwapchainImageAcquireInfo,
    index: *mut u32,
) -> xr::Result {
    let next = with(|_, next| next.acquire_swapchain_image);
    // SAFETY: the application's own arguments.
    unsafe {
        let result = next(swapchain, info, index);
        if result == xr::Result::SUCCESS {
            with(|state, _| {
                if let Some(known) = state.swapchains.get_mut(&swapchain.into_raw()) {
                    known.acquired.push_back(*index);
                }
            });
        }
        result
    }
}

/// # Safety
/// As `xrReleaseSwapchainImage`.
unsafe extern "system" fn release_swapchain_image(
    swapchain: xr::Swapchain,
    info: *const xr::SwapchainImageReleaseInfo,
) -> xr::Result {
    let next = with(|_, next| next.release_swapchain_image);
    // SAFETY: the application's own arguments.
    let result = unsafe { next(swapchain, info) };
    if result == xr::Result::SUCCESS {
        with(|state, _| {
            if let Some(known) = state.swapchains.get_mut(&swapchain.into_raw()) {
                known.released = known.acquired.pop_front();
            }
        });
    }
    result
}

/// # Safety
/// As `xrEndFrame`.
unsafe extern "system" fn end_frame(session: xr::Session, info: *const xr::FrameEndInfo) -> xr::Result {
    let next = with(|state, next| {
        if let Some((folder, name)) = wanted() {
            // SAFETY: the application's own arguments.
            unsafe { state.save(&*info, &folder, &name) };
        }
        next.end_frame
    });
    // SAFETY: the application's own arguments.
    unsafe { next(session, info) }
}

/// The folder, and the name of the frame that is to be saved.
fn wanted() -> Option<(PathBuf, String)> {
    let folder = PathBuf::from(std::env::var_os(CAPTURE_FOLDER_VARIABLE)?);
    let next = folder.join("next");
    let name = fs::read_to_string(&next).ok()?;
    fs::remove_file(&next).ok()?;
    Some((folder, name.trim().to_owned()))
}

impl State {
    /// # Safety
    ///
    /// Valid usage of xrEndFrame.
    unsafe fn save(&self, info: &xr::FrameEndInfo, folder: &Path, name: &str) {
        // SAFETY: the caller vouches for the layers; each has the type that its first member states.
        let views = unsafe {
            let layers = match info.layer_count {
                0 => &[][..],
                count => std::slice::from_raw_parts(info.layers, count as usize),
            };
            let projection =
                layers.iter().find(|layer| (***layer).ty == xr::CompositionLayerProjection::TYPE);
            let Some(projection) = projection else { return };
            let projection = &*projection.cast::<xr::CompositionLayerProjection>();
            std::slice::from_raw_parts(projection.views, projection.view_count as usize)
        };
        for (index, view) in views.iter().enumerate() {
            let image = self.swapchains.get(&view.sub_image.swapchain.into_raw());
            let image = image.and_then(|known| known.images.get(known.released? as usize));
            let (Some(device), Some(image)) = (&self.device, image) else { return };
            // SAFETY: the image was released, so that all work with it was submitted, and no other thread uses the queue now.
            unsafe { device.save(*image, &view.sub_image, &folder.join(format!("{name}-{index}.png"))) };
        }
        let views: Vec<_> = views.iter().map(CapturedView::of).collect();
        let path = folder.join(format!("{name}.json"));
        let written = serde_json::to_string(&views).map_err(std::io::Error::from);
        if let Err(error) = written.and_then(|text| fs::write(&path, text)) {
            panic!("{}: {error}", path.display());
        }
    }
}

impl CapturedView {
    fn of(view: &xr::CompositionLayerProjectionView) -> Self {
        let xr::Fovf { angle_left, angle_right, angle_up, angle_down } = view.fov;
        let xr::Posef { orientation: turned, position } = view.pose;
        Self {
            fov: [angle_left, angle_right, angle_up, angle_down],
            position: [position.x, position.y, position.z],
            orientation: [turned.x, turned.y, turned.z, turned.w],
        }
    }
}
