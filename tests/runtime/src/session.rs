//! Sessions: creation on a Vulkan device, and the states a session goes through.

use crate::abi::pointers::{In, Out};
use crate::actions::sync::InputState;
use crate::events::Event;
use crate::fault::{Fault, section};
use crate::frame::FrameLoop;
use crate::record::Line;
use crate::runtime::{Runtime, call};
use crate::system;
use crate::vulkan::Gpu;
use crate::vulkan::render::Renderer;
use openxr_sys as xr;
use openxr_sys::{Handle, SessionState};
use std::sync::Arc;

/// An `XrSession`.
pub(crate) struct Session {
    pub instance: xr::Instance,
    pub state: SessionState,
    /// Between `xrBeginSession` and `xrEndSession`.
    pub running: bool,
    pub frames: FrameLoop,
    pub input: InputState,
    /// Made with the first frame that is composited.
    pub renderer: Option<Renderer>,
    pub gpu: Arc<Gpu>,
}

impl Session {
    /// Fails unless the session is running.
    pub fn check_running(&self) -> Result<(), Fault> {
        if self.running {
            return Ok(());
        }
        let message = format!("the session is not running; its state is {:?}", self.state);
        Err(Fault::new(xr::Result::ERROR_SESSION_NOT_RUNNING, section::SESSION_CONTROL, message))
    }

    /// Whether the application's image is visible.
    pub fn is_visible(&self) -> bool {
        matches!(self.state, SessionState::VISIBLE | SessionState::FOCUSED)
    }
}

impl Runtime {
    /// Brings a session into another state, with an event of its instance.
    pub fn enter(&mut self, handle: xr::Session, state: SessionState) -> Result<(), Fault> {
        let time = self.now();
        let session = self.sessions.get_mut(handle)?;
        session.state = state;
        let events = &mut self.instances.get_mut(session.instance)?.events;
        events.push_back(Event::SessionState { session: handle, state, time });
        let line = Line::SessionState { session: handle.into_raw(), state: format!("{state:?}") };
        self.recorder.line(&line);
        Ok(())
    }

    /// Takes a running session, state by state, from its current state to STOPPING.
    pub fn stop(&mut self, handle: xr::Session) -> Result<(), Fault> {
        let order = [SessionState::VISIBLE, SessionState::SYNCHRONIZED, SessionState::STOPPING];
        let reached = match self.sessions.get(handle)?.state {
            SessionState::FOCUSED => 0,
            SessionState::VISIBLE => 1,
            SessionState::STOPPING => 3,
            _ => 2,
        };
        order[reached..].iter().try_for_each(|&state| self.enter(handle, state))
    }
}

/// `xrCreateSession`.
pub(crate) extern "system" fn create(
    instance: xr::Instance,
    info: In<xr::SessionCreateInfo>,
    session: Out<xr::Session>,
) -> xr::Result {
    call("xrCreateSession", |runtime| {
        let info = runtime.read(&info)?;
        system::check(runtime, instance, info.system_id)?;
        let owner = runtime.instances.get(instance)?;
        let enabled = owner.has("XR_KHR_vulkan_enable") || owner.has("XR_KHR_vulkan_enable2");
        let binding = info.extension::<xr::GraphicsBindingVulkanKHR>().filter(|_| enabled);
        let binding = binding.ok_or_else(|| {
            let message = "no XrGraphicsBindingVulkanKHR is chained, or no Vulkan extension is enabled";
            Fault::new(xr::Result::ERROR_GRAPHICS_DEVICE_INVALID, section::SESSION_CREATION, message)
        })?;
        let gpu = Arc::new(owner.vulkan.bind(&binding, &runtime.scenario.vulkan.device)?);
        let created = Session {
            instance,
            state: SessionState::UNKNOWN,
            running: false,
            frames: FrameLoop::default(),
            input: InputState::default(),
            renderer: None,
            gpu,
        };
        let handle = runtime.sessions.insert(&mut runtime.serial, created);
        session.set("session", handle)?;
        runtime.enter(handle, SessionState::IDLE)?;
        runtime.enter(handle, SessionState::READY)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrDestroySession`, with all that belongs to it.
pub(crate) extern "system" fn destroy(session: xr::Session) -> xr::Result {
    call("xrDestroySession", |runtime| {
        remove(runtime, session)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// Destroys a session.
pub(crate) fn remove(runtime: &mut Runtime, handle: xr::Session) -> Result<(), Fault> {
    runtime.swapchains.retain(|swapchain| swapchain.session != handle);
    runtime.spaces.retain(|space| space.session != handle);
    let session = runtime.sessions.remove(handle)?;
    // Missing where the whole instance is being destroyed.
    if let Ok(instance) = runtime.instances.get_mut(session.instance) {
        instance.events.retain(|event| event.session() != handle);
    }
    Ok(())
}

/// `xrBeginSession`.
pub(crate) extern "system" fn begin(session: xr::Session, info: In<xr::SessionBeginInfo>) -> xr::Result {
    call("xrBeginSession", |runtime| {
        let info = runtime.read(&info)?;
        let session = runtime.sessions.get_mut(session)?;
        system::check_view_configuration(info.primary_view_configuration_type)?;
        if session.running {
            let message = "the session is already running";
            return Err(Fault::new(xr::Result::ERROR_SESSION_RUNNING, section::SESSION_CONTROL, message));
        }
        if session.state != SessionState::READY {
            let message = format!("the session's state is {:?}, not READY", session.state);
            return Err(Fault::new(xr::Result::ERROR_SESSION_NOT_READY, section::SESSION_CONTROL, message));
        }
        session.running = true;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrEndSession`.
pub(crate) extern "system" fn end(session: xr::Session) -> xr::Result {
    call("xrEndSession", |runtime| {
        let ended = runtime.sessions.get_mut(session)?;
        ended.check_running()?;
        if ended.state != SessionState::STOPPING {
            let message = format!("the session's state is {:?}, not STOPPING", ended.state);
            return Err(Fault::new(
                xr::Result::ERROR_SESSION_NOT_STOPPING,
                section::SESSION_CONTROL,
                message,
            ));
        }
        ended.running = false;
        // Nothing brings this headset back into use: the session ends for good.
        runtime.enter(session, SessionState::IDLE)?;
        runtime.enter(session, SessionState::EXITING)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrRequestExitSession`.
pub(crate) extern "system" fn request_exit(session: xr::Session) -> xr::Result {
    call("xrRequestExitSession", |runtime| {
        runtime.sessions.get(session)?.check_running()?;
        runtime.stop(session)?;
        Ok(xr::Result::SUCCESS)
    })
}
