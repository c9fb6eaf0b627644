//! Temporal filters of the visual system: castleCSF's sustained and transient responses, as filters over frames.
//!
//! In castleCSF sensitivity is R_s(omega) G_s + R_t(omega) G_t, with G independent of temporal frequency omega. So a
//! change passes two filters with the gains R_s and R_t. The filters are symmetrical in time (they do not displace
//! the change) and [`HALF_LENGTH_S`] long on each side.

use parafovea_core::perception::csf::{Stimulus, VisualField, castle};
use std::f64::consts::PI;

/// Length of the filters before and after a change, seconds. The gains equal castleCSF's to within 0.1.
pub const HALF_LENGTH_S: f64 = 0.25;

/// Steps of the integral over frequency.
const STEPS: usize = 512;

/// Taps from the middle frame on; those before it mirror them.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    taps: Vec<f32>,
}

/// Both filters, and the peak frequency of the transient one.
pub(crate) struct Responses {
    /// Gain 1 at 0 Hz.
    pub sustained: Kernel,
    /// Gain 0 at 0 Hz and 1 at `peak_hz`.
    pub transient: Kernel,
    /// Temporal frequency that the transient response is greatest at, Hz.
    pub peak_hz: f32,
}

impl Responses {
    /// For eyes adapted to a luminance.
    pub fn new(refresh_hz: f32, luminance_cd_m2: f32) -> Self {
        let stimulus = |temporal_hz: f32| Stimulus { temporal_hz, luminance_cd_m2, ..Stimulus::default() };
        let sustained = |hz: f32| castle::sustained(&stimulus(hz), VisualField::Worst);
        let transient = |hz: f32| castle::transient(&stimulus(hz), VisualField::Worst);
        let eighths = (1..=(refresh_hz * 4.0) as u32).map(|eighth| eighth as f32 / 8.0);
        let peak_hz = eighths.max_by(|a, b| transient(*a).total_cmp(&transient(*b))).unwrap_or(0.0);
        let low = taps(refresh_hz, |hz| f64::from(sustained(hz) / sustained(0.0)));
        let mut band = taps(refresh_hz, |hz| f64::from(transient(hz) / transient(peak_hz)));
        // The window lets some of 0 Hz through: take it out again with its own shape.
        let window: Vec<f64> = (0..band.len()).map(|frame| hann(frame, band.len())).collect();
        let share = gain(&band, 0.0) / gain(&window, 0.0);
        band.iter_mut().zip(&window).for_each(|(tap, window)| *tap -= share * window);
        let at_peak = gain(&band, f64::from(peak_hz / refresh_hz));
        Self {
            sustained: Kernel::scaled(&low, gain(&low, 0.0)),
            transient: Kernel::scaled(&band, at_peak),
            peak_hz,
        }
    }
}

impl Kernel {
    fn scaled(taps: &[f64], by: f64) -> Self {
        Self { taps: taps.iter().map(|tap| (tap / by) as f32).collect() }
    }

    /// The filtered frame `middle`, added up in `sum`; the first and last frame go on for ever.
    pub fn filter<'a>(&self, frames: usize, middle: usize, sum: &mut [f32], at: impl Fn(usize) -> &'a [f32]) {
        sum.fill(0.0);
        let mut add = |frame: usize, tap: f32| {
            for (sum, value) in sum.iter_mut().zip(at(frame)) {
                *sum += tap * value;
            }
        };
        for (distance, &tap) in self.taps.iter().enumerate() {
            add((middle + distance).min(frames - 1), tap);
            if distance > 0 {
                add(middle.saturating_sub(distance), tap);
            }
        }
    }
}

/// Windowed inverse Fourier transform of a zero-phase response, from the middle on.
fn taps(refresh_hz: f32, response: impl Fn(f32) -> f64) -> Vec<f64> {
    let nyquist_hz = refresh_hz / 2.0;
    let response: Vec<f64> =
        (0..STEPS).map(|step| response(nyquist_hz * (step as f32 + 0.5) / STEPS as f32)).collect();
    let length = (HALF_LENGTH_S * f64::from(refresh_hz)).round() as usize + 1;
    let tap = |frame: usize| {
        let angle = |step: usize| PI * (step as f64 + 0.5) / STEPS as f64 * frame as f64;
        let sum: f64 = response.iter().enumerate().map(|(step, gain)| gain * angle(step).cos()).sum();
        sum / STEPS as f64 * hann(frame, length)
    };
    (0..length).map(tap).collect()
}

/// The falling half of a Hann window, which is 0 just beyond its length.
fn hann(frame: usize, length: usize) -> f64 {
    (PI * frame as f64 / length as f64 / 2.0).cos().powi(2)
}

/// Gain of a symmetrical filter at a frequency in cycles per frame.
fn gain(taps: &[f64], cycles: f64) -> f64 {
    let rest: f64 =
        taps.iter().enumerate().skip(1).map(|(at, tap)| tap * (2.0 * PI * cycles * at as f64).cos()).sum();
    taps[0] + 2.0 * rest
}

#[cfg(test)]
mod tests;
