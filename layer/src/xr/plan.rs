//! Timing of a session's plans, and their delivery to the Vulkan half. Each frame is planned once, with the newest gaze that can still
//! matter: at the application's first xrLocateViews between xrBeginFrame and xrEndFrame for the frame's display time. An application whose
//! last frame had no such call is planned at xrBeginFrame, and a frame without any plan at xrEndFrame.
//!
//! Gaze is located on these threads, never inside a call of Vulkan: engines hold the locks of their queues there, and a
//! locate may wait for another process. No lock of ours is held meanwhile. The plan itself is made by a thread of ours, or by the first
//! call that needs it: the submit of a pass with a map, or xrEndFrame.

mod seen;
mod settings;
mod sleep;
mod status;
mod thread;
mod views;
mod work;

pub use sleep::fall_asleep;
pub use status::{report_unseen, status};
pub use views::{head_in_layer, locate_views, views_shown};
pub use work::PlanWork;

use super::frame::{History, SortedTiles};
use super::session::{Active, Session};
use super::vulkan_device::{FrameReport, VulkanDevice};
use crate::abi::cpu_time::process_cpu_ns;
use crate::config::{Config, ConfigSnapshot, gate_modes, wants_reuse};
use crate::inputs::audio::AudioInput;
use crate::pass_detection::Feedback;
use crate::planner::{Benefit, Clock, EndedFrame, SessionPlanner, View};
use crate::status::{Quiet, Topic, decided};
use openxr_sys as xr;
use parafovea_core::audio::AudioFeatures;
use parafovea_core::chroma::{ChromaSettings, Focus};
use parafovea_core::gate::{GateMode, Techniques};
use seen::SeenFrames;
use settings::VulkanSettings;
use sleep::Sleep;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use thread::PlanThread;
use views::{plan, watch};

/// Serial of the newest plan, counted over all sessions: one device can have several sessions in sequence.
static SERIAL: AtomicU64 = AtomicU64::new(0);

/// No time yet.
const NEVER: i64 = i64::MIN;

/// The plan of an active session.
pub struct SessionPlan {
    thread: PlanThread,
    sent_settings: Mutex<Option<VulkanSettings>>,
    benefit: Mutex<Benefit>,
    audio_input: Mutex<AudioInput>,
    /// Display time of the frame that xrWaitFrame returned last.
    awaited: AtomicI64,
    seen: SeenFrames,
    frame: Mutex<Frame>,
    /// Since when recognition is quiet.
    quiet: Mutex<Quiet>,
    has_reported_unseen: AtomicBool,
    /// Whether the session runs, for all that is known: until xrEndSession, and again from xrBeginSession on.
    is_running: AtomicBool,
    /// The ignored frames.
    pub sleep: Sleep,
    /// Whether passes read pictures of earlier frames.
    feedback: Mutex<Feedback>,
    /// Whether the last frame's pictures are kept for the next one.
    keeps_pictures: AtomicBool,
}

/// The frame that xrBeginFrame began last.
#[derive(Clone, Debug)]
struct Frame {
    /// Configuration of the frame.
    config: Arc<ConfigSnapshot>,
    /// Its display time; `None` before the first.
    time: Option<xr::Time>,
    /// Whether its views were located.
    is_located: bool,
    /// Whether its views were located before it began.
    was_located_ahead: bool,
    /// Views of later calls, and of calls for the next frame, to be taken when the frame ends: the first call planned it.
    later: Option<LaterViews>,
}

impl Frame {
    fn new(config: Arc<ConfigSnapshot>, time: Option<xr::Time>) -> Self {
        Self { config, time, is_located: false, was_located_ahead: false, later: None }
    }
}

impl SessionPlan {
    /// Begins without a frame, on a device; `config` holds until the first frame.
    pub fn new(config: Arc<ConfigSnapshot>, device: VulkanDevice) -> Self {
        Self {
            thread: PlanThread::new(PlanWork::new(device)),
            sent_settings: Mutex::default(),
            benefit: Mutex::default(),
            audio_input: Mutex::default(),
            awaited: AtomicI64::new(NEVER),
            seen: SeenFrames::default(),
            frame: Mutex::new(Frame::new(config, None)),
            quiet: Mutex::default(),
            has_reported_unseen: AtomicBool::new(false),
            is_running: AtomicBool::new(true),
            sleep: Sleep::default(),
            feedback: Mutex::default(),
            keeps_pictures: AtomicBool::new(false),
        }
    }

    /// The configuration of the frame that xrBeginFrame began last.
    pub fn config(&self) -> Arc<ConfigSnapshot> {
        Arc::clone(&self.frame().config)
    }

    fn frame(&self) -> MutexGuard<'_, Frame> {
        self.frame.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The planner, after the plan of the frame was made.
    pub fn planner(&self) -> MutexGuard<'_, SessionPlanner> {
        self.thread.work().planner()
    }

    /// The session's last pictures.
    pub fn history(&self) -> MutexGuard<'_, History> {
        self.thread.work_in_progress().history()
    }

    /// The tiles of the frame's pictures that were sorted ahead, after their sorting has ended.
    pub fn sorted(&self) -> MutexGuard<'_, SortedTiles> {
        self.thread.finish_sorting();
        self.thread.work_in_progress().sorted()
    }

    /// Ends its thread, before the session is destroyed.
    pub fn end(&self) {
        self.thread.end();
    }

    /// The gates.
    fn benefit(&self) -> MutexGuard<'_, Benefit> {
        self.benefit.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The source of sound.
    fn audio_input(&self) -> MutexGuard<'_, AudioInput> {
        self.audio_input.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// xrWaitFrame returned a frame to be shown at `time`, which the application should render or not.
    pub fn frame_awaited(&self, time: xr::Time, should_render: bool) {
        self.awaited.store(time.as_nanos(), Ordering::Relaxed);
        self.seen.take(time.as_nanos(), should_render);
    }

    /// The sound at `time`; without it, and without a capture, while nothing is shown.
    fn sound(&self, config: &Config, time: xr::Time) -> Option<AudioFeatures> {
        let mut input = self.audio_input();
        if self.is_running.load(Ordering::Relaxed) && self.seen.are_recent(time.as_nanos()) {
            return input.poll(config);
        }
        input.rest();
        None
    }

    /// Display time of the frame that xrBeginFrame is about to begin; `None` before the first xrWaitFrame.
    pub fn awaited(&self) -> Option<xr::Time> {
        let time = self.awaited.load(Ordering::Relaxed);
        (time != NEVER).then(|| xr::Time::from_nanos(time))
    }

    /// Focus of full colour in the left and in the right view, in the space of the head, with the settings of the falloff around it.
    pub fn focuses(&self) -> [Option<(Focus, ChromaSettings)>; 2] {
        if self.has_failed() {
            return [None; 2];
        }
        let planner = self.planner();
        [planner.focus(0), planner.focus(1)]
    }

    /// The modes of a configuration; re-use is off where pictures of earlier frames are read.
    fn gate_modes(&self, config: &Config) -> Techniques<GateMode> {
        let modes = gate_modes(config);
        let may_reuse = self.feedback().allows_reuse();
        Techniques { reuse: if may_reuse { modes.reuse } else { GateMode::Off }, ..modes }
    }

    fn feedback(&self) -> Feedback {
        *self.feedback.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes whether passes of the last frame read eye buffers of earlier frames.
    fn take_feedback(&self, config: &Config, feedback: Feedback) {
        let before =
            std::mem::replace(&mut *self.feedback.lock().unwrap_or_else(PoisonError::into_inner), feedback);
        if before != feedback && wants_reuse(config) {
            decided(Topic::Feedback, &feedback);
        }
    }

    fn has_failed(&self) -> bool {
        self.thread.work_in_progress().has_failed()
    }

    /// Sets whether the session runs. Without frames no newer plan arrives, so passes get no rates.
    pub fn set_running(&self, active: &Active, is_running: bool) {
        self.is_running.store(is_running, Ordering::Relaxed);
        if !is_running {
            self.audio_input().rest();
        }
        self.sleep.wake();
        self.notify_settings(active, &self.config());
    }

    /// Whether passes get shading rates, by the last settings of the Vulkan half.
    pub fn has_rates(&self) -> bool {
        let sent = self.sent_settings.lock().unwrap_or_else(PoisonError::into_inner);
        sent.is_some_and(|sent| sent.techniques.rates)
    }

    /// Whether depth is needed: tiles of this frame or the next may be re-used. Without pictures that are kept, or where the gate or passes
    /// that read earlier frames forbid it, none are. Takes no lock that a plan holds.
    pub fn needs_depth(&self) -> bool {
        let sent = self.sent_settings.lock().unwrap_or_else(PoisonError::into_inner);
        self.keeps_pictures.load(Ordering::Relaxed) && sent.is_some_and(|sent| sent.techniques.reuse)
    }

    /// Notes whether the pictures of the frame that ends are kept for re-use.
    pub fn keep_pictures(&self, are_kept: bool) {
        self.keeps_pictures.store(are_kept, Ordering::Relaxed);
    }
}

/// Takes the end of the frame that is shown at `time`: its cost goes to the gate, and the gate's answer to the Vulkan half at the next xrBeginFrame.
pub fn frame_ended(
    session: &Session,
    (active, config): (&Active, &Config),
    time: xr::Time,
    report: &FrameReport,
) {
    let state = &active.plan;
    state.take_feedback(config, report.feedback);
    let time_ns = time.as_nanos();
    let (look, phase, on_cpu) = {
        let mut planner = state.planner();
        (planner.take_look(config), planner.phase(config, time_ns), planner.renders_on_cpu())
    };
    if let Some((look, phase, time_ns)) = look {
        session.gaze.note_phase(look, phase, time_ns);
    }
    let sent_settings = *state.sent_settings.lock().unwrap_or_else(PoisonError::into_inner);
    let is_timed = sent_settings.is_some_and(|sent| sent.times_frames);
    let clock =
        if on_cpu { Clock::Cpu(is_timed.then(process_cpu_ns).flatten()) } else { Clock::Gpu(report.frame) };
    let frame = EndedFrame {
        time_ns,
        clock,
        wanted: sent_settings.map(|sent| sent.techniques).unwrap_or_default(),
        passes: report.passes_with_rates,
        eye_passes: report.eye_passes,
        eye_pixels: report.eye_pixels,
        phase,
    };
    let costs = active.gpu_costs(report, is_timed && !on_cpu);
    let line = state.benefit().frame_ended(&frame, &costs);
    if let Some(line) = line {
        tracing::info!("{line}");
    }
}

/// Located views that planned no frame.
#[derive(Clone, Debug)]
struct LaterViews {
    time: xr::Time,
    views: SmallVec<[View; 4]>,
}

/// xrBeginFrame succeeded, for the frame that is shown at `time`.
pub fn frame_begun(session: &Session, active: &Active, time: xr::Time) {
    let state = &active.plan;
    let Some(count) = state.sleep.frame_begins() else { return };
    let config = session.instance.config.snapshot();
    let mut frame = Frame::new(Arc::clone(&config), Some(time));
    let last = {
        let mut last = state.frame();
        frame.was_located_ahead = last.later.as_ref().is_some_and(|later| later.time == time);
        std::mem::replace(&mut *last, frame)
    };
    state.notify_settings(active, &config);
    {
        let mut planner = state.planner();
        if let Some(later) = &last.later {
            planner.views.located(&later.views);
        }
        planner.frame_begins(time.as_nanos(), count);
    }
    // An application that located the last frame's views will locate this frame's too, and the gaze is newer then. One with a thread ahead of
    // the render thread has located them already; if its last frame was not located ahead, it is not known to locate them twice.
    let located = last.later.filter(|later| later.time == time).map(|later| later.views);
    let is_only_ahead = located.is_some() && !last.was_located_ahead;
    if !last.is_located || is_only_ahead {
        watch(session, (active, &config), time);
        plan(session, (active, &config), time, views::expected(active, &config, located));
    }
}
