//! From views and gaze of the OpenXR half to the plan: the rates of the Vulkan half, and the regions that keep their colour.
//!
//! Pure: gaze, views and times come from [`crate::xr`]. Unchanged inputs allocate nothing, and give the same plan.

mod benefit;
mod capabilities;
mod frame_rate;
mod seen;
mod signal;
mod status;
mod uploaded_plan;
mod views;
mod watched;

pub use benefit::{Benefit, Clock, EndedFrame};
pub use capabilities::Capabilities;
pub use seen::DebugOverlay;

pub use views::{ShownView, TREMOR, View, Views, head_of};
pub use watched::Watched;

use crate::config::{
    Config, GazeSource, PlannedDevice, debug_view, gate_modes, gaze_settings, plan_settings, wants_maps,
};
use crate::inputs::gaze::Look;
use crate::link::PlanRecord;
use frame_rate::FrameRate;
use glam::{Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::chroma::{ChromaSettings, Focus};
use parafovea_core::gate::{GateMode, Techniques};
use parafovea_core::gaze::{GazePhase, GazeSample, GazeSettings, GazeState, GazeTracker, Rejection};
use parafovea_core::geometry;
use parafovea_core::plan::{PlanInput, PlanSettings, Planner, RateSettings, SafetySettings, tile_of};
use parafovea_core::reuse::StaleTiles;
use signal::Signal;
use status::LastLook;
use uploaded_plan::UploadedPlan;

/// A display time that is earlier than the one before by less than this belongs to another thread that is behind; by more, the runtime's
/// clock has restarted.
const LONGEST_STEP_BACK_NS: i64 = 1_000_000_000;

/// Frames that are shown further apart than this, nanoseconds, re-use nothing: the application paused, or is so slow that the
/// periphery would be renewed too rarely.
const LONGEST_REUSE_NS: i64 = 50_000_000;

/// Plans the frames of one session.
pub struct SessionPlanner {
    /// The views of the eyes.
    pub views: Views,
    capabilities: Capabilities,
    gaze_settings: GazeSettings,
    gaze: GazeTracker,
    /// The newest turn of the head in a space that rests in the world, and its display time, nanoseconds.
    head: Option<(i64, Quat)>,
    /// The sound, as far as it can be relied on.
    audio: Option<AudioFeatures>,
    frame_rate: FrameRate,
    frame: u64,
    /// Present while there is something to plan.
    planner: Option<Planner>,
    settings: PlanSettings,
    /// Frames went by without anything to plan.
    was_idle: bool,
    last: Option<Last>,
    /// Orientations in the world of the views of the newest plan.
    orientations: [Quat; 2],
    uploaded: UploadedPlan,
    /// The techniques in the uploaded maps.
    techniques: Techniques<bool>,
    /// Whether the gates keep every technique off, with no trial under way or due.
    are_resting: bool,
    /// Whether each eye buffer of the frame before this one, with its sources, is kept.
    has_history: [bool; 2],
    /// The same of this frame.
    keeps_history: [bool; 2],
    /// The display time of this frame, from xrWaitFrame.
    begun_ns: Option<i64>,
    /// For each reason of [`Rejection::ALL`], whether a sample was rejected for it.
    rejected: [bool; Rejection::ALL.len()],
    last_look: LastLook,
    /// The newest answer of the eye tracker with its time, nanoseconds, until it is taken.
    newest_look: Option<(Look, i64)>,
    signal: Signal,
}

/// Display time and number of the frame that was planned last.
#[derive(Clone, Copy, Debug)]
struct Last {
    time_ns: i64,
    frame: u64,
}

impl Default for SessionPlanner {
    fn default() -> Self {
        Self::new(Capabilities::default())
    }
}

impl SessionPlanner {
    /// Begins without views or gaze, for a device's rates.
    pub fn new(capabilities: Capabilities) -> Self {
        let gaze_settings = GazeSettings::default();
        Self {
            views: Views::default(),
            capabilities,
            gaze_settings,
            gaze: GazeTracker::new(gaze_settings),
            head: None,
            audio: None,
            frame_rate: FrameRate::default(),
            frame: 0,
            planner: None,
            settings: PlanSettings::default(),
            was_idle: false,
            last: None,
            orientations: [Quat::IDENTITY; 2],
            uploaded: UploadedPlan::default(),
            techniques: Techniques { rates: true, reuse: true },
            are_resting: false,
            has_history: [false; 2],
            keeps_history: [false; 2],
            begun_ns: None,
            rejected: Default::default(),
            last_look: LastLook::default(),
            newest_look: None,
            signal: Signal::default(),
        }
    }

    /// A frame begins, to be shown at `time_ns`; it is the `count`th since the last call.
    pub fn frame_begins(&mut self, time_ns: i64, count: u32) {
        self.frame += u64::from(count);
        self.views.frame_begins();
        self.has_history = std::mem::take(&mut self.keeps_history);
        let begun_ns = self.begun_ns.replace(time_ns);
        let passed_ns = begun_ns.map(|begun_ns| time_ns.saturating_sub(begun_ns));
        if !passed_ns.is_some_and(|passed_ns| (0..=LONGEST_REUSE_NS).contains(&passed_ns)) {
            self.has_history = [false; 2];
        }
        self.frame_rate.frame_at(time_ns, count);
    }

    /// Sets the planned techniques whose maps are uploaded from now on.
    ///
    /// Neither technique, and no use for costs of frames, means that the gates rest: maps without a receiver are not planned. Costs are
    /// requested from the beginning of a trial on, whose first stretch is without the technique: rates become coarse within it.
    pub fn set_techniques(&mut self, techniques: Techniques<bool>, wants_costs: bool) {
        self.techniques = techniques;
        self.are_resting = !(techniques.rates || techniques.reuse || wants_costs);
    }

    /// Whether there is nothing to plan before a gate begins its next trial, which is hidden in a saccade or a blink: the eyes are watched.
    pub fn only_watches(&self, config: &Config, can_attenuate: bool) -> bool {
        let Techniques { rates, reuse } = gate_modes(config);
        let may_try = rates == GateMode::Auto || reuse == GateMode::Auto;
        self.are_resting && may_try && self.has_maps(config) && !self.has_work(config, can_attenuate)
    }

    /// The current frame ends with an eye buffer that is kept, with the sources of its stale tiles: the next frame need not render
    /// all of it. Without this call, for any reason, the next frame renders everything: another swapchain, rectangle or field of view,
    /// several projection layers, a picture that could not be composed, no picture.
    pub fn history_kept(&mut self, eye: usize) {
        self.keeps_history[eye] = true;
    }

    /// Whether there is anything to plan: rates that the device has, or stale tiles, or, where `can_attenuate`, chroma and views of plans.
    pub fn has_work(&self, config: &Config, can_attenuate: bool) -> bool {
        let is_shown = can_attenuate && debug_view(config).is_some();
        (self.has_maps(config) && !self.are_resting)
            || is_shown
            || self.chroma(config, can_attenuate).is_some()
    }

    /// Skips a frame: forgets the planner and the uploaded maps.
    pub fn idle(&mut self) {
        self.planner = None;
        self.uploaded.forget();
        self.was_idle = self.views.are_known();
    }

    /// Takes the answer of the eye tracker for `time_ns`, with this orientation of the head. Returns the reason why it is rejected, once
    /// for each reason; untracked eyes are not a reason.
    pub fn look(&mut self, config: &Config, look: Look, head: Quat, time_ns: i64) -> Option<Rejection> {
        let settings = gaze_settings(config);
        if settings != self.gaze_settings {
            self.gaze_settings = settings;
            self.gaze = GazeTracker::new(settings);
        }
        self.head = Some((time_ns, head));
        self.gaze.head_turned(head, time_ns);
        self.gaze.set_views(self.views.seen());
        self.last_look.note(&look, time_ns);
        self.newest_look = Some((look, time_ns));
        let rejection = self.follow(look, time_ns);
        self.signal.note(&look, self.gaze.state(time_ns).phase, time_ns);
        let place = Rejection::ALL.iter().position(|other| Some(*other) == rejection)?;
        rejection.filter(|_| !std::mem::replace(&mut self.rejected[place], true))
    }

    /// The newest answer of the eye tracker, with the phase of the gaze by it and its time, nanoseconds; `None` if it was taken before.
    pub fn take_look(&mut self, config: &Config) -> Option<(Look, GazePhase, i64)> {
        let (look, time_ns) = self.newest_look.take()?;
        Some((look, self.phase(config, time_ns), time_ns))
    }

    /// Orientation of the head at `time_ns` in a space that rests in the world; `None` if that is not the newest time of [`Self::look`].
    pub fn head_at(&self, time_ns: i64) -> Option<Quat> {
        self.head.filter(|(known_ns, _)| *known_ns == time_ns).map(|(_, head)| head)
    }

    /// Hands the answer of the source to the filter; the reason for a rejection, where the source itself stands by it.
    fn follow(&mut self, look: Look, time_ns: i64) -> Option<Rejection> {
        let sample = match look {
            Look::NoTracker => {
                self.gaze.source_ended(time_ns);
                return None;
            }
            Look::Unseen => {
                GazeSample { directions: [Vec3::ZERO; 2], time_ns, uncertainty_ns: 0, valid: false }
            }
            Look::At { direction, sampled_ns, uncertainty_ns } => {
                GazeSample { directions: [direction; 2], time_ns: sampled_ns, uncertainty_ns, valid: true }
            }
        };
        self.gaze.push_at(&sample, time_ns);
        self.gaze.rejection().filter(|rejection| *rejection != Rejection::NotTracked)
    }

    /// Sets the current features of the sound; `None` if they are unknown or unreliable.
    pub fn listen(&mut self, features: Option<AudioFeatures>) {
        self.audio = features;
    }

    /// Plans the frame that is shown at `time_ns`. `head` leads from the space of the head to one that rests in the world.
    /// False where there is nothing to plan for yet, or a later frame is planned already.
    pub fn plan(&mut self, config: &Config, can_attenuate: bool, head: Quat, time_ns: i64) -> bool {
        let is_behind =
            |last: Last| (1..LONGEST_STEP_BACK_NS).contains(&last.time_ns.saturating_sub(time_ns));
        let Some(mut eyes) = self.views.eyes() else { return false };
        if self.last.is_some_and(is_behind) {
            return false;
        }
        self.gaze.head_turned(head, time_ns);
        let settings = self.plan_settings(config, can_attenuate);
        for (eye, has_history) in eyes.iter_mut().zip(self.has_history) {
            eye.refresh = settings.schedule.is_some() && !has_history;
        }
        let gaze = match config.gaze.source {
            // One ray: the distance of the point that the eyes look at is unknown.
            GazeSource::Auto | GazeSource::Eyes | GazeSource::Osc | GazeSource::File => {
                self.gaze.state(time_ns).with_nearest(self.views.positions(), self.views.nearest_m())
            }
            GazeSource::Centre => fixed_gaze(&settings, eyes.each_ref().map(|eye| eye.orientation)),
        };
        let input = PlanInput {
            time_ns,
            frame: self.frame,
            frame_rate_hz: self.frame_rate.hz(),
            eyes,
            head,
            gaze,
            audio: self.audio,
        };
        let planner = match &mut self.planner {
            Some(planner) => planner,
            none => {
                let planner = none.insert(Planner::new(settings));
                self.settings = settings;
                if self.was_idle {
                    // Full colour was shown until now: it goes from there.
                    planner.set_settings(PlanSettings { chroma: None, ..settings });
                    planner.plan(&input);
                    planner.set_settings(settings);
                }
                planner
            }
        };
        if self.settings != settings {
            self.settings = settings;
            planner.set_settings(settings);
        }
        planner.set_drift(self.views.drift_arcmin());
        planner.plan(&input);
        self.orientations = [0, 1].map(|eye| head * self.views.orientation(eye));
        self.last = Some(Last { time_ns, frame: self.frame });
        true
    }

    /// Takes the changes of some tiles of a picture: [`Planner::content_changed`].
    pub fn content_changed(&mut self, view: &geometry::View, tiles: &[u32], changes: &[f32]) {
        if let Some(planner) = &mut self.planner {
            planner.content_changed(view, tiles.iter().copied().zip(changes.iter().copied()));
        }
    }

    /// The phase of the gaze at `time_ns`.
    pub fn phase(&self, config: &Config, time_ns: i64) -> GazePhase {
        match config.gaze.source {
            GazeSource::Auto | GazeSource::Eyes | GazeSource::Osc | GazeSource::File => {
                self.gaze.state(time_ns).phase
            }
            GazeSource::Centre => STRAIGHT_AHEAD.phase,
        }
    }

    /// Whether a CPU renders, whose time is known.
    pub fn renders_on_cpu(&self) -> bool {
        self.capabilities.is_cpu()
    }

    /// Whether this frame has a plan.
    pub fn is_planned(&self) -> bool {
        self.planner.is_some() && self.last.is_some_and(|last| last.frame == self.frame)
    }

    /// The maps of the newest plan, if they differ from the ones handed over last; `serial` numbers them. Data that the record points to is
    /// valid until the next call of a method that changes anything.
    pub fn new_rates(&mut self, config: &Config, serial: impl FnOnce() -> u64) -> Option<PlanRecord> {
        let Some(planner) = self.planner.as_ref().filter(|_| self.has_maps(config)) else {
            self.uploaded.forget();
            return None;
        };
        let orientations = self.gpu_decides().then_some(self.orientations);
        let plan = planner.newest();
        self.uploaded
            .update(&plan.eyes, self.techniques, orientations, plan.frame)
            .then(|| self.uploaded.record(serial()))
    }

    /// The stale tiles of an eye in the maps that were handed over last.
    pub fn stale(&self, eye: usize, tiles: &mut StaleTiles) {
        self.uploaded.stale(eye, tiles);
    }

    /// Region in which the newest plan keeps an eye's colour, in the space of the head, and the settings of chroma attenuation.
    pub fn focus(&self, eye: usize) -> Option<(Focus, ChromaSettings)> {
        let plan = self.planner.as_ref()?.newest();
        let focus = plan.eyes[eye].focus?;
        let direction = self.views.orientation(eye) * focus.direction;
        Some((Focus { direction, ..focus }, plan.chroma?))
    }

    /// Whether the GPU is asked to decide the rates.
    fn gpu_decides(&self) -> bool {
        self.settings.contrast_on_gpu && self.techniques.rates
    }

    /// Whether plans have maps of rates or stale tiles: the configuration wants some, and the device can have them.
    pub fn has_maps(&self, config: &Config) -> bool {
        wants_maps(config) && !self.capabilities.rates().is_empty()
    }

    fn chroma(&self, config: &Config, can_attenuate: bool) -> Option<ChromaSettings> {
        crate::config::chroma_settings(config).filter(|_| can_attenuate)
    }

    fn plan_settings(&self, config: &Config, can_attenuate: bool) -> PlanSettings {
        let extent = self.views.eyes().map_or([0; 2], |[left, right]| {
            [0, 1].map(|axis: usize| left.extent[axis].max(right.extent[axis]))
        });
        let tile = tile_of(self.capabilities.texel(), extent);
        let device = PlannedDevice {
            rates: self.capabilities.rates(),
            texel: tile,
            is_cpu: self.capabilities.is_cpu(),
            has_mask: self.capabilities.has_mask(),
        };
        let settings = plan_settings(config, &device);
        let safety = match config.gaze.source {
            GazeSource::Auto | GazeSource::Eyes | GazeSource::Osc | GazeSource::File => settings.safety,
            // Nothing moves: there is no change that could be seen, and every frame has the same rings.
            GazeSource::Centre => {
                SafetySettings { coarsening_octaves_per_s: f32::INFINITY, ..settings.safety }
            }
        };
        PlanSettings { safety, chroma: self.chroma(config, can_attenuate), ..settings }
    }
}

/// The gaze of `gaze.source = "centre"`.
const STRAIGHT_AHEAD: GazeState = GazeState { phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST };

/// The same for the plan: rings are around the axes of the lenses; contrast and colour are judged by the angle from the centre of the
/// view, where the eyes rest. `orientations` lead from the views to the head.
fn fixed_gaze(settings: &PlanSettings, orientations: [Quat; 2]) -> GazeState {
    let directions = match &settings.rates {
        RateSettings::Fixed(rings) => rings.lens_centres(orientations),
        RateSettings::AudioVisual(_) | RateSettings::Off => STRAIGHT_AHEAD.directions,
    };
    GazeState { directions, ray: Some(Vec3::NEG_Z), ..STRAIGHT_AHEAD }
}

#[cfg(test)]
mod tests;
