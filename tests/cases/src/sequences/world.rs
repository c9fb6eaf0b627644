//! What exists in a sequence, and the calls that can be made next.

use super::{Manner, Numbers};
use crate::app::App;
use crate::failure::name;
use crate::session::IDENTITY;
use ash::vk;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::c_void;
use std::ptr::{from_ref, null, null_mut};

/// Calls of a sequence.
const STEPS: usize = 40;

/// Images that may be acquired at a time: as many as the runtime has.
const IMAGES: usize = 3;

/// The longest chain of unknown structures: longer ones are circles in the runtime's eyes.
const LONGEST_CHAIN: usize = 64;

/// Numbers of structures that no extension has.
const UNKNOWN_TYPE: i32 = 1_999_000_000;

struct Session {
    handle: xr::Session,
    space: xr::Space,
    state: xr::SessionState,
    is_running: bool,
    waited: Option<xr::Time>,
    begun: Option<xr::Time>,
}

struct Swapchain {
    handle: xr::Swapchain,
    session: xr::Session,
    size: [u32; 2],
    is_color: bool,
    acquired: usize,
    is_waited: bool,
    is_released: bool,
    is_static: bool,
}

/// A sequence under way.
pub struct World<'a> {
    app: &'a App,
    numbers: Numbers,
    manner: Manner,
    sessions: Vec<Session>,
    swapchains: Vec<Swapchain>,
    /// Handles that were destroyed.
    gone: Vec<u64>,
    trace: Vec<String>,
}

/// A structure of an unknown type.
#[repr(C)]
struct Unknown {
    ty: i32,
    next: *const c_void,
}

impl<'a> World<'a> {
    pub fn new(app: &'a App, numbers: Numbers, manner: Manner) -> Self {
        let (sessions, swapchains) = (Vec::new(), Vec::new());
        Self { app, numbers, manner, sessions, swapchains, gone: Vec::new(), trace: Vec::new() }
    }

    /// Makes the calls.
    pub fn run(&mut self) {
        for _ in 0..STEPS {
            match self.numbers.below(16) {
                0 => self.create_session(),
                1 => self.begin_session(),
                2 => self.create_swapchain(),
                3 => self.destroy_swapchain(),
                4 => self.end_session(),
                5 | 6 => self.frame_step(),
                7 => self.locate_views(),
                8 => self.enumerate_images(),
                9 | 10 => self.acquire(),
                11 => self.wait_image(),
                12 => self.release(),
                13 => self.end_frame(),
                14 => self.poll(),
                _ => self.whole_frame(),
            }
        }
    }

    /// Destroys what is left; what each call returned.
    pub fn end(mut self) -> Vec<String> {
        while let Some(session) = self.sessions.pop() {
            self.destroy_session(session.handle);
        }
        self.poll();
        self.trace
    }

    fn is_hostile(&self) -> bool {
        self.manner == Manner::Hostile
    }

    /// Whether a call that is illegal now is made all the same.
    fn dares(&mut self) -> bool {
        self.is_hostile() && self.numbers.once_in(3)
    }

    fn told(&mut self, call: &str, result: xr::Result) -> bool {
        self.trace.push(format!("{call}: {}", name(result)));
        result.into_raw() >= 0
    }

    /// A handle, or in a hostile sequence perhaps another one.
    fn handle<H: Handle>(&mut self, handle: H) -> H {
        if !self.is_hostile() || !self.numbers.once_in(6) {
            return handle;
        }
        let others = [0, 0xdead_beef, u64::MAX, self.sessions.first().map_or(7, |one| one.handle.into_raw())];
        let gone = self.gone.get(self.numbers.below(self.gone.len())).copied();
        let other = others[self.numbers.below(others.len())];
        H::from_raw(if self.numbers.once_in(2) { gone.unwrap_or(other) } else { other })
    }

    /// A chain that nobody knows, kept alive by what is returned beside.
    fn chain(&mut self) -> (Vec<Unknown>, *const c_void) {
        let length = match self.numbers.below(4) {
            0 if self.is_hostile() => self.numbers.below(LONGEST_CHAIN),
            1 => self.numbers.below(3),
            _ => 0,
        };
        let mut chain: Vec<Unknown> =
            (0..length).map(|at| Unknown { ty: UNKNOWN_TYPE + at as i32, next: null() }).collect();
        for at in 1..length {
            chain[at - 1].next = (&raw const chain[at]).cast();
        }
        let first = if length == 0 { null() } else { chain.as_ptr().cast() };
        (chain, first)
    }

    fn session(&mut self) -> Option<usize> {
        let count = self.sessions.len();
        (count > 0).then(|| self.numbers.below(count))
    }

    fn swapchain(&mut self) -> Option<usize> {
        let count = self.swapchains.len();
        (count > 0).then(|| self.numbers.below(count))
    }

    fn create_session(&mut self) {
        if !self.sessions.is_empty() {
            return;
        }
        let app = self.app;
        let binding = app.vulkan.binding();
        let info = xr::SessionCreateInfo {
            ty: xr::SessionCreateInfo::TYPE,
            next: from_ref(&binding).cast(),
            create_flags: xr::SessionCreateFlags::EMPTY,
            system_id: app.xr.system,
        };
        let mut handle = xr::Session::NULL;
        // SAFETY: the instance and the device of the binding are live; the structures outlive the call.
        let result = unsafe { (app.xr.functions.create_session)(app.xr.instance, &info, &mut handle) };
        if !self.told("xrCreateSession", result) {
            return;
        }
        let info = xr::ReferenceSpaceCreateInfo {
            ty: xr::ReferenceSpaceCreateInfo::TYPE,
            next: null(),
            reference_space_type: xr::ReferenceSpaceType::LOCAL,
            pose_in_reference_space: IDENTITY,
        };
        let mut space = xr::Space::NULL;
        // SAFETY: the session is live; the structures outlive the call.
        let result = unsafe { (app.xr.functions.create_reference_space)(handle, &info, &mut space) };
        self.told("xrCreateReferenceSpace", result);
        self.sessions.push(Session {
            handle,
            space,
            state: xr::SessionState::UNKNOWN,
            is_running: false,
            waited: None,
            begun: None,
        });
        self.poll();
    }

    fn begin_session(&mut self) {
        let Some(at) = self.session() else { return };
        let is_legal = !self.sessions[at].is_running && self.sessions[at].state == xr::SessionState::READY;
        if !is_legal && !self.dares() {
            return;
        }
        let handle = self.handle(self.sessions[at].handle);
        let info = xr::SessionBeginInfo {
            ty: xr::SessionBeginInfo::TYPE,
            next: null(),
            primary_view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        };
        // SAFETY: the structure outlives the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.begin_session)(handle, &info) };
        if self.told("xrBeginSession", result) {
            self.sessions[at].is_running = true;
        }
    }

    /// Ends a session a step further.
    fn end_session(&mut self) {
        let Some(at) = self.session() else { return };
        let Session { handle, state, is_running, .. } = self.sessions[at];
        let functions = &self.app.xr.functions;
        if is_running && state == xr::SessionState::STOPPING {
            // SAFETY: the session is live.
            let result = unsafe { (functions.end_session)(handle) };
            self.told("xrEndSession", result);
            self.sessions[at].is_running = false;
        } else if is_running && self.numbers.once_in(4) {
            let handle = self.handle(handle);
            // SAFETY: a handle may be invalid on purpose.
            let result = unsafe { (functions.request_exit_session)(handle) };
            self.told("xrRequestExitSession", result);
        } else if self.numbers.once_in(8) {
            self.destroy_session(handle);
        }
        self.poll();
    }

    fn destroy_session(&mut self, handle: xr::Session) {
        self.app.vulkan.wait_idle();
        // SAFETY: the session is live.
        let result = unsafe { (self.app.xr.functions.destroy_session)(handle) };
        self.told("xrDestroySession", result);
        self.sessions.retain(|session| session.handle != handle);
        self.gone.push(handle.into_raw());
        let of_it = self.swapchains.iter().filter(|swapchain| swapchain.session == handle);
        self.gone.extend(of_it.map(|swapchain| swapchain.handle.into_raw()));
        self.swapchains.retain(|swapchain| swapchain.session != handle);
    }

    fn create_swapchain(&mut self) {
        const COLORS: [vk::Format; 3] =
            [vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM, vk::Format::R16G16B16A16_SFLOAT];
        let Some(at) = self.session() else { return };
        if self.swapchains.len() >= 4 {
            return;
        }
        let session = self.handle(self.sessions[at].handle);
        let is_color = !self.numbers.once_in(6);
        let is_static = self.numbers.once_in(8);
        let size = [16 + 8 * self.numbers.below(4) as u32, 16 + 8 * self.numbers.below(4) as u32];
        let format = if is_color { COLORS[self.numbers.below(3)] } else { vk::Format::D32_SFLOAT };
        let is_odd = self.is_hostile() && self.numbers.once_in(5);
        let attachment = if is_color {
            xr::SwapchainUsageFlags::COLOR_ATTACHMENT
        } else {
            xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT
        };
        let (_chain, next) = self.chain();
        let info = xr::SwapchainCreateInfo {
            ty: xr::SwapchainCreateInfo::TYPE,
            next,
            create_flags: if is_static {
                xr::SwapchainCreateFlags::STATIC_IMAGE
            } else {
                xr::SwapchainCreateFlags::EMPTY
            },
            usage_flags: attachment | xr::SwapchainUsageFlags::SAMPLED,
            format: if is_odd { -7 } else { i64::from(format.as_raw()) },
            sample_count: if is_odd && self.numbers.once_in(2) { 3 } else { 1 },
            width: if is_odd && self.numbers.once_in(2) { 0 } else { size[0] },
            height: size[1],
            face_count: 1,
            array_size: if self.numbers.once_in(4) { 2 } else { 1 },
            mip_count: if self.numbers.once_in(8) { 2 } else { 1 },
        };
        let mut handle = xr::Swapchain::NULL;
        // SAFETY: the structures outlive the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.create_swapchain)(session, &info, &mut handle) };
        if self.told("xrCreateSwapchain", result) {
            self.swapchains.push(Swapchain {
                handle,
                session,
                size,
                is_color,
                acquired: 0,
                is_waited: false,
                is_released: false,
                is_static,
            });
        }
    }

    fn destroy_swapchain(&mut self) {
        if !self.numbers.once_in(3) {
            return;
        }
        let Some(at) = self.swapchain() else { return };
        self.app.vulkan.wait_idle();
        let handle = self.handle(self.swapchains[at].handle);
        // SAFETY: nothing of ours uses its images; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.destroy_swapchain)(handle) };
        self.told("xrDestroySwapchain", result);
        self.gone.push(handle.into_raw());
        self.swapchains.retain(|swapchain| swapchain.handle != handle);
    }

    fn enumerate_images(&mut self) {
        let Some(at) = self.swapchain() else { return };
        let handle = self.handle(self.swapchains[at].handle);
        let capacity = if self.dares() { self.numbers.below(5) } else { [0, 8][self.numbers.below(2)] };
        let empty =
            xr::SwapchainImageVulkanKHR { ty: xr::SwapchainImageVulkanKHR::TYPE, next: null_mut(), image: 0 };
        let mut images = vec![empty; capacity];
        let mut count = 77;
        let first = if capacity == 0 { null_mut() } else { images.as_mut_ptr().cast() };
        let enumerate = self.app.xr.functions.enumerate_images;
        // SAFETY: there is room for as many images as is said; a handle may be invalid on purpose.
        let result = unsafe { enumerate(handle, capacity as u32, &mut count, first) };
        let filled = images.iter().filter(|image| image.image != 0).count();
        self.told(&format!("xrEnumerateSwapchainImages {capacity} {count} {filled}"), result);
    }

    fn acquire(&mut self) {
        let Some(at) = self.swapchain() else { return };
        let Swapchain { acquired, is_static, is_released, .. } = self.swapchains[at];
        let most = if is_static { usize::from(!is_released) } else { IMAGES };
        if acquired >= most && !self.dares() {
            return;
        }
        let handle = self.handle(self.swapchains[at].handle);
        let mut index = 77;
        // SAFETY: null stands for no info, the output outlives the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.acquire_image)(handle, null(), &mut index) };
        if self.told("xrAcquireSwapchainImage", result) {
            self.trace.push(format!("image {index}"));
            self.swapchains[at].acquired += 1;
        }
    }

    fn wait_image(&mut self) {
        let Some(at) = self.swapchain() else { return };
        let is_legal = self.swapchains[at].acquired > 0 && !self.swapchains[at].is_waited;
        if !is_legal && !self.dares() {
            return;
        }
        let handle = self.handle(self.swapchains[at].handle);
        let (_chain, next) = self.chain();
        let info = xr::SwapchainImageWaitInfo {
            ty: xr::SwapchainImageWaitInfo::TYPE,
            next,
            timeout: xr::Duration::INFINITE,
        };
        // SAFETY: the structures outlive the call; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.wait_image)(handle, &info) };
        if self.told("xrWaitSwapchainImage", result) {
            self.swapchains[at].is_waited = true;
        }
    }

    fn release(&mut self) {
        let Some(at) = self.swapchain() else { return };
        if !self.swapchains[at].is_waited && !self.dares() {
            return;
        }
        let handle = self.handle(self.swapchains[at].handle);
        // SAFETY: null stands for no info; a handle may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.release_image)(handle, null()) };
        if self.told("xrReleaseSwapchainImage", result) {
            let swapchain = &mut self.swapchains[at];
            (swapchain.is_waited, swapchain.is_released) = (false, true);
            swapchain.acquired = swapchain.acquired.saturating_sub(1);
        }
    }

    /// Waits for a frame, or begins the one that was waited for.
    fn frame_step(&mut self) {
        let Some(at) = self.session() else { return };
        let Session { is_running, waited, begun, .. } = self.sessions[at];
        let functions = &self.app.xr.functions;
        if let Some(time) = waited {
            if begun.is_some() && !self.numbers.once_in(4) {
                return;
            }
            let handle = self.handle(self.sessions[at].handle);
            // SAFETY: null stands for no info; a handle may be invalid on purpose.
            let result = unsafe { (functions.begin_frame)(handle, null()) };
            if self.told("xrBeginFrame", result) {
                self.sessions[at].waited = None;
                self.sessions[at].begun = Some(time);
            }
        } else if is_running || self.dares() {
            let (_chain, next) = self.chain();
            let info = xr::FrameWaitInfo { ty: xr::FrameWaitInfo::TYPE, next };
            let mut state = xr::FrameState::out(null_mut());
            // SAFETY: the session is live; the structures outlive the call.
            let result =
                unsafe { (functions.wait_frame)(self.sessions[at].handle, &info, state.as_mut_ptr()) };
            if self.told("xrWaitFrame", result) {
                // SAFETY: the call succeeded, so it filled the structure.
                let state = unsafe { state.assume_init() };
                self.trace.push(format!("renders {:?}", state.should_render));
                self.sessions[at].waited = Some(state.predicted_display_time);
            }
        }
    }

    fn locate_views(&mut self) {
        let Some(at) = self.session() else { return };
        let Some(time) = self.sessions[at].begun.or(self.sessions[at].waited) else { return };
        let handle = self.handle(self.sessions[at].handle);
        let space = self.handle(self.sessions[at].space);
        let (_chain, next) = self.chain();
        let info = xr::ViewLocateInfo {
            ty: xr::ViewLocateInfo::TYPE,
            next,
            view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
            display_time: if self.dares() { xr::Time::from_nanos(-1) } else { time },
            space,
        };
        let mut state = xr::ViewState::out(null_mut());
        let mut views = [xr::View::out(null_mut()); 2];
        let mut count = 77;
        let capacity = if self.dares() { self.numbers.below(2) as u32 } else { 2 };
        let locate = self.app.xr.functions.locate_views;
        // SAFETY: there is room for as many views as is said; a handle may be invalid on purpose.
        let result = unsafe {
            locate(handle, &info, state.as_mut_ptr(), capacity, &mut count, views.as_mut_ptr().cast())
        };
        self.told(&format!("xrLocateViews {count}"), result);
    }

    fn end_frame(&mut self) {
        let Some(at) = self.session() else { return };
        let Session { handle, space, begun, .. } = self.sessions[at];
        if begun.is_none() && !self.dares() {
            return;
        }
        let time = begun.unwrap_or(xr::Time::from_nanos(5));
        let of_session = |swapchain: &&Swapchain| swapchain.session == handle && swapchain.is_color;
        let shown: Vec<usize> = (0..self.swapchains.len())
            .filter(|&index| of_session(&&self.swapchains[index]) && self.swapchains[index].is_released)
            .collect();
        let shown =
            if shown.is_empty() && self.dares() { (0..self.swapchains.len()).collect() } else { shown };
        let eyes: Vec<usize> =
            (0..2).filter_map(|_| shown.get(self.numbers.below(shown.len())).copied()).collect();
        let views: Vec<xr::CompositionLayerProjectionView> =
            eyes.iter().map(|&index| self.view(index)).collect();
        let layer = xr::CompositionLayerProjection {
            ty: xr::CompositionLayerProjection::TYPE,
            next: null(),
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: self.handle(space),
            view_count: views.len() as u32,
            views: views.as_ptr(),
        };
        let layers: [*const xr::CompositionLayerBaseHeader; 1] = [from_ref(&layer).cast()];
        let (_chain, next) = self.chain();
        let info = xr::FrameEndInfo {
            ty: xr::FrameEndInfo::TYPE,
            next,
            display_time: time,
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: u32::from(views.len() == 2),
            layers: layers.as_ptr(),
        };
        let handle = self.handle(handle);
        // SAFETY: the structures outlive the call; handles may be invalid on purpose.
        let result = unsafe { (self.app.xr.functions.end_frame)(handle, &info) };
        if self.told(&format!("xrEndFrame {}", info.layer_count), result) {
            self.sessions[at].begun = None;
        }
        self.poll();
    }

    fn view(&mut self, index: usize) -> xr::CompositionLayerProjectionView {
        let Swapchain { handle, size, .. } = self.swapchains[index];
        let edge = 0.7;
        let is_odd = self.is_hostile() && self.numbers.once_in(8);
        let width = if is_odd { i32::MAX } else { size[0] as i32 };
        xr::CompositionLayerProjectionView {
            ty: xr::CompositionLayerProjectionView::TYPE,
            next: null(),
            pose: IDENTITY,
            fov: xr::Fovf {
                angle_left: if is_odd { f32::NAN } else { -edge },
                angle_right: edge,
                angle_up: edge,
                angle_down: -edge,
            },
            sub_image: xr::SwapchainSubImage {
                swapchain: self.handle(handle),
                image_rect: xr::Rect2Di {
                    offset: xr::Offset2Di { x: if is_odd { -5 } else { 0 }, y: 0 },
                    extent: xr::Extent2Di { width, height: size[1] as i32 },
                },
                image_array_index: if is_odd { 9 } else { 0 },
            },
        }
    }

    /// What an application does in a frame, so that sequences get somewhere.
    fn whole_frame(&mut self) {
        self.begin_session();
        self.frame_step();
        self.frame_step();
        self.acquire();
        self.wait_image();
        self.release();
        self.locate_views();
        self.end_frame();
    }

    fn poll(&mut self) {
        loop {
            let mut event =
                xr::EventDataBuffer { ty: xr::EventDataBuffer::TYPE, next: null_mut(), varying: [0; 4000] };
            let app = self.app;
            // SAFETY: the instance is live and the output outlives the call.
            let result = unsafe { (app.xr.functions.poll_event)(app.xr.instance, &mut event) };
            if result != xr::Result::SUCCESS {
                return;
            }
            if event.ty != xr::EventDataSessionStateChanged::TYPE {
                self.trace.push(format!("event {:?}", event.ty));
                continue;
            }
            // SAFETY: the type says which structure the buffer begins with; the buffer is larger and as aligned.
            let changed = unsafe { *from_ref(&event).cast::<xr::EventDataSessionStateChanged>() };
            self.trace.push(format!("state {:?}", changed.state));
            for session in self.sessions.iter_mut().filter(|session| session.handle == changed.session) {
                session.state = changed.state;
            }
        }
    }
}
