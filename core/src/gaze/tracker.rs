//! From samples of the eye tracker to the state of the gaze.

use super::{GazePhase, GazeSample, GazeState};
use crate::geometry::unit_direction;
use glam::Vec3;

mod velocity;

use velocity::Recent;

/// How the gaze is judged. The defaults suit any tracker of 60 Hz or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeSettings {
    /// How long the gaze may be missing as in a blink, milliseconds; the last one is held meanwhile. A blink takes 100
    /// to 400 ms (BioNumbers; Volkmann et al. 1980), the longest about 500.
    pub hold_ms: f32,
    /// How long trust takes from 1 to 0 after that, milliseconds. 200 ms keeps the change to uniform rates from
    /// showing as a flash; it is our choice.
    pub ramp_down_ms: f32,
    /// How long trust takes from 0 to 1 once samples are valid again, milliseconds.
    pub ramp_up_ms: f32,
    /// Speed from which on the eyes are in a saccade, degrees a second: the velocity threshold of I-VT (Salvucci
    /// and Goldberg 2000), above pursuit, which the eyes follow up to about 100.
    pub saccade_onset_deg_s: f32,
    /// Speed below which the saccade is over, degrees a second; lower than the onset, so that a speed near one
    /// threshold does not flicker between the two.
    pub saccade_end_deg_s: f32,
    /// How long after a saccade nothing may become coarser, milliseconds: the 60 ms within which an update after
    /// landing goes unnoticed (Loschky and Wolverton 2007).
    pub post_saccade_ms: f32,
}

impl Default for GazeSettings {
    fn default() -> Self {
        Self {
            hold_ms: 500.0,
            ramp_down_ms: 200.0,
            ramp_up_ms: 200.0,
            saccade_onset_deg_s: 100.0,
            saccade_end_deg_s: 50.0,
            post_saccade_ms: 60.0,
        }
    }
}

/// Without a sample for longer than this, the eyes are taken as not seen: three frames of a 60 Hz tracker.
const SILENT_NS: i64 = 50_000_000;

/// Longest saccade. 21 + 2.2 ms per degree (Carpenter) makes 80 degrees 197 ms; what stays fast for longer is the eye
/// turning against the head, with which one does see.
const LONGEST_SACCADE_NS: i64 = 200_000_000;

/// The gaze as a state machine over samples. Holds no clock: every time is passed in.
///
/// Samples may come late, twice or in the wrong order. One that is older than the newest by up to the hold
/// time is dropped; by more, the source's clock has started anew, and trust with it.
#[derive(Clone, Debug)]
pub struct GazeTracker {
    settings: GazeSettings,
    /// Present once a sample was usable.
    seen: Option<Seen>,
    /// The source said that it has ended ([`Self::source_ended`]).
    ended: bool,
}

/// What is known since the first usable sample.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// The newest usable samples.
    recent: Recent,
    /// Trust at the time of the newest usable sample.
    trust: f32,
    /// Whether an unusable sample came since.
    interrupted: bool,
    motion: Motion,
}

/// What the eyes did last, with the time of the sample that showed it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    FastSince(i64),
    SlowSince(i64),
}

impl GazeTracker {
    /// A tracker that has seen nothing yet: [`GazeState::LOST`]. Settings that are negative or NaN count as 0.
    pub fn new(settings: GazeSettings) -> Self {
        Self { settings, seen: None, ended: false }
    }

    /// Takes one sample. One without `valid` or without a usable direction for either eye is a missing gaze.
    pub fn push(&mut self, sample: &GazeSample) {
        let Some(directions) = usable(sample) else {
            if let Some(seen) = &mut self.seen {
                seen.interrupted = true;
            }
            return;
        };
        let time = sample.time_ns;
        let next = match &self.seen {
            Some(seen) if !self.ended => match self.follow(seen, directions, time) {
                Some(next) => next,
                None => return,
            },
            // Found for the first time, or again: trust begins with the next sample.
            _ => Seen {
                recent: Recent::new(directions, time),
                trust: self.trust_at(time),
                interrupted: false,
                motion: Motion::SlowSince(time),
            },
        };
        self.ended = false;
        self.seen = Some(next);
    }

    /// The source itself says that there is no gaze any more (an inactive action, an error): trust ramps down
    /// from `time_ns` on, without the hold that a blink gets.
    pub fn source_ended(&mut self, time_ns: i64) {
        let trust = self.trust_at(time_ns);
        if let Some(seen) = &mut self.seen
            && !self.ended
        {
            seen.trust = trust;
            seen.recent = Recent::new(seen.recent.directions(), time_ns);
            self.ended = true;
        }
    }

    /// The gaze at `now_ns`, on the clock of the samples. A time before the newest sample
    /// (samples may be predictions) is as good as one that is as far after it.
    pub fn state(&self, now_ns: i64) -> GazeState {
        let Some(seen) = &self.seen else { return GazeState::LOST };
        let phase = self.phase(seen, now_ns);
        let visible = !matches!(phase, GazePhase::Blink | GazePhase::Lost);
        GazeState {
            directions: seen.recent.directions(),
            velocity_deg_s: if visible { seen.recent.velocity_deg_s() } else { 0.0 },
            phase,
            trust: self.trust_at(now_ns),
        }
    }

    /// The state after a usable sample, or nothing when the sample is too old to be used.
    fn follow(&self, seen: &Seen, directions: [Vec3; 2], time: i64) -> Option<Seen> {
        let gap = time.saturating_sub(seen.recent.time_ns());
        let hold = nanoseconds(self.settings.hold_ms);
        if gap < 0 && gap >= -hold {
            return None;
        }
        if !(0..=SILENT_NS).contains(&gap) || seen.interrupted {
            // Where the eyes went meanwhile is unknown: no speed, and the same care as after a saccade.
            let trust = if gap < 0 { 0.0 } else { self.trust_at(time) };
            return Some(Seen {
                recent: Recent::new(directions, time),
                trust,
                interrupted: false,
                motion: Motion::SlowSince(time),
            });
        }
        let recent = seen.recent.with(directions, time);
        Some(Seen {
            recent,
            trust: (seen.trust + portion(gap, self.settings.ramp_up_ms)).min(1.0),
            interrupted: false,
            motion: self.motion_after(seen.motion, recent.velocity_deg_s(), time),
        })
    }

    fn motion_after(&self, before: Motion, velocity_deg_s: f32, time: i64) -> Motion {
        let fast = match before {
            Motion::FastSince(_) => velocity_deg_s >= self.settings.saccade_end_deg_s,
            Motion::SlowSince(_) => velocity_deg_s >= self.settings.saccade_onset_deg_s,
        };
        match (before, fast) {
            (Motion::FastSince(_), true) | (Motion::SlowSince(_), false) => before,
            (Motion::FastSince(_), false) => Motion::SlowSince(time),
            (Motion::SlowSince(_), true) => Motion::FastSince(time),
        }
    }

    fn phase(&self, seen: &Seen, now: i64) -> GazePhase {
        let age = distance_ns(now, seen.recent.time_ns());
        if self.ended || age > nanoseconds(self.settings.hold_ms) {
            return GazePhase::Lost;
        }
        if seen.interrupted || age > SILENT_NS {
            return GazePhase::Blink;
        }
        match seen.motion {
            Motion::FastSince(onset) if now.saturating_sub(onset) <= LONGEST_SACCADE_NS => GazePhase::Saccade,
            Motion::FastSince(_) => GazePhase::PostSaccade,
            Motion::SlowSince(end)
                if now.saturating_sub(end) < nanoseconds(self.settings.post_saccade_ms) =>
            {
                GazePhase::PostSaccade
            }
            Motion::SlowSince(_) => GazePhase::Fixation,
        }
    }

    /// As it was with the newest usable sample until the hold is over, then falling.
    fn trust_at(&self, now: i64) -> f32 {
        let Some(seen) = &self.seen else { return 0.0 };
        let hold = if self.ended { 0 } else { nanoseconds(self.settings.hold_ms) };
        let overdue = distance_ns(now, seen.recent.time_ns()) - hold;
        if overdue <= 0 {
            seen.trust
        } else {
            (seen.trust - portion(overdue, self.settings.ramp_down_ms)).max(0.0)
        }
    }
}

/// Unit directions of both eyes; an eye that is not seen takes the other's. Nothing if neither is.
fn usable(sample: &GazeSample) -> Option<[Vec3; 2]> {
    if !sample.valid {
        return None;
    }
    match sample.directions.map(unit_direction) {
        [Some(left), Some(right)] => Some([left, right]),
        [Some(one), None] | [None, Some(one)] => Some([one; 2]),
        [None, None] => None,
    }
}

/// How far apart two times are, whichever is first.
fn distance_ns(a: i64, b: i64) -> i64 {
    a.saturating_sub(b).saturating_abs()
}

/// Milliseconds as whole nanoseconds; negative and NaN are 0.
fn nanoseconds(ms: f32) -> i64 {
    (f64::from(ms.max(0.0)) * 1e6) as i64
}

/// Which part of a ramp of `ramp_ms` passes in `span_ns` >= 0: 0..=1; all of a ramp that takes no time.
fn portion(span_ns: i64, ramp_ms: f32) -> f32 {
    let ramp = nanoseconds(ramp_ms);
    if span_ns >= ramp { 1.0 } else { (span_ns as f64 / ramp as f64) as f32 }
}
