//! Confidence interval of a figure from a few frames.

use fastrand::Rng;

/// A range that a figure lies in.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// Resampling of frames (Efron 1979), in blocks, as neighbouring frames are alike (the circular block bootstrap of Politis and
/// Romano 1992).
#[derive(Clone, Copy, Debug)]
pub struct Bootstrap {
    /// Number of times that frames are drawn.
    pub resamples: usize,
    /// Frames that are drawn together, one after the other.
    pub block: usize,
    /// Frames of a clip, which are one after the other: clips are drawn first, and blocks within each (Davison and Hinkley 1997, section 3.8);
    /// 0: all frames are one clip.
    pub clip: usize,
    /// Share of the drawn figures that lie within the interval, 0..=1.
    pub confidence: f64,
    /// Of the random numbers: the same seed gives the same interval.
    pub seed: u64,
}

impl Default for Bootstrap {
    /// 1000 times blocks of 5 frames of one clip, 95 %.
    fn default() -> Self {
        Self { resamples: 1000, block: 5, clip: 0, confidence: 0.95, seed: 1 }
    }
}

impl Bootstrap {
    /// The interval of `figure` over frames that are drawn from `frames` ones, given by their indices. Where it measures several things in
    /// the same frames, these are paired. None where it finds nothing in more than one in twenty draws, or there are no frames.
    pub fn interval(
        &self,
        frames: usize,
        mut figure: impl FnMut(&[usize]) -> Option<f64>,
    ) -> Option<Interval> {
        if frames == 0 {
            return None;
        }
        let mut random = Rng::with_seed(self.seed);
        // Frames beyond the last whole clip are not drawn; if there are fewer than a clip has, they are one clip.
        let clip = if (1..frames).contains(&self.clip) { self.clip } else { frames };
        let clips = frames / clip;
        let block = self.block.clamp(1, clip);
        let mut drawn = Vec::with_capacity(frames + block);
        let mut found = Vec::with_capacity(self.resamples);
        for _ in 0..self.resamples {
            drawn.clear();
            for number in 1..=clips {
                let first = clip * random.usize(0..clips);
                while drawn.len() < number * clip {
                    let start = random.usize(0..clip);
                    drawn.extend((start..start + block).map(|frame| first + frame % clip));
                }
                drawn.truncate(number * clip);
            }
            found.extend(figure(&drawn).filter(|figure| figure.is_finite()));
        }
        if found.is_empty() || found.len() * 20 < self.resamples * 19 {
            return None;
        }
        found.sort_by(f64::total_cmp);
        let tail = (1.0 - self.confidence) / 2.0;
        let at =
            |share: f64| found[((share * (found.len() - 1) as f64).round() as usize).min(found.len() - 1)];
        Some(Interval { low: at(tail), high: at(1.0 - tail) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(values: &[f64], drawn: &[usize]) -> f64 {
        drawn.iter().map(|&frame| values[frame]).sum::<f64>() / drawn.len() as f64
    }

    #[test]
    fn constant_samples_have_an_interval_of_one_point() {
        let values = [3.0; 12];
        let interval = Bootstrap::default().interval(12, |drawn| Some(mean(&values, drawn)));
        assert_eq!(interval, Some(Interval { low: 3.0, high: 3.0 }));
    }

    /// Of independent frames the interval of the mean is 2 x 1.96 standard errors wide.
    #[test]
    fn the_interval_is_as_wide_as_the_standard_error_says() {
        let mut random = Rng::with_seed(7);
        // Sums of twelve even numbers: normal, with a standard deviation of 1.
        let values: Vec<f64> = (0..400).map(|_| (0..12).map(|_| random.f64()).sum::<f64>() - 6.0).collect();
        let bootstrap = Bootstrap { resamples: 4000, block: 1, ..Bootstrap::default() };
        let interval = bootstrap.interval(400, |drawn| Some(mean(&values, drawn))).unwrap();
        let middle = mean(&values, &(0..400).collect::<Vec<_>>());
        let variance = values.iter().map(|value| (value - middle).powi(2)).sum::<f64>() / 400.0;
        let expected = 2.0 * 1.96 * (variance / 400.0).sqrt();
        let width = interval.high - interval.low;
        assert!((width / expected - 1.0).abs() < 0.06, "{width}, not {expected}");
        assert!(interval.low < middle && middle < interval.high);
    }

    /// Frames that come in runs of alike ones are fewer than they look.
    #[test]
    fn blocks_widen_the_interval_of_frames_that_are_alike() {
        let values: Vec<f64> = (0..200).map(|frame| f64::from(frame / 10 % 2)).collect();
        let width = |block| {
            let bootstrap = Bootstrap { block, ..Bootstrap::default() };
            let interval = bootstrap.interval(200, |drawn| Some(mean(&values, drawn))).unwrap();
            interval.high - interval.low
        };
        assert!(width(5) > 1.6 * width(1), "{} and {}", width(5), width(1));
    }

    /// Frames of two clips that differ are no more than two.
    #[test]
    fn clips_that_differ_widen_the_interval() {
        let values: Vec<f64> = (0..200).map(|frame| f64::from(frame / 100) + f64::from(frame % 7)).collect();
        let interval = |clip| {
            let bootstrap = Bootstrap { clip, ..Bootstrap::default() };
            bootstrap.interval(200, |drawn| Some(mean(&values, drawn))).unwrap()
        };
        let (one, two) = (interval(0), interval(100));
        assert!(two.high - two.low > 1.5 * (one.high - one.low), "{one:?}, {two:?}");
        assert!(two.low < 3.1 && two.high > 3.9, "both clips alone are among the draws: {two:?}");
        assert_eq!(interval(200), one);
    }

    /// Two figures of the same frames: variation that both share does not widen the interval of their difference.
    #[test]
    fn pairs_stay_together() {
        let mut random = Rng::with_seed(3);
        let first: Vec<f64> = (0..60).map(|_| 100.0 * random.f64()).collect();
        let second: Vec<f64> = first.iter().map(|value| value + 1.0).collect();
        let difference = |drawn: &[usize]| Some(mean(&second, drawn) - mean(&first, drawn));
        let interval = Bootstrap::default().interval(60, difference).unwrap();
        assert!((interval.low - 1.0).abs() < 1e-9 && (interval.high - 1.0).abs() < 1e-9, "{interval:?}");
    }

    #[test]
    fn the_same_seed_gives_the_same_and_too_few_figures_give_none() {
        let values: Vec<f64> = (0..30).map(f64::from).collect();
        let with = |seed| {
            Bootstrap { seed, ..Bootstrap::default() }
                .interval(30, |drawn| Some(mean(&values, drawn)))
                .unwrap()
        };
        assert_eq!(with(1), with(1));
        assert_ne!(with(1), with(2));
        let mut calls = 0;
        let one_in_ten_fails = |_: &[usize]| {
            calls += 1;
            (calls % 10 != 0).then_some(1.0)
        };
        assert_eq!(Bootstrap::default().interval(30, one_in_ten_fails), None);
        assert_eq!(Bootstrap::default().interval(0, |_| Some(1.0)), None);
    }
}
