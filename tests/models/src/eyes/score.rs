//! Scores of a region that follows the eyes: the gaze within it, and its size.

use super::baselines::{OneEuro, TUNED, Unfiltered};
use super::path::{Event, EyePath, HALF_IPD_M};
use super::region::{Region, angle_deg, union_area_deg2};
use super::tracker::{LATENCY_S, Report, TrackerModel, nanoseconds};
use glam::{DVec3, Vec3};
use parafovea_core::gaze::{GazeSettings, GazeState, GazeTracker};
use parafovea_core::plan::SafetySettings;

/// Time that a frame is shown, seconds.
const FRAME_S: f64 = 1.0 / 90.0;

/// Start of the time that counts: trust has to rise first.
const WARM_UP_S: f64 = 1.0;

/// Smallest amplitude of large saccades, degrees: they leave the region that was at full rate before.
const FAR_DEG: f64 = 12.0;

/// Samples of the true gaze in each frame.
const LOOKS_A_FRAME: u32 = 4;

/// Positions of the eyes relative to the origin of the ray, metres.
const EYES_M: [Vec3; 2] = [Vec3::new(-HALF_IPD_M as f32, 0.0, 0.0), Vec3::new(HALF_IPD_M as f32, 0.0, 0.0)];

/// Something that makes a gaze from a tracker's reports.
pub trait Follower {
    /// Takes a report that is new in the frame that is shown at `now_s`.
    fn take(&mut self, report: &Report, now_s: f64);
    /// The gaze for the frame that is shown at `now_s`.
    fn state(&self, now_s: f64) -> GazeState;
}

impl Follower for GazeTracker {
    fn take(&mut self, report: &Report, now_s: f64) {
        self.push_at(&report.sample, nanoseconds(now_s));
    }

    fn state(&self, now_s: f64) -> GazeState {
        self.state(nanoseconds(now_s))
    }
}

/// A way to follow the gaze.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// [`GazeTracker`].
    Tracker,
    /// The same with a known fixation distance.
    TrackerWithDepth,
    /// The last sample.
    Unfiltered,
    /// The One Euro filter with these parameters.
    OneEuro([f64; 3]),
}

impl Method {
    /// All reported methods.
    pub const ALL: [Self; 4] =
        [Self::Tracker, Self::TrackerWithDepth, Self::Unfiltered, Self::OneEuro(TUNED)];

    /// As it is printed.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Tracker => "GazeTracker",
            Self::TrackerWithDepth => "GazeTracker, depth known",
            Self::Unfiltered => "unfiltered",
            Self::OneEuro(_) => "One Euro",
        }
    }

    fn follower(&self) -> Box<dyn Follower> {
        match self {
            Self::Tracker | Self::TrackerWithDepth => Box::new(GazeTracker::new(GazeSettings::default())),
            Self::Unfiltered => Box::new(Unfiltered::default()),
            Self::OneEuro(parameters) => Box::new(OneEuro::new(*parameters)),
        }
    }
}

/// One eye at one moment of a fixation or pursuit that counts.
#[derive(Clone, Copy, Debug)]
struct Moment {
    /// Least radius with which the region contains the fixation point, degrees.
    needs_deg: f64,
    /// Inflation of the region then, degrees.
    inflation_deg: f64,
    /// Angle between the true and the estimated gaze, both from between the eyes, degrees.
    error_deg: f64,
    /// Index in [`DISTANCES_M`](super::path::DISTANCES_M).
    distance: usize,
    /// Whether it is too soon after the landing for any sample to show it.
    early: bool,
}

/// Radius of the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// With the widening of the safety limits: a base, degrees, and the possible movement of the eyes on top.
    Inflated(f64),
    /// Always the same, degrees.
    Fixed(f64),
}

impl Radius {
    fn holds(self, moment: &Moment) -> bool {
        moment.needs_deg <= self.of(moment.inflation_deg)
    }

    fn of(self, inflation_deg: f64) -> f64 {
        match self {
            Self::Inflated(base) => base + inflation_deg,
            Self::Fixed(radius) => radius,
        }
    }
}

/// Measurements of a method.
#[derive(Clone, Debug, Default)]
pub struct Score {
    moments: Vec<Moment>,
    /// Inflation and separation of the centres of each frame, degrees.
    frames: Vec<[f64; 2]>,
    /// Separation of the true directions of both eyes in each frame, degrees.
    truths: Vec<f64>,
    /// Time from the landing of each saccade of [`FAR_DEG`] or more until the region of the safety limits contains the fixation point of
    /// both eyes, seconds.
    late_s: Vec<f64>,
}

impl Score {
    /// Share of the moments in which each eye's gaze lies in its region with this radius, 0..=1.
    pub fn hits(&self, radius: Radius) -> f64 {
        share(self.due().map(|moment| radius.holds(moment)))
    }

    /// The same for fixation points at each of [`DISTANCES_M`](super::path::DISTANCES_M).
    pub fn hits_at(&self, radius: Radius, distance: usize) -> f64 {
        share(self.due().filter(|moment| moment.distance == distance).map(|moment| radius.holds(moment)))
    }

    /// The same from the moment of landing on, before any sample can show it.
    pub fn hits_from_landing(&self, radius: Radius) -> f64 {
        share(self.moments.iter().map(|moment| radius.holds(moment)))
    }

    /// Least radius of a kind with at least this share of hits.
    pub fn radius_for(&self, hits: f64, kind: fn(f64) -> Radius) -> Radius {
        radius_for(self.due(), hits, kind)
    }

    /// The same from the moment of landing on.
    pub fn radius_from_landing(&self, hits: f64, kind: fn(f64) -> Radius) -> Radius {
        radius_for(self.moments.iter(), hits, kind)
    }

    fn due(&self) -> impl Iterator<Item = &Moment> {
        self.moments.iter().filter(|moment| !moment.early)
    }

    /// Mean area of the region over all frames, square degrees.
    pub fn area_deg2(&self, radius: Radius) -> f64 {
        let area = |[inflation, apart]: &[f64; 2]| union_area_deg2(radius.of(*inflation), *apart);
        self.frames.iter().map(area).sum::<f64>() / self.frames.len() as f64
    }

    /// The same of a perfect tracker, which knows where each eye looks as the frame is shown.
    pub fn perfect_area_deg2(&self, base_deg: f64) -> f64 {
        let area = |apart: &f64| union_area_deg2(base_deg, *apart);
        self.truths.iter().map(area).sum::<f64>() / self.truths.len() as f64
    }

    /// Quantile of the time from the landing of large saccades until the region contains the fixation point of both eyes, seconds.
    pub fn late_s(&self, share: f64) -> f64 {
        let mut late = self.late_s.clone();
        late.sort_by(f64::total_cmp);
        late.get((share * late.len() as f64) as usize).copied().unwrap_or(f64::NAN)
    }

    /// Median angle from where the eyes look to where they are thought to look, degrees.
    pub fn median_error_deg(&self) -> f64 {
        let mut errors: Vec<f64> = self.due().map(|moment| moment.error_deg).collect();
        errors.sort_by(f64::total_cmp);
        errors[errors.len() / 2]
    }
}

/// The radius that the safety limits give a gaze at rest, degrees: of the tracker's model, and of a perfect one without error.
pub fn foveal_radii_deg() -> [f64; 2] {
    let safety = SafetySettings::default();
    [safety.least_foveal_deg + safety.tracker_error_deg, safety.least_foveal_deg].map(f64::from)
}

/// Follows the gaze of some seeds, each for `duration_s`.
pub fn follow(method: Method, model: TrackerModel, seeds: &[u64], duration_s: f64) -> Score {
    let mut score = Score::default();
    for seed in seeds {
        let path = EyePath::new(*seed, duration_s);
        let reports = model.reports(&path, *seed, duration_s);
        follow_path(method, model, &path, &reports, duration_s, &mut score);
    }
    score
}

fn follow_path(
    method: Method,
    model: TrackerModel,
    path: &EyePath,
    reports: &[Report],
    duration_s: f64,
    score: &mut Score,
) {
    let mut follower = method.follower();
    let (mut next, mut newest) = (0, None);
    let mut reached = 0;
    let base_deg = foveal_radii_deg()[0];
    for frame in 0..((duration_s / FRAME_S) as u32) {
        let shown = f64::from(frame) * FRAME_S;
        while let Some(report) = reports.get(next).filter(|report| report.known_s <= shown) {
            newest = Some(report);
            next += 1;
            if model.tells_time {
                follower.take(report, shown);
            }
        }
        // Without times, all that is known of a sample is that it is the answer in this frame.
        if let Some(report) = newest.filter(|_| !model.tells_time) {
            follower.take(report, shown);
        }
        if shown < WARM_UP_S {
            continue;
        }
        let state = follower.state(shown);
        let middle = state.directions[0].as_dvec3();
        let distance_m = match method {
            // Distance of the target when the newest sample was taken.
            Method::TrackerWithDepth => Some((1.0 / path.at(shown - LATENCY_S).1) as f32),
            _ => None,
        };
        let region = Region::new(&state.with_vergence(EYES_M, distance_m));
        score.frames.push([region.inflation_deg, region.separation_deg()]);
        let [left, right] = path.eyes_at(shown);
        score.truths.push(angle_deg(left, right));
        for look in 0..LOOKS_A_FRAME {
            let t = shown + FRAME_S * f64::from(look) / f64::from(LOOKS_A_FRAME);
            let eyes = path.eyes_at(t);
            let holds = |eye: &DVec3| region.distance_deg(*eye) <= base_deg + region.inflation_deg;
            if let Event::Looking(number) = path.event(t)
                && number > reached
                && eyes.iter().all(holds)
            {
                reached = number;
                if path.amplitude_deg(number) >= FAR_DEG && !path.is_blink(path.looks()[number].start_s) {
                    score.late_s.push(t - path.looks()[number].start_s);
                }
            }
            let Some(distance) = path.seen(t) else { continue };
            let early = !path.counts(t, LATENCY_S + 1.0 / model.rate_hz + FRAME_S);
            let error_deg = angle_deg(path.at(t).0, middle);
            for eye in eyes {
                let (needs_deg, inflation_deg) = (region.distance_deg(eye), region.inflation_deg);
                score.moments.push(Moment { needs_deg, inflation_deg, error_deg, distance, early });
            }
        }
    }
}

fn radius_for<'a>(moments: impl Iterator<Item = &'a Moment>, hits: f64, kind: fn(f64) -> Radius) -> Radius {
    let mut needs: Vec<f64> =
        moments.map(|moment| moment.needs_deg - kind(0.0).of(moment.inflation_deg)).collect();
    needs.sort_by(f64::total_cmp);
    let index = (hits * needs.len() as f64).ceil() as usize;
    kind(needs[index.clamp(1, needs.len()) - 1])
}

fn share(of: impl Iterator<Item = bool>) -> f64 {
    let (hits, count) = of.fold((0u64, 0u64), |(hits, count), hit| (hits + u64::from(hit), count + 1));
    hits as f64 / count.max(1) as f64
}
