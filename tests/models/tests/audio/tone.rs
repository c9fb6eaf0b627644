//! Signals made of sines.

use std::f64::consts::TAU;

/// Part of a signal: seconds, and the peak level of each channel in dBFS.
pub type Part<'a> = (f64, &'a [f64]);

/// Level of silence, dBFS.
pub const SILENCE: f64 = f64::NEG_INFINITY;

/// Sines of `hz`, in phase in all channels, interleaved.
pub fn tones(rate_hz: u32, hz: f64, parts: &[Part<'_>]) -> Vec<f32> {
    let mut samples = Vec::new();
    for (seconds, levels_dbfs) in parts {
        for n in 0..(seconds * f64::from(rate_hz)).round() as u64 {
            let sine = (TAU * hz * n as f64 / f64::from(rate_hz)).sin();
            samples.extend(levels_dbfs.iter().map(|level| (10f64.powf(level / 20.0) * sine) as f32));
        }
    }
    samples
}
