//! Frames of an application whose true costs are known.

use super::{GateFrame, GazePhase};
use std::collections::VecDeque;

/// Eye movement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Eyes {
    /// They rest, for ever.
    Rest,
    /// A saccade of four frames every 300 ms, a blink of 15 frames every four seconds.
    Move,
    /// Their gaze is lost.
    Lost,
}

/// Frames, one after the other.
pub(super) struct Simulation {
    random: u64,
    frame: i64,
    ratio: f64,
    noise: f64,
    growth: f64,
    wander: f64,
    wandered: f64,
    outliers: bool,
    eyes: Eyes,
    /// Pixels of the next frame; 0: unknown.
    pixels: u32,
    /// Frames whose cost is not known yet: whether the technique was on, the cost, and the pixels.
    in_flight: VecDeque<(bool, u64, u32)>,
    latency: usize,
    newest_cost_ns: u64,
    frame_ns: i64,
}

impl Simulation {
    pub(super) fn new(seed: u64) -> Self {
        Self {
            random: seed,
            frame: 0,
            ratio: 1.0,
            noise: 0.1,
            growth: 1.0,
            wander: 0.0,
            wandered: 0.0,
            outliers: false,
            eyes: Eyes::Move,
            pixels: 0,
            in_flight: VecDeque::new(),
            latency: 0,
            newest_cost_ns: 0,
            frame_ns: 11_111_111,
        }
    }

    /// Cost of a frame with the technique, in costs without.
    pub(super) fn ratio(self, ratio: f64) -> Self {
        Self { ratio, ..self }
    }

    /// Standard deviation of a frame's cost, as part of it.
    pub(super) fn noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    pub(super) fn eyes(self, eyes: Eyes) -> Self {
        Self { eyes, ..self }
    }

    /// So many frames later the cost of a frame is known.
    pub(super) fn latency(self, latency: usize) -> Self {
        Self { latency, ..self }
    }

    /// So many frames a second, instead of 90.
    pub(super) fn rate(self, hz: f64) -> Self {
        Self { frame_ns: (1e9 / hz) as i64, ..self }
    }

    /// Costs grow by this factor each frame.
    pub(super) fn growing(self, growth: f64) -> Self {
        Self { growth, ..self }
    }

    /// Costs wander with this standard deviation, as part of them, and forget within some 100 frames.
    pub(super) fn wandering(self, wander: f64) -> Self {
        Self { wander, ..self }
    }

    pub(super) fn outliers(self) -> Self {
        Self { outliers: true, ..self }
    }

    /// Sets the pixels of the next frame.
    pub(super) fn set_pixels(&mut self, pixels: u32) {
        self.pixels = pixels;
    }

    /// The cost of the newest frame, nanoseconds, which the gate may not know yet.
    pub(super) fn newest_cost_ns(&self) -> u64 {
        self.newest_cost_ns
    }

    pub(super) fn now(&self) -> i64 {
        self.frame * self.frame_ns
    }

    /// The next frame, with the technique on or off.
    pub(super) fn frame(&mut self, on: bool) -> GateFrame {
        self.frame_with_factor(on, if on { self.ratio } else { 1.0 })
    }

    pub(super) fn frame_with_factor(&mut self, on: bool, factor: f64) -> GateFrame {
        self.frame += 1;
        // Twelve uniform numbers: a normal one, near enough, and without tails that would go below 0.
        let normal = (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0;
        if self.wander > 0.0 {
            let step = (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0;
            self.wandered = 0.99 * self.wandered + (1.0_f64 - 0.99 * 0.99).sqrt() * self.wander * step;
        }
        let outlier = if self.outliers && self.frame % 10 == 0 { 10.0 } else { 1.0 };
        let base = 5e6 * self.growth.powi((self.frame % 100_000) as i32);
        let base = base * self.wandered.exp();
        let cost = base * factor * outlier * (1.0 + self.noise * normal).max(0.05);
        self.newest_cost_ns = cost as u64;
        self.in_flight.push_back((on, self.newest_cost_ns, self.pixels));
        let known = if self.in_flight.len() > self.latency { self.in_flight.pop_front() } else { None };
        GateFrame {
            time_ns: self.now(),
            cost_ns: known.map(|(_, cost, _)| cost),
            was_on: known.map_or(on, |(on, ..)| on),
            phase: self.phase(),
            passes: Some(2),
            pixels: known.map_or(0, |(.., pixels)| pixels),
        }
    }

    fn phase(&self) -> GazePhase {
        match self.eyes {
            Eyes::Rest => GazePhase::Fixation,
            Eyes::Lost => GazePhase::Lost,
            Eyes::Move if self.frame % 360 < 15 => GazePhase::Blink,
            Eyes::Move => match self.frame % 27 {
                0..4 => GazePhase::Saccade,
                4..9 => GazePhase::PostSaccade,
                _ => GazePhase::Fixation,
            },
        }
    }

    /// 0..1, by splitmix64 (Steele, Lea and Flood 2014).
    pub(super) fn uniform(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.random;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
