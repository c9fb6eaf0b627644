//! True gaze of the eyes: fixations, pursuits, and saccades between them, on targets near and far.

use super::random::Random;
use glam::{DQuat, DVec3};
use std::ops::Range;

/// Half the distance between the eyes, metres.
pub const HALF_IPD_M: f64 = 0.0315;

/// Distances of fixation points, metres.
pub const DISTANCES_M: [f64; 4] = [0.3, 0.5, 1.0, f64::INFINITY];

/// Amplitudes of saccades, degrees.
const AMPLITUDES_DEG: Range<f64> = 2.0..30.0;

/// Largest angle of new targets from the forward direction, degrees.
const REACH_DEG: f64 = 25.0;

/// A saccade that falls short does so by this part, and a second one corrects it.
const SHORTFALL: f64 = 0.08;

/// A fixation or pursuit of one target, without the saccades on both sides.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Time at which the eyes land on it, seconds.
    pub start_s: f64,
    /// Time at which they leave.
    pub end_s: f64,
    /// Its direction at the landing, unit vector from between the eyes.
    pub from: DVec3,
    /// Its rotation around the head, radians a second along an axis; 0 at rest.
    pub turn: DVec3,
    /// Its distance, metres.
    pub distance_m: f64,
}

impl Look {
    /// Whether it moves, so that looking at it is pursuit.
    pub fn is_pursuit(&self) -> bool {
        self.turn != DVec3::ZERO
    }

    fn at(&self, t: f64) -> DVec3 {
        DQuat::from_scaled_axis(self.turn * (t - self.start_s)) * self.from
    }
}

/// State of the eyes at a time.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// Look at the thing of this number.
    Looking(usize),
    /// Jump, from the thing of this number to the next one.
    Jumping(usize),
}

/// The gaze over time.
#[derive(Clone, Debug)]
pub struct EyePath {
    looks: Vec<Look>,
    /// Exponents of each saccade's profile of speed.
    shapes: Vec<[f64; 2]>,
    blinks: Vec<Range<f64>>,
}

impl EyePath {
    /// The eyes wander for `duration_s`; one seed always gives the same path.
    pub fn new(seed: u64, duration_s: f64) -> Self {
        let random = &mut Random::new(seed, 1);
        let mut looks = vec![Look {
            start_s: 0.0,
            end_s: 0.5,
            from: DVec3::NEG_Z,
            turn: DVec3::ZERO,
            distance_m: f64::INFINITY,
        }];
        let mut shapes = Vec::new();
        let mut owed: Option<DVec3> = None;
        while let Some(last) = looks.last().copied().filter(|last| last.end_s < duration_s) {
            let leaves = last.at(last.end_s);
            let corrects = owed.is_some();
            let (target, turn, distance_m, stays_s) = match owed.take() {
                Some(target) => (target, DVec3::ZERO, last.distance_m, random.within(0.2, 0.6)),
                None => next_target(random, leaves),
            };
            let far = leaves.angle_between(target).to_degrees() > 5.0;
            let falls_short = !corrects && far && turn == DVec3::ZERO && random.chance(0.25);
            let lands = if falls_short {
                owed = Some(target);
                DQuat::IDENTITY.slerp(DQuat::from_rotation_arc(leaves, target), 1.0 - SHORTFALL) * leaves
            } else {
                target
            };
            let amplitude = leaves.angle_between(lands).to_degrees();
            // The main sequence (Carpenter 1988), and how single saccades differ from it.
            let lasts = (0.021 + 0.0022 * amplitude) * random.within(0.9, 1.1);
            // Large saccades slow down for longer than they speed up (van Opstal and van Gisbergen 1987). The peak is 1.65 to
            // 1.75 of the mean speed: 500 degrees a second at 15 degrees.
            shapes.push([1.4, 1.4 + 0.02 * amplitude]);
            let start_s = last.end_s + lasts;
            let stays_s = if falls_short { random.within(0.12, 0.18) } else { stays_s };
            looks.push(Look { start_s, end_s: start_s + stays_s, from: lands, turn, distance_m });
        }
        Self { looks, shapes, blinks: blinks(&mut Random::new(seed, 2), duration_s) }
    }

    /// The eyes rest on one distant thing at the centre of the view.
    pub fn resting(duration_s: f64) -> Self {
        let (from, turn) = (DVec3::NEG_Z, DVec3::ZERO);
        let look = Look { start_s: 0.0, end_s: duration_s, from, turn, distance_m: f64::INFINITY };
        Self { looks: vec![look], shapes: Vec::new(), blinks: Vec::new() }
    }

    /// All targets of the eyes, in order.
    pub fn looks(&self) -> &[Look] {
        &self.looks
    }

    /// State of the eyes at a time.
    pub fn event(&self, t: f64) -> Event {
        let number = self.looks.partition_point(|look| look.start_s <= t).max(1) - 1;
        if t <= self.looks[number].end_s || number + 1 == self.looks.len() {
            Event::Looking(number)
        } else {
            Event::Jumping(number)
        }
    }

    /// Direction from between the eyes, unit vector, and nearness (1 / distance in metres) at a time.
    pub fn at(&self, t: f64) -> (DVec3, f64) {
        match self.event(t) {
            Event::Looking(number) => (self.looks[number].at(t), 1.0 / self.looks[number].distance_m),
            Event::Jumping(number) => {
                let (from, to) = (&self.looks[number], &self.looks[number + 1]);
                let s = self.way(t);
                let turn = DQuat::IDENTITY.slerp(DQuat::from_rotation_arc(from.at(from.end_s), to.from), s);
                let nearness = (1.0 - s) / from.distance_m + s / to.distance_m;
                ((turn * from.at(from.end_s)).normalize(), nearness)
            }
        }
    }

    /// Direction of each eye, left first, unit vectors.
    pub fn eyes_at(&self, t: f64) -> [DVec3; 2] {
        let (direction, nearness) = self.at(t);
        [-HALF_IPD_M, HALF_IPD_M].map(|x| (direction - DVec3::X * x * nearness).normalize())
    }

    /// Part of the present saccade that is done, 0..=1; 0 where there is none.
    pub fn way(&self, t: f64) -> f64 {
        let Event::Jumping(number) = self.event(t) else { return 0.0 };
        let (leaves, lands) = (self.looks[number].end_s, self.looks[number + 1].start_s);
        let [rise, fall] = self.shapes[number];
        let speed = |s: f64| s.powf(rise) * (1.0 - s).powf(fall);
        let gone = |until: f64| {
            let steps = 64;
            let width = until / f64::from(steps);
            (0..steps).map(|step| speed((f64::from(step) + 0.5) * width) * width).sum::<f64>()
        };
        (gone((t - leaves) / (lands - leaves)) / gone(1.0)).clamp(0.0, 1.0)
    }

    /// Amplitude of the saccade that lands on the target of this number, degrees; 0 for the first.
    pub fn amplitude_deg(&self, number: usize) -> f64 {
        let Some(before) = number.checked_sub(1).map(|before| &self.looks[before]) else { return 0.0 };
        before.at(before.end_s).angle_between(self.looks[number].from).to_degrees()
    }

    /// Whether the lids are shut.
    pub fn is_blink(&self, t: f64) -> bool {
        self.blinks.iter().any(|blink| blink.contains(&t))
    }

    /// Index in [`DISTANCES_M`] of the distance of the current target; None in saccades and blinks.
    pub fn seen(&self, t: f64) -> Option<usize> {
        let Event::Looking(number) = self.event(t) else { return None };
        let distance_m = self.looks[number].distance_m;
        DISTANCES_M.iter().position(|distance| *distance == distance_m).filter(|_| !self.is_blink(t))
    }

    /// Whether the eyes look at something, the lids are open, and both have been so for at least `delay_s` since the landing:
    /// when the lids were shut then, since they opened.
    pub fn counts(&self, t: f64, delay_s: f64) -> bool {
        let Event::Looking(number) = self.event(t) else { return false };
        let landed_s = self.looks[number].start_s;
        let landed_shut = self.blinks.iter().find(|blink| blink.contains(&landed_s));
        let seen_from = landed_shut.map_or(landed_s, |blink| blink.end);
        !self.is_blink(t) && t >= seen_from + delay_s
    }

    /// Times in which the lids are shut.
    pub fn blinks(&self) -> &[Range<f64>] {
        &self.blinks
    }
}

/// The next target: direction, angular velocity, distance, and duration of the look.
fn next_target(random: &mut Random, leaves: DVec3) -> (DVec3, DVec3, f64, f64) {
    let distance_m = DISTANCES_M[random.within(0.0, 4.0) as usize % 4];
    let moves = random.chance(0.3);
    let stays_s = if moves { random.within(0.6, 1.4) } else { random.within(0.2, 0.8) };
    loop {
        // As many small ones as large ones, by ratio.
        let amplitude =
            AMPLITUDES_DEG.start * (AMPLITUDES_DEG.end / AMPLITUDES_DEG.start).powf(random.within(0.0, 1.0));
        let target = turned(leaves, random.within(0.0, std::f64::consts::TAU), amplitude);
        let speed = if moves { random.within(5.0, 30.0).to_radians() } else { 0.0 };
        let heading = turned(target, random.within(0.0, std::f64::consts::TAU), 90.0);
        let turn = target.cross(heading).normalize() * speed;
        let ends = DQuat::from_scaled_axis(turn * stays_s) * target;
        let within = |direction: DVec3| direction.angle_between(DVec3::NEG_Z).to_degrees() <= REACH_DEG;
        if within(target) && within(ends) {
            return (target, turn, distance_m, stays_s);
        }
    }
}

/// About one in 4 seconds, of 100 to 400 ms.
fn blinks(random: &mut Random, duration_s: f64) -> Vec<Range<f64>> {
    let mut blinks = Vec::new();
    let mut t = random.within(1.0, 4.0);
    while t < duration_s {
        let end = t + random.within(0.1, 0.4);
        blinks.push(t..end);
        t = end + random.within(2.0, 6.0);
    }
    blinks
}

/// A direction, turned by an angle in degrees; `around` is the heading, radians from the right towards up.
pub fn turned(direction: DVec3, around: f64, angle_deg: f64) -> DVec3 {
    let (right, up) = direction.any_orthonormal_pair();
    let across = right * around.cos() + up * around.sin();
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    (direction * cos + across * sin).normalize()
}
