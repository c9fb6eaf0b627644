//! The benefit gate: whether a technique saves time in this application, by the cost of frames with and without it.
//!
//! [`Gate`] decides about one technique. It keeps the technique on or off, and measures the alternative in *A/B trials*. A trial has up
//! to four segments: the state that is kept, the other one, and both again. After 8, 16, 32 ... frames of a segment a line is fitted to the
//! costs so far, over technique and time; the trial ends once the result has a confidence of 99.95 %, and at the latest
//! after four segments. A saving of 30 % takes two seconds, and a saving of 3 % half a minute.
//!
//! - The start and each new scene have one full trial, of three switches, and one more switch if the state changes at its end. The end
//!   decides with a confidence of 97 %; without a decision the technique is off. After a trial without a decision but with a likely
//!   saving, in the cost alone or per pixel, a second one follows after [`TRIAL_REST_NS`].
//! - Later trials are short controls of two switches, one per [`CONTROL_REST_NS`] with open eyes, or per
//!   [`HIDDEN_REST_NS`] in saccades and blinks; only a confidence of 99.95 % changes the state.
//! - After a trial without a decision, full trials continue in saccades and blinks alone, with rests of
//!   [`RETRY_REST_NS`], twice that, and so on. After a decision against the technique, controls continue so, and the first one with open
//!   eyes follows after [`TRIAL_REST_NS`]: the start of a game may have been its menu.
//! - A switch waits up to a second for a saccade or blink of eyes that are tracked.
//!
//! A scene is a set of eye passes. A pass that comes and goes begins no scene; its frames do not count. Where two scenes in a row were too
//! short for a decision, the technique is off until the next trial, whose rest is doubled each time.
//!
//! At a changing resolution a verdict has to hold for the cost alone and for the cost per pixel. With dynamic resolution, where the pixels
//! follow the technique, half of the cost or more counts per pixel.
//!
//! [`Gates`] has one gate for shading rates and one for re-use; at most one of them has a trial at any time.

mod both;
mod comparison;
mod estimate;
mod evidence;
mod frame;
mod mode;
mod running_trial;
mod scenes;
mod trial;

pub use both::{Gates, MeasuredFrame, Techniques};
pub use estimate::{MARGIN, Verdict};
pub use evidence::Evidence;
pub use frame::GateFrame;
pub use mode::GateMode;
pub use scenes::SCENE_HOLD_NS;

use crate::gaze::GazePhase;
use comparison::Comparison;
use running_trial::{RunningTrial, Step};
use scenes::{Decision, Scenes};
use trial::{Cost, RECENT, RecentCosts, Trial};

/// Longest segment of a full trial, nanoseconds: three of them, the frames ahead and the settling fit into 30 s at 2 Hz.
pub const SEGMENT_NS: i64 = 8_000_000_000;

/// Full trials of a scene: the second only after a first one without a decision, but with a likely saving.
const FULL_TRIALS: u8 = 2;

/// Longest segment of a control, nanoseconds.
pub const CONTROL_NS: i64 = 2_000_000_000;

/// Least time from one full trial to the next one with open eyes, nanoseconds.
pub const TRIAL_REST_NS: i64 = 60_000_000_000;

/// Least time from one trial to a control with open eyes, nanoseconds: one switch in five minutes.
pub const CONTROL_REST_NS: i64 = 600_000_000_000;

/// Least time from one trial to a control in a saccade or blink, nanoseconds.
pub const HIDDEN_REST_NS: i64 = 300_000_000_000;

/// Time from a trial without a decision to the next in a saccade or blink, nanoseconds; doubled each time, up to [`HIDDEN_REST_NS`].
pub const RETRY_REST_NS: i64 = 30_000_000_000;

/// Consecutive trials against a technique before the rests of any other control hold. One with open eyes, after the first, is enough.
const REFUSALS: u32 = 5;

/// Longest wait of a switch for a saccade or blink, nanoseconds, of eyes that had one within twice that time.
const HIDING_NS: i64 = 1_000_000_000;

/// Least costs ahead of a trial of slow frames: this number, or half a segment.
const LEAST: usize = 8;

/// Time for which a technique costs more after it is turned on, nanoseconds: rates become coarse over a quarter of a second, once
/// the gaze is known. Costs within it do not count.
const RAMP_NS: i64 = 500_000_000;

/// Time without an eye pass, or without a known cost, after which costs are not asked for, nanoseconds: the timestamps of all command
/// buffers are not free.
const PATIENCE_NS: i64 = 10_000_000_000;

/// Frames after a switch that do not count: CPU time between two frames has work of the frame before in it, and up to two
/// frames are under way.
const SETTLING: u32 = 2;

/// Gate of one technique. Has no clock; allocates nothing.
#[derive(Clone, Debug)]
pub struct Gate {
    mode: GateMode,
    /// Whether the technique is on, apart from trials.
    is_kept_on: bool,
    trial: Option<RunningTrial>,
    evidence: Evidence,
    scenes: Scenes,
    recent: RecentCosts,
    /// The last known number of pixels, 1 before it.
    pixels: u32,
    /// Consecutive frames with the technique in one state.
    same: u32,
    last_was_on: bool,
    /// Time of the last frame that turned the technique on.
    on_since_ns: i64,
    /// Remaining full trials of the scene with open eyes.
    full_trials_left: u8,
    /// Trials without a decision since the last one with a decision.
    undecided: u32,
    /// Trials in a row that left the technique off, the decision against it included.
    refused: u32,
    last_trial_ns: Option<i64>,
    last_full_ns: Option<i64>,
    last_hidden_ns: Option<i64>,
    /// Consecutive full trials that new scenes ended.
    cut_short: u32,
    /// Time of the last frame.
    now_ns: i64,
    wants_costs: bool,
    /// Time since which costs were asked for without one of the scene.
    unanswered_since_ns: Option<i64>,
}

impl Gate {
    /// A gate before the first frame. [`GateMode::Auto`] begins with the technique on, and keeps it on while no cost is known.
    pub fn new(mode: GateMode) -> Self {
        Self {
            mode,
            is_kept_on: true,
            trial: None,
            evidence: Evidence::default(),
            scenes: Scenes::default(),
            recent: RecentCosts::default(),
            pixels: 1,
            same: 0,
            last_was_on: false,
            on_since_ns: 0,
            full_trials_left: FULL_TRIALS,
            undecided: 0,
            refused: 0,
            last_trial_ns: None,
            last_full_ns: None,
            last_hidden_ns: None,
            cut_short: 0,
            now_ns: i64::MIN,
            wants_costs: true,
            unanswered_since_ns: None,
        }
    }

    /// Source of the decision.
    pub fn mode(&self) -> GateMode {
        self.mode
    }

    /// Changes the source of the decision. Earlier decisions stay; a running trial ends without one.
    pub fn set_mode(&mut self, mode: GateMode) {
        if self.mode != mode {
            self.drop_trial();
        }
        self.mode = mode;
    }

    /// Forgets all decisions, because the technique or its cost has changed: it is on until a full trial decides again.
    pub fn forget_decisions(&mut self) {
        self.drop_trial();
        self.scenes.forget_decisions();
        (self.undecided, self.refused, self.cut_short) = (0, 0, 0);
        (self.is_kept_on, self.full_trials_left) = (true, FULL_TRIALS);
        self.evidence = Evidence::default();
    }

    /// Ends a running trial without a decision; costs of earlier frames do not count in the next one. The rest after it is that after a
    /// complete one, so that trials that never end show no more switches. Returns whether it was a full trial.
    fn drop_trial(&mut self) -> bool {
        self.recent.clear();
        let Some(running) = self.trial.take() else { return false };
        self.last_trial_ns = Some(self.now_ns);
        if !running.is_control {
            self.last_full_ns = Some(self.now_ns);
        }
        !running.is_control
    }

    /// Whether the technique is on in the next frame.
    pub fn is_on(&self) -> bool {
        match (self.mode, &self.trial) {
            (GateMode::On, _) => true,
            (GateMode::Off, _) => false,
            (GateMode::Auto, None) => self.is_kept_on,
            (GateMode::Auto, Some(running)) => running.trial.is_on(),
        }
    }

    /// Whether the technique is kept, apart from trials.
    pub fn is_kept(&self) -> bool {
        match self.mode {
            GateMode::On => true,
            GateMode::Off => false,
            GateMode::Auto => self.is_kept_on,
        }
    }

    /// Result of the last trial, or of the first one so far, for reports.
    pub fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// Whether a trial is running.
    pub fn has_trial(&self) -> bool {
        self.trial.is_some()
    }

    /// Whether a trial is running or due, so that costs of frames are needed.
    pub fn wants_costs(&self) -> bool {
        self.mode == GateMode::Auto && self.wants_costs
    }

    /// Time from `now` within which no trial can begin, nanoseconds; 0 while one is running or due. The phase of the gaze is not needed before:
    /// a hidden trial depends on the saccades and blinks of its last ten seconds.
    pub fn rests_ns(&self, now: i64) -> i64 {
        if self.mode != GateMode::Auto {
            return i64::MAX;
        }
        if self.trial.is_some() || self.wants_costs || self.full_trials_left > 0 {
            return 0;
        }
        let Some(last) = self.last_trial_ns else { return 0 };
        let rest_ns = self.hidden_rest_ns().min(self.control_rest_ns()) - 10 * HIDING_NS;
        last.saturating_add(rest_ns).saturating_sub(now).max(0)
    }

    /// Records a rendered frame, and returns whether the technique is on in the next one.
    ///
    /// `may_begin`: whether a trial may begin now; not while another gate has one.
    pub fn frame(&mut self, frame: &GateFrame, may_begin: bool) -> bool {
        if self.mode != GateMode::Auto {
            return self.is_on();
        }
        let now = frame.time_ns;
        self.now_ns = now;
        for last in [&mut self.last_trial_ns, &mut self.last_full_ns, &mut self.last_hidden_ns] {
            // A clock that restarts also restarts the rest.
            *last = last.map(|last| last.min(now));
        }
        if is_hidden(frame.phase) {
            self.last_hidden_ns = Some(now);
        }
        if self.scenes.frame(frame.passes, now) {
            self.unanswered_since_ns = None;
            self.begin_scene();
        }
        self.record_cost(frame);
        if self.trial.is_some() {
            self.advance_trial(frame);
        } else if may_begin && self.is_due(is_hidden(frame.phase), now) {
            self.begin_trial(now);
        }
        let eyes_move = !has_elapsed(self.last_hidden_ns, 10 * HIDING_NS, now);
        self.wants_costs = self.trial.is_some() || self.asks(eyes_move, frame.passes, now);
        self.is_on()
    }

    /// Whether costs are asked for ahead of a trial that is due: not within a rest of [`RETRY_REST_NS`] after [`PATIENCE_NS`] without
    /// any, nor after it without eye passes.
    fn asks(&mut self, eyes_move: bool, passes: Option<u32>, now: i64) -> bool {
        if !self.is_due(eyes_move, now) {
            self.unanswered_since_ns = None;
            return false;
        }
        let since = self.unanswered_since_ns.map_or(now, |since| since.min(now));
        let has_rested = now.saturating_sub(since) >= PATIENCE_NS + RETRY_REST_NS && passes.is_some();
        let since = if has_rested { now } else { since };
        self.unanswered_since_ns = Some(since);
        now.saturating_sub(since) < PATIENCE_NS
    }

    /// Begins a scene with its earlier decision, or else with a full trial.
    fn begin_scene(&mut self) {
        if self.drop_trial() {
            self.cut_short = self.cut_short.saturating_add(1);
        }
        (self.undecided, self.refused) = (0, 0);
        let decision = self.scenes.decision();
        self.full_trials_left = if decision.is_none() { FULL_TRIALS } else { 0 };
        self.evidence = decision.map(|decision| decision.evidence).unwrap_or_default();
        // Scenes too short for a decision leave the technique off.
        let is_undecided = self.cut_short >= u32::from(FULL_TRIALS);
        self.is_kept_on = decision.map_or(self.is_kept_on && !is_undecided, |decision| decision.is_on);
    }

    /// Adds the frame's cost to the running trial or to the recent costs.
    fn record_cost(&mut self, frame: &GateFrame) {
        self.same = if frame.was_on == self.last_was_on { self.same.saturating_add(1) } else { 0 };
        // A clock that restarts also restarts the ramp.
        let came_on = frame.was_on && (!self.last_was_on || frame.time_ns < self.on_since_ns);
        if came_on {
            self.on_since_ns = frame.time_ns;
        }
        self.last_was_on = frame.was_on;
        self.pixels = if frame.pixels > 0 { frame.pixels } else { self.pixels };
        let is_ramping = frame.was_on && !has_elapsed(Some(self.on_since_ns), RAMP_NS, frame.time_ns);
        let cost = frame.cost_ns.filter(|&cost| cost > 0 && self.same >= SETTLING);
        let Some(cost) = cost.filter(|_| self.scenes.is_current(frame.passes)) else { return };
        self.unanswered_since_ns = None;
        let [ln, ln_pixels] = [cost as f64, f64::from(self.pixels)].map(|count| count.ln() as f32);
        let cost = Cost { time_ns: frame.time_ns, ln, ln_pixels };
        match &mut self.trial {
            _ if is_ramping => {}
            Some(running) if frame.was_on == running.trial.is_on() => running.trial.push(cost),
            None if frame.was_on == self.is_kept_on => self.recent.push(cost),
            _ => {}
        }
    }

    /// Whether a trial is due; `hidden` in a saccade or blink.
    fn is_due(&self, hidden: bool, now: i64) -> bool {
        if self.full_trials_left > 0 {
            return has_elapsed(self.last_full_ns, self.full_rest_ns(), now) || hidden;
        }
        has_elapsed(self.last_trial_ns, self.control_rest_ns(), now)
            || hidden && has_elapsed(self.last_trial_ns, self.hidden_rest_ns(), now)
    }

    /// Least time from the last full trial to the next one with open eyes, nanoseconds.
    fn full_rest_ns(&self) -> i64 {
        let doublings = self.cut_short.saturating_sub(1).min(8);
        (TRIAL_REST_NS << doublings).min(CONTROL_REST_NS)
    }

    /// Least time from the last trial to a control with open eyes, nanoseconds.
    fn control_rest_ns(&self) -> i64 {
        if self.refused == 1 { TRIAL_REST_NS } else { CONTROL_REST_NS }
    }

    /// Least time from the last trial to one in a saccade or blink, nanoseconds.
    fn hidden_rest_ns(&self) -> i64 {
        match self.undecided.max(self.refused) {
            0 => HIDDEN_REST_NS,
            trials => RETRY_REST_NS.saturating_mul(1 << (trials - 1).min(8)).min(HIDDEN_REST_NS),
        }
    }

    /// Begins a trial, if there are costs to compare with.
    fn begin_trial(&mut self, now: i64) {
        let is_seen = self.last_hidden_ns != Some(now);
        let is_control = self.full_trials_left == 0 && (self.undecided == 0 || is_seen);
        let recent = self.recent.since(now.saturating_sub(SEGMENT_NS));
        let span = recent.first().map_or(0, |first| now.saturating_sub(first.time_ns));
        if recent.len() < LEAST || (recent.len() < RECENT && span < SEGMENT_NS / 2) {
            return;
        }
        if is_seen && self.refused > 0 {
            self.refused = self.refused.max(REFUSALS);
        }
        let trial = Trial::begin(now, self.is_kept_on, recent);
        self.trial = Some(RunningTrial::begin(trial, is_control, self.full_trials_left > 0, now));
    }

    /// Advances the running trial.
    fn advance_trial(&mut self, frame: &GateFrame) {
        let now = frame.time_ns;
        let may_try_again = self.full_trials_left > 1 || self.scenes.decision().is_some();
        let Some(running) = &mut self.trial else { return };
        running.next = running.next.or_else(|| Some((running.step(now)?, now)));
        if self.evidence.verdict() == Verdict::Unclear && running.trial.at() > 1 && running.latest.is_some() {
            self.evidence = Evidence::new(running.latest, Verdict::Unclear);
        }
        let Some((step, since)) = running.next else { return };
        let is_on_after = match step {
            Step::Switch => !running.trial.is_on(),
            Step::GiveUp => self.is_kept_on && (running.is_control || may_try_again),
            Step::End(_, Verdict::Unclear) if running.is_control => self.is_kept_on,
            Step::End(_, verdict) => verdict == Verdict::Saves,
        };
        let may_switch = is_hidden(frame.phase)
            || has_elapsed(self.last_hidden_ns, 2 * HIDING_NS, now)
            || has_elapsed(Some(since.min(now)), HIDING_NS, now);
        if is_on_after != running.trial.is_on() && !may_switch {
            return;
        }
        running.next = None;
        let is_control = running.is_control;
        match step {
            Step::Switch => return running.switch(now),
            Step::End(_, Verdict::Unclear) if is_control => {
                self.refused = if self.refused > 0 { self.refused.saturating_add(1) } else { 0 };
            }
            Step::End(comparison, verdict) => self.decide(comparison, verdict),
            Step::GiveUp => {
                self.is_kept_on = is_on_after;
                self.full_trials_left = self.full_trials_left.saturating_sub(1);
                self.undecided = self.undecided.saturating_add(1);
            }
        }
        self.trial = None;
        self.recent.clear();
        self.last_trial_ns = Some(now);
        if !is_control {
            self.last_full_ns = Some(now);
        }
    }

    fn decide(&mut self, comparison: Option<Comparison>, verdict: Verdict) {
        self.is_kept_on = verdict == Verdict::Saves;
        self.cut_short = 0;
        self.refused = if verdict == Verdict::SavesNothing { self.refused.saturating_add(1) } else { 0 };
        self.undecided = if verdict == Verdict::Unclear { self.undecided.saturating_add(1) } else { 0 };
        let is_promising = comparison.is_some_and(|comparison| comparison.is_promising());
        self.full_trials_left = if is_promising && verdict == Verdict::Unclear {
            self.full_trials_left.saturating_sub(1)
        } else {
            0
        };
        self.evidence = Evidence::new(comparison.map(|comparison| comparison.estimate()), verdict);
        self.scenes.decide(Decision { is_on: self.is_kept_on, evidence: self.evidence });
    }
}

/// Whether the user cannot see a change of the image now.
fn is_hidden(phase: GazePhase) -> bool {
    matches!(phase, GazePhase::Saccade | GazePhase::Blink)
}

fn has_elapsed(last_ns: Option<i64>, rest_ns: i64, now: i64) -> bool {
    last_ns.is_none_or(|last| now.saturating_sub(last) >= rest_ns)
}

#[cfg(test)]
mod tests;
