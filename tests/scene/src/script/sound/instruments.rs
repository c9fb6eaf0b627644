//! Noises and tones, added into a stereo mix.

use std::f64::consts::TAU;

use super::RATE_HZ;
use crate::scene::noise::hash;

const RATE: f64 = RATE_HZ as f64;

/// A stereo sound in the making.
pub struct Mix {
    frames: Vec<[f32; 2]>,
}

/// White noise in -1..1, the same for a seed.
struct Noise {
    index: u32,
    seed: u32,
}

impl Noise {
    fn new(seed: u32) -> Self {
        Self { index: 0, seed: 9000 + seed }
    }

    fn next(&mut self) -> f64 {
        self.index += 1;
        2.0 * f64::from(hash(self.index, 0, self.seed)) - 1.0
    }
}

/// A state-variable filter of two poles (Chamberlin 1985).
#[derive(Default)]
struct Filter {
    low: f64,
    band: f64,
}

impl Filter {
    /// Low-passed and band-passed input; `damping` is the inverse of the quality, up to 2.
    fn step(&mut self, input: f64, frequency_hz: f64, damping: f64) -> [f64; 2] {
        let f = 2.0 * (TAU / 2.0 * frequency_hz / RATE).sin();
        self.low += f * self.band;
        self.band += f * (input - self.low - damping * self.band);
        [self.low, self.band]
    }
}

/// Left and right of equal power; `place` is 0 on the left and 1 on the right.
fn pan(place: f64) -> [f64; 2] {
    let (right, left) = (place * TAU / 4.0).sin_cos();
    [left, right]
}

impl Mix {
    /// Silence of so many frames.
    pub fn new(length: usize) -> Self {
        Self { frames: vec![[0.0; 2]; length] }
    }

    /// Left and right in turn.
    pub fn frames(self) -> Vec<f32> {
        self.frames.into_iter().flatten().collect()
    }

    fn length_s(&self) -> f64 {
        self.frames.len() as f64 / RATE
    }

    /// Adds a sound that begins at a time, in a place, until `sound` (of the seconds since) ends.
    fn add(&mut self, start_s: f64, length_s: f64, place: f64, mut sound: impl FnMut(f64) -> f64) {
        let [left, right] = pan(place);
        let first = (start_s * RATE) as usize;
        let count = (length_s * RATE) as usize;
        for (index, frame) in self.frames.iter_mut().skip(first).take(count).enumerate() {
            let value = sound(index as f64 / RATE);
            frame[0] += (value * left) as f32;
            frame[1] += (value * right) as f32;
        }
    }

    /// Low-passed noise that swells and fades, another on each side.
    pub fn wind(&mut self, level: f64, cut_off_hz: f64, seed: u32) {
        for side in 0..2 {
            let (mut noise, mut filter) = (Noise::new(seed * 2 + side), Filter::default());
            let phase = f64::from(side) * 1.3;
            self.add(0.0, self.length_s(), f64::from(side), |t| {
                let gust = 0.65 + 0.35 * (TAU * 0.17 * t + phase).sin() * (TAU * 0.06 * t).cos();
                filter.step(noise.next(), cut_off_hz * gust, 1.2)[0] * level * gust
            });
        }
    }

    /// A hum of eight harmonics that beats slowly, with a little noise.
    pub fn engine(&mut self, level: f64, base_hz: f64, seed: u32) {
        let (mut noise, mut filter) = (Noise::new(seed), Filter::default());
        self.add(0.0, self.length_s(), 0.5, |t| {
            let hum: f64 = (1..=8)
                .map(|harmonic| {
                    let n = f64::from(harmonic);
                    let detuned = base_hz * n * (1.0 + 0.002 * f64::from(hash(harmonic, 1, seed)));
                    (TAU * detuned * t).sin() / n.powf(0.8)
                })
                .sum();
            let beat = 1.0 + 0.15 * (TAU * 1.7 * t).sin();
            level * (0.3 * hum * beat + filter.step(noise.next(), 700.0, 1.0)[0])
        });
    }

    /// Footsteps: a knock and a scuff, so many seconds apart.
    pub fn steps(&mut self, level: f64, interval_s: f64, seed: u32) {
        let place = 0.15 + 0.7 * f64::from(hash(0, 2, seed));
        let mut start = f64::from(hash(0, 3, seed)) * interval_s;
        while start < self.length_s() {
            let index = (start * 1000.0) as u32;
            let loud = level * (0.8 + 0.4 * f64::from(hash(index, 4, seed)));
            let (mut noise, mut knock, mut scuff) =
                (Noise::new(seed * 977 + index), Filter::default(), Filter::default());
            self.add(start, 0.2, place, |t| {
                let source = noise.next();
                let heel = knock.step(source * (-t * 60.0).exp(), 190.0, 0.4)[1];
                let sole = scuff.step(source * (-t * 25.0).exp(), 2600.0, 0.9)[1];
                loud * (1.6 * heel + 0.35 * sole)
            });
            start += interval_s * (0.97 + 0.06 * f64::from(hash(index, 5, seed)));
        }
    }

    /// A clock: one click each interval, alternately high and low.
    pub fn ticks(&mut self, level: f64, interval_s: f64) {
        for beat in 0..(self.length_s() / interval_s) as u32 {
            let pitch_hz = if beat % 2 == 0 { 2300.0 } else { 1900.0 };
            self.add(f64::from(beat) * interval_s, 0.06, 0.55, |t| {
                level * (TAU * pitch_hz * t).sin() * (-t * 120.0).exp()
            });
        }
    }

    /// Chirps: short sweeps in groups.
    pub fn birds(&mut self, level: f64, groups: u32, seed: u32) {
        for group in 0..groups {
            let random = |what| f64::from(hash(group, what, 300 + seed));
            let (start, place) = (random(0) * (self.length_s() - 1.2), random(1));
            let pitch_hz = 2200.0 + 2600.0 * random(2);
            for note in 0..2 + (4.0 * random(3)) as u32 {
                let begin = start + 0.15 * f64::from(note);
                self.add(begin, 0.11, place, |t| {
                    let swell = (TAU / 2.0 * t / 0.11).sin();
                    let sweep = pitch_hz * t + 4000.0 * t * t * (random(4) - 0.3);
                    level * swell * swell * (TAU * sweep).sin()
                });
            }
        }
    }

    /// Voices that cannot be understood: noise in three formants, in syllables.
    pub fn murmur(&mut self, level: f64, voices: u32, seed: u32) {
        for voice in 0..voices {
            let random = |what| f64::from(hash(voice, what, 400 + seed));
            let (pitch, pace, phase) = (0.85 + 0.4 * random(0), 2.8 + 1.8 * random(1), TAU * random(2));
            let mut noise = Noise::new(500 + seed * 64 + voice);
            let mut formants = [Filter::default(), Filter::default(), Filter::default()];
            self.add(0.0, self.length_s(), random(3), |t| {
                let syllable = (TAU * pace * t + phase).sin() * (TAU * 0.37 * pace * t).sin() + 0.2;
                let vowel = 1.0 + 0.35 * (TAU * 0.9 * t + 2.0 * phase).sin();
                let source = noise.next() * syllable.max(0.0);
                let [a, b, c] = &mut formants;
                let spoken = a.step(source, 520.0 * pitch * vowel, 0.12)[1]
                    + 0.5 * b.step(source, 1500.0 * pitch, 0.1)[1]
                    + 0.2 * c.step(source, 2600.0 * pitch, 0.1)[1];
                level * spoken
            });
        }
    }

    /// Cars that come, pass from one side to the other, and go.
    pub fn passing_cars(&mut self, level: f64, cars: u32, seed: u32) {
        let length = self.length_s();
        for car in 0..cars {
            let random = |what| f64::from(hash(car, what, 600 + seed));
            let passes = length * (f64::from(car) + 0.3 + 0.4 * random(0)) / f64::from(cars);
            let (mut noise, mut tyres) = (Noise::new(700 + seed + car), Filter::default());
            for (index, frame) in self.frames.iter_mut().enumerate() {
                let off = (index as f64 / RATE - passes) / 1.1;
                let near = 1.0 / (1.0 + off * off);
                let rolling = tyres.step(noise.next(), 300.0 + 900.0 * near, 0.9)[0] * level * near;
                let side = 0.5 + 0.5 * (off / (1.0 + off.abs()));
                let [left, right] = pan(if car.is_multiple_of(2) { side } else { 1.0 - side });
                frame[0] += (rolling * left) as f32;
                frame[1] += (rolling * right) as f32;
            }
        }
    }
}
