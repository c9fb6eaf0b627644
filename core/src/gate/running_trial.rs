//! The course of one trial: interim estimates, switches, and its end.

use super::comparison::Comparison;
use super::estimate::{Estimate, FINAL, STRICT};
use super::trial::{SEGMENTS, Trial};
use super::{CONTROL_NS, LEAST, RAMP_NS, SEGMENT_NS, Verdict};

/// A segment without enough costs ends the trial after this multiple of its longest time.
const PATIENCE: i64 = 4;

/// A running trial.
#[derive(Clone, Debug)]
pub(super) struct RunningTrial {
    pub(super) trial: Trial,
    /// Whether it is a control; else a full trial.
    pub(super) is_control: bool,
    /// Whether it is one of the first of its scene, which [`FINAL`] decides at the end.
    is_early: bool,
    segment_began_ns: i64,
    /// Frames of the segment at the next interim estimate.
    next_estimate: usize,
    /// The next step, and the time since which it waits for a saccade or blink.
    pub(super) next: Option<(Step, i64)>,
    /// The last interim estimate.
    pub(super) latest: Option<Estimate>,
}

/// Outcome of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// The next segment begins.
    Switch,
    /// The trial ends with that.
    End(Option<Comparison>, Verdict),
    /// The trial ends without enough costs.
    GiveUp,
}

impl RunningTrial {
    /// A trial that begins at `now_ns`.
    pub(super) fn begin(trial: Trial, is_control: bool, is_early: bool, now_ns: i64) -> Self {
        Self {
            trial,
            is_control,
            is_early,
            segment_began_ns: now_ns,
            next_estimate: LEAST,
            next: None,
            latest: None,
        }
    }

    /// The next step, if one is due.
    pub(super) fn step(&mut self, now: i64) -> Option<Step> {
        self.segment_began_ns = self.segment_began_ns.min(now);
        let passed = now.saturating_sub(self.segment_began_ns);
        let counted = if self.is_control { CONTROL_NS } else { SEGMENT_NS };
        let longest = counted + if self.trial.is_on() && self.trial.at() > 0 { RAMP_NS } else { 0 };
        let [frames, frames_before] = self.trial.frames();
        let is_over = passed >= longest && frames >= LEAST;
        let least = if self.trial.at() == 2 { frames_before.min(4 * LEAST) } else { LEAST };
        if frames >= self.next_estimate.max(least) || is_over {
            self.next_estimate = 2 * frames.max(LEAST);
            let comparison = self.trial.compare();
            self.latest = comparison.map(|comparison| comparison.estimate());
            let verdict =
                |quantile| comparison.map_or(Verdict::Unclear, |comparison| comparison.verdict(quantile));
            let strict = verdict(STRICT);
            let is_last = self.trial.at() == if self.is_control { 2 } else { SEGMENTS - 1 };
            match (self.trial.at(), strict) {
                (1, Verdict::Saves | Verdict::SavesNothing) => return Some(Step::Switch),
                (_, Verdict::Saves | Verdict::SavesNothing) if self.trial.at() > 1 => {
                    return Some(Step::End(comparison, strict));
                }
                _ if is_over && is_last && self.is_early => {
                    return Some(Step::End(comparison, verdict(FINAL)));
                }
                _ if is_over && is_last => return Some(Step::End(comparison, Verdict::Unclear)),
                _ if is_over => return Some(Step::Switch),
                _ => {}
            }
        }
        (passed >= PATIENCE * longest).then_some(Step::GiveUp)
    }

    /// Begins the next segment.
    pub(super) fn switch(&mut self, now: i64) {
        self.trial.switch();
        self.segment_began_ns = now;
        self.next_estimate = LEAST;
    }
}
