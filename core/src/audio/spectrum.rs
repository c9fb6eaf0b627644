//! Power spectra of sound, added up over frames and channels.

use super::channels;
use ebur128::Channel;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use std::f32::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// Frame length at 48 kHz, samples (Hamming window, as of mel-frequency cepstral coefficients, which paper A's Eq. 5
/// names).
const LENGTH_AT_48_KHZ: u64 = 2048;

/// The Hamming window is `MEAN - COSINE cos(2 pi n / N)`.
const MEAN: f32 = 0.54;
const COSINE: f32 = 0.46;

/// Samples of one channel that no finished frame has passed yet.
struct Pending {
    channel: usize,
    weight: f32,
    samples: Vec<f32>,
}

/// Adds up weighted power spectra of frames that overlap by half.
///
/// Powers of channels are added, not their samples, so that opposite phases do not cancel. The mean of each frame is
/// left out: a constant is not heard, but the window would spread it into the lowest bin.
pub(super) struct Spectrum {
    fft: Arc<dyn RealToComplex<f32>>,
    window: Vec<f32>,
    frame: Vec<f32>,
    bins: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
    pending: Vec<Pending>,
    channels: usize,
    power: Vec<f32>,
}

impl Spectrum {
    /// Frame length, samples: the power of two at or next above 42.7 ms, so that bins are never further apart than
    /// the 23.4 Hz that 2048 samples have at 48 kHz. 43 to 85 ms.
    pub(super) fn length(sample_rate_hz: u32) -> usize {
        let length = (LENGTH_AT_48_KHZ * u64::from(sample_rate_hz)).div_ceil(48_000);
        (length as usize).next_power_of_two()
    }

    /// For hops of `hop_frames` frames each, at least as long as one [`Self::length`].
    pub(super) fn new(sample_rate_hz: u32, positions: &[Channel], hop_frames: usize) -> Self {
        let length = Self::length(sample_rate_hz);
        let fft = RealFftPlanner::new().plan_fft_forward(length);
        let window = (0..length).map(|n| MEAN - COSINE * (TAU * n as f32 / length as f32).cos()).collect();
        let pending = positions
            .iter()
            .map(|&position| channels::weight(position))
            .enumerate()
            .filter(|&(_, weight)| weight > 0.0)
            .map(|(channel, weight)| Pending {
                channel,
                weight,
                samples: Vec::with_capacity(length + hop_frames),
            })
            .collect();
        Self {
            window,
            frame: fft.make_input_vec(),
            bins: fft.make_output_vec(),
            scratch: fft.make_scratch_vec(),
            fft,
            pending,
            channels: positions.len(),
            power: vec![0.0; length / 2 + 1],
        }
    }

    /// Takes a hop of interleaved samples, all finite, and gives the power by bin of the frames that it completed;
    /// bins outside `heard` are not computed.
    pub(super) fn push_hop(&mut self, samples: &[f32], heard: Range<usize>) -> &[f32] {
        let Self { fft, window, frame, bins, scratch, pending, channels, power } = self;
        power.fill(0.0);
        for Pending { channel, weight, samples: waiting } in pending {
            waiting.extend(samples.iter().skip(*channel).step_by(*channels));
            let mut start = 0;
            while let Some(next) = waiting.get(start..start + window.len()) {
                // Like any constant, the first sample changes nothing; without it silence on an offset is exactly 0.
                let offset = next[0];
                for ((windowed, sample), weight) in frame.iter_mut().zip(next).zip(&*window) {
                    *windowed = (sample - offset) * weight;
                }
                start += window.len() / 2;
                // The transform made the buffers itself: it never refuses them.
                if fft.process_with_scratch(frame, bins, scratch).is_err() {
                    continue;
                }
                // A constant has nothing but bin 0 and, half the cosine's share of it, bin 1.
                let constant = bins[0];
                bins[1] += constant * (0.5 * COSINE / MEAN);
                for (power, bin) in power[heard.clone()].iter_mut().zip(&bins[heard.clone()]) {
                    *power += *weight * bin.norm_sqr();
                }
            }
            waiting.drain(..start);
        }
        power
    }
}
