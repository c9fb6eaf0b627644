//! Signals of 500 ms that are hard to measure.

use std::f64::consts::TAU;

/// A signal, the same in each channel but for a level that falls by 1 dB from one to the next.
pub(super) struct Signal {
    pub(super) name: &'static str,
    pub(super) rate_hz: u32,
    pub(super) channels: u32,
    /// Of the first channel.
    samples: Vec<f32>,
}

/// Weights of BS.1770-4, Table 4, of mono, stereo and 7.1.
const WEIGHTS: [(u32, &[f64]); 3] =
    [(1, &[1.0]), (2, &[1.0, 1.0]), (8, &[1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.41, 1.41])];

impl Signal {
    fn new(name: &'static str, rate_hz: u32, channels: u32, sample: impl Fn(u32) -> f32) -> Self {
        Self { name, rate_hz, channels, samples: (0..rate_hz / 2).map(sample).collect() }
    }

    fn gain(channel: u32) -> f32 {
        10f32.powf(-(channel as f32) / 20.0)
    }

    /// As it is pushed.
    pub(super) fn interleaved(&self) -> Vec<f32> {
        self.samples
            .iter()
            .flat_map(|sample| (0..self.channels).map(move |channel| sample * Self::gain(channel)))
            .collect()
    }

    /// Each channel with its weight, without channels that do not count by the documentation.
    pub(super) fn heard(&self) -> Vec<(f64, Vec<f64>)> {
        let (_, weights) = WEIGHTS[WEIGHTS.iter().position(|(n, _)| *n == self.channels).unwrap_or(0)];
        (0..self.channels)
            .zip(weights)
            .map(|(channel, &weight)| {
                let heard = |sample: &f32| match sample * Self::gain(channel) {
                    sample if !sample.is_finite() || sample.abs() < 1e-15 => 0.0,
                    sample => f64::from(sample.clamp(-16.0, 16.0)),
                };
                (weight, self.samples.iter().map(heard).collect())
            })
            .collect()
    }
}

fn sine(rate_hz: u32, hz: f64, n: u32) -> f32 {
    (TAU * hz * f64::from(n) / f64::from(rate_hz)).sin() as f32
}

pub(super) fn all() -> Vec<Signal> {
    vec![
        Signal::new("digital silence", 48_000, 2, |_| 0.0),
        Signal::new("DC 0.5", 48_000, 1, |_| 0.5),
        Signal::new("full-scale square of 100 Hz", 48_000, 2, |n| if n / 240 % 2 == 0 { 1.0 } else { -1.0 }),
        Signal::new("one-sample impulse", 48_000, 1, |n| f32::from(n == 20_000)),
        Signal::new("one-sample impulse, the first", 48_000, 1, |n| f32::from(n == 0)),
        Signal::new("denormals", 48_000, 1, |n| f32::MIN_POSITIVE / (2.0 + n as f32)),
        Signal::new("NaN samples in a tone", 48_000, 1, |n| {
            if n % 1000 == 7 { f32::NAN } else { 0.1 * sine(48_000, 2000.0, n) }
        }),
        Signal::new("infinite samples in a tone", 48_000, 2, |n| match n % 1000 {
            7 => f32::INFINITY,
            500 => f32::NEG_INFINITY,
            _ => 0.1 * sine(48_000, 2000.0, n),
        }),
        Signal::new("nothing but NaN", 48_000, 1, |_| f32::NAN),
        Signal::new("one sample of f32::MAX", 48_000, 1, |n| if n == 20_000 { f32::MAX } else { 0.0 }),
        Signal::new("8 kHz", 8_000, 1, |n| 0.5 * sine(8_000, 997.0, n) + 0.2 * sine(8_000, 3100.0, n)),
        Signal::new("192 kHz", 192_000, 1, |n| {
            0.5 * sine(192_000, 997.0, n) + 0.2 * sine(192_000, 5000.0, n)
        }),
        Signal::new("sound above what is heard", 192_000, 1, |n| sine(192_000, 40_000.0, n)),
        Signal::new("8 channels", 48_000, 8, |n| 0.2 * sine(48_000, 1500.0, n)),
    ]
}
