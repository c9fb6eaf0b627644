//! The power-weighted mean on the mel scale, to which the triangular bands amount.

use std::f64::consts::TAU;

/// Paper A Eq. 2.
pub fn mel(hz: f64) -> f64 {
    2595.0 * (1.0 + hz / 700.0).log10()
}

/// Mean mel of `channels`, each with its weight, over 20 Hz..=20 kHz: of the power spectra of all frames of `length`
/// samples under a Hamming window, which overlap by half and each lack their (windowed) mean. Bin by bin, by the
/// definition of the discrete Fourier transform. `None` without power.
pub fn mean_mel(rate_hz: u32, length: usize, channels: &[(f64, Vec<f64>)]) -> Option<f64> {
    let circle: Vec<(f64, f64)> = (0..length).map(|n| (TAU * n as f64 / length as f64).sin_cos()).collect();
    let window: Vec<f64> = circle.iter().map(|(_, cos)| 0.54 - 0.46 * cos).collect();
    let window_sum: f64 = window.iter().sum();
    let (mut weighted, mut sum) = (0.0, 0.0);
    for (weight, samples) in channels.iter().filter(|(weight, _)| *weight > 0.0) {
        for frame in samples.windows(length).step_by(length / 2) {
            // Relative to the first sample, so that a constant leaves 0, without an error of rounding.
            let frame: Vec<f64> = frame.iter().map(|x| x - frame[0]).collect();
            let mean = frame.iter().zip(&window).map(|(x, w)| x * w).sum::<f64>() / window_sum;
            let frame: Vec<f64> = frame.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
            for bin in 0..=length / 2 {
                let hz = bin as f64 * f64::from(rate_hz) / length as f64;
                if !(20.0..=20_000.0).contains(&hz) {
                    continue;
                }
                // Samples n and length - n share a cosine, and have opposite sines.
                let (mut re, mut im) =
                    (frame[0] + frame[length / 2] * circle[bin * (length / 2) % length].1, 0.0);
                let mut at = 0;
                for (n, x) in frame[..length / 2].iter().enumerate().skip(1) {
                    // bin * n modulo length, without dividing millions of times.
                    at += bin;
                    at -= if at >= length { length } else { 0 };
                    let ((sin, cos), mirrored) = (circle[at], frame[length - n]);
                    re += (x + mirrored) * cos;
                    im += (x - mirrored) * sin;
                }
                let power = weight * (re * re + im * im);
                weighted += power * mel(hz);
                sum += power;
            }
        }
    }
    (sum > 0.0).then(|| weighted / sum)
}
