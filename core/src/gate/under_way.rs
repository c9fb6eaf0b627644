//! The course of one trial: looks at its costs, switches, and its end.

use super::estimate::{Estimate, FINAL, STRICT};
use super::trial::{STRETCHES, Trial};
use super::{CONTROL_NS, LEAST, STRETCH_NS, Verdict};

/// A stretch without enough costs is given up after so many times its longest time.
const PATIENCE: i64 = 4;

/// A trial under way.
#[derive(Clone, Debug)]
pub(super) struct UnderWay {
    pub(super) trial: Trial,
    /// Whether it is a control, or a whole trial.
    pub(super) is_control: bool,
    /// Whether it is one of the first of its scene, at whose end [`FINAL`] decides.
    is_early: bool,
    stretch_began_ns: i64,
    /// Frames of the stretch at which the costs are looked at next.
    next_look: usize,
    /// The next step, and since when it waits for the eyes.
    pub(super) next: Option<(Step, i64)>,
    /// At the last look.
    pub(super) latest: Option<Estimate>,
}

/// Outcome of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// The next stretch begins.
    Switch,
    /// The trial ends with that.
    End(Option<Estimate>, Verdict),
    /// Its costs do not come.
    GiveUp,
}

impl UnderWay {
    /// A trial that leaves the stand at `now_ns`.
    pub(super) fn begin(trial: Trial, is_control: bool, is_early: bool, now_ns: i64) -> Self {
        Self {
            trial,
            is_control,
            is_early,
            stretch_began_ns: now_ns,
            next_look: LEAST,
            next: None,
            latest: None,
        }
    }

    /// The next step, if it is time for one.
    pub(super) fn step(&mut self, now: i64) -> Option<Step> {
        self.stretch_began_ns = self.stretch_began_ns.min(now);
        let passed = now.saturating_sub(self.stretch_began_ns);
        let longest = if self.is_control { CONTROL_NS } else { STRETCH_NS };
        let [frames, frames_before] = self.trial.frames();
        let is_over = passed >= longest && frames >= LEAST;
        let least = if self.trial.at() == 2 { frames_before.min(4 * LEAST) } else { LEAST };
        if frames >= self.next_look.max(least) || is_over {
            self.next_look = 2 * frames.max(LEAST);
            let estimate = self.trial.estimate();
            self.latest = estimate;
            let verdict = |quantile| estimate.map_or(Verdict::Unclear, |estimate| estimate.verdict(quantile));
            let strict = verdict(STRICT);
            let is_last = self.trial.at() == if self.is_control { 2 } else { STRETCHES - 1 };
            match (self.trial.at(), strict) {
                (1, Verdict::Pays | Verdict::DoesNotPay) => return Some(Step::Switch),
                (_, Verdict::Pays | Verdict::DoesNotPay) if self.trial.at() > 1 => {
                    return Some(Step::End(estimate, strict));
                }
                _ if is_over && is_last && self.is_early => {
                    return Some(Step::End(estimate, verdict(FINAL)));
                }
                _ if is_over && is_last => return Some(Step::End(estimate, Verdict::Unclear)),
                _ if is_over => return Some(Step::Switch),
                _ => {}
            }
        }
        (passed >= PATIENCE * longest).then_some(Step::GiveUp)
    }

    /// Begins the next stretch.
    pub(super) fn switch(&mut self, now: i64) {
        self.trial.switch();
        self.stretch_began_ns = now;
        self.next_look = LEAST;
    }
}
