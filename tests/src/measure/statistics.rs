//! Statistics of many noisy frames.

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

    /// Time of each frame of a turn, in the mean of the turns. As many frames as the shortest turn has.
    pub fn by_frame(&self) -> impl Iterator<Item = f64> {
        let frames = self.turns.iter().map(Vec::len).min().unwrap_or(0);
        let mean =
            |frame| self.turns.iter().map(|turn| turn[frame]).sum::<f64>() / self.turns.len().max(1) as f64;
        (0..frames).map(mean)
    }

    /// Ratio of its time to that of `baseline`: of each turn the ratio of the sums over all frames, of these the mean of the middle
    /// half; and half of their interquartile range. The turns of both must have been taken together, side by side, and have the same
    /// frames, so that interference slows down both alike. The remaining error is a difference between processes, some 5 % for as
    /// long as they run.
    pub fn ratio_to(&self, baseline: &Self) -> Ratio {
        let sums = |samples: &Self| samples.turns.iter().map(|turn| turn.iter().sum()).collect::<Vec<f64>>();
        let ratios = sums(self).into_iter().zip(sums(baseline)).map(|(own, other): (f64, f64)| own / other);
        let of_turns = Self { turns: vec![ratios.collect()] };
        let [low, high] = [0.25, 0.75].map(|share| of_turns.quantile(share));
        let middle: Vec<f64> =
            of_turns.turns.concat().into_iter().filter(|ratio| (low..=high).contains(ratio)).collect();
        Ratio { value: middle.iter().sum::<f64>() / middle.len() as f64, spread: (high - low) / 2.0 }
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

    /// A disturbance of a whole turn does not change the ratio, but would change the ratio of the medians; nor does a turn in which only
    /// one was slowed down.
    #[test]
    fn ratios_are_of_turns() {
        let baseline = samples(&[&[10.0, 10.0], &[30.0, 30.0], &[10.0]]);
        let half = samples(&[&[5.0, 5.0], &[15.0, 15.0], &[5.0]]);
        assert_eq!(half.ratio_to(&baseline), Ratio { value: 0.5, spread: 0.0 });
        let ten = samples(&[&[10.0][..]; 6]);
        let varied = samples(&[&[1.0], &[4.0], &[5.0], &[5.5], &[6.5], &[90.0]]).ratio_to(&ten);
        assert!((varied.value - 0.525).abs() < 1e-12, "0.4, 0.5, 0.55 and 0.65 are the middle: {varied:?}");
        assert!((varied.spread - 0.125).abs() < 1e-12, "{varied:?}");
        assert!(Samples::default().ratio_to(&baseline).value.is_nan());
    }

    #[test]
    fn frames_are_means_of_turns() {
        let frames: Vec<f64> = samples(&[&[1.0, 4.0, 9.0], &[3.0, 6.0]]).by_frame().collect();
        assert_eq!(frames, [2.0, 5.0]);
        assert_eq!(Samples::default().by_frame().count(), 0);
    }
}
