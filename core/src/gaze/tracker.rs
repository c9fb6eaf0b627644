//! From samples of the eye tracker to the state of the gaze.

use super::rejection::{Rejection, Views, plausible};
use super::settings::GazeSettings;
use super::{GazePhase, GazeSample, GazeState};
use crate::geometry::{Fov, rotation};
use glam::{Quat, Vec3};

mod freeze_detector;
mod head;
mod line_fit;
mod motion;
mod saccade;
mod sample_times;

use freeze_detector::FreezeDetector;
pub use freeze_detector::is_unchanged;
use head::Head;
use line_fit::EyeSample;
use motion::{EyeMovement, Motion};
use sample_times::SampleTimes;

/// Without a sample for longer than this, the eyes are taken as not seen: three frames of a 60 Hz tracker.
const SILENT_NS: i64 = 50_000_000;

/// The same of a slower tracker, in times between its samples.
const SILENT_INTERVALS: f32 = 2.5;

/// Longest time without a usable sample that counts as a lost sample: after a longer one, the eyes may be elsewhere.
const INTERRUPTION_NS: i64 = 30_000_000;

/// The same of a slower tracker, in times between its samples.
const INTERRUPTION_INTERVALS: f32 = 1.5;

/// Shortest blink: they take 100 ms and more, and trackers lose the eyes only while the lids cover the pupils.
const BLINK_NS: i64 = 50_000_000;

/// Uncertainty of a time that is not known: the greatest age beyond [`GazeSettings::latency_ms`] when the frame is shown, nanoseconds, 81 ms in
/// the slowest of three headsets with a cable (Stein et al. 2021), less 50.
const UNKNOWN_AGE_NS: i64 = 31_000_000;

/// Longest that a motion is carried on, and that a new time between samples counts: a longer one is an interruption.
const LONGEST_NS: i64 = 150_000_000;

/// The gaze as a state machine over samples. Holds no clock: every time is passed in. Allocates nothing.
///
/// In a frame: [`Self::push_at`] with the source's answer for the time when the frame is shown, and [`Self::state`] for that
/// time. Samples may come late, twice or in the wrong order. One that is older than the newest by up to the hold time is
/// dropped; by more, the source's clock has restarted, and trust with it.
#[derive(Clone, Debug)]
pub struct GazeTracker {
    settings: GazeSettings,
    /// Present once a sample was usable.
    seen: Option<Seen>,
    /// The source has ended ([`Self::source_ended`]), or is not believed any more.
    ended: bool,
    rejection: Option<Rejection>,
    freeze: FreezeDetector,
    times: SampleTimes,
    head: Head,
    views: Option<Views>,
    /// Time of the last answer of the source, usable or not; `None` before the first.
    answered_ns: Option<i64>,
}

/// State since the first usable sample.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// In the world.
    motion: Motion,
    /// As seen from the head.
    from_head: Motion,
    /// Orientation of the head at the newest sample, if known.
    head: Option<Quat>,
    /// Time at which the newest sample came, on the clock of the samples.
    arrived_ns: i64,
    /// Arrival of the last sample after a gap, or at the end of a saccade.
    settled_ns: i64,
    /// Trust when the newest came.
    trust: f32,
    /// Whether an unusable sample came since, long after it.
    interrupted: bool,
    /// Possible error of the time of the newest sample.
    uncertainty_ns: i64,
}

/// A plausible sample.
#[derive(Clone, Copy, Debug)]
struct Sighting {
    in_world: EyeSample,
    from_head: EyeSample,
}

impl Seen {
    /// Whether the eyes turn in the world only because the head does. The content that they follow keeps its place in the views.
    fn looks_along(&self) -> bool {
        let movements = (self.motion.movement(), self.from_head.movement());
        movements == (EyeMovement::Turning, EyeMovement::Resting) && self.motion.in_doubt().is_none()
    }

    /// Whether the newest sample is not long before a time.
    fn is_fresh(&self, time_ns: i64) -> bool {
        let age = time_ns.saturating_sub(self.motion.newest().time_ns);
        (0..silent_ns(&self.motion) / 5 * 4).contains(&age)
    }
}

impl GazeTracker {
    /// A tracker that has seen nothing yet: [`GazeState::LOST`].
    pub fn new(settings: GazeSettings) -> Self {
        Self {
            settings,
            seen: None,
            ended: false,
            rejection: None,
            freeze: FreezeDetector::default(),
            times: SampleTimes::default(),
            head: Head::default(),
            views: None,
            answered_ns: None,
        }
    }

    /// Takes one sample at its own time: [`Self::push_at`] for a source without latency.
    pub fn push(&mut self, sample: &GazeSample) {
        self.take(sample, sample.time_ns);
    }

    /// Takes the newest sample of the source at `now_ns` (in a frame, its display time, as for [`Self::state`]). A time of 0 or less is
    /// unknown, as in `XrEyeGazeSampleTimeEXT`. A time that is 20 ms or more ahead of `now_ns`, or 300 ms behind, is wrong, and so are all
    /// times within a second of it. A sample with an unknown or a wrong time counts as [`GazeSettings::latency_ms`] old, and as a
    /// repetition if it is within 0.005 degrees of the sample before. A sample without `valid` or without a plausible direction is a
    /// missing gaze, see [`Self::rejection`].
    pub fn push_at(&mut self, sample: &GazeSample, now_ns: i64) {
        let is_dated = sample.time_ns > 0;
        let is_old = is_dated && sample.valid && !self.times.take(sample.time_ns, now_ns);
        if is_dated && self.times.are_believed() {
            return self.take(sample, now_ns);
        }
        let time_ns = now_ns.saturating_sub(nanoseconds(self.settings.latency_ms));
        let repeated = sample.valid && self.freeze.is_same(sample.directions);
        if repeated && is_old {
            return;
        }
        match &mut self.seen {
            // The same as in the last frame: the source is slower than the display. Before that would be silence, it is a
            // gaze that rests.
            Some(seen) if repeated && self.rejection.is_none() && seen.is_fresh(time_ns) => {
                seen.arrived_ns = now_ns;
            }
            _ => {
                let uncertainty_ns = sample.uncertainty_ns.max(UNKNOWN_AGE_NS);
                self.take(&GazeSample { time_ns, uncertainty_ns, ..*sample }, now_ns);
            }
        }
    }

    /// Takes the orientation of the head (in any fixed space) at a time, on the clock of the samples: eyes turn against it, so that
    /// a gaze that rests in the world follows nothing, is where it was in the world when the frame is shown, and is in no saccade.
    /// One that turns with the head follows nothing either, and is where it was from the head; but one that does not change
    /// meanwhile is frozen. Without this call, the head counts as still.
    pub fn head_turned(&mut self, head: Quat, time_ns: i64) {
        if let Some(head) = rotation(head) {
            let angle_deg = self.head.turned(head, time_ns);
            self.freeze.head_turned(angle_deg);
        }
    }

    /// Sets the views: field of view, and rotation from the view's space to that of the samples, of the left and the
    /// right one. A gaze outside of both by more than [`GazeSettings::outside_deg`] is not believed. Without, it may be anywhere.
    pub fn set_views(&mut self, views: Option<[(Fov, Quat); 2]>) {
        self.views = views.and_then(Views::new);
    }

    /// Reason why the newest sample was not used; `None` if it was.
    pub fn rejection(&self) -> Option<Rejection> {
        self.rejection
    }

    /// Takes the source's own report that it has no gaze any more (an inactive action, an error): trust ramps down from
    /// `time_ns` on, without the hold that a blink gets.
    pub fn source_ended(&mut self, time_ns: i64) {
        let trust = self.trust_at(time_ns);
        if let Some(seen) = &mut self.seen
            && !self.ended
        {
            seen.trust = trust;
            seen.arrived_ns = time_ns;
            self.ended = true;
        }
    }

    /// The gaze at `now_ns`, on the clock of the samples: when the frame is shown. A time before the newest sample
    /// came (samples may be predictions) is as good as one that is as far after it.
    pub fn state(&self, now_ns: i64) -> GazeState {
        let Some(seen) = &self.seen else { return GazeState::LOST };
        let phase = self.phase(seen, now_ns);
        let visible = !matches!(phase, GazePhase::Blink | GazePhase::Lost);
        let ahead = now_ns.saturating_sub(seen.motion.newest().time_ns).clamp(0, LONGEST_NS);
        let looks_along = seen.looks_along();
        let motion = if looks_along { &seen.from_head } else { &seen.motion };
        let (directions, prediction_error_deg) =
            motion.directions(&self.settings, (ahead as f64 * 1e-9) as f32);
        // Without coarsening, refinement at a place that may be wrong loses nothing.
        let doubted = seen.motion.in_doubt().filter(|_| visible);
        // A held gaze stays at its direction from the head, within the reach of the eyes.
        let head = if visible { self.head.at(now_ns) } else { seen.head };
        let timing_s = (seen.uncertainty_ns as f64 * 1e-9) as f32;
        let timing_error_deg = if visible && !looks_along { self.head.deg_s() * timing_s } else { 0.0 };
        let head = head.filter(|_| !looks_along);
        GazeState {
            directions: turned(doubted.unwrap_or(directions), head.map(|head| head.inverse())),
            ray: None,
            velocity_deg_s: if visible { motion.speed_deg_s() } else { 0.0 },
            prediction_error_deg: prediction_error_deg.filter(|_| visible),
            timing_error_deg,
            phase,
            is_suppressed: self.is_suppressed(seen, phase, now_ns),
            trust: self.trust_at(now_ns),
        }
    }

    fn take(&mut self, sample: &GazeSample, now_ns: i64) {
        let checked = self.check(sample, now_ns);
        self.rejection =
            checked.and_then(|sighting| self.follow(sighting, now_ns, sample.uncertainty_ns.max(0))).err();
        self.answered_ns = Some(now_ns);
        match self.rejection {
            None => self.ended = false,
            Some(Rejection::Frozen) => self.source_ended(now_ns),
            // One of these alone is not an interruption; a stream of them is, as nothing else arrives.
            Some(Rejection::TooFast | Rejection::OutOfOrder) => {}
            Some(_) => {
                if let Some(seen) = &mut self.seen {
                    let age_ns = distance_ns(now_ns, seen.arrived_ns);
                    seen.interrupted |= age_ns >= interruption_ns(&seen.motion);
                }
            }
        }
    }

    /// The sighting of a sample; an error if it is impossible.
    fn check(&mut self, sample: &GazeSample, now_ns: i64) -> Result<Sighting, Rejection> {
        if !sample.valid {
            return Err(Rejection::NotTracked);
        }
        let directions = plausible(sample.directions, self.settings.reach_deg)?;
        if let Some(views) = &self.views
            && !views.show(directions, self.settings.outside_deg)
        {
            return Err(Rejection::OutsideViews);
        }
        if self.freeze.is_frozen(&self.settings, sample.directions, now_ns) {
            return Err(Rejection::Frozen);
        }
        let at = |directions: [Vec3; 2]| EyeSample { directions, time_ns: sample.time_ns };
        let in_world = at(turned(directions, self.head.at(sample.time_ns)));
        Ok(Sighting { in_world, from_head: at(directions) })
    }

    /// The state after a plausible sample.
    fn follow(&mut self, sighting: Sighting, now_ns: i64, uncertainty_ns: i64) -> Result<(), Rejection> {
        let Sighting { in_world: sample, from_head } = sighting;
        let trust = self.trust_at(now_ns);
        let head = self.head.at(sample.time_ns);
        let found = |[motion, from_head]: [Motion; 2], trust: f32| Seen {
            motion,
            from_head,
            head,
            arrived_ns: now_ns,
            settled_ns: now_ns,
            trust,
            interrupted: false,
            uncertainty_ns,
        };
        let (settings, head_deg_s) = (&self.settings, self.head.deg_s());
        let is_late =
            self.answered_ns.is_some_and(|answered_ns| now_ns.saturating_sub(answered_ns) > LONGEST_NS);
        match &mut self.seen {
            None => self.seen = Some(found([sample, from_head].map(Motion::new), trust)),
            Some(seen) => {
                let gap = sample.time_ns.saturating_sub(seen.motion.newest().time_ns);
                if gap < 0 {
                    if gap >= -nanoseconds(settings.hold_ms).max(SILENT_NS) {
                        return Err(Rejection::OutOfOrder);
                    }
                    // The clock restarted.
                    *seen = found([sample, from_head].map(Motion::new), 0.0);
                } else if self.ended
                    || seen.interrupted
                    || gap > silent_ns(&seen.motion) && seen.motion.in_doubt().is_none()
                    || is_late
                {
                    // Where the eyes went meanwhile is unknown: no speed, and the same care as after a saccade. Trust begins
                    // with the next sample.
                    let late = gap <= LONGEST_NS && !self.ended && !seen.interrupted;
                    let again =
                        [seen.motion.found_again(sample, late), seen.from_head.found_again(from_head, late)];
                    *seen = found(again, trust);
                } else {
                    // Eyes that rest on the world may be faster from the head than eyes turn.
                    let _ = seen.from_head.add(settings, from_head, 0.0);
                    let (before, settled) = (seen.motion.newest().time_ns, seen.motion.settled_ns());
                    seen.motion.add(settings, sample, head_deg_s).map_err(|_| Rejection::TooFast)?;
                    if seen.motion.settled_ns() != settled {
                        seen.settled_ns = seen.motion.landing_ns().unwrap_or(now_ns);
                    }
                    if seen.motion.newest().time_ns != before {
                        (seen.arrived_ns, seen.uncertainty_ns) = (now_ns, uncertainty_ns);
                        seen.head = head;
                        seen.trust = (seen.trust + portion(gap.min(SILENT_NS), settings.ramp_up_ms)).min(1.0);
                    }
                }
            }
        }
        Ok(())
    }

    fn phase(&self, seen: &Seen, now: i64) -> GazePhase {
        let age = distance_ns(now, seen.arrived_ns);
        if self.ended || age > self.held_ns(seen) {
            return GazePhase::Lost;
        }
        if seen.interrupted && age >= BLINK_NS || age > silent_ns(&seen.motion) {
            return GazePhase::Blink;
        }
        if seen.interrupted || seen.motion.in_doubt().is_some() {
            return GazePhase::PostSaccade;
        }
        match seen.motion.movement() {
            EyeMovement::Saccade => GazePhase::Saccade,
            // The landing may have been later than its estimated time.
            _ if now.saturating_sub(seen.settled_ns)
                < nanoseconds(self.settings.post_saccade_ms).saturating_add(seen.uncertainty_ns) =>
            {
                GazePhase::PostSaccade
            }
            EyeMovement::Turning if !seen.looks_along() => GazePhase::Pursuit,
            EyeMovement::Turning | EyeMovement::Resting => GazePhase::Fixation,
        }
    }

    /// Whether changes in a picture that is shown now go unnoticed.
    fn is_suppressed(&self, seen: &Seen, phase: GazePhase, now: i64) -> bool {
        let window_ns = nanoseconds(self.settings.post_saccade_ms);
        matches!(phase, GazePhase::Saccade | GazePhase::PostSaccade)
            && !seen.interrupted
            && seen.motion.in_doubt().is_none()
            && seen.motion.landing_ns().is_some_and(|landing| {
                now.saturating_sub(landing) < window_ns.saturating_sub(seen.uncertainty_ns)
            })
    }

    /// Time that the last gaze stays in use: at least until two samples are missing, with trackers of 25 Hz or more.
    fn held_ns(&self, seen: &Seen) -> i64 {
        let missing_ns = intervals_ns(&seen.motion, SILENT_INTERVALS).min(2 * SILENT_NS);
        nanoseconds(self.settings.hold_ms).max(missing_ns)
    }

    /// As it was with the newest usable sample until the hold is over, then falling.
    fn trust_at(&self, now: i64) -> f32 {
        let Some(seen) = &self.seen else { return 0.0 };
        let hold = if self.ended { 0 } else { self.held_ns(seen) };
        let overdue = distance_ns(now, seen.arrived_ns) - hold;
        if overdue <= 0 {
            seen.trust
        } else {
            (seen.trust - portion(overdue, self.settings.ramp_down_ms)).max(0.0)
        }
    }
}

/// Directions turned by a rotation, if there is one.
fn turned(directions: [Vec3; 2], by: Option<Quat>) -> [Vec3; 2] {
    by.map_or(directions, |by| directions.map(|direction| (by * direction).normalize()))
}

/// Time without a sample after which the eyes count as unseen.
fn silent_ns(motion: &Motion) -> i64 {
    intervals_ns(motion, SILENT_INTERVALS).clamp(SILENT_NS, LONGEST_NS)
}

/// Time without a usable sample, in spite of answers, after which the eyes may be elsewhere.
fn interruption_ns(motion: &Motion) -> i64 {
    intervals_ns(motion, INTERRUPTION_INTERVALS).clamp(INTERRUPTION_NS, LONGEST_NS)
}

/// A number of times between samples of the tracker.
fn intervals_ns(motion: &Motion, count: f32) -> i64 {
    (f64::from(count * motion.interval_s()) * 1e9) as i64
}

/// Distance between two times, in any order.
fn distance_ns(a: i64, b: i64) -> i64 {
    a.saturating_sub(b).saturating_abs()
}

/// Milliseconds as whole nanoseconds; negative and NaN are 0.
fn nanoseconds(ms: f32) -> i64 {
    (f64::from(ms.max(0.0)) * 1e6) as i64
}

/// Part of a ramp of `ramp_ms` that passes in `span_ns` >= 0: 0..=1; 1 for a ramp that takes no time.
fn portion(span_ns: i64, ramp_ms: f32) -> f32 {
    let ramp = nanoseconds(ramp_ms);
    if span_ns >= ramp { 1.0 } else { (span_ns as f64 / ramp as f64) as f32 }
}
