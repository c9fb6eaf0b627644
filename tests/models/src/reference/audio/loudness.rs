//! K-weighting, windows and gates of BS.1770-4.

use std::f64::consts::PI;

/// A filter of second order: `numerator` over `denominator`, each by powers of z^-1.
#[derive(Clone, Copy, Debug)]
pub struct Biquad {
    numerator: [f64; 3],
    denominator: [f64; 3],
}

/// The two filters as BS.1770-4 tabulates them for 48 kHz (Annex 1, Tables 1 and 2).
pub const K_WEIGHTING_48_KHZ: [Biquad; 2] = [
    Biquad {
        numerator: [1.53512485958697, -2.69169618940638, 1.19839281085285],
        denominator: [1.0, -1.69065929318241, 0.73248077421585],
    },
    Biquad { numerator: [1.0, -2.0, 1.0], denominator: [1.0, -1.99004745483398, 0.99007225036621] },
];

/// Between powers of z^-1 and powers of x = (1 - z^-1) / (1 + z^-1), which is its own inverse but for a factor of 4.
fn bilinear([c0, c1, c2]: [f64; 3]) -> [f64; 3] {
    [c0 + c1 + c2, 2.0 * (c0 - c2), c0 - c1 + c2]
}

impl Biquad {
    /// The filter that has at `rate_hz` the response that this one has at 48 kHz: through the analogue filter, which
    /// keeps its corner frequency.
    fn at_rate(self, rate_hz: f64) -> Self {
        let [a0, _, a2] = bilinear(self.denominator);
        let corner_hz = (a0 / a2).sqrt().atan() / PI * 48_000.0;
        let scale = (PI * corner_hz / 48_000.0).tan() / (PI * corner_hz / rate_hz).tan();
        let moved = |polynomial| {
            let [c0, c1, c2] = bilinear(polynomial);
            bilinear([c0, c1 * scale, c2 * scale * scale])
        };
        let (numerator, denominator) = (moved(self.numerator), moved(self.denominator));
        let unit = denominator[0];
        Self { numerator: numerator.map(|c| c / unit), denominator: denominator.map(|c| c / unit) }
    }

    fn filtered(&self, samples: &[f64]) -> Vec<f64> {
        let ([b0, b1, b2], [_, a1, a2]) = (self.numerator, self.denominator);
        let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
        samples
            .iter()
            .map(|&x| {
                let y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
                (x2, x1, y2, y1) = (x1, x, y1, y);
                y
            })
            .collect()
    }
}

/// Weighted mean square of each 100 ms of a signal.
pub struct Energies(Vec<f64>);

impl Energies {
    /// Of `channels`, each with its weight (BS.1770-4, Table 4).
    pub fn new(rate_hz: u32, channels: &[(f64, Vec<f64>)]) -> Self {
        let hop = rate_hz as usize / 10;
        let filters = K_WEIGHTING_48_KHZ.map(|filter| filter.at_rate(f64::from(rate_hz)));
        let mut energies = Vec::new();
        for (weight, samples) in channels {
            let weighted = filters.iter().fold(samples.clone(), |samples, filter| filter.filtered(&samples));
            let hops = weighted.chunks_exact(hop);
            energies.resize(hops.len(), 0.0);
            for (energy, hop) in energies.iter_mut().zip(hops) {
                *energy += weight * hop.iter().map(|y| y * y).sum::<f64>() / hop.len() as f64;
            }
        }
        Self(energies)
    }

    /// Loudness of the last `hops` of 100 ms, LKFS; silence before the beginning.
    pub fn ungated_lufs(&self, hops: usize) -> f64 {
        let first = self.0.len().saturating_sub(hops);
        lufs(self.0[first..].iter().sum::<f64>() / hops as f64)
    }

    /// Gated loudness of the last `hops` of 100 ms, LKFS (BS.1770-4, Eq. 3-7).
    pub fn gated_lufs(&self, hops: usize) -> f64 {
        let first = self.0.len().saturating_sub(hops);
        let blocks: Vec<f64> =
            self.0[first..].windows(4).map(|block| block.iter().sum::<f64>() / 4.0).collect();
        let loudness_above = |gate: f64| {
            let loud: Vec<f64> = blocks.iter().copied().filter(|&energy| lufs(energy) > gate).collect();
            lufs(loud.iter().sum::<f64>() / loud.len().max(1) as f64)
        };
        let relative_gate = loudness_above(-70.0) - 10.0;
        loudness_above(relative_gate.max(-70.0))
    }
}

fn lufs(energy: f64) -> f64 {
    -0.691 + 10.0 * energy.log10()
}
