//! The benefit gate: whether a technique pays in this application, by the cost of frames with it and without it.
//!
//! [`Gate`] judges one technique. It stands at *on* or *off*, and learns of the other side by *trials*. A trial has up to
//! four stretches: at the stand, away, at the stand again, away again. After 8, 16, 32 ... frames of a stretch the costs so far
//! are fitted over the technique and time; the trial ends as soon as the result is sure to 99.95 %, and at
//! the latest after four stretches. So a gain of 30 % takes a second, and one of 3 % half a minute.
//!
//! - At the start and in a scene that was not seen before there is one whole trial, of three switches, and one more where its end
//!   changes the stand. Its end decides with 97 %; undecided means off. Where an undecided one promised a saving, a second
//!   follows after [`TRIAL_REST_NS`].
//! - Later trials are short controls of two switches, one each [`CONTROL_REST_NS`] with open eyes, or each
//!   [`HIDDEN_REST_NS`] in saccades and blinks; only a result that is sure to 99.95 % changes the stand.
//! - After an undecided trial, and only in saccades and blinks, whole trials go on with rests of
//!   [`RETRY_REST_NS`], twice that, and so on.
//! - A switch waits up to a second for a saccade or blink of eyes that are tracked.
//!
//! A scene is a set of eye passes. A pass that comes and goes begins no scene; its frames do not count.
//!
//! [`Gates`] has one gate for shading rates and one for re-use; at most one of them has a trial at any time.

mod both;
mod estimate;
mod evidence;
mod scenes;
mod trial;
mod under_way;

pub use both::{Gates, JudgedFrame, Techniques};
pub use estimate::{MARGIN, Verdict};
pub use evidence::Evidence;
pub use scenes::SCENE_HOLD_NS;

use crate::gaze::GazePhase;
use estimate::Estimate;
use scenes::{Decision, Scenes};
use trial::{BEFORE, Before, Cost, Trial};
use under_way::{Step, UnderWay};

/// Who decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum GateMode {
    /// The gate, by the cost of frames.
    #[default]
    Auto,
    /// Always on.
    On,
    /// Always off.
    Off,
}

/// Longest stretch of a whole trial, nanoseconds: three of them, the frames ahead and the settling fit into 30 s at 2 Hz.
pub const STRETCH_NS: i64 = 8_000_000_000;

/// Whole trials of a scene: the second only where the first was undecided, but promised a saving.
const WHOLE: u8 = 2;

/// Longest stretch of a control, nanoseconds.
pub const CONTROL_NS: i64 = 2_000_000_000;

/// Least time from one whole trial to the next that may be seen, nanoseconds.
pub const TRIAL_REST_NS: i64 = 60_000_000_000;

/// Least time from one trial to a control that may be seen, nanoseconds: one switch in five minutes.
pub const CONTROL_REST_NS: i64 = 600_000_000_000;

/// Least time from one trial to a control that nobody sees, nanoseconds.
pub const HIDDEN_REST_NS: i64 = 300_000_000_000;

/// Time from an undecided trial to the next that nobody sees, nanoseconds; doubled each time, up to [`HIDDEN_REST_NS`].
pub const RETRY_REST_NS: i64 = 30_000_000_000;

/// Longest wait of a switch for a saccade or blink, nanoseconds, of eyes that had one within twice that time.
const HIDING_NS: i64 = 1_000_000_000;

/// Costs that are enough ahead of a trial where frames are slow: so many frames, or half a stretch.
const LEAST: usize = 8;

/// Time for which a technique that has come on costs more than later, nanoseconds: rates become coarse over a quarter of a second, once
/// the gaze is known. Earlier costs do not count for the state that trials compare with.
const RAMP_NS: i64 = 500_000_000;

/// Frames after a switch that do not count: CPU time between two frames has work of the frame before in it, and up to two
/// frames are under way.
const SETTLING: u32 = 2;

/// A frame that was rendered, as a gate sees it. Its cost may be known later than the frame was; frames come in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GateFrame {
    /// Now, nanoseconds on any one clock.
    pub time_ns: i64,
    /// Time *spent* on the frame, nanoseconds, never the time between frames, which a display's clock or a frame limiter can pin: GPU
    /// time of the whole frame, our own work with it, or CPU time of the process where a CPU renders. None if unknown.
    pub cost_ns: Option<u64>,
    /// Whether the technique was at work in that frame.
    pub was_on: bool,
    /// Phase of the gaze now.
    pub phase: GazePhase,
    /// The set of eye passes of that frame, as any number that tells one set from another. None without passes.
    pub passes: Option<u32>,
    /// Whether the frame waited for something that the technique cannot change. Its processors may have slept or clocked
    /// down: its cost does not count, and no trial begins.
    pub waited: bool,
}

/// Judges one technique. Holds no clock; allocates nothing.
#[derive(Clone, Debug)]
pub struct Gate {
    mode: GateMode,
    /// Where it is when it is not away.
    stands_on: bool,
    trial: Option<UnderWay>,
    evidence: Evidence,
    scenes: Scenes,
    before: Before,
    /// Frames in a row with the technique as it was in the last.
    same: u32,
    last_was_on: bool,
    /// When the technique came on last.
    on_since_ns: i64,
    /// Whole trials that the scene may still have with open eyes.
    whole_left: u8,
    /// Undecided trials since the last decision.
    undecided: u32,
    last_trial_ns: Option<i64>,
    last_whole_ns: Option<i64>,
    last_hidden_ns: Option<i64>,
    wants_costs: bool,
}

impl Gate {
    /// A gate that has seen nothing. [`GateMode::Auto`] begins at on, and stays there as long as no cost is known.
    pub fn new(mode: GateMode) -> Self {
        Self {
            mode,
            stands_on: true,
            trial: None,
            evidence: Evidence::default(),
            scenes: Scenes::default(),
            before: Before::default(),
            same: 0,
            last_was_on: false,
            on_since_ns: 0,
            whole_left: WHOLE,
            undecided: 0,
            last_trial_ns: None,
            last_whole_ns: None,
            last_hidden_ns: None,
            wants_costs: true,
        }
    }

    /// Who decides.
    pub fn mode(&self) -> GateMode {
        self.mode
    }

    /// Changes who decides. Decisions stay; a trial under way ends without one.
    pub fn set_mode(&mut self, mode: GateMode) {
        if self.mode != mode {
            self.trial = None;
            self.before.clear();
        }
        self.mode = mode;
    }

    /// Whether the technique is to be at work in the next frame.
    pub fn is_on(&self) -> bool {
        match (self.mode, &self.trial) {
            (GateMode::On, _) => true,
            (GateMode::Off, _) => false,
            (GateMode::Auto, None) => self.stands_on,
            (GateMode::Auto, Some(under_way)) => under_way.trial.is_on(),
        }
    }

    /// Whether the technique is kept, apart from trials.
    pub fn is_kept(&self) -> bool {
        match self.mode {
            GateMode::On => true,
            GateMode::Off => false,
            GateMode::Auto => self.stands_on,
        }
    }

    /// The result of the last trial, and during the first trial the result so far, for people.
    pub fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// Whether a trial is under way.
    pub fn is_trying(&self) -> bool {
        self.trial.is_some()
    }

    /// Whether costs of frames are of use now: a trial is under way or due. Between trials nobody needs to measure.
    pub fn wants_costs(&self) -> bool {
        self.mode == GateMode::Auto && self.wants_costs
    }

    /// Takes a frame that was rendered; says whether the technique is to be at work in the next.
    ///
    /// `may_begin`: whether a trial may begin now; another gate's may be under way.
    pub fn frame(&mut self, frame: &GateFrame, may_begin: bool) -> bool {
        if self.mode != GateMode::Auto {
            return self.is_on();
        }
        let now = frame.time_ns;
        for last in [&mut self.last_trial_ns, &mut self.last_whole_ns, &mut self.last_hidden_ns] {
            // A clock that starts anew starts the rest anew.
            *last = last.map(|last| last.min(now));
        }
        if is_hidden(frame.phase) {
            self.last_hidden_ns = Some(now);
        }
        if self.scenes.frame(frame.passes, now) {
            self.begin_scene(now);
        }
        self.take(frame);
        if self.trial.is_some() {
            self.go_on(frame);
        } else if may_begin && !frame.waited && self.is_due(is_hidden(frame.phase), now) {
            self.begin_trial(now);
        }
        let eyes_move = !has_passed(self.last_hidden_ns, 10 * HIDING_NS, now);
        self.wants_costs = self.trial.is_some() || self.is_due(eyes_move, now);
        self.is_on()
    }

    /// Begins another scene with its earlier decision, or else with a whole trial.
    fn begin_scene(&mut self, now: i64) {
        if self.trial.take().is_some() {
            self.last_trial_ns = Some(now);
        }
        self.before.clear();
        self.undecided = 0;
        let decision = self.scenes.decision();
        self.whole_left = if decision.is_none() { WHOLE } else { 0 };
        self.evidence = decision.map(|decision| decision.evidence).unwrap_or_default();
        self.stands_on = decision.map_or(self.stands_on, |decision| decision.is_on);
    }

    /// Puts the frame's cost where it belongs.
    fn take(&mut self, frame: &GateFrame) {
        self.same = if frame.was_on == self.last_was_on { self.same.saturating_add(1) } else { 0 };
        // A clock that starts anew starts the ramp anew.
        let came_on = frame.was_on && (!self.last_was_on || frame.time_ns < self.on_since_ns);
        if came_on {
            self.on_since_ns = frame.time_ns;
        }
        self.last_was_on = frame.was_on;
        let is_ramping = frame.was_on && !has_passed(Some(self.on_since_ns), RAMP_NS, frame.time_ns);
        let cost = frame.cost_ns.filter(|&cost| cost > 0 && !frame.waited && self.same >= SETTLING);
        let Some(cost) = cost.filter(|_| self.scenes.is_current(frame.passes)) else { return };
        let cost = Cost { time_ns: frame.time_ns, ln: (cost as f64).ln() as f32 };
        match &mut self.trial {
            Some(under_way) if frame.was_on == under_way.trial.is_on() => under_way.trial.push(cost),
            None if frame.was_on == self.stands_on && !is_ramping => self.before.push(cost),
            _ => {}
        }
    }

    /// Whether it is time for a trial, with open eyes or not.
    fn is_due(&self, hidden: bool, now: i64) -> bool {
        if self.whole_left > 0 {
            return has_passed(self.last_whole_ns, TRIAL_REST_NS, now) || hidden;
        }
        let hidden_rest = match self.undecided {
            0 => HIDDEN_REST_NS,
            trials => RETRY_REST_NS.saturating_mul(1 << (trials - 1).min(8)).min(HIDDEN_REST_NS),
        };
        has_passed(self.last_trial_ns, CONTROL_REST_NS, now)
            || hidden && has_passed(self.last_trial_ns, hidden_rest, now)
    }

    /// Begins a trial, if there are costs to compare with.
    fn begin_trial(&mut self, now: i64) {
        let is_seen = self.last_hidden_ns != Some(now);
        let is_control = self.whole_left == 0 && (self.undecided == 0 || is_seen);
        let before = self.before.since(now.saturating_sub(STRETCH_NS));
        let span = before.first().map_or(0, |first| now.saturating_sub(first.time_ns));
        if before.len() < LEAST || (before.len() < BEFORE && span < STRETCH_NS / 2) {
            return;
        }
        let trial = Trial::begin(now, self.stands_on, before);
        self.trial = Some(UnderWay::begin(trial, is_control, self.whole_left > 0, now));
    }

    /// Goes on with the trial under way.
    fn go_on(&mut self, frame: &GateFrame) {
        let now = frame.time_ns;
        let Some(under_way) = &mut self.trial else { return };
        under_way.next = under_way.next.or_else(|| Some((under_way.step(now)?, now)));
        if self.evidence.verdict() == Verdict::Unclear
            && under_way.trial.at() > 1
            && under_way.latest.is_some()
        {
            self.evidence = Evidence::new(under_way.latest, Verdict::Unclear);
        }
        let Some((step, since)) = under_way.next else { return };
        let is_on_after = match step {
            Step::Switch => !under_way.trial.is_on(),
            Step::GiveUp => self.stands_on,
            Step::End(_, Verdict::Unclear) if under_way.is_control => self.stands_on,
            Step::End(_, verdict) => verdict == Verdict::Pays,
        };
        let may_switch = is_hidden(frame.phase)
            || has_passed(self.last_hidden_ns, 2 * HIDING_NS, now)
            || has_passed(Some(since.min(now)), HIDING_NS, now);
        if is_on_after != under_way.trial.is_on() && !may_switch {
            return;
        }
        under_way.next = None;
        let is_control = under_way.is_control;
        match step {
            Step::Switch => return under_way.switch(now),
            Step::End(_, Verdict::Unclear) if is_control => {}
            Step::End(estimate, verdict) => self.decide(estimate, verdict),
            Step::GiveUp => {
                self.whole_left = 0;
                self.undecided = self.undecided.saturating_add(1);
            }
        }
        self.trial = None;
        self.before.clear();
        self.last_trial_ns = Some(now);
        if !is_control {
            self.last_whole_ns = Some(now);
        }
    }

    fn decide(&mut self, estimate: Option<Estimate>, verdict: Verdict) {
        self.stands_on = verdict == Verdict::Pays;
        self.undecided = if verdict == Verdict::Unclear { self.undecided.saturating_add(1) } else { 0 };
        let is_promising = estimate.is_some_and(|estimate| estimate.is_promising());
        self.whole_left =
            if is_promising && verdict == Verdict::Unclear { self.whole_left.saturating_sub(1) } else { 0 };
        self.evidence = Evidence::new(estimate, verdict);
        self.scenes.decide(Decision { is_on: self.stands_on, evidence: self.evidence });
    }
}

/// Whether nobody sees a change of the picture now.
fn is_hidden(phase: GazePhase) -> bool {
    matches!(phase, GazePhase::Saccade | GazePhase::Blink)
}

fn has_passed(last_ns: Option<i64>, rest_ns: i64, now: i64) -> bool {
    last_ns.is_none_or(|last| now.saturating_sub(last) >= rest_ns)
}

#[cfg(test)]
mod tests;
