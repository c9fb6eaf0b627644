//! Sessions, and the events of their states.

use super::{Session, World};
use crate::session::calls;
use openxr_sys as xr;
use openxr_sys::Handle;
use std::ptr::{from_ref, null_mut};

impl World<'_> {
    pub(super) fn create_session(&mut self) {
        if !self.sessions.is_empty() {
            return;
        }
        let (result, handle) = calls::create_session(self.app);
        if !self.told("xrCreateSession", result) {
            return;
        }
        let (result, space) = calls::create_local_space(self.app, handle);
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

    pub(super) fn begin_session(&mut self) {
        let Some(at) = self.session() else { return };
        let is_legal = !self.sessions[at].is_running && self.sessions[at].state == xr::SessionState::READY;
        if !is_legal && !self.dares() {
            return;
        }
        let handle = self.handle(self.sessions[at].handle);
        let result = calls::begin_session(self.app, handle);
        if self.told("xrBeginSession", result) {
            self.sessions[at].is_running = true;
        }
    }

    /// Ends a session a step further.
    pub(super) fn end_session(&mut self) {
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

    pub(super) fn destroy_session(&mut self, handle: xr::Session) {
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

    pub(super) fn poll(&mut self) {
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
            // SAFETY: the type identifies the structure at the start of the buffer; the buffer is larger and equally aligned.
            let changed = unsafe { *from_ref(&event).cast::<xr::EventDataSessionStateChanged>() };
            self.trace.push(format!("state {:?}", changed.state));
            for session in self.sessions.iter_mut().filter(|session| session.handle == changed.session) {
                session.state = changed.state;
            }
        }
    }
}
