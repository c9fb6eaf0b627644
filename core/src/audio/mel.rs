//! The mel scale, the 24 bands, and the frequency feature (paper A Eq. 2-6).

/// Number of critical bands (paper A Eq. 3).
pub const BANDS: usize = 24;

/// Range of frequencies that are heard, hertz: minMel and maxMel of Eq. 4 are the mel of these.
pub(super) const AUDIBLE_HZ: [f64; 2] = [20.0, 20_000.0];

/// Least gamma_fq, kilo-mel: the mel of 1 kHz. Below, 1 / gamma_fq of Eq. 14 would leave the range of the study; a hum
/// of 50 Hz would raise the score by 5.8.
pub const LEAST_KILOMEL: f32 = 1.0;

/// Greatest gamma_fq, kilo-mel: the mel of 6 kHz, where the study ends.
pub const GREATEST_KILOMEL: f32 = 2.5457;

/// The mel of a frequency in hertz, 2595 lg(1 + f / 700) (paper A Eq. 2). NaN and negative values count as 0.
pub fn mel_of_hz(hz: f64) -> f64 {
    2595.0 * (1.0 + hz.max(0.0) / 700.0).log10()
}

/// The frequency in hertz of a mel, the inverse of [`mel_of_hz`]. NaN and negative values count as 0.
pub fn hz_of_mel(mel: f64) -> f64 {
    700.0 * (10f64.powf(mel.max(0.0) / 2595.0) - 1.0)
}

/// gamma_fq in kilo-mel of a weighted mean in mel, limited to [`LEAST_KILOMEL`]..=[`GREATEST_KILOMEL`]; the greatest,
/// which gives the least budget, for `None` and NaN.
pub fn gamma_fq(mean_mel: Option<f64>) -> f32 {
    match mean_mel {
        Some(mel) if !mel.is_nan() => ((mel / 1000.0) as f32).clamp(LEAST_KILOMEL, GREATEST_KILOMEL),
        _ => GREATEST_KILOMEL,
    }
}

/// The triangular filters of Eq. 4-6, over the bins of a power spectrum.
///
/// Centres are `(i - 1) / 23` of the way from the mel of 20 Hz to that of 20 kHz, or of half the sample rate where
/// that is less: the paper's 24 would leave a gap of two steps before the last. The outer sides of the first and last
/// filter, for which the paper names no nodes, are absent: each ends at its centre. Triangles are not scaled to equal
/// area, so the weights of two neighbours for a bin add up to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterBank {
    /// Index of the first bin at or above 20 Hz.
    first_bin: usize,
    /// For each bin from there on: the band whose centre is at or below it, and the next band's share of it.
    bins: Vec<(usize, f64)>,
    centres_mel: [f64; BANDS],
}

impl FilterBank {
    /// Filters for the spectrum of `fft_length` samples, bin `k` of which is at `k * sample_rate_hz / fft_length`.
    /// Without bins (no energy, ever) where either is 0 or half the rate does not exceed 20 Hz.
    pub fn new(sample_rate_hz: u32, fft_length: usize) -> Self {
        let bin_hz = f64::from(sample_rate_hz) / fft_length.max(1) as f64;
        let [least_hz, greatest_hz] = AUDIBLE_HZ;
        let greatest_hz = greatest_hz.min(f64::from(sample_rate_hz) / 2.0);
        let (least, greatest) = (mel_of_hz(least_hz), mel_of_hz(greatest_hz));
        let step = (greatest - least) / (BANDS - 1) as f64;
        let centres_mel = std::array::from_fn(|i| least + i as f64 * step);

        let first_bin = (least_hz / bin_hz).ceil();
        let last_bin = (greatest_hz / bin_hz).floor().min((fft_length / 2) as f64);
        // Also where the rate is 0, which makes the first bin infinite.
        let heard = if first_bin <= last_bin { first_bin as usize..last_bin as usize + 1 } else { 0..0 };
        let bins = heard
            .clone()
            .map(|bin| {
                let position = (mel_of_hz(bin as f64 * bin_hz) - least) / step;
                let lower = (position.max(0.0) as usize).min(BANDS - 2);
                (lower, position - lower as f64)
            })
            .collect();
        Self { first_bin: heard.start, bins, centres_mel }
    }

    /// The bins that lie within the filters.
    pub fn heard_bins(&self) -> std::ops::Range<usize> {
        self.first_bin..self.first_bin + self.bins.len()
    }

    /// Centre frequencies of the bands (Eq. 4), mel, rising.
    pub fn centres_mel(&self) -> &[f64; BANDS] {
        &self.centres_mel
    }

    /// FB of Eq. 5: the energy in each band of a power spectrum, in the spectrum's unit. `power` begins at bin 0;
    /// bins that it lacks count as 0.
    pub fn energies(&self, power: &[f32]) -> [f64; BANDS] {
        let mut energies = [0.0; BANDS];
        for (&power, &(lower, share)) in power.iter().skip(self.first_bin).zip(&self.bins) {
            let power = f64::from(power);
            energies[lower] += power * (1.0 - share);
            energies[lower + 1] += power * share;
        }
        energies
    }

    /// gamma_fq of Eq. 3 before it is limited: the mean of the centres weighted by `energies`, mel. `None` where they
    /// add up to 0 or are not finite.
    pub fn mean_mel(&self, energies: &[f64; BANDS]) -> Option<f64> {
        let sum: f64 = energies.iter().sum();
        let weighted: f64 = energies.iter().zip(&self.centres_mel).map(|(energy, mel)| energy * mel).sum();
        (sum > 0.0 && weighted.is_finite()).then(|| weighted / sum)
    }
}
