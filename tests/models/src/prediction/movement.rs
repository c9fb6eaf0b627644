//! Eye movements with known truth: fixations with drift, pursuit and saccades of 1 to 20 degrees, with the statistics of recordings of
//! free viewing and reading (GazeBase, Griffith et al. 2021).
//!
//! The saccades have the waveforms of two models, neither of which is the predictor's: the sum of two soft ramps (Dai et al. 2016, A
//! parametric model for saccadic eye movement), which is symmetric, and the gamma function (van Opstal and van Gisbergen 1987), which is
//! not. Nor are their durations the predictor's.

use crate::eyes::Random;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;
use std::ops::Range;

/// Moments a second at which the truth is known.
const STEPS_HZ: f64 = 1000.0;

/// Amplitudes of saccades, degrees.
const AMPLITUDES_DEG: Range<f64> = 1.0..20.0;

/// Mean of their distribution, which is exponential within that range, degrees (Bahill, Adler and Stark 1975).
const USUAL_AMPLITUDE_DEG: f64 = 7.6;

/// Largest angle of new targets from the forward direction, degrees.
const REACH_DEG: f64 = 22.0;

/// Diffusion of the eyes in a fixation, square degrees a second: 40 square minutes of arc (Kuang et al. 2012).
const DIFFUSION_DEG2_S: f64 = 40.0 / 3600.0;

/// Time after a landing for which frames count as around a saccade, seconds.
const AFTER_S: f64 = 0.1;

/// State of the eyes at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Movement {
    /// They rest.
    Fixation,
    /// They follow something.
    Pursuit,
    /// A saccade is in flight, or landed no longer ago than 100 ms.
    Saccade {
        /// Time at which it began, seconds.
        begun_s: f64,
    },
}

/// A gaze over time.
#[derive(Clone, Debug, Default)]
pub struct Movements {
    directions: Vec<DVec3>,
    movements: Vec<Movement>,
    /// The newest saccade, and after which step it landed.
    landed: Option<(Movement, usize)>,
}

impl Movements {
    /// The eyes wander for at least `duration_s`; one seed always gives the same gaze.
    pub fn new(seed: u64, duration_s: f64) -> Self {
        let random = &mut Random::new(seed, 11);
        // Eyes differ from each other in how fast they are.
        let pace = random.within(0.85, 1.15);
        let mut path = Self::default();
        let mut at = DVec3::NEG_Z;
        while (path.directions.len() as f64) < duration_s * STEPS_HZ {
            let target = next_target(random, at);
            at = path.jump(random, pace, at, target);
            if random.chance(0.2) {
                at = path.pursue(random, at);
                continue;
            }
            at = path.rest(random, at);
            let short = at.angle_between(target).to_degrees();
            if short > 0.4 {
                at = path.jump(random, pace, at, target);
                at = path.rest(random, at);
            }
        }
        path
    }

    /// Direction at a time, a unit vector from between the eyes.
    pub fn at(&self, t: f64) -> DVec3 {
        let place = (t * STEPS_HZ).clamp(0.0, (self.directions.len() - 2) as f64);
        let index = place as usize;
        self.directions[index].lerp(self.directions[index + 1], place - index as f64).normalize()
    }

    /// State of the eyes at a time.
    pub fn movement(&self, t: f64) -> Movement {
        self.movements[((t * STEPS_HZ).max(0.0) as usize).min(self.movements.len() - 1)]
    }

    fn push(&mut self, direction: DVec3, movement: Movement) {
        let after = self.directions.len();
        let lands = self.landed.filter(|(_, landed)| ((after - landed) as f64) < AFTER_S * STEPS_HZ);
        let flies = matches!(movement, Movement::Saccade { .. });
        self.directions.push(direction);
        self.movements.push(lands.filter(|_| !flies).map_or(movement, |(saccade, _)| saccade));
    }

    fn jump(&mut self, random: &mut Random, pace: f64, from: DVec3, target: DVec3) -> DVec3 {
        let whole = from.angle_between(target).to_degrees();
        // A quarter of the large saccades fall short, and a second one corrects them (Becker and Fuchs 1969: 10 %).
        let amplitude = if whole > 4.0 && random.chance(0.25) { 0.9 * whole } else { whole };
        let pace = pace * random.within(0.92, 1.08);
        let wave = if random.chance(0.5) { soft_ramps(amplitude, pace) } else { gamma(amplitude, pace) };
        let axis = from.cross(target).normalize();
        let turned = |degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians()) * from;
        let saccade = Movement::Saccade { begun_s: self.directions.len() as f64 / STEPS_HZ };
        for way in &wave {
            self.push(turned(way * amplitude), saccade);
        }
        self.landed = Some((saccade, self.directions.len()));
        turned(amplitude)
    }

    fn rest(&mut self, random: &mut Random, from: DVec3) -> DVec3 {
        // Median and spread of fixations in reading and free viewing (Rayner 1998): 220 ms, most of them 100 to 500.
        let seconds = (0.22 * (0.45 * random.normal()).exp()).clamp(0.1, 1.2);
        let step = (2.0 * DIFFUSION_DEG2_S / STEPS_HZ).sqrt().to_radians();
        let mut at = from;
        for _ in 0..(seconds * STEPS_HZ) as u32 {
            let (right, up) = at.any_orthonormal_pair();
            at = (at + (right * random.normal() + up * random.normal()) * step).normalize();
            self.push(at, Movement::Fixation);
        }
        at
    }

    fn pursue(&mut self, random: &mut Random, from: DVec3) -> DVec3 {
        let speed = random.within(5.0, 25.0).to_radians();
        // Towards the middle, more or less.
        let (right, up) = from.any_orthonormal_pair();
        let around = random.within(0.0, TAU);
        let across = right * around.cos() + up * around.sin();
        let across =
            if (from + 0.1 * across).dot(DVec3::NEG_Z) > from.dot(DVec3::NEG_Z) { across } else { -across };
        let axis = from.cross(across).normalize();
        let steps = (random.within(0.4, 1.2) * STEPS_HZ) as u32;
        let at = |step: u32| DQuat::from_axis_angle(axis, speed * f64::from(step) / STEPS_HZ) * from;
        for step in 0..steps {
            self.push(at(step), Movement::Pursuit);
        }
        at(steps)
    }
}

/// Something to look at that is a saccade away.
fn next_target(random: &mut Random, from: DVec3) -> DVec3 {
    loop {
        let share = |amplitude: f64| 1.0 - (-amplitude / USUAL_AMPLITUDE_DEG).exp();
        let drawn = random.within(share(AMPLITUDES_DEG.start), share(AMPLITUDES_DEG.end));
        let amplitude = (-USUAL_AMPLITUDE_DEG * (1.0 - drawn).ln()).to_radians();
        let (right, up) = from.any_orthonormal_pair();
        let around = random.within(0.0, TAU);
        let across = right * around.cos() + up * around.sin();
        let target = from * amplitude.cos() + across * amplitude.sin();
        if target.angle_between(DVec3::NEG_Z).to_degrees() < REACH_DEG {
            return target;
        }
    }
}

/// The part of its amplitude that a saccade has done at each step of time (Dai et al. 2016, equations 3 and 4). Its peak speed is 550
/// degrees a second times 1 - exp(-amplitude / 6 degrees): the main sequence (Bahill, Clark and Stark 1975).
fn soft_ramps(amplitude_deg: f64, pace: f64) -> Vec<f64> {
    const BEFORE: f64 = 1.5;
    let (speed, knee) = (550.0 * pace, 6.0);
    let ramp = |u: f64| if u < 0.0 { 0.25 * (2.0 * u).exp() } else { u + 0.25 * (-2.0 * u).exp() };
    let whole = amplitude_deg / knee;
    let gone = |u: f64| ramp(u) - ramp(u - whole);
    let (first, last) = (gone(-BEFORE), gone(whole + BEFORE));
    let seconds = (whole + 2.0 * BEFORE) * knee / speed;
    let steps = (seconds * STEPS_HZ) as u32;
    (0..steps)
        .map(|step| gone(f64::from(step) / STEPS_HZ * speed / knee - BEFORE))
        .map(|gone| (gone - first) / (last - first))
        .collect()
}

/// The same with a speed that is a gamma function of time, more skewed the longer it takes (van Opstal and van Gisbergen 1987, equation
/// 1 and figure 5). It takes 23 ms + 2.7 ms a degree (Collewijn, Erkelens and Steinman 1988).
fn gamma(amplitude_deg: f64, pace: f64) -> Vec<f64> {
    let seconds = (0.023 + 0.0027 * amplitude_deg) / pace;
    let shape = 4.0 + 8.0 * (-amplitude_deg / 10.0).exp();
    let beta = seconds / (shape + 3.0 * shape.sqrt());
    let speed = |t: f64| (t / beta).powf(shape - 1.0) * (-t / beta).exp();
    let steps = (seconds * STEPS_HZ) as u32;
    let mut gone = 0.0;
    let mut way = Vec::with_capacity(steps as usize);
    for step in 0..steps {
        way.push(gone);
        gone += speed((f64::from(step) + 0.5) / STEPS_HZ);
    }
    way.iter_mut().for_each(|way| *way /= gone);
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak_deg_s(wave: &[f64], amplitude_deg: f64) -> f64 {
        wave.windows(2).map(|pair| (pair[1] - pair[0]) * amplitude_deg * STEPS_HZ).fold(0.0, f64::max)
    }

    #[test]
    fn saccades_are_as_fast_as_the_main_sequence_says() {
        // Bahill, Clark and Stark (1975), figure 2: peak speeds of saccades of these amplitudes, degrees a second.
        for (amplitude, peaks) in
            [(2.0, 90.0..220.0), (5.0, 180.0..380.0), (10.0, 280.0..550.0), (20.0, 380.0..650.0)]
        {
            for wave in [soft_ramps(amplitude, 1.0), gamma(amplitude, 1.0)] {
                let peak = peak_deg_s(&wave, amplitude);
                assert!(peaks.contains(&peak), "{amplitude} degrees: {peak}");
                assert!(wave[0] < 0.01 && wave[wave.len() - 1] > 0.97, "{wave:?}");
            }
        }
    }

    #[test]
    fn saccades_have_the_amplitudes_and_the_eyes_the_reach_that_are_told() {
        let path = Movements::new(3, 60.0);
        let reach = path.directions.iter().map(|at| at.angle_between(DVec3::NEG_Z).to_degrees());
        assert!(reach.fold(0.0, f64::max) < REACH_DEG + 20.0);
        let share = |is: fn(&Movement) -> bool| {
            path.movements.iter().filter(|found| is(found)).count() as f64 / path.movements.len() as f64
        };
        assert!(share(|found| *found == Movement::Fixation) > 0.2);
        assert!(share(|found| *found == Movement::Pursuit) > 0.1);
        assert!(share(|found| matches!(found, Movement::Saccade { .. })) > 0.3);
        let fastest =
            path.directions.windows(2).map(|pair| pair[0].angle_between(pair[1]).to_degrees() * STEPS_HZ);
        assert!((400.0..800.0).contains(&fastest.fold(0.0, f64::max)));
    }
}
