//! Sessions: creation, tracking, destruction.

mod active;
mod shared;

pub use active::{Active, Health, Tools};

use super::actions::{Headset, SessionActions};
use super::dispatch::Next;
use super::gaze::SessionGaze;
use super::instance::{self, Instance, next_of_any};
use super::offer::{self, SessionOffer};
use super::spaces::{self, LocatedHead, Spaces};
use super::structures::{VulkanBinding, extending};
use super::swapchain::{self, Swapchain};
use super::vulkan_device::{RuntimeSection, VulkanDevice};
use crate::abi::{attempt, executable, guard};
use crate::config::{ChromaMode, Config, Environment, GazeSource, debug_view, wants_contrast, wants_reuse};
use crate::inputs::gaze::correction::{CorrectionRequests, SessionGazeCorrection};
use crate::link::BACKEND_NONE;
use crate::registry::Registry;
use crate::status::StatusReporter;
use openxr_sys as xr;
use parafovea_manifest::status::Status;
use std::sync::Arc;
use std::time::Instant;

/// A session of an instance that is not inert.
pub struct Session {
    /// Its handle.
    pub handle: xr::Session,
    /// Its instance.
    pub instance: Arc<Instance>,
    /// Its headset.
    pub system: xr::SystemId,
    /// The state of work on its device; `None` for an inert session.
    pub active: Option<Active>,
    /// Spaces of ours, if it is active or gives the gaze to the application, and they could be made.
    pub spaces: Option<Spaces>,
    /// Orientation of the head, by its located views.
    pub head: LocatedHead,
    /// State of its actions and ours.
    pub actions: SessionActions,
    /// Source of its gaze.
    pub gaze: SessionGaze,
    /// Actions of the application that get that gaze; `None` if the runtime gives its own, or the application asks for none.
    pub offer: Option<SessionOffer>,
    /// Reports the session to `parafovea status`; `None` if there is no place for its file.
    pub reporter: Option<StatusReporter>,
}

impl Session {
    /// Whether the configuration could give `compose` work: only then are swapchains substituted.
    pub fn may_have_work(&self, config: &Config) -> bool {
        let has_gaze = || self.gaze.may_have_gaze(self, config);
        let may_attenuate = config.enabled && config.chroma.mode != ChromaMode::Off && has_gaze();
        let is_healthy = self.active.as_ref().is_some_and(|active| active.health() == Health::Works);
        let is_shown = debug_view(config).is_some();
        is_healthy && (may_attenuate || is_shown || self.may_reuse(config))
    }

    /// Whether images cannot be used in the call that returns them: draws to them may be submitted later.
    pub fn submits_late(&self) -> bool {
        self.active.as_ref().is_some_and(|active| active.device.submits_late())
    }

    /// Whether pictures could be completed from earlier ones: the configuration asks for it, and the device's backend can leave
    /// something out.
    pub fn may_reuse(&self, config: &Config) -> bool {
        wants_reuse(config) && self.has_backend()
    }

    /// Whether the contrast of pictures could decide rates: the configuration asks for it, and the device has a backend.
    pub fn may_judge(&self, config: &Config) -> bool {
        let on_cpu = self.active.as_ref().is_some_and(|active| active.device.is_cpu());
        wants_contrast(config, on_cpu) && self.has_backend()
    }

    /// Whether passes on the device can be made coarser.
    pub fn has_backend(&self) -> bool {
        self.active.as_ref().is_some_and(|active| active.device.capabilities.backend != BACKEND_NONE)
    }

    /// Whether the current frame is ignored.
    pub fn is_asleep(&self) -> bool {
        self.active.as_ref().is_some_and(|active| active.plan.sleep.is_asleep())
    }

    /// Whether a frame that ends is ignored.
    pub fn sleeps_through(&self) -> bool {
        let is_asked = || self.reporter.as_ref().is_some_and(StatusReporter::is_asked);
        self.active.as_ref().is_some_and(|active| active.plan.sleep.frame_ends(is_asked()))
    }

    /// Marks submits of this thread as the runtime's, while it is in a call down.
    pub fn runtime_section(&self) -> Option<RuntimeSection> {
        Some(self.active.as_ref()?.device.runtime_section())
    }
}

static SESSIONS: Registry<xr::Session, Session> = Registry::new();

/// The session of that handle.
pub fn find(handle: xr::Session) -> Option<Arc<Session>> {
    SESSIONS.get(handle)
}

/// The session of that handle, if it is known, and the functions below; `None` without any instance.
pub fn find_with_next(handle: xr::Session) -> Option<(Option<Arc<Session>>, Next)> {
    let known = find(handle);
    let next = known.as_ref().map(|known| known.instance.next).or_else(next_of_any)?;
    Some((known, next))
}

/// A session of that instance whose application is owed an event about interaction profiles, which it gets now.
pub fn owed_event(instance: xr::Instance) -> Option<xr::Session> {
    let owes = |session: &Session| {
        let owes_for_gaze = || session.offer.as_ref().is_some_and(SessionOffer::take_owed);
        session.instance.handle == instance && (session.actions.profiles.take_owed() || owes_for_gaze())
    };
    SESSIONS.find_map(|session| owes(session).then_some(session.handle))
}

/// Forgets the sessions of an instance, before it is destroyed: they go with it. Our images go with the result, see
/// [`swapchain::forget_all_of`].
pub fn forget_all_of(instance: xr::Instance) -> Vec<Arc<Swapchain>> {
    let sessions = SESSIONS.remove_where(|session| session.instance.handle == instance);
    sessions.iter().flat_map(|session| forget(session)).collect()
}

/// `xrCreateSession`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    instance: xr::Instance,
    info: *const xr::SessionCreateInfo,
    session: *mut xr::Session,
) -> xr::Result {
    let known = instance::hooked(instance);
    let Some(next) = known.as_ref().map(|known| known.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.create_session)(instance, info, session) };
    guard("xrCreateSession", below, |answer| {
        // SAFETY: valid usage: `info` is valid, and its chain and the device in it are.
        let device = unsafe { info.as_ref().map(|info| vulkan_device(info)) };
        let device = device.unwrap_or_else(|| Err("xrCreateSession has no create info".to_owned()));
        let section = device.as_ref().ok().map(VulkanDevice::runtime_section);
        let result = answer.record(below());
        drop(section);
        if let (true, Some(known)) = (result.into_raw() >= 0, known) {
            // SAFETY: the call succeeded: `info` is valid, and `session` points to the new handle.
            unsafe { track(known, (*info).system_id, *session, device) };
        }
        result
    })
}

/// The device of the session's graphics binding, or the reason why it or its Vulkan half is missing.
///
/// # Safety
///
/// `info` is valid, and its chain and the device in it are.
unsafe fn vulkan_device(info: &xr::SessionCreateInfo) -> Result<VulkanDevice, String> {
    // SAFETY: the chain and the device in it are valid, as `# Safety` demands.
    unsafe {
        let Some(binding) = extending(info.next).find::<VulkanBinding>() else {
            return Err("its graphics API is not Vulkan".to_owned());
        };
        VulkanDevice::find(binding).map_err(|reason| reason.to_string())
    }
}

/// Begins to track a session, active where it has a device of both halves.
///
/// # Safety
///
/// The device is live, and outlives the session, as `XrGraphicsBindingVulkanKHR` demands.
pub(super) unsafe fn track(
    instance: Arc<Instance>,
    system: xr::SystemId,
    handle: xr::Session,
    device: Result<VulkanDevice, String>,
) {
    let inert = device.as_ref().err().cloned().unwrap_or_default();
    if !inert.is_empty() {
        tracing::info!("session inert: {inert}");
    }
    let config = instance.config.snapshot();
    // SAFETY: the device is live, as `# Safety` demands.
    let active = device.ok().map(|device| unsafe { Active::new(device, Arc::clone(&config)) });
    let is_asked = active.is_some() || instance.offer.is_some();
    let headset = if is_asked { instance.headset(system) } else { Headset::default() };
    let actions = SessionActions::new(active.is_some() && headset.reports_eye_gaze);
    // The gaze that is given to the application needs no Vulkan.
    let may_offer = instance.offer.is_some() && !headset.reports_eye_gaze;
    let needs_spaces = active.is_some() || may_offer;
    let spaces = if needs_spaces { Spaces::create(&instance.next, handle) } else { None };
    let offer = spaces.filter(|_| may_offer).map(|_| SessionOffer::default());
    if let Some(active) = &active {
        active.device.set_active(true);
        active.plan.notify_settings(active, &config);
        tracing::info!("session active, {}", gaze_of(config.gaze.source, actions.may_have_gaze()));
    }
    // Never with elevated rights: then instances are inert.
    let environment = Environment::of_process(false);
    let correction = Arc::<SessionGazeCorrection>::default();
    let has_gaze = active.is_some() || offer.is_some();
    let requests = has_gaze.then(|| {
        CorrectionRequests::new(&environment, std::process::id(), headset.name, Arc::clone(&correction))
    });
    let gaze = SessionGaze::new(correction);
    if active.is_some() || (offer.is_some() && config.gaze.offer) {
        gaze.open(&config, actions.may_have_gaze(), Instant::now());
    }
    let known = Status {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        pid: std::process::id(),
        executable: executable().to_string_lossy().into_owned(),
        application: instance.application.clone(),
        inert,
        ..Status::default()
    };
    let reporter = StatusReporter::begin(&environment, known, Arc::clone(&config.source), requests);
    let head = LocatedHead::default();
    let session = Session { handle, instance, system, active, spaces, head, actions, gaze, offer, reporter };
    SESSIONS.insert(handle, Arc::new(session));
}

/// The source of a session's gaze, as the log names it.
fn gaze_of(source: GazeSource, has_tracker: bool) -> &'static str {
    match (source, has_tracker) {
        (GazeSource::Auto | GazeSource::Eyes, true) => "with an eye tracker",
        (GazeSource::Auto, false) => {
            "without an eye tracker: rates are fixed around the axis of each lens until OSC packets arrive"
        }
        (GazeSource::Eyes, false) => "without an eye tracker: rates are fixed around the axis of each lens",
        (GazeSource::Osc, _) => "gaze from OSC packets (gaze.source = \"osc\")",
        (GazeSource::Centre, _) => "gaze fixed around the axis of each lens (gaze.source = \"centre\")",
        (GazeSource::File, _) => "gaze from a file (gaze.source = \"file\")",
    }
}

/// `xrDestroySession`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(handle: xr::Session) -> xr::Result {
    let Some((known, next)) = find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument.
    let below = || unsafe { (next.destroy_session)(handle) };
    let leave = || {
        SESSIONS.remove(handle);
        known.as_ref().map(|known| forget(known)).unwrap_or_default()
    };
    let pass_through = || {
        attempt("xrDestroySession", || drop(leave()));
        below()
    };
    guard("xrDestroySession", pass_through, |answer| {
        let _section = known.as_ref().and_then(|known| known.runtime_section());
        let swapchains = leave();
        let result = answer.record(below());
        drop(swapchains);
        result
    })
}

/// `xrBeginSession`: frames follow.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin_session(
    handle: xr::Session,
    info: *const xr::SessionBeginInfo,
) -> xr::Result {
    let Some((known, next)) = find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    set_running("xrBeginSession", known.as_deref(), true, || unsafe { (next.begin_session)(handle, info) })
}

/// `xrEndSession`: the application may go on to draw, for a window, without frames that would bring a newer plan.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end_session(handle: xr::Session) -> xr::Result {
    let Some((known, next)) = find_with_next(handle) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own argument.
    set_running("xrEndSession", known.as_deref(), false, || unsafe { (next.end_session)(handle) })
}

/// Calls `below`, and notes that the session runs, or does not run any more, if the call succeeds.
fn set_running(
    call: &'static str,
    session: Option<&Session>,
    is_running: bool,
    below: impl Fn() -> xr::Result,
) -> xr::Result {
    guard(call, &below, |answer| {
        let _section = session.and_then(Session::runtime_section);
        let result = answer.record(below());
        if let (true, Some(active)) =
            (result.into_raw() >= 0, session.and_then(|known| known.active.as_ref()))
        {
            active.plan.set_running(active, is_running);
        }
        result
    })
}

/// Ends our part in a session that is about to be destroyed. Our images go with the result, see [`swapchain::forget_all_of`].
fn forget(session: &Session) -> Vec<Arc<Swapchain>> {
    let swapchains = swapchain::forget_all_of(session.handle);
    spaces::forget_all_of(session.handle);
    offer::forget_all_of(session.handle);
    session.gaze.close();
    if let Some(active) = &session.active {
        active.plan.end();
        active.device.set_active(false);
    }
    swapchains
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_eye_tracker_matters_only_where_the_gaze_comes_from_it() {
        for (source, has_tracker, is_missed) in [
            (GazeSource::Eyes, false, true),
            (GazeSource::Eyes, true, false),
            (GazeSource::Auto, false, true),
            (GazeSource::Auto, true, false),
            (GazeSource::Osc, false, false),
            (GazeSource::File, false, false),
            (GazeSource::Centre, false, false),
        ] {
            let line = gaze_of(source, has_tracker);
            assert_eq!(line.contains("without an eye tracker"), is_missed, "{source:?}: {line}");
        }
    }
}
