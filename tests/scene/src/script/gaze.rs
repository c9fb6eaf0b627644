//! True gaze of the eyes: fixations, pursuits, and saccades between them.

use std::ops::Range;

use glam::Vec3;

use super::DURATION_S;
use super::head::HeadPath;
use crate::scene::noise::hash;

/// Largest angle of the gaze from the forward direction, degrees: beyond it, people turn their head.
pub const REACH_DEG: f32 = 26.0;
/// The same in scripts of glances: as far as eyes turn before a head follows at once, and past the edges of OpenXR Toolkit's ellipses in a view of
/// 90 degrees, the outer one of "Wide" upwards included (0.80 of 45 degrees in tangents: 38.7).
pub const FAR_REACH_DEG: f32 = 40.0;
/// The fastest thing that the eyes follow, degrees a second in VIEW.
const FASTEST_PURSUIT_DEG_S: f32 = 30.0;
/// Smallest and largest saccade, degrees.
const AMPLITUDES_DEG: Range<f32> = 2.5..32.0;

/// Probability that the eyes choose a moving target, if there is one.
const MOVING_SHARE: f32 = 0.4;

/// Something to look at, in the world, metres.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// Stays where it is: looking at it is a fixation.
    Still(Vec3),
    /// Is somewhere at each time: looking at it is a pursuit.
    Moving(fn(f64) -> Vec3),
}

impl Target {
    /// Position at a time.
    pub fn at(&self, t: f64) -> Vec3 {
        match self {
            Self::Still(point) => *point,
            Self::Moving(place) => place(t),
        }
    }
}

/// Kind of eye movement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Resting on something that stands still (the head may turn; the eyes turn against it).
    Fixation,
    /// Following something that moves.
    Pursuit,
    /// Jumping.
    Saccade,
}

/// The gaze at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// Unit vector in VIEW, from the point between the eyes: -z is ahead, +y is up.
    pub direction: Vec3,
    /// Fixation distance, metres: both eyes converge there.
    pub distance_m: f32,
    /// Kind of eye movement.
    pub phase: Phase,
}

/// A keyframe of a gaze; the fields of the mock runtime's `[[gaze]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeKey {
    /// Seconds.
    pub t: f64,
    /// To the left, degrees.
    pub yaw_deg: f32,
    /// Upwards, degrees.
    pub pitch_deg: f32,
    /// Whether the eyes are tracked, from here to the next keyframe.
    pub tracked: bool,
}

impl GazeKey {
    /// A keyframe of a direction in VIEW.
    pub fn new(t: f64, direction: Vec3, tracked: bool) -> Self {
        Self {
            t,
            yaw_deg: (-direction.x).atan2(-direction.z).to_degrees(),
            pitch_deg: direction.y.clamp(-1.0, 1.0).asin().to_degrees(),
            tracked,
        }
    }

    /// The direction in VIEW, a unit vector.
    pub fn direction(&self) -> Vec3 {
        let ((sin, cos), (up, level)) =
            (self.yaw_deg.to_radians().sin_cos(), self.pitch_deg.to_radians().sin_cos());
        Vec3::new(-sin * level, up, -cos * level)
    }
}

/// One jump of the eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saccade {
    /// Start, seconds.
    pub start_s: f64,
    /// Duration, seconds.
    pub duration_s: f64,
    /// The angle between its ends, degrees in VIEW.
    pub amplitude_deg: f32,
}

/// Duration of a saccade of an amplitude, seconds: the main sequence, 21 ms + 2.2 ms a degree (Carpenter 1988).
pub fn saccade_duration_s(amplitude_deg: f32) -> f64 {
    (21.0 + 2.2 * f64::from(amplitude_deg)) * 1e-3
}

/// A rest of the eyes on a target, without the saccades on both sides.
#[derive(Clone, Copy, Debug)]
struct Look {
    start: f64,
    end: f64,
    target: Target,
}

/// The gaze of the whole script.
#[derive(Clone, Debug)]
pub struct TrueGaze {
    head: HeadPath,
    /// In order; a saccade lies between the end of one and the start of the next.
    looks: Vec<Look>,
    blinks: Vec<Range<f64>>,
}

impl TrueGaze {
    /// Lets the eyes wander over the targets as the head moves; the same seed gives the same gaze.
    pub(super) fn new(head: &HeadPath, targets: &[Target], seed: u32, reach_deg: f32) -> Self {
        let builder = Builder { head, targets, seed, reach_deg };
        Self { head: head.clone(), looks: builder.looks(), blinks: blinks(seed) }
    }

    /// The gaze at a time.
    pub fn at(&self, t: f64) -> Gaze {
        let t = t.clamp(0.0, DURATION_S);
        let next = self.looks.partition_point(|look| look.start <= t).max(1);
        let look = &self.looks[next - 1];
        let Some(following) = self.looks.get(next).filter(|_| t > look.end) else {
            let (direction, distance_m) = self.head.at(t).view_of(look.target.at(t));
            let phase = match look.target {
                Target::Still(_) => Phase::Fixation,
                Target::Moving(_) => Phase::Pursuit,
            };
            return Gaze { direction, distance_m, phase };
        };
        let [(from, near), (to, far)] = ends(&self.head, look, following);
        let s = smooth_step(((t - look.end) / (following.start - look.end)) as f32);
        let rotation = glam::Quat::from_rotation_arc(from, to);
        let direction = (glam::Quat::IDENTITY.slerp(rotation, s) * from).normalize();
        // Vergence, which is inverse distance, changes along.
        let distance_m = 1.0 / ((1.0 - s) / near + s / far);
        Gaze { direction, distance_m, phase: Phase::Saccade }
    }

    /// All saccades in order.
    pub fn saccades(&self) -> Vec<Saccade> {
        let between = |pair: &[Look]| {
            let [(from, _), (to, _)] = ends(&self.head, &pair[0], &pair[1]);
            Saccade {
                start_s: pair[0].end,
                duration_s: pair[1].start - pair[0].end,
                amplitude_deg: from.angle_between(to).to_degrees(),
            }
        };
        self.looks.windows(2).map(between).collect()
    }

    /// Times in which the lids are shut, seconds: 100 to 400 ms each.
    pub fn blinks(&self) -> &[Range<f64>] {
        &self.blinks
    }

    /// Whether the lids are shut at a time.
    pub fn is_blink(&self, t: f64) -> bool {
        self.blinks.iter().any(|blink| blink.contains(&t))
    }

    /// Dense keyframes for linear interpolation, so many a second; all are tracked.
    pub fn keyframes(&self, rate_hz: f64) -> Vec<GazeKey> {
        times(rate_hz).map(|t| GazeKey::new(t, self.at(t).direction, true)).collect()
    }
}

/// Times from 0 to the end of a script, so many a second.
pub(super) fn times(rate_hz: f64) -> impl Iterator<Item = f64> {
    let count = (DURATION_S * rate_hz).ceil() as u64;
    (0..=count).map(move |index| index as f64 / rate_hz)
}

/// Directions and distances at which a saccade begins and ends.
fn ends(head: &HeadPath, from: &Look, to: &Look) -> [(Vec3, f32); 2] {
    let seen = |look: &Look, t: f64| head.at(t).view_of(look.target.at(t));
    [seen(from, from.end), seen(to, to.start)]
}

/// The path of least jerk (Flash and Hogan 1985), whose peak speed is 1.875 times the mean: 577 degrees a second in a
/// saccade of 20 degrees.
fn smooth_step(s: f32) -> f32 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}

/// About 17 a minute.
fn blinks(seed: u32) -> Vec<Range<f64>> {
    let mut blinks = Vec::new();
    let mut t = 1.2 + f64::from(hash(0, 1, seed));
    for index in 1.. {
        let duration = 0.1 + 0.3 * f64::from(hash(index, 2, seed));
        if t + duration > DURATION_S {
            break;
        }
        blinks.push(t..t + duration);
        t += 2.2 + 2.6 * f64::from(hash(index, 3, seed));
    }
    blinks
}

struct Builder<'a> {
    head: &'a HeadPath,
    targets: &'a [Target],
    seed: u32,
    reach_deg: f32,
}

impl Builder<'_> {
    fn looks(&self) -> Vec<Look> {
        let ahead = |target: &usize| {
            let (direction, _) = self.head.at(0.0).view_of(self.targets[*target].at(0.0));
            direction.angle_between(Vec3::NEG_Z)
        };
        let still = |target: &usize| matches!(self.targets[*target], Target::Still(_));
        let mut current =
            (0..self.targets.len()).filter(still).min_by(|a, b| ahead(a).total_cmp(&ahead(b))).unwrap_or(0);
        let (mut looks, mut previous) = (Vec::<Look>::new(), current);
        let mut start = 0.0;
        for number in 0.. {
            let target = self.targets[current];
            let mut end = start + self.dwell(current, number);
            // Stays a little longer where there is nowhere else to look.
            let found = loop {
                if end >= DURATION_S {
                    break None;
                }
                let look = Look { start, end, target };
                let mut fit: Vec<_> = (0..self.targets.len())
                    .filter(|&other| other != current)
                    .filter_map(|other| Some((other, self.landing(&look, other, number + 1)?)))
                    .collect();
                if fit.len() > 1 {
                    fit.retain(|(other, _)| *other != previous);
                }
                let moves = |(other, _): &(usize, f64)| matches!(self.targets[*other], Target::Moving(_));
                if hash(number, 6, self.seed) < MOVING_SHARE && fit.iter().any(moves) {
                    fit.retain(moves);
                }
                if !fit.is_empty() {
                    let choice = (hash(number, 5, self.seed) * fit.len() as f32) as usize;
                    break fit.get(choice.min(fit.len() - 1)).copied();
                }
                end += 0.05;
            };
            looks.push(Look { start, end: end.min(DURATION_S), target });
            match found {
                Some((next, landing)) => (previous, current, start) = (current, next, landing),
                None => break,
            }
        }
        looks
    }

    fn dwell(&self, target: usize, number: u32) -> f64 {
        let random = f64::from(hash(number, 4, self.seed));
        match self.targets[target] {
            Target::Still(_) => 0.22 + 0.48 * random,
            Target::Moving(_) => 1.1 + 0.9 * random,
        }
    }

    /// Landing time of a saccade from a look to another target, if the target suits.
    fn landing(&self, look: &Look, target: usize, number: u32) -> Option<f64> {
        let next = self.targets[target];
        let view = |t: f64| self.head.at(t).view_of(next.at(t)).0;
        let (from, _) = self.head.at(look.end).view_of(look.target.at(look.end));
        // Where it will be depends on when; a few rounds settle that.
        let (mut landing, mut amplitude) = (look.end, 0.0);
        for _ in 0..8 {
            amplitude = from.angle_between(view(landing)).to_degrees();
            landing = look.end + saccade_duration_s(amplitude);
        }
        if !AMPLITUDES_DEG.contains(&amplitude) {
            return None;
        }
        const STEP: f64 = 0.02;
        let leaves = landing + self.dwell(target, number) + 0.1;
        let mut t = landing;
        while t < leaves {
            let (here, there) = (view(t), view(t + STEP));
            let speed = here.angle_between(there).to_degrees() / STEP as f32;
            let off = here.angle_between(Vec3::NEG_Z).to_degrees();
            if off > self.reach_deg || speed > FASTEST_PURSUIT_DEG_S {
                return None;
            }
            t += STEP;
        }
        Some(landing)
    }
}

#[cfg(test)]
mod tests;
