//! A session from its creation to its end, and its frame loop.

pub mod calls;
mod events;
mod submit;

use crate::app::App;
use crate::failure::{Failure, succeeded};
use openxr_sys as xr;
use std::cell::Cell;
use std::ptr::{null, null_mut};

pub use submit::{Layer, SubImage};

/// Frames after which a runtime that was asked for a state change has had its chance.
const PATIENCE: u32 = 200;

/// A running or stopped session.
pub struct Session<'a> {
    pub app: &'a App,
    pub handle: xr::Session,
    /// The LOCAL reference space, which views and quads are placed in.
    pub space: xr::Space,
    state: Cell<xr::SessionState>,
    running: Cell<bool>,
}

/// A frame between xrBeginFrame and xrEndFrame.
pub struct Frame {
    /// Number of the frame in its loop, from 0.
    pub index: u32,
    pub display_time: xr::Time,
    pub should_render: bool,
    pub views: [xr::View; 2],
}

impl<'a> Session<'a> {
    /// Creates a session, not yet begun.
    pub fn create(app: &'a App) -> Result<Self, Failure> {
        let (result, handle) = calls::create_session(app);
        succeeded("xrCreateSession", result)?;
        let (result, space) = calls::create_local_space(app, handle);
        succeeded("xrCreateReferenceSpace", result)?;
        Ok(Self {
            app,
            handle,
            space,
            state: Cell::new(xr::SessionState::UNKNOWN),
            running: Cell::new(false),
        })
    }

    /// Creates a session and begins it.
    pub fn start(app: &'a App) -> Result<Self, Failure> {
        let session = Self::create(app)?;
        session.begin()?;
        Ok(session)
    }

    /// Waits for READY and begins.
    pub fn begin(&self) -> Result<(), Failure> {
        for _ in 0..PATIENCE {
            self.poll()?;
            if self.state.get() == xr::SessionState::READY {
                succeeded("xrBeginSession", calls::begin_session(self.app, self.handle))?;
                self.running.set(true);
                return Ok(());
            }
        }
        Err(Failure::Unsupported("the session never became READY".to_owned()))
    }

    /// Runs frames: `body` gets each between xrBeginFrame and xrEndFrame, and ends it.
    pub fn frames(
        &self,
        count: u32,
        mut body: impl FnMut(&Frame) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for index in 0..count {
            self.poll()?;
            body(&self.next_frame(index)?)?;
        }
        Ok(())
    }

    /// Asks for the end, follows the states to EXITING, and destroys the session.
    pub fn finish(self) -> Result<(), Failure> {
        // SAFETY: the session is live.
        let result = unsafe { (self.app.xr.functions.request_exit_session)(self.handle) };
        succeeded("xrRequestExitSession", result)?;
        for index in 0..PATIENCE {
            self.poll()?;
            match self.state.get() {
                xr::SessionState::EXITING => return Ok(()),
                xr::SessionState::STOPPING if self.running.get() => {
                    self.running.set(false);
                    // SAFETY: the session is live.
                    let result = unsafe { (self.app.xr.functions.end_session)(self.handle) };
                    succeeded("xrEndSession", result)?;
                }
                _ if self.running.get() => {
                    let frame = self.next_frame(index)?;
                    self.submit(&frame, &[])?;
                }
                _ => {}
            }
        }
        Err(Failure::Unsupported("the session never reached EXITING".to_owned()))
    }

    fn next_frame(&self, index: u32) -> Result<Frame, Failure> {
        let functions = &self.app.xr.functions;
        let mut state = xr::FrameState::out(null_mut());
        // SAFETY: the session is live, null stands for no wait info, the output outlives the call.
        let result = unsafe { (functions.wait_frame)(self.handle, null(), state.as_mut_ptr()) };
        succeeded("xrWaitFrame", result)?;
        // SAFETY: the call succeeded, so it filled the structure.
        let state = unsafe { state.assume_init() };
        // SAFETY: the session is live and null stands for no begin info.
        let result = unsafe { (functions.begin_frame)(self.handle, null()) };
        succeeded("xrBeginFrame", result)?;
        Ok(Frame {
            index,
            display_time: state.predicted_display_time,
            should_render: state.should_render.into(),
            views: self.locate(state.predicted_display_time)?,
        })
    }

    fn locate(&self, display_time: xr::Time) -> Result<[xr::View; 2], Failure> {
        self.locator()(display_time)
    }

    /// Locates the views for a display time, on any thread during the session.
    pub fn locator(&self) -> impl Fn(xr::Time) -> Result<[xr::View; 2], Failure> + Send + use<> {
        let (session, space, locate_views) = (self.handle, self.space, self.app.xr.functions.locate_views);
        move |display_time| {
            let info = xr::ViewLocateInfo {
                ty: xr::ViewLocateInfo::TYPE,
                next: null(),
                view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
                display_time,
                space,
            };
            let mut state = xr::ViewState::out(null_mut());
            let mut views =
                [xr::View { ty: xr::View::TYPE, next: null_mut(), pose: IDENTITY, fov: xr::Fovf::default() };
                    2];
            let mut count = 0;
            // SAFETY: the session and the space are live, the array has the capacity that is passed.
            let result = unsafe {
                locate_views(session, &info, state.as_mut_ptr(), 2, &mut count, views.as_mut_ptr())
            };
            succeeded("xrLocateViews", result)?;
            Ok(views)
        }
    }
}

impl Drop for Session<'_> {
    fn drop(&mut self) {
        self.app.vulkan.wait_idle();
        // SAFETY: the session is live; swapchains borrow it, so they are gone.
        unsafe { (self.app.xr.functions.destroy_session)(self.handle) };
    }
}

/// No rotation, no translation.
pub const IDENTITY: xr::Posef = xr::Posef {
    orientation: xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 1.0 },
    position: xr::Vector3f { x: 0.0, y: 0.0, z: 0.0 },
};
