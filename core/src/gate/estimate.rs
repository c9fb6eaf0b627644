//! The saving of a technique, estimated from costs with it and without it.

/// Least saving for which a technique is kept, logarithm of the ratio: about 1.5 %.
pub const MARGIN: f64 = 0.015;

/// Quantile of the normal distribution for a decision ahead of the end of a trial: 99.95 %, because a trial has up to
/// 16 looks at the costs.
pub(super) const STRICT: f64 = 3.2905;

/// Quantile for the decision at the end of a full trial: 97 %. A scene has one or two such trials.
pub(super) const FINAL: f64 = 1.8808;

/// Number of standard deviations to which larger residuals are reduced (Huber's winsorizing; 1.345 would be his choice
/// for 95 % efficiency, but costs of frames have rare and large outliers rather than heavy tails).
const OUTLIER: f64 = 2.5;

/// Standard deviation of a normal distribution, in medians of its absolute values.
const OF_MEDIAN: f64 = 1.4826;

/// Rounds of winsorizing: with one frame in ten of ten times the cost, each removes two thirds of the excess.
const ROUNDS: usize = 4;

/// Least costs with and without the technique.
const LEAST: usize = 4;

/// The cost of one frame, or the mean of a few.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Point {
    /// Since the beginning of the trial, seconds.
    pub(super) at_s: f32,
    /// Natural logarithm of nanoseconds.
    pub(super) cost: f32,
    /// Frames.
    pub(super) weight: f32,
    pub(super) is_on: bool,
}

/// Result of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Verdict {
    /// Frames cost less with the technique, by more than [`MARGIN`].
    Saves,
    /// Frames do not cost less by more than [`MARGIN`].
    SavesNothing,
    /// Neither has enough confidence.
    #[default]
    Unclear,
}

/// Logarithm of the ratio of the cost with a technique to that without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate {
    mean: f64,
    standard_error: f64,
    freedom: usize,
}

impl Estimate {
    /// Least squares of the costs over the technique and, `with_drift`, over time. `scratch` has room for all points.
    ///
    /// Residuals that follow each other alike, as when a head turns, widen the error by their correlation time.
    ///
    /// None if there are too few costs on either side.
    pub(super) fn of(points: &mut [Point], with_drift: bool, scratch: &mut [f32]) -> Option<Self> {
        let on = points.iter().filter(|point| point.is_on).count();
        if on.min(points.len() - on) < LEAST {
            return None;
        }
        let scratch = scratch.get_mut(..points.len())?;
        let mut line = Line::through(points, with_drift)?;
        for _ in 0..ROUNDS {
            line.winsorize(points, scratch);
            line = Line::through(points, with_drift)?;
        }
        let freedom = points.len() - 2 - usize::from(with_drift);
        for (residual, point) in scratch.iter_mut().zip(&*points) {
            *residual = line.residual(point) as f32;
        }
        let squares: f64 = scratch.iter().map(|&residual| f64::from(residual).powi(2)).sum();
        let time = correlation_time(scratch);
        let variance = squares / freedom as f64 * time;
        let parameters = points.len() - freedom;
        let freedom = ((points.len() as f64 / time) as usize).saturating_sub(parameters).max(1);
        let estimate =
            Self { mean: line.technique, standard_error: (variance * line.inverse).sqrt(), freedom };
        (estimate.mean.is_finite() && estimate.standard_error.is_finite()).then_some(estimate)
    }

    /// The verdict with the confidence of that quantile of the normal distribution.
    pub(super) fn verdict(&self, quantile: f64) -> Verdict {
        let reach = student_t(quantile, self.freedom) * self.standard_error;
        if self.mean + reach < 0.0 && self.mean < -MARGIN {
            Verdict::Saves
        } else if self.mean - reach > -MARGIN {
            Verdict::SavesNothing
        } else {
            Verdict::Unclear
        }
    }

    /// Whether it differs from 0, with the confidence of that quantile of the normal distribution.
    pub(super) fn is_difference(&self, quantile: f64) -> bool {
        self.mean.abs() > student_t(quantile, self.freedom) * self.standard_error
    }

    /// The logarithm.
    pub(super) fn mean(&self) -> f64 {
        self.mean
    }

    /// Whether a saving is likely, without enough confidence for a decision.
    pub(super) fn is_promising(&self) -> bool {
        self.mean < -MARGIN && self.mean + self.standard_error < 0.0
    }

    /// The ratio, and its 95 % confidence interval.
    pub(super) fn ratio(&self) -> (f64, [f64; 2]) {
        let reach = student_t(1.96, self.freedom) * self.standard_error;
        (self.mean.exp(), [(self.mean - reach).exp(), (self.mean + reach).exp()])
    }
}

/// Correlation time: the number of consecutive values, 1 or more, that have the information of one independent value. 1 + 2 times the sum
/// of autocorrelations up to the first that may be chance (Sokal 1997, Monte Carlo methods, section 3).
fn correlation_time(values: &[f32]) -> f64 {
    let product = |lag: usize| -> f64 {
        let later = values.get(lag..).unwrap_or_default();
        values.iter().zip(later).map(|(&one, &other)| f64::from(one * other)).sum()
    };
    let squares = product(0);
    // Of white noise an autocorrelation has a standard error of one over the root of the count.
    let by_chance = 1.0 / (values.len() as f64).sqrt();
    let correlations = (1..=values.len() / 4).map(|lag| product(lag) / squares);
    1.0 + 2.0 * correlations.take_while(|&correlation| correlation > by_chance).sum::<f64>()
}

/// The fitted line.
struct Line {
    means: [f64; 3],
    technique: f64,
    drift: f64,
    /// Variance of `technique`, in variances of a cost of weight 1.
    inverse: f64,
}

impl Line {
    fn through(points: &[Point], with_drift: bool) -> Option<Self> {
        let values = |point: &Point| {
            let [is_on, at_s] = [f64::from(u8::from(point.is_on)), f64::from(point.at_s)];
            (f64::from(point.weight), [is_on, at_s, f64::from(point.cost)])
        };
        let (mut weights, mut means) = (0.0, [0.0; 3]);
        for (weight, values) in points.iter().map(values) {
            weights += weight;
            means.iter_mut().zip(values).for_each(|(mean, value)| *mean += weight * value);
        }
        means.iter_mut().for_each(|mean| *mean /= weights);
        let mut sums = [[0.0; 3]; 3];
        for (weight, values) in points.iter().map(values) {
            for row in 0..3 {
                for column in 0..3 {
                    sums[row][column] +=
                        weight * (values[row] - means[row]) * (values[column] - means[column]);
                }
            }
        }
        let [[xx, xt, xy], [_, tt, ty], _] = sums;
        let determinant = xx * tt - xt * xt;
        let (technique, drift, inverse) = if with_drift && determinant > 1e-9 * xx * tt {
            ((xy * tt - ty * xt) / determinant, (ty * xx - xy * xt) / determinant, tt / determinant)
        } else {
            (xy / xx, 0.0, 1.0 / xx)
        };
        (technique.is_finite() && inverse.is_finite()).then_some(Self { means, technique, drift, inverse })
    }

    /// Winsorizes outliers.
    fn winsorize(&self, points: &mut [Point], scratch: &mut [f32]) {
        for (residual, point) in scratch.iter_mut().zip(&*points) {
            *residual = self.residual(point).abs() as f32;
        }
        let (_, &mut median, _) = scratch.select_nth_unstable_by(points.len() / 2, f32::total_cmp);
        let most = OUTLIER * OF_MEDIAN * f64::from(median);
        for point in points {
            let residual = self.residual(point);
            // Not to the line's own scale of 0, where more than half of the costs are alike.
            if most > 0.0 {
                let excess = residual - residual.clamp(-most, most);
                point.cost -= (excess / f64::from(point.weight).sqrt()) as f32;
            }
        }
    }

    /// Times the root of the weight, so that all have one variance.
    fn residual(&self, point: &Point) -> f64 {
        let is_on = f64::from(u8::from(point.is_on)) - self.means[0];
        let at_s = f64::from(point.at_s) - self.means[1];
        let expected = self.means[2] + self.technique * is_on + self.drift * at_s;
        (f64::from(point.cost) - expected) * f64::from(point.weight).sqrt()
    }
}

/// The quantile of Student's distribution that belongs to one of the normal distribution (Abramowitz and Stegun, 26.7.5,
/// three terms).
fn student_t(quantile: f64, degrees_of_freedom: usize) -> f64 {
    let (z, n) = (quantile, degrees_of_freedom.max(1) as f64);
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + first / n + second / (n * n) + third / (n * n * n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs in four segments of so many frames, by turns with the technique and without; `noise` of each frame.
    fn points(frames: usize, ratio: f64, drift: f64, noise: impl Fn(usize) -> f64) -> Vec<Point> {
        let point = |frame: usize| {
            let is_on = (frame / frames).is_multiple_of(2);
            let cost = if is_on { ratio.ln() } else { 0.0 } + drift * frame as f64 + noise(frame);
            Point { at_s: frame as f32, cost: cost as f32, weight: 1.0, is_on }
        };
        (0..4 * frames).map(point).collect()
    }

    fn estimate(mut points: Vec<Point>) -> Estimate {
        let mut scratch = vec![0.0; points.len()];
        Estimate::of(&mut points, true, &mut scratch).unwrap()
    }

    fn alternating(frame: usize) -> f64 {
        [0.03, -0.02, 0.01, -0.05, 0.04, -0.01, 0.02, -0.02][frame % 8]
    }

    /// Table values of Student's t: 97.5 % with 5, 10 and 30, 99.9 % with 10 and 30 degrees of freedom.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (quantile, freedom, expected) in
            [(1.96, 5, 2.571), (1.96, 10, 2.228), (1.96, 30, 2.042), (3.0902, 10, 4.144), (3.0902, 30, 3.385)]
        {
            let found = student_t(quantile, freedom);
            assert!((found / expected - 1.0).abs() < 0.005, "{found}, not {expected}");
        }
    }

    #[test]
    fn a_drift_is_no_saving() {
        for (ratio, verdict) in
            [(0.8, Verdict::Saves), (1.0, Verdict::SavesNothing), (1.2, Verdict::SavesNothing)]
        {
            let found = estimate(points(64, ratio, 0.01, |frame| 0.1 * alternating(frame)));
            assert!((found.ratio().0 / ratio - 1.0).abs() < 0.01, "{found:?}");
            assert_eq!(found.verdict(STRICT), verdict, "{found:?}");
        }
    }

    #[test]
    fn outliers_are_winsorized() {
        let outlier = |frame: usize| if frame % 10 == 3 { 2.3 } else { alternating(frame) };
        let found = estimate(points(40, 0.9, 0.0, outlier));
        assert_eq!(found.verdict(STRICT), Verdict::Saves, "{found:?}");
    }

    /// Slow waves leave few independent costs: an error that took them for many would decide.
    #[test]
    fn slow_waves_are_not_taken_for_many_costs() {
        let wave = |frame: usize| 0.2 * (frame as f64 / 15.0).sin();
        let found = estimate(points(40, 0.95, 0.0, wave));
        assert_eq!(found.verdict(STRICT), Verdict::Unclear, "{found:?}");
    }

    #[test]
    fn half_a_percent_is_nothing() {
        let found = estimate(points(100, 0.995, 0.0, |frame| 0.01 * alternating(frame)));
        assert_eq!(found.verdict(STRICT), Verdict::SavesNothing, "{found:?}");
    }

    #[test]
    fn few_costs_say_nothing() {
        let mut few = points(3, 0.5, 0.0, alternating);
        few.truncate(6);
        assert_eq!(Estimate::of(&mut few, true, &mut [0.0; 6]), None);
    }
}
