//! What many noisy frames say together.

use crate::record::median;

/// Times of frames in milliseconds, grouped by turns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    turns: Vec<Vec<f64>>,
}

impl Samples {
    /// Adds a turn.
    pub fn push(&mut self, turn: Vec<f64>) {
        self.turns.push(turn);
    }

    /// Frames of all turns.
    pub fn len(&self) -> usize {
        self.turns.iter().map(Vec::len).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Median of all frames; NaN without any.
    pub fn median(&self) -> f64 {
        median(self.turns.concat()).unwrap_or(f64::NAN)
    }

    /// The value that `share` (0..=1) of all frames do not exceed, by the nearest rank; NaN without any.
    pub fn quantile(&self, share: f64) -> f64 {
        let mut all = self.turns.concat();
        all.sort_by(f64::total_cmp);
        let rank = (share * all.len() as f64).ceil() as usize;
        all.get(rank.saturating_sub(1).min(all.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
    }

    /// The slowest frame; NaN without any.
    pub fn worst(&self) -> f64 {
        self.quantile(1.0)
    }

    /// The least that each frame of a turn took in any turn: all turns render the same, and what else the machine does only
    /// adds to that. As many frames as the shortest turn has.
    pub fn least(&self) -> impl Iterator<Item = f64> {
        let frames = self.turns.iter().map(Vec::len).min().unwrap_or(0);
        (0..frames).map(|frame| self.turns.iter().map(|turn| turn[frame]).fold(f64::INFINITY, f64::min))
    }

    /// How many times as long as `baseline` it took, by the sum of the [`Self::least`] that each frame took; and how much turns
    /// differ: of each turn the ratio of the medians, of these half of the range in which their middle half lies. The turns of
    /// both must have been taken together, and have the same frames.
    pub fn ratio_to(&self, baseline: &Self) -> Ratio {
        let medians = |samples: &Self| samples.turns.iter().cloned().map(median).collect::<Vec<_>>();
        let pairs = medians(self).into_iter().zip(medians(baseline));
        let ratios = Self { turns: vec![pairs.filter_map(|(a, b)| Some(a? / b?)).collect()] };
        let value = self.least().sum::<f64>() / baseline.least().sum::<f64>();
        Ratio { value, spread: (ratios.quantile(0.75) - ratios.quantile(0.25)) / 2.0 }
    }
}

/// A ratio of two measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// Half of the interquartile range of the turns' ratios.
    pub spread: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(turns: &[&[f64]]) -> Samples {
        let mut samples = Samples::default();
        turns.iter().for_each(|turn| samples.push(turn.to_vec()));
        samples
    }

    #[test]
    fn quantiles_are_of_all_frames() {
        let samples = samples(&[&[3.0, 1.0], &[2.0, 10.0]]);
        assert_eq!(samples.median(), 2.5);
        assert_eq!([0.0, 0.25, 0.5, 0.99].map(|share| samples.quantile(share)), [1.0, 1.0, 2.0, 10.0]);
        assert_eq!(samples.worst(), 10.0);
        assert!(Samples::default().worst().is_nan() && Samples::default().median().is_nan());
    }

    /// What slows a turn or a frame down does not change the ratio, which the ratio of the medians would show.
    #[test]
    fn ratios_are_of_what_was_disturbed_least() {
        let baseline = samples(&[&[10.0, 10.0], &[30.0, 30.0], &[10.0]]);
        let half = samples(&[&[5.0, 5.0], &[15.0, 15.0], &[5.0]]);
        assert_eq!(half.ratio_to(&baseline), Ratio { value: 0.5, spread: 0.0 });
        let (frames, disturbed) =
            (samples(&[&[10.0, 20.0], &[10.0, 20.0]]), samples(&[&[9.0, 12.0], &[6.0, 90.0], &[50.0, 9.0]]));
        assert_eq!(disturbed.ratio_to(&frames).value, 0.5);
        let varied = samples(&[&[4.0], &[15.0], &[6.0]]);
        assert!((varied.ratio_to(&baseline).spread - 0.1).abs() < 1e-12);
    }
}
