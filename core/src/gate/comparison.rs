//! The comparison of costs at different resolutions.
//!
//! A game with *dynamic resolution* holds the cost of its frames: a technique that saves time gives it more pixels at the same cost. The
//! share of the cost that follows the pixels is unknown, and no fit finds it, because such a game changes its pixels by the cost. So costs
//! are compared at both ends of the possible shares, and only a verdict that holds at both counts:
//!
//! - all of the cost follows the pixels: the cost per pixel;
//! - none of it does: the cost alone; or half of it, once the pixels follow the technique, in segments that are long enough to show it.
//!
//! Pixels that change for any other reason follow the technique only by chance; even then, a clearly higher cost is no saving. At a
//! constant resolution both ends are the cost alone.

use super::estimate::{Estimate, FINAL, MARGIN, Point, STRICT, Verdict};
use super::trial::{MOST_POINTS, SEGMENTS};

/// The cost and the resolution of one frame, or their means over a few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Since the beginning of the trial, seconds.
    pub(super) at_s: f32,
    /// Natural logarithm of nanoseconds.
    pub(super) cost: f32,
    /// Natural logarithm of the pixels, relative to the first frame.
    pub(super) pixels: f32,
}

impl Sample {
    pub(super) const ZERO: Self = Self { at_s: 0.0, cost: 0.0, pixels: 0.0 };
}

/// Least share of the cost that follows the pixels, where the pixels follow the technique: with less, they would hardly control the cost.
const LEAST_SHARE: f32 = 0.5;

/// Least change of the pixels at a switch, as a share of their mean difference between on and off: a resolution that changes once does not
/// follow.
const LEAST_CHANGE: f64 = 0.5;

/// Least length of a segment, seconds, that shows whether pixels follow the technique: in a shorter one, pixels that wander seem to stay.
const LEAST_S: f32 = 1.5;

/// The saving at both ends of the possible shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Comparison {
    /// The end with the smaller saving.
    worse: Estimate,
    better: Estimate,
}

impl Comparison {
    /// The comparison of up to [`SEGMENTS`] segments, each with its samples and the weight of a sample, with the technique on and off in
    /// alternation. `None` if there are too few samples on either side.
    ///
    /// Before the third segment a drift cannot be distinguished from a saving, and no drift is assumed.
    pub(super) fn of<'a>(
        segments: impl ExactSizeIterator<Item = (&'a [Sample], f32)> + Clone,
        begins_on: bool,
    ) -> Option<Self> {
        let is_on = |at: usize| begins_on == at.is_multiple_of(2);
        let estimate = |value: &dyn Fn(&Sample) -> f32| {
            let samples = segments.clone().enumerate().flat_map(|(at, (samples, weight))| {
                samples.iter().map(move |sample| (is_on(at), weight, sample))
            });
            let mut points = [Point::default(); MOST_POINTS];
            let mut len = 0;
            for (point, (is_on, weight, sample)) in points.iter_mut().zip(samples) {
                *point = Point { at_s: sample.at_s, cost: value(sample), weight, is_on };
                len += 1;
            }
            Estimate::of(&mut points[..len], segments.len() > 2, &mut [0.0; MOST_POINTS])
        };
        let at_share = |share: f32| estimate(&|sample| sample.cost - share * sample.pixels);
        let cost = estimate(&|sample| sample.cost)?;
        if segments.clone().all(|(samples, _)| samples.iter().all(|sample| sample.pixels == 0.0)) {
            return Some(Self { worse: cost, better: cost });
        }
        let is_long = |samples: &[Sample]| match samples {
            [first, .., last] => last.at_s - first.at_s >= LEAST_S,
            _ => false,
        };
        // More pixels at a clearly higher cost may be worth less than they cost.
        let may_follow = segments.len() > 2
            && segments.clone().skip(1).all(|(samples, _)| is_long(samples))
            && !(cost.mean() > MARGIN && cost.is_difference(STRICT));
        let mut means = [f64::NAN; SEGMENTS];
        for (mean, (samples, _)) in means.iter_mut().zip(segments.clone()) {
            let sum: f64 = samples.iter().map(|sample| f64::from(sample.pixels)).sum();
            *mean = sum / samples.len() as f64;
        }
        let pixels = if may_follow { estimate(&|sample| sample.pixels) } else { None };
        let least = match pixels {
            Some(pixels) if follows(&means[..segments.len()], begins_on, &pixels) => at_share(LEAST_SHARE)?,
            _ => cost,
        };
        let most = at_share(1.0)?;
        let [better, worse] = if least.mean() < most.mean() { [least, most] } else { [most, least] };
        Some(Self { worse, better })
    }

    /// The smaller saving.
    pub(super) fn estimate(&self) -> Estimate {
        self.worse
    }

    /// Whether a further trial may find a saving: one is likely at an end of the shares, and the other end does not exclude it.
    pub(super) fn is_promising(&self) -> bool {
        let is_excluded = self.worse.verdict(FINAL) == Verdict::SavesNothing;
        self.worse.is_promising() || self.better.is_promising() && !is_excluded
    }

    /// The verdict of both ends, with the confidence of that quantile of the normal distribution.
    pub(super) fn verdict(&self, quantile: f64) -> Verdict {
        let verdict = self.worse.verdict(quantile);
        if verdict == self.better.verdict(quantile) { verdict } else { Verdict::Unclear }
    }
}

/// Whether the pixels follow the technique: a difference between on and off, and a change in its direction at every switch, two or more.
/// `means`: mean pixels of each segment.
fn follows(means: &[f64], begins_on: bool, difference: &Estimate) -> bool {
    let mut changes = means.windows(2).enumerate().map(|(at, pair)| {
        let turned_off = begins_on == at.is_multiple_of(2);
        (if turned_off { pair[0] - pair[1] } else { pair[1] - pair[0] }) / difference.mean()
    });
    means.len() > 2 && difference.is_difference(STRICT) && changes.all(|change| change >= LEAST_CHANGE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Frames in a segment.
    const FRAMES: usize = 150;

    /// Three or four segments that begin with the technique, of frames with these costs and pixels, natural logarithms, by the number of the
    /// frame and the technique. Costs have noise.
    fn compare(segments: usize, frame: impl Fn(usize, bool) -> (f64, f64)) -> Comparison {
        let sample = |number: usize| {
            let (cost, pixels) = frame(number, (number / FRAMES).is_multiple_of(2));
            let noise = [0.03, -0.02, 0.01, -0.05, 0.04, -0.01, 0.02, -0.02][number * 5 % 8];
            Sample { at_s: number as f32 / 90.0, cost: (cost + noise) as f32, pixels: pixels as f32 }
        };
        let samples: Vec<Sample> = (0..segments * FRAMES).map(sample).collect();
        Comparison::of(samples.chunks(FRAMES).map(|segment| (segment, 1.0)), true).unwrap()
    }

    fn on(is_on: bool, value: f64) -> f64 {
        if is_on { value } else { 0.0 }
    }

    proptest! {
        /// More pixels at the same cost are a saving, and fewer are none; the reported saving is the smaller one.
        #[test]
        fn pixels_that_follow_the_technique_count(more in 0.05f64..0.7, segments in 3usize..=4) {
            let comparison = compare(segments, |_, is_on| (0.0, on(is_on, more)));
            prop_assert_eq!(comparison.verdict(STRICT), Verdict::Saves);
            prop_assert!((comparison.estimate().mean() + more / 2.0).abs() < 0.01);
            let comparison = compare(segments, |_, is_on| (0.0, on(is_on, -more)));
            prop_assert_eq!(comparison.verdict(STRICT), Verdict::SavesNothing);
        }

        /// One change of the resolution at any time, at any share of the cost, is no saving.
        #[test]
        fn one_change_of_the_resolution_is_no_saving(
            at in 1usize..4 * FRAMES,
            change in -0.7f64..0.7,
            share in 0.0f64..1.0,
            costs in 0.0f64..0.3,
            segments in 3usize..=4,
        ) {
            let comparison = compare(segments, |frame, is_on| {
                let pixels = if frame >= at { change } else { 0.0 };
                (share * pixels + on(is_on, costs), pixels)
            });
            prop_assert_ne!(comparison.verdict(STRICT), Verdict::Saves);
        }

        /// A lower cost with fewer pixels is a saving only if a pixel costs less, too.
        #[test]
        fn fewer_pixels_are_no_saving(less in 0.1f64..0.5, fewer in 0.0f64..0.5) {
            let comparison = compare(4, |_, is_on| (on(is_on, -less), on(is_on, -fewer)));
            prop_assert!(fewer < less || comparison.verdict(STRICT) != Verdict::Saves);
            prop_assert!(fewer > less - 0.05 || comparison.verdict(STRICT) == Verdict::Saves);
        }

        /// More pixels at a clearly higher cost are no saving, even if a pixel costs less.
        #[test]
        fn more_pixels_do_not_excuse_a_higher_cost(higher in 0.02f64..0.3, more in 0.0f64..0.7) {
            let comparison = compare(4, |_, is_on| (on(is_on, higher), on(is_on, more)));
            prop_assert_ne!(comparison.verdict(STRICT), Verdict::Saves);
        }

        /// A constant resolution does not change the estimate of the costs.
        #[test]
        fn a_constant_resolution_leaves_costs_alone(change in -0.3f64..0.3) {
            let comparison = compare(4, |_, is_on| (on(is_on, change), 0.0));
            prop_assert_eq!(comparison.worse, comparison.better);
            prop_assert!((comparison.estimate().mean() - change).abs() < 0.01);
        }
    }

    #[test]
    fn few_samples_have_no_comparison() {
        let samples = [Sample { pixels: 0.5, ..Sample::ZERO }; 3];
        assert_eq!(Comparison::of([(&samples[..], 1.0), (&samples[..], 1.0)].into_iter(), true), None);
        assert_eq!(Comparison::of([(&samples[..0], 1.0); 3].into_iter(), false), None);
    }
}
