//! When a session's frames are planned, and who is told. Each frame is planned once, with the newest gaze that can still matter: at the
//! application's first xrLocateViews between xrBeginFrame and xrEndFrame for the frame's display time. An application whose last frame
//! had no such call is planned at xrBeginFrame, and a frame without any plan at xrEndFrame.
//!
//! Gaze is located on these threads, never inside a call of Vulkan: engines hold the locks of their queues there, and a
//! locate may wait for another process. No lock of ours is held meanwhile.

use super::frame;
use super::instance::next_of_any;
use super::session::{self, Active, Health, Session, Tools};
use super::submission::{self, Projection, ProjectionView};
use super::swapchain;
use super::vulkan_device::FrameReport;
use crate::abi::cpu_time::process_cpu_ns;
use crate::abi::guard;
use crate::config::{Config, ConfigSnapshot, GazeSource, PassRules, RatesBackend, debug_view, gate_modes};
use crate::inputs::audio::Ears;
use crate::inputs::gaze::rotation;
use crate::link::{
    BACKEND_ANY, BACKEND_MASK, BACKEND_NONE, BACKEND_RATE_ATTACHMENT, FrameStart, SettingsRecord,
};
use crate::planning::{Benefit, Clock, EndedFrame, Offer, Planning, ShownView, View, head_of};
use crate::status::{Known, Moment, Quiet, Topic, all_decisions, decided, decision_count, why_unseen};
use glam::{Quat, Vec3};
use openxr_sys as xr;
use parafovea_core::chroma::{ChromaSettings, Focus};
use parafovea_core::gate::Techniques;
use smallvec::SmallVec;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Numbers of plans rise in all sessions alike: one device may have one session after the other.
static SERIAL: AtomicU64 = AtomicU64::new(0);

/// No time yet.
const NEVER: i64 = i64::MIN;

/// The plan of an active session.
pub struct SessionPlan {
    planning: Mutex<Planning>,
    told: Mutex<Option<Wanted>>,
    benefit: Mutex<Benefit>,
    ears: Mutex<Ears>,
    /// Display time of the frame that xrWaitFrame returned last.
    awaited: AtomicI64,
    frame: Mutex<Frame>,
    /// Since when recognition is quiet.
    quiet: Mutex<Quiet>,
    has_looked: AtomicBool,
    has_failed: AtomicBool,
}

/// The frame that xrBeginFrame began last.
#[derive(Clone, Debug)]
struct Frame {
    /// The configuration of all that is done for it.
    config: Arc<ConfigSnapshot>,
    /// Its display time; `None` before the first.
    time: Option<xr::Time>,
    /// Whether its views were located.
    is_located: bool,
}

impl SessionPlan {
    /// Begins without a frame, on a device with these rates; `config` holds until the first frame.
    pub fn new(config: Arc<ConfigSnapshot>, offer: Offer) -> Self {
        Self {
            planning: Mutex::new(Planning::new(offer)),
            told: Mutex::default(),
            benefit: Mutex::default(),
            ears: Mutex::default(),
            awaited: AtomicI64::new(NEVER),
            frame: Mutex::new(Frame { config, time: None, is_located: false }),
            quiet: Mutex::default(),
            has_looked: AtomicBool::new(false),
            has_failed: AtomicBool::new(false),
        }
    }

    /// The configuration of the frame that xrBeginFrame began last.
    pub fn config(&self) -> Arc<ConfigSnapshot> {
        Arc::clone(&self.frame().config)
    }

    fn frame(&self) -> MutexGuard<'_, Frame> {
        self.frame.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The planner.
    pub fn planning(&self) -> MutexGuard<'_, Planning> {
        self.planning.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The source of sound.
    fn ears(&self) -> MutexGuard<'_, Ears> {
        self.ears.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// xrWaitFrame returned a frame to be shown at `time`.
    pub fn frame_awaited(&self, time: xr::Time) {
        self.awaited.store(time.as_nanos(), Ordering::Relaxed);
    }

    /// Display time of the frame that xrBeginFrame is about to begin; `None` before the first xrWaitFrame.
    pub fn awaited(&self) -> Option<xr::Time> {
        let time = self.awaited.load(Ordering::Relaxed);
        (time != NEVER).then(|| xr::Time::from_nanos(time))
    }

    /// Where colour is kept in the left and in the right view, in the space of the head, and how it falls off from there.
    pub fn focuses(&self) -> [Option<(Focus, ChromaSettings)>; 2] {
        if self.has_failed() {
            return [None; 2];
        }
        let planning = self.planning();
        [planning.focus(0), planning.focus(1)]
    }

    fn has_failed(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }

    /// Tells the Vulkan half the settings of the configuration and of the gates where they are new.
    pub fn tell_settings(&self, active: &Active, config: &Config) {
        let (pays, wants_costs) = {
            let mut benefit = self.benefit.lock().unwrap_or_else(PoisonError::into_inner);
            benefit.set_mode(gate_modes(config));
            (benefit.is_on(), benefit.wants_costs())
        };
        let techniques = if self.has_failed() { Techniques::default() } else { pays };
        let wanted = Wanted::new(config, techniques, wants_costs);
        self.planning().set_techniques(wanted.techniques, wants_costs);
        let is_news = {
            let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
            told.replace(wanted) != Some(wanted)
        };
        if is_news {
            let passes = wanted.passes.to_string();
            let record = SettingsRecord {
                is_on: u32::from(wanted.is_on()),
                backend: wanted.backend,
                times_frames: u32::from(wanted.times_frames),
                passes: passes.as_ptr(),
                passes_len: passes.len() as u32,
            };
            // SAFETY: the record points to `passes`.
            unsafe { active.device.begin_frame(&FrameStart { settings: &record, plan: ptr::null() }) };
        }
    }
}

/// Settings of the Vulkan half.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wanted {
    techniques: Techniques<bool>,
    times_frames: bool,
    backend: u32,
    passes: PassRules,
}

impl Wanted {
    fn new(config: &Config, techniques: Techniques<bool>, times_frames: bool) -> Self {
        let backend = match config.rates.backend {
            RatesBackend::Auto => BACKEND_ANY,
            RatesBackend::Attachment => BACKEND_RATE_ATTACHMENT,
            RatesBackend::Mask => BACKEND_MASK,
            RatesBackend::Off => BACKEND_NONE,
        };
        Self { techniques, times_frames, backend, passes: config.rates.passes }
    }

    /// Whether passes that are recognised get maps.
    fn is_on(&self) -> bool {
        self.techniques.rates || self.techniques.reuse
    }
}

/// A frame that is shown at `time` ended: its cost goes to the gate, whose answer the next xrBeginFrame tells.
pub fn frame_ended(active: &Active, config: &Config, time: xr::Time, report: &FrameReport) {
    let state = &active.plan;
    let time_ns = time.as_nanos();
    let (phase, on_cpu) = {
        let planning = state.planning();
        (planning.phase(config, time_ns), planning.renders_on_cpu())
    };
    let told = *state.told.lock().unwrap_or_else(PoisonError::into_inner);
    let is_timed = told.is_some_and(|told| told.times_frames);
    let clock =
        if on_cpu { Clock::Cpu(is_timed.then(process_cpu_ns).flatten()) } else { Clock::Gpu(report.frame) };
    let frame = EndedFrame {
        time_ns,
        clock,
        wanted: told.map(|told| told.techniques).unwrap_or_default(),
        passes: report.passes_with_rates,
        eye_passes: report.eye_passes,
        phase,
    };
    let costs = active.gpu_costs(report, is_timed && !on_cpu);
    let news = state.benefit.lock().unwrap_or_else(PoisonError::into_inner).frame_ended(&frame, &costs);
    if let Some(news) = news {
        tracing::info!("{news}");
    }
}

/// The status at the end of a frame, for `parafovea status`.
pub fn moment(session: &Session, active: &Active, config: &ConfigSnapshot, report: &FrameReport) -> Moment {
    let (state, frames) = (&active.plan, report.frame);
    let mut moment = Moment {
        frames,
        backend: active.device.offer.backend,
        passes_matched: report.passes_with_rates,
        debug_view: config.debug.view,
        debug_view_is_asked: config.is_view_asked,
        debug_view_is_drawn: debug_view(config)
            .is_some_and(|view| active.debug_views().is_drawn(view, frames)),
        ..Moment::default()
    };
    state.planning().tell(config, &mut moment);
    session.gaze.tell(&mut moment);
    let benefit = state.benefit.lock().unwrap_or_else(PoisonError::into_inner);
    let Techniques { rates, reuse } = benefit.gates().gates();
    (moment.rates, moment.reuse) = (rates.into(), reuse.into());
    moment
}

/// Says once, when recognition has settled, why an active session has no visible effect, if that is so.
pub fn tell_unseen(
    session: &Session,
    (active, config): (&Active, &ConfigSnapshot),
    time: xr::Time,
    report: &FrameReport,
) {
    let state = &active.plan;
    if state.has_looked.load(Ordering::Relaxed) {
        return;
    }
    let has_settled = {
        let mut quiet = state.quiet.lock().unwrap_or_else(PoisonError::into_inner);
        quiet.frame(time.as_nanos(), decision_count())
    };
    if !has_settled || state.has_looked.swap(true, Ordering::Relaxed) {
        return;
    }
    let known = Known {
        had_maps: state.benefit.lock().unwrap_or_else(PoisonError::into_inner).had_maps(),
        has_own_images: !swapchain::virtual_ones(session.handle).is_empty(),
        is_healthy: active.health() == Health::Works && !state.has_failed(),
        decisions: &all_decisions(),
    };
    if let Some(why) = why_unseen(config, &moment(session, active, config, report), &known) {
        decided(Topic::Unseen, &why);
    }
}

/// xrBeginFrame succeeded, for the frame that is shown at `time`.
pub fn frame_begun(session: &Session, active: &Active, time: xr::Time) {
    let state = &active.plan;
    let config = session.instance.config.snapshot();
    let frame = Frame { config: Arc::clone(&config), time: Some(time), is_located: false };
    let was_located = std::mem::replace(&mut *state.frame(), frame).is_located;
    state.tell_settings(active, &config);
    let only_watches = {
        let mut planning = state.planning();
        planning.frame_begins(time.as_nanos());
        planning.only_watches(&config, active.health() == Health::Works)
    };
    if only_watches {
        look(session, state, &config, time);
    }
    // An application that located the last frame's views will locate this frame's too, and the gaze is newer then.
    if !was_located {
        _ = plan(session, (active, &config), time);
    }
}

/// `xrLocateViews`: the views that the application will draw, and with them the newest gaze.
pub unsafe extern "system" fn locate_views(
    handle: xr::Session,
    info: *const xr::ViewLocateInfo,
    state: *mut xr::ViewState,
    capacity: u32,
    count: *mut u32,
    views: *mut xr::View,
) -> xr::Result {
    let known = session::find(handle);
    let Some(next) = known.as_ref().map(|known| known.instance.next).or_else(next_of_any) else {
        return xr::Result::ERROR_HANDLE_INVALID;
    };
    // SAFETY: the next layer's function with the application's own arguments.
    let below = || unsafe { (next.locate_views)(handle, info, state, capacity, count, views) };
    guard("xrLocateViews", below, |answer| {
        let result = answer.record(below());
        let active = known.as_ref().and_then(|known| Some((known, known.active.as_ref()?)));
        if let (true, Some((known, active))) = (result.into_raw() >= 0, active) {
            // SAFETY: the call succeeded: its arguments are valid, and as many views were written as it says.
            unsafe {
                if let (Some(info), Some(state), Some(count)) =
                    (info.as_ref(), state.as_ref(), count.as_ref())
                {
                    let is_valid = state.view_state_flags.contains(xr::ViewStateFlags::ORIENTATION_VALID);
                    if is_valid && !views.is_null() && *count <= capacity {
                        let views = std::slice::from_raw_parts(views, *count as usize);
                        views_located(known, active, info.display_time, views);
                    }
                }
            }
        }
        result
    })
}

/// The application located its views. Of several calls for one frame the first plans it, where the plan waits for it; calls for other
/// times, of a thread that prepares the next frame, plan nothing.
fn views_located(session: &Session, active: &Active, time: xr::Time, views: &[xr::View]) {
    let views: SmallVec<[View; 4]> = views.iter().filter_map(|view| of_pose(&view.pose, &view.fov)).collect();
    let state = &active.plan;
    let is_planned = {
        let mut planning = state.planning();
        planning.views.located(&views);
        planning.is_planned()
    };
    let (config, is_first) = {
        let mut frame = state.frame();
        if frame.time != Some(time) {
            return;
        }
        (Arc::clone(&frame.config), !std::mem::replace(&mut frame.is_located, true))
    };
    if is_first && (is_planned || plan(session, (active, &config), time)) {
        frame::expect(active, &config, &views);
    }
}

/// Projection views are shown at `time`: the frame is planned now if that was not possible before. Nothing is shown that is
/// nearer than `nearest_m`, where that is known.
pub fn views_shown(
    session: &Session,
    (active, config): (&Active, &Config),
    time: xr::Time,
    views: &[ProjectionView],
    nearest_m: Option<f32>,
) {
    let shown = views.iter().map(|view| {
        let extent = view.sub_image.image_rect.extent;
        let extent = [extent.width.max(0) as u32, extent.height.max(0) as u32];
        Some(ShownView { view: view.view()?, extent })
    });
    let Some(shown) = shown.collect::<Option<SmallVec<[ShownView; 4]>>>() else { return };
    let is_planned = {
        let mut planning = active.plan.planning();
        planning.views.shown(&shown);
        planning.views.set_nearest(nearest_m);
        planning.is_planned()
    };
    if !is_planned {
        _ = plan(session, (active, config), time);
    }
}

/// A pose and a field of view, if the pose makes sense.
fn of_pose(pose: &xr::Posef, fov: &xr::Fovf) -> Option<View> {
    let xr::Quaternionf { x, y, z, w } = pose.orientation;
    let xr::Vector3f { x: right, y: up, z: back } = pose.position;
    Some(View {
        orientation: rotation(x, y, z, w)?,
        position: Vec3::new(right, up, back),
        fov: submission::fov(fov),
    })
}

/// Plans the frame that is shown at `time`, and hands its rates over. Whether the frame has a plan.
fn plan(session: &Session, (active, config): (&Active, &Config), time: xr::Time) -> bool {
    let state = &active.plan;
    if state.has_failed() {
        return false;
    }
    let _give_up = GiveUpOnPanic(state);
    let can_attenuate = active.health() == Health::Works;
    let has_work = {
        let mut planning = state.planning();
        let has_work = planning.has_work(config, can_attenuate);
        if !has_work {
            planning.idle();
        }
        has_work
    };
    if !has_work {
        state.ears().rest();
        return false;
    }
    let head = look(session, state, config, time);
    let heard = state.ears().hear(config);

    let mut planning = state.planning();
    if let Some(mut compose) = active.made_tools().and_then(Tools::free_compose) {
        compose.changes(|view, tiles, changes| planning.content_changed(view, tiles, changes));
    }
    let time = time.as_nanos();
    planning.listen(heard);
    if planning.plan(config, can_attenuate, head, time) {
        let serial = || SERIAL.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(record) = planning.new_rates(config, serial) {
            // SAFETY: what the record points to is `planning`'s, which is locked. The Vulkan half copies it, and calls
            // nobody.
            unsafe { active.device.begin_frame(&FrameStart { settings: ptr::null(), plan: &record }) };
        }
    }
    planning.is_planned()
}

/// Asks the eye tracker, and returns how the head is turned at `time`.
fn look(session: &Session, state: &SessionPlan, config: &Config, time: xr::Time) -> Quat {
    let look = session.gaze.look(session, config, time);
    let head = session.head_in_world(time);
    if let Some(reason) = state.planning().look(config, look, head, time.as_nanos()) {
        tracing::info!("a gaze sample was rejected: {reason}");
    }
    head
}

/// How the head was turned when a projection layer's pictures were drawn, in the layer's space: the direction of the gaze
/// is known relative to the head.
pub fn head_in_layer(
    session: &Session,
    config: &Config,
    layer: &Projection<'_>,
    time: xr::Time,
) -> Option<Quat> {
    let of_views = || head_of(layer.views.iter().take(2).filter_map(|view| view.orientation));
    match config.gaze.source {
        // Straight ahead of the picture, whenever it was drawn.
        GazeSource::Centre => of_views(),
        GazeSource::Auto | GazeSource::Eyes | GazeSource::Osc | GazeSource::File => {
            session.head_in(layer.space, time).or_else(of_views)
        }
    }
}

/// Gives planning up when it panics, so that it does not do so in every frame.
struct GiveUpOnPanic<'a>(&'a SessionPlan);

impl Drop for GiveUpOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.has_failed.store(true, Ordering::Relaxed);
        }
    }
}
