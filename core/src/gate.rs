//! The benefit gate: whether a technique pays in this application, by what frames cost with it and without it.
//!
//! [`Gate`] judges one technique. It stands at *on* or *off* and looks at the other side by *excursions*: it leaves its
//! stand for a few frames, comes back, and compares the median of what the frames cost there with the median of those just
//! before and just after, so that what changes slowly falls on both sides. The logarithms of these ratios are the
//! [`Evidence`]; the stand changes when Student's t says with [`CONFIDENCE`] that the other side is cheaper by more than
//! [`MARGIN`]. In between nothing changes: that is the hysteresis.
//!
//! When it leaves its stand:
//! - at the start and after a change of scene, one excursion after the other, until it is sure or [`BURST`] are done;
//! - in saccades and blinks, where nobody sees it: every [`HIDDEN_REST_NS`] while it is not sure, else every
//!   [`VISIBLE_REST_NS`]; it comes back, and changes its stand, in a saccade or blink too;
//! - with open eyes at most once in [`VISIBLE_REST_NS`].
//!
//! [`Gates`] has one for shading rates and one for re-use, of which at most one is away at any time.

mod both;
mod costs;
mod evidence;

pub use both::{Gates, JudgedFrame, Techniques};
pub use evidence::{CONFIDENCE, Evidence, MARGIN, Verdict};

use crate::gaze::GazePhase;
use costs::Costs;

/// Who decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum GateMode {
    /// The gate, by what frames cost.
    #[default]
    Auto,
    /// Always on.
    On,
    /// Always off.
    Off,
}

/// Longest series of excursions, one after the other, at the start and after a change of scene.
pub const BURST: u32 = 16;

/// Least time between the beginnings of two such series, nanoseconds: an application that changes all the time is not
/// probed all the time.
pub const BURST_REST_NS: i64 = 5_000_000_000;

/// Least time between excursions that nobody sees, nanoseconds, while the gate is not sure.
pub const HIDDEN_REST_NS: i64 = 2_000_000_000;

/// Least time between excursions that may be seen, nanoseconds; also of hidden ones, once the gate is sure.
pub const VISIBLE_REST_NS: i64 = 30_000_000_000;

/// Frames that are measured on each side of an excursion in a series, or in a saccade or blink: with
/// [`GateFrame::cost_ns`] at 90 Hz, these and the settling fit into a blink, and the median bears one outlier.
const SHORT: usize = 4;

/// Frames on each side of an excursion with open eyes, of which there are few.
const LONG: usize = 16;

/// Frames after a change that are not counted: CPU time between two frames has work of the frame before in it, and up to
/// two frames are under way.
const SETTLING: u32 = 2;

/// An excursion that takes so many times its frames is given up: its costs do not come.
const PATIENCE: u32 = 8;

/// A frame that was rendered, as a gate sees it. Its cost may be known later than the frame was; frames come in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GateFrame {
    /// Now, nanoseconds on any one clock.
    pub time_ns: i64,
    /// Time *spent* on the frame, never the time between frames, which a display's clock or a frame limiter can pin: GPU
    /// time of the passes that the technique touches together with our own work for it, or CPU time of the process where
    /// a CPU renders. Nanoseconds; none where it is not known.
    pub cost_ns: Option<u64>,
    /// Whether the technique was at work in that frame.
    pub was_on: bool,
    /// What the eyes do now.
    pub phase: GazePhase,
    /// Whether other passes were matched in that frame than in the one before: costs from before do not compare.
    pub scene_changed: bool,
    /// Whether the frame waited for something that the technique cannot change. Its processors may have slept or clocked
    /// down: its cost does not count, and nothing is begun or decided.
    pub waited: bool,
}

/// Judges one technique. Holds no clock; allocates nothing.
#[derive(Clone, Debug)]
pub struct Gate {
    mode: GateMode,
    /// Where it is when it is not away.
    stands_on: bool,
    stage: Stage,
    evidence: Evidence,
    /// The newest costs at its stand.
    before: Costs,
    /// Frames in a row with the technique as it was in the last.
    same: u32,
    last_was_on: bool,
    /// Excursions left of a series.
    burst: u32,
    burst_due: bool,
    last_burst_ns: Option<i64>,
    last_visible_ns: Option<i64>,
    last_excursion_ns: Option<i64>,
}

/// Where it is.
#[derive(Clone, Copy, Debug)]
enum Stage {
    Standing,
    /// On the other side.
    Away(Excursion),
    /// At its stand again, to compare.
    Back(Excursion),
}

/// What was measured of an excursion.
#[derive(Clone, Copy, Debug)]
struct Excursion {
    /// Whether it ends in a saccade or blink alone, as it began.
    hidden: bool,
    /// Frames on each side.
    frames: usize,
    /// Frames in this stage.
    age: u32,
    /// Costs at its stand, half from before, half from after.
    standing: Costs,
    away: Costs,
}

impl Excursion {
    fn is_too_long(&self) -> bool {
        self.age > PATIENCE * (self.frames as u32 + SETTLING)
    }
}

impl Gate {
    /// A gate that has seen nothing. [`GateMode::Auto`] begins at on: what is there is expected to pay.
    pub fn new(mode: GateMode) -> Self {
        Self {
            mode,
            stands_on: true,
            stage: Stage::Standing,
            evidence: Evidence::default(),
            before: Costs::new(LONG / 2),
            same: 0,
            last_was_on: false,
            burst: 0,
            burst_due: true,
            last_burst_ns: None,
            last_visible_ns: None,
            last_excursion_ns: None,
        }
    }

    /// Who decides.
    pub fn mode(&self) -> GateMode {
        self.mode
    }

    /// Changes who decides. What is known stays.
    pub fn set_mode(&mut self, mode: GateMode) {
        self.mode = mode;
    }

    /// Whether the technique is to be at work in the next frame.
    pub fn is_on(&self) -> bool {
        match self.mode {
            GateMode::On => true,
            GateMode::Off => false,
            GateMode::Auto => self.stands_on != matches!(self.stage, Stage::Away(_)),
        }
    }

    /// Whether the technique is kept, apart from excursions.
    pub fn is_kept(&self) -> bool {
        match self.mode {
            GateMode::On => true,
            GateMode::Off => false,
            GateMode::Auto => self.stands_on,
        }
    }

    /// What is known of the costs, for people.
    pub fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// Whether an excursion is under way, and frames are not as the gate would have them.
    pub fn is_away(&self) -> bool {
        self.mode == GateMode::Auto && !matches!(self.stage, Stage::Standing)
    }

    /// Takes a frame that was rendered; says whether the technique is to be at work in the next.
    ///
    /// `may_leave`: whether an excursion may begin now; another gate's may be under way.
    pub fn frame(&mut self, frame: &GateFrame, may_leave: bool) -> bool {
        if self.mode != GateMode::Auto {
            return self.is_on();
        }
        let now = frame.time_ns;
        for last in [&mut self.last_burst_ns, &mut self.last_visible_ns, &mut self.last_excursion_ns] {
            // A clock that starts anew starts the rest anew.
            *last = last.map(|last| last.min(now));
        }
        if frame.scene_changed {
            self.forget();
        }
        self.take(frame);
        self.step(frame, may_leave);
        self.is_on()
    }

    /// Another scene: what was measured is of the old one.
    fn forget(&mut self) {
        self.evidence.clear();
        self.before.clear();
        self.stage = Stage::Standing;
        self.burst = 0;
        self.burst_due = true;
    }

    /// Puts the frame's cost where it belongs.
    fn take(&mut self, frame: &GateFrame) {
        self.same = if frame.was_on == self.last_was_on { self.same.saturating_add(1) } else { 0 };
        self.last_was_on = frame.was_on;
        if frame.waited {
            self.before.clear();
        }
        if let Stage::Away(excursion) | Stage::Back(excursion) = &mut self.stage {
            excursion.age = excursion.age.saturating_add(1);
        }
        let usable = frame.cost_ns.filter(|&cost| cost > 0 && !frame.waited && self.same >= SETTLING);
        let Some(cost) = usable else { return };
        let at_stand = frame.was_on == self.stands_on;
        match &mut self.stage {
            Stage::Standing if at_stand => self.before.push(cost),
            Stage::Away(excursion) if !at_stand && excursion.away.len() < excursion.frames => {
                excursion.away.push(cost);
            }
            Stage::Back(excursion) if at_stand => excursion.standing.push(cost),
            _ => {}
        }
    }

    fn step(&mut self, frame: &GateFrame, may_leave: bool) {
        match self.stage {
            Stage::Standing => self.stand(frame, may_leave),
            Stage::Away(excursion) => self.come_back(frame, excursion),
            Stage::Back(excursion) if excursion.standing.len() == excursion.frames => {
                self.stage = Stage::Standing;
                self.conclude(&excursion);
                self.stand(frame, false);
            }
            Stage::Back(excursion) if excursion.is_too_long() => self.stage = Stage::Standing,
            Stage::Back(_) => {}
        }
    }

    fn stand(&mut self, frame: &GateFrame, may_leave: bool) {
        if frame.waited {
            return;
        }
        let now = frame.time_ns;
        if self.burst_due && has_passed(self.last_burst_ns, BURST_REST_NS, now) {
            self.burst_due = false;
            self.burst = BURST;
            self.last_burst_ns = Some(now);
        }
        let hidden = is_hidden(frame.phase);
        let may_be_seen = self.burst > 0 || has_passed(self.last_visible_ns, VISIBLE_REST_NS, now);
        let verdict = self.evidence.verdict();
        if verdict.wants_on().is_some_and(|wanted| wanted != self.stands_on) && (hidden || may_be_seen) {
            self.stands_on = !self.stands_on;
            self.before.clear();
            self.burst = 0;
            if !hidden {
                self.last_visible_ns = Some(now);
            }
            return;
        }
        if verdict != Verdict::Unclear {
            self.burst = 0;
        }
        if !may_leave {
            return;
        }
        let rest = if verdict == Verdict::Unclear && !self.evidence.is_full() {
            HIDDEN_REST_NS
        } else {
            VISIBLE_REST_NS
        };
        if self.burst > 0 {
            if self.leave(now, SHORT, false) {
                self.burst -= 1;
                self.last_visible_ns = Some(now);
            }
        } else if hidden && has_passed(self.last_excursion_ns, rest, now) {
            self.leave(now, SHORT, true);
        } else if has_passed(self.last_visible_ns, VISIBLE_REST_NS, now) && self.leave(now, LONG, false) {
            self.last_visible_ns = Some(now);
        }
    }

    /// Begins an excursion, if enough is known to compare with.
    fn leave(&mut self, now: i64, frames: usize, hidden: bool) -> bool {
        let mut standing = Costs::new(frames);
        if !self.before.newest(frames / 2, &mut standing) {
            return false;
        }
        let away = Costs::new(frames);
        self.stage = Stage::Away(Excursion { hidden, frames, age: 0, standing, away });
        self.last_excursion_ns = Some(now);
        true
    }

    fn come_back(&mut self, frame: &GateFrame, excursion: Excursion) {
        let full = excursion.away.len() == excursion.frames;
        if !full && !excursion.is_too_long() {
            return;
        }
        let hidden = is_hidden(frame.phase);
        let may_be_seen =
            !excursion.hidden || has_passed(self.last_visible_ns, VISIBLE_REST_NS, frame.time_ns);
        if !hidden && !may_be_seen {
            return;
        }
        if excursion.hidden && !hidden {
            self.last_visible_ns = Some(frame.time_ns);
        }
        self.before.clear();
        self.stage = if full { Stage::Back(Excursion { age: 0, ..excursion }) } else { Stage::Standing };
    }

    fn conclude(&mut self, excursion: &Excursion) {
        let (away, standing) = (excursion.away.median(), excursion.standing.median());
        let (on, off) = if self.stands_on { (standing, away) } else { (away, standing) };
        self.evidence.push((on / off).ln());
    }
}

/// Whether nobody sees what changes now.
fn is_hidden(phase: GazePhase) -> bool {
    matches!(phase, GazePhase::Saccade | GazePhase::Blink)
}

fn has_passed(last_ns: Option<i64>, rest_ns: i64, now: i64) -> bool {
    last_ns.is_none_or(|last| now.saturating_sub(last) >= rest_ns)
}

#[cfg(test)]
mod tests;
