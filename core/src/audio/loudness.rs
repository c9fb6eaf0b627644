//! Loudness after BS.1770-4, over a window that slides by 100 ms.
//!
//! The crate `ebur128` filters, squares and weights. It keeps every block of a programme for its gated loudness, and
//! sums its short-term window again at each query; so only the energy of the 100 ms just pushed is read from it, and
//! the windows and gates are made of these energies here: four in a row are the standard's block of 400 ms, with its
//! overlap of 75 %.

use ebur128::{Channel, EbuR128, Error};
use std::collections::VecDeque;
use std::f64::consts::PI;

/// Hops in a block, and in the window of momentary loudness: 400 ms (BS.1770-4; EBU Tech 3341).
pub(super) const BLOCK_HOPS: usize = 4;

/// Length of a hop, milliseconds: a quarter of a block, which is the standard's overlap of 75 %.
const HOP_MS: u32 = 100;

/// Threshold of silence, LKFS (BS.1770-4, absolute gate).
pub(super) const ABSOLUTE_GATE_LUFS: f64 = -70.0;

/// Threshold below the mean under which energy does not count, loudness units (BS.1770-4, relative gate).
const RELATIVE_GATE_LU: f64 = -10.0;

/// Loudness of an energy of 1, LKFS (BS.1770-4, Eq. 2): takes back the gain of the K-weighting at 997 Hz.
const OFFSET_LUFS: f64 = -0.691;

/// Loudness of the last T_a, hop by hop of 100 ms, of a [`FeatureExtractor`](super::FeatureExtractor).
pub struct Loudness {
    meter: EbuR128,
    /// Factor on `meter`'s energies: see [`level_correction`].
    correction: f64,
    /// Energies of the last hops of the window, oldest first.
    energies: VecDeque<f64>,
    window_hops: usize,
}

impl Loudness {
    /// Frames of a hop: 100 ms, rounded down.
    pub(super) fn hop_frames(sample_rate_hz: u32) -> usize {
        // As `EbuR128::loudness_window` rounds.
        (sample_rate_hz as u64 * HOP_MS as u64 / 1000) as usize
    }

    /// A meter with a window of `window_hops`, of which no sound has come yet.
    pub(super) fn new(sample_rate_hz: u32, positions: &[Channel], window_hops: usize) -> Result<Self, Error> {
        let mut meter = EbuR128::new(positions.len() as u32, sample_rate_hz, ebur128::Mode::M)?;
        meter.set_channel_map(positions)?;
        Ok(Self {
            meter,
            correction: level_correction(f64::from(sample_rate_hz)),
            energies: VecDeque::with_capacity(window_hops),
            window_hops,
        })
    }

    /// Takes a hop of interleaved samples, all finite.
    pub(super) fn push_hop(&mut self, samples: &[f32]) {
        let lufs = self.meter.add_frames_f32(samples).and_then(|()| self.meter.loudness_window(HOP_MS));
        if self.energies.len() == self.window_hops {
            self.energies.pop_front();
        }
        // Whole frames and a window within the meter's are never refused.
        self.energies.push_back(lufs.map_or(0.0, |lufs| energy(lufs) * self.correction));
    }

    /// Loudness of the last 400 ms, LUFS: "momentary" of EBU Tech 3341. Time before the first sample counts as silence,
    /// of negative infinity.
    pub fn momentary(&self) -> f64 {
        self.ungated(BLOCK_HOPS)
    }

    /// Loudness of all of T_a without gates, LUFS: with 3 s "short-term" of EBU Tech 3341. Time before the first sample
    /// counts as silence, of negative infinity.
    pub fn short_term(&self) -> f64 {
        self.ungated(self.window_hops)
    }

    fn ungated(&self, hops: usize) -> f64 {
        lufs(self.energies.iter().rev().take(hops).sum::<f64>() / hops as f64)
    }

    /// Gated loudness of T_a, LUFS (BS.1770-4, Eq. 5-7), of the blocks that are complete; negative infinity
    /// where none is above the absolute gate.
    pub fn gated(&self) -> f64 {
        let absolute = energy(ABSOLUTE_GATE_LUFS);
        let relative = self.mean_above(absolute) * 10f64.powf(RELATIVE_GATE_LU / 10.0);
        lufs(self.mean_above(absolute.max(relative)))
    }

    /// Mean energy of the blocks above `gate`; 0 where there is none.
    fn mean_above(&self, gate: f64) -> f64 {
        let blocks = (BLOCK_HOPS..=self.energies.len())
            .map(|end| self.energies.range(end - BLOCK_HOPS..end).sum::<f64>() / BLOCK_HOPS as f64);
        let (sum, count) = blocks
            .filter(|&energy| energy > gate)
            .fold((0.0, 0u32), |(sum, count), energy| (sum + energy, count + 1));
        if count == 0 { 0.0 } else { sum / f64::from(count) }
    }
}

/// Loudness of a mean energy, LKFS (BS.1770-4, Eq. 2); negative infinity for 0.
fn lufs(energy: f64) -> f64 {
    OFFSET_LUFS + 10.0 * energy.log10()
}

/// The energy that has a loudness: the inverse of [`lufs`].
fn energy(lufs: f64) -> f64 {
    10f64.powf((lufs - OFFSET_LUFS) / 10.0)
}

/// Factor on the crate's energies that gives them at any sample rate the response that BS.1770-4 tabulates
/// for 48 kHz, as the Recommendation asks.
///
/// The standard's second filter has the numerator 1, -2, 1. Transformed from the same analogue filter to another rate
/// it would be g times that, g = 1 / (1 + K/Q + K^2) with K = tan(pi f0 / rate), relative to g at 48 kHz; the crate
/// keeps 1, -2, 1. Without the correction it would be up to 0.42 LU too loud at 8 kHz, and 0.04 LU too quiet at
/// 192 kHz; with it 0.01 LU are left from 44.1 kHz on, 0.06 LU from 16 kHz on and 0.21 LU at 8 kHz (there the
/// transform bends the first filter's shelf, which is close to half the rate).
fn level_correction(sample_rate_hz: f64) -> f64 {
    /// Corner frequency and quality of the high-pass whose form at 48 kHz is BS.1770-4's Table 2.
    const CORNER_HZ: f64 = 38.13547087602444;
    const QUALITY: f64 = 0.5003270373238773;
    let gain = |rate_hz: f64| {
        let k = (PI * CORNER_HZ / rate_hz).tan();
        1.0 / (1.0 + k / QUALITY + k * k)
    };
    (gain(sample_rate_hz) / gain(48_000.0)).powi(2)
}
