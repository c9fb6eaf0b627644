//! The mean difference in bits of two codecs, or of two pictures in one, at equal quality (Bjøntegaard, "Calculation of average PSNR differences between
//! RD-curves", VCEG-M33, 2001).

/// A picture, encoded at one setting of quality.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RatePoint {
    /// Bits, or any other measure of size, above 0.
    pub bits: f64,
    /// Quality, decibels.
    pub psnr_db: f64,
}

/// Reason for a missing figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BdRateError {
    /// A size that has no logarithm, or a quality that is not a number.
    #[error("a point has no bits, or no finite quality")]
    Point,
    /// Two points of equal quality.
    #[error("two settings give the same quality")]
    Equal,
    /// The ranges of quality do not meet.
    #[error("both are never of equal quality")]
    Apart,
}

/// Relative increase of the bits from `reference` to `test`, in the mean over the qualities that both have: -0.1 for a
/// tenth less. The logarithm of the bits of each is a cubic of the quality through its four points.
///
/// # Errors
/// [`BdRateError`].
pub fn bd_rate(reference: &[RatePoint; 4], test: &[RatePoint; 4]) -> Result<f64, BdRateError> {
    let range = |points: &[RatePoint; 4]| {
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point.psnr_db), high.max(point.psnr_db))
        })
    };
    let (curves, ranges) = ([curve(reference)?, curve(test)?], [range(reference), range(test)]);
    let (low, high) = (ranges[0].0.max(ranges[1].0), ranges[0].1.min(ranges[1].1));
    if low >= high {
        return Err(BdRateError::Apart);
    }
    let mean = |curve: &Cubic| (curve.integral(high) - curve.integral(low)) / (high - low);
    Ok((mean(&curves[1]) - mean(&curves[0])).exp() - 1.0)
}

/// A cubic around `centre`, lowest power first.
struct Cubic {
    centre: f64,
    powers: [f64; 4],
}

impl Cubic {
    /// Its integral from `centre` on.
    fn integral(&self, to: f64) -> f64 {
        let x = to - self.centre;
        self.powers
            .iter()
            .enumerate()
            .map(|(power, factor)| factor * x.powi(power as i32 + 1) / (power + 1) as f64)
            .sum()
    }
}

/// The cubic through the four logarithms, by Newton's divided differences.
fn curve(points: &[RatePoint; 4]) -> Result<Cubic, BdRateError> {
    if points.iter().any(|point| !(point.bits > 0.0 && point.bits.is_finite() && point.psnr_db.is_finite())) {
        return Err(BdRateError::Point);
    }
    let centre = points.iter().map(|point| point.psnr_db).sum::<f64>() / 4.0;
    let x = points.map(|point| point.psnr_db - centre);
    let mut differences = points.map(|point| point.bits.ln());
    for order in 1..4 {
        for index in (order..4).rev() {
            let step = x[index] - x[index - order];
            if step == 0.0 {
                return Err(BdRateError::Equal);
            }
            differences[index] = (differences[index] - differences[index - 1]) / step;
        }
    }
    // Horner's scheme, with polynomials in place of numbers.
    let mut powers = [0.0; 4];
    for index in (0..4).rev() {
        let times = powers;
        for (power, factor) in powers.iter_mut().enumerate() {
            *factor = if power > 0 { times[power - 1] } else { 0.0 } - x[index] * times[power];
        }
        powers[0] += differences[index];
    }
    Ok(Cubic { centre, powers })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: [(f64, f64); 4]) -> [RatePoint; 4] {
        points.map(|(bits, psnr_db)| RatePoint { bits, psnr_db })
    }

    const REFERENCE: [(f64, f64); 4] = [(686.76, 40.28), (309.58, 37.18), (157.11, 34.24), (85.95, 31.42)];
    const TEST: [(f64, f64); 4] = [(893.34, 40.39), (407.8, 37.21), (204.93, 34.17), (112.75, 31.24)];

    /// By numpy's polyfit and polyint.
    const EXPECTED: f64 = 0.313973741;

    #[test]
    fn a_tenth_less_at_every_quality_is_a_tenth_less() {
        let less = REFERENCE.map(|(bits, psnr_db)| (0.9 * bits, psnr_db));
        let rate = bd_rate(&points(REFERENCE), &points(less)).unwrap();
        assert!((rate + 0.1).abs() < 1e-12, "{rate}");
        let back = bd_rate(&points(less), &points(REFERENCE)).unwrap();
        assert!((back - 1.0 / 9.0).abs() < 1e-12, "{back}");
        assert!(bd_rate(&points(REFERENCE), &points(REFERENCE)).unwrap().abs() < 1e-12);
    }

    #[test]
    fn known_curves_have_their_known_difference() {
        let rate = bd_rate(&points(REFERENCE), &points(TEST)).unwrap();
        assert!((rate - EXPECTED).abs() < 1e-6, "{rate}, not {EXPECTED}");
        // In any order.
        let mut shuffled = points(TEST);
        shuffled.swap(0, 3);
        shuffled.swap(1, 2);
        assert!((bd_rate(&points(REFERENCE), &shuffled).unwrap() - EXPECTED).abs() < 1e-6);
    }

    #[test]
    fn incomparable_curves_are_refused() {
        let better = REFERENCE.map(|(bits, psnr_db)| (bits, psnr_db + 20.0));
        assert_eq!(bd_rate(&points(REFERENCE), &points(better)), Err(BdRateError::Apart));
        let mut broken = points(REFERENCE);
        broken[2].bits = 0.0;
        assert_eq!(bd_rate(&points(REFERENCE), &broken), Err(BdRateError::Point));
        broken[2] = RatePoint { bits: 1.0, psnr_db: f64::INFINITY };
        assert_eq!(bd_rate(&broken, &points(REFERENCE)), Err(BdRateError::Point));
        broken[2] = broken[1];
        assert_eq!(bd_rate(&broken, &points(REFERENCE)), Err(BdRateError::Equal));
    }
}
