//! Unknown structures in the chains of arguments: runtimes skip them, and so do layers in between.

use super::stereo::Stereo;
use super::{FRAMES, Outcome};
use crate::app::App;
use crate::failure::name;
use crate::functions::characters;
use crate::session::{Frame, IDENTITY, Layer, Session};
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ffi::c_void;
use std::ptr::{from_ref, null, null_mut};

/// Numbers of structures that no extension has.
const UNKNOWN: i32 = 1_999_000_000;

/// Structures of a chain: a few, many, and more than a runtime follows.
const LENGTHS: [usize; 3] = [3, 60, 400];

/// Longer ones have a cycle in the runtime's eyes.
const FOLLOWED: usize = 60;

/// A structure that begins as all do.
#[repr(C)]
struct Link {
    ty: i32,
    next: *const c_void,
}

/// So many structures of unknown types, each another one, and then `last`. To be kept while the first is used.
fn chain(length: usize, last: *const c_void) -> Vec<Link> {
    let mut links: Vec<Link> = (0..length).map(|at| Link { ty: UNKNOWN + at as i32, next: last }).collect();
    for at in 1..length {
        links[at - 1].next = (&raw const links[at]).cast();
    }
    links
}

/// The calls of an application with chains of each length, among frames as usual.
pub fn unknown_structures(app: &App) -> Outcome {
    for length in LENGTHS {
        let links = chain(length, null());
        let calls = Calls { app, length, next: from_ref(&links[0]).cast() };
        calls.create_session();
        let session = Session::start(app)?;
        let stereo = Stereo::create(&session)?;
        calls.input(&session);
        calls.swapchain(&session);
        session.frames(FRAMES / 2, |frame| {
            calls.locate(&session, frame);
            if length <= FOLLOWED {
                calls.turn(stereo.eyes[0].handle);
            }
            stereo.paint(frame.index)?;
            calls.end_frame(&session, frame);
            session.submit(frame, &[Layer::Projection(stereo.images())])
        })?;
        calls.wait_frame(&session);
        drop(stereo);
    }
    Ok(())
}

/// Calls with a chain, whose results go to the report.
struct Calls<'a> {
    app: &'a App,
    length: usize,
    next: *const c_void,
}

impl Calls<'_> {
    fn told(&self, call: &str, result: xr::Result) -> bool {
        self.app.report().trace.push(format!(
            "{call} with {} unknown structures: {}",
            self.length,
            name(result)
        ));
        result == xr::Result::SUCCESS
    }

    /// A known structure comes last in the chain.
    fn create_session(&self) {
        let binding = self.app.vulkan.binding();
        let links = chain(self.length, from_ref(&binding).cast());
        let info = xr::SessionCreateInfo {
            ty: xr::SessionCreateInfo::TYPE,
            next: from_ref(&links[0]).cast(),
            create_flags: xr::SessionCreateFlags::EMPTY,
            system_id: self.app.xr.system,
        };
        let (functions, mut session) = (&self.app.xr.functions, xr::Session::NULL);
        // SAFETY: the instance and the device of the binding are live; the structures outlive the call.
        let result = unsafe { (functions.create_session)(self.app.xr.instance, &info, &mut session) };
        if self.told("xrCreateSession", result) {
            // SAFETY: the session is live.
            self.told("xrDestroySession", unsafe { (functions.destroy_session)(session) });
        }
    }

    fn input(&self, session: &Session) {
        let functions = &self.app.xr.functions;
        let label = format!("unknown_{}", self.length);
        let label = std::ffi::CString::new(label).unwrap_or_default();
        let info = xr::ActionSetCreateInfo {
            ty: xr::ActionSetCreateInfo::TYPE,
            next: self.next,
            action_set_name: characters(&label),
            localized_action_set_name: characters(&label),
            priority: 0,
        };
        let mut set = xr::ActionSet::NULL;
        // SAFETY: the instance is live; the structures outlive the call.
        let result = unsafe { (functions.create_action_set)(self.app.xr.instance, &info, &mut set) };
        if !self.told("xrCreateActionSet", result) {
            return;
        }
        let info = xr::ActionCreateInfo {
            ty: xr::ActionCreateInfo::TYPE,
            next: self.next,
            action_name: characters(&label),
            action_type: xr::ActionType::BOOLEAN_INPUT,
            count_subaction_paths: 0,
            subaction_paths: null(),
            localized_action_name: characters(&label),
        };
        let mut action = xr::Action::NULL;
        // SAFETY: the set is live; the structures outlive the call.
        self.told("xrCreateAction", unsafe { (functions.create_action)(set, &info, &mut action) });
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: self.next,
            count_action_sets: 1,
            action_sets: &set,
        };
        // SAFETY: the session and the set are live; the structures outlive the call.
        let result = unsafe { (functions.attach_action_sets)(session.handle, &info) };
        self.told("xrAttachSessionActionSets", result);
        let active = xr::ActiveActionSet { action_set: set, subaction_path: xr::Path::NULL };
        let info = xr::ActionsSyncInfo {
            ty: xr::ActionsSyncInfo::TYPE,
            next: self.next,
            count_active_action_sets: 1,
            active_action_sets: &active,
        };
        // SAFETY: as above.
        self.told("xrSyncActions", unsafe { (functions.sync_actions)(session.handle, &info) });
        let info = xr::ReferenceSpaceCreateInfo {
            ty: xr::ReferenceSpaceCreateInfo::TYPE,
            next: self.next,
            reference_space_type: xr::ReferenceSpaceType::VIEW,
            pose_in_reference_space: IDENTITY,
        };
        let mut space = xr::Space::NULL;
        // SAFETY: as above.
        let result = unsafe { (functions.create_reference_space)(session.handle, &info, &mut space) };
        self.told("xrCreateReferenceSpace", result);
    }

    /// A swapchain that is made, and never used.
    fn swapchain(&self, session: &Session) {
        let info = xr::SwapchainCreateInfo {
            ty: xr::SwapchainCreateInfo::TYPE,
            next: self.next,
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: xr::SwapchainUsageFlags::COLOR_ATTACHMENT,
            format: i64::from(ash::vk::Format::R8G8B8A8_SRGB.as_raw()),
            sample_count: 1,
            width: 64,
            height: 64,
            face_count: 1,
            array_size: 1,
            mip_count: 1,
        };
        let (functions, mut swapchain) = (&self.app.xr.functions, xr::Swapchain::NULL);
        // SAFETY: the session is live; the structures outlive the call.
        let result = unsafe { (functions.create_swapchain)(session.handle, &info, &mut swapchain) };
        if self.told("xrCreateSwapchain", result) {
            // SAFETY: the swapchain is live, and nothing uses it.
            self.told("xrDestroySwapchain", unsafe { (functions.destroy_swapchain)(swapchain) });
        }
    }

    /// An image is acquired, waited for and released with nothing drawn to it.
    fn turn(&self, swapchain: xr::Swapchain) {
        let functions = &self.app.xr.functions;
        let info = xr::SwapchainImageAcquireInfo { ty: xr::SwapchainImageAcquireInfo::TYPE, next: self.next };
        let mut index = 0;
        // SAFETY: the swapchain is live; the structures outlive the calls.
        let results = unsafe {
            let acquired = (functions.acquire_image)(swapchain, &info, &mut index);
            let info = xr::SwapchainImageWaitInfo {
                ty: xr::SwapchainImageWaitInfo::TYPE,
                next: self.next,
                timeout: xr::Duration::INFINITE,
            };
            let waited = (functions.wait_image)(swapchain, &info);
            let info =
                xr::SwapchainImageReleaseInfo { ty: xr::SwapchainImageReleaseInfo::TYPE, next: self.next };
            [acquired, waited, (functions.release_image)(swapchain, &info)]
        };
        for (call, result) in ["xrAcquire", "xrWait", "xrRelease"].into_iter().zip(results) {
            self.told(&format!("{call}SwapchainImage"), result);
        }
    }

    fn locate(&self, session: &Session, frame: &Frame) {
        let info = xr::ViewLocateInfo {
            ty: xr::ViewLocateInfo::TYPE,
            next: self.next,
            view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
            display_time: frame.display_time,
            space: session.space,
        };
        let mut state = xr::ViewState::out(null_mut());
        let (mut views, mut count) = ([xr::View::out(null_mut()); 2], 0);
        let locate = self.app.xr.functions.locate_views;
        // SAFETY: the session and the space are live; there is room for as many views as is said.
        let result = unsafe {
            locate(session.handle, &info, state.as_mut_ptr(), 2, &mut count, views.as_mut_ptr().cast())
        };
        self.told("xrLocateViews", result);
    }

    /// A frame cannot be ended with a layer that has no views: the runtime reads the argument, and refuses it.
    fn end_frame(&self, session: &Session, frame: &Frame) {
        let layer = xr::CompositionLayerProjection {
            ty: xr::CompositionLayerProjection::TYPE,
            next: self.next,
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: session.space,
            view_count: 0,
            views: null(),
        };
        let layers: [*const xr::CompositionLayerBaseHeader; 1] = [from_ref(&layer).cast()];
        let info = xr::FrameEndInfo {
            ty: xr::FrameEndInfo::TYPE,
            next: self.next,
            display_time: frame.display_time,
            environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE,
            layer_count: 1,
            layers: layers.as_ptr(),
        };
        // SAFETY: the session is live; the structures outlive the call.
        let result = unsafe { (self.app.xr.functions.end_frame)(session.handle, &info) };
        self.told("xrEndFrame of no views", result);
    }

    /// A frame, or none.
    fn wait_frame(&self, session: &Session) {
        let functions = &self.app.xr.functions;
        let info = xr::FrameWaitInfo { ty: xr::FrameWaitInfo::TYPE, next: self.next };
        let mut state = xr::FrameState::out(null_mut());
        // SAFETY: the session is live; the structures outlive the call.
        let result = unsafe { (functions.wait_frame)(session.handle, &info, state.as_mut_ptr()) };
        if self.told("xrWaitFrame", result) {
            let info = xr::FrameBeginInfo { ty: xr::FrameBeginInfo::TYPE, next: self.next };
            // SAFETY: as above.
            self.told("xrBeginFrame", unsafe { (functions.begin_frame)(session.handle, &info) });
        }
    }
}
