//! What excursions have shown, and whether it is enough to be sure.

/// Probability with which an interval from [`Evidence::ratio`] holds the true ratio, if noise is normal and the true ratio
/// stays. A single look at a true ratio of 1 is wrong to one side in less than a quarter of a percent, as it also has to
/// exceed [`MARGIN`]; the gate looks after every excursion.
pub const CONFIDENCE: f64 = 0.995;

/// By how much the cheaper side has to be cheaper, logarithm of the ratio: about 1 %.
pub const MARGIN: f64 = 0.01;

/// Excursions that are kept: with 10 % of noise on every frame they tell 5 % from nothing.
const KEPT: usize = 128;

/// Excursions that are kept once they are clear: when things change, fewer old ones have to be outweighed.
const KEPT_WHEN_CLEAR: usize = 32;

/// Fewer are never enough.
const LEAST: usize = 4;

/// What the evidence says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Frames cost less with the technique.
    Pays,
    /// Frames cost more with it.
    Costs,
    /// Neither is sure.
    Unclear,
}

impl Verdict {
    /// Whether the technique is to be on; none where that is unclear.
    pub(super) fn wants_on(self) -> Option<bool> {
        match self {
            Verdict::Pays => Some(true),
            Verdict::Costs => Some(false),
            Verdict::Unclear => None,
        }
    }
}

/// Ratios of the cost of a frame with the technique to that without it, one of each excursion.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Logarithms; a ring, of which `next` is the oldest once it is full.
    ratios: [f32; KEPT],
    len: usize,
    next: usize,
    verdict: Verdict,
}

impl Default for Evidence {
    fn default() -> Self {
        Self { ratios: [0.0; KEPT], len: 0, next: 0, verdict: Verdict::Unclear }
    }
}

impl Evidence {
    /// How many excursions it is from.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// What it says.
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// The cost of a frame with the technique, in costs without it (their geometric mean), and the interval around it
    /// that holds the truth with [`CONFIDENCE`]; none before there are four excursions.
    pub fn ratio(&self) -> Option<(f64, [f64; 2])> {
        let (mean, reach) = self.mean()?;
        Some((mean.exp(), [(mean - reach).exp(), (mean + reach).exp()]))
    }

    pub(super) fn is_full(&self) -> bool {
        self.len == KEPT
    }

    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds the logarithm of a ratio; one that is not finite is none.
    pub(super) fn push(&mut self, ratio: f64) {
        if !ratio.is_finite() {
            return;
        }
        self.ratios[self.next] = ratio as f32;
        self.next = (self.next + 1) % KEPT;
        self.len = (self.len + 1).min(KEPT);
        self.verdict = match self.mean() {
            Some((mean, reach)) if mean + reach < -MARGIN => Verdict::Pays,
            Some((mean, reach)) if mean - reach > MARGIN => Verdict::Costs,
            _ => Verdict::Unclear,
        };
        if self.verdict != Verdict::Unclear {
            self.len = self.len.min(KEPT_WHEN_CLEAR);
        }
    }

    /// Mean of the logarithms, and how far to each side the truth may be.
    fn mean(&self) -> Option<(f64, f64)> {
        if self.len < LEAST {
            return None;
        }
        let newest = (1..=self.len).map(|back| f64::from(self.ratios[(self.next + KEPT - back) % KEPT]));
        let count = self.len as f64;
        let mean = newest.clone().sum::<f64>() / count;
        let variance = newest.map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / (count - 1.0);
        Some((mean, student_t(self.len - 1) * (variance / count).sqrt()))
    }
}

/// The value that |t| of Student's distribution exceeds with probability 1 - [`CONFIDENCE`], with so many degrees of
/// freedom, 3 or more; between two rows that of the fewer.
fn student_t(degrees_of_freedom: usize) -> f64 {
    const TABLE: [(usize, f64); 17] = [
        (3, 7.4533),
        (4, 5.5976),
        (5, 4.7733),
        (6, 4.3168),
        (7, 4.0293),
        (8, 3.8325),
        (9, 3.6897),
        (10, 3.5814),
        (11, 3.4966),
        (12, 3.4284),
        (15, 3.2860),
        (20, 3.1534),
        (25, 3.0782),
        (30, 3.0298),
        (40, 2.9712),
        (60, 2.9146),
        (120, 2.8599),
    ];
    let row = TABLE.iter().rev().find(|row| row.0 <= degrees_of_freedom);
    row.map_or(f64::INFINITY, |row| row.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table against the density of the distribution, summed up: c (1 + t^2 / n)^(-(n + 1) / 2), of which the constant
    /// follows from the whole being 1.
    #[test]
    fn the_table_is_students() {
        for degrees in [3usize, 4, 5, 6, 7, 8, 9, 10, 11, 12, 15, 20, 25, 30, 40, 60, 120] {
            let density = |t: f64| (1.0 + t * t / degrees as f64).powf(-(degrees as f64 + 1.0) / 2.0);
            let sum = |from: f64, to: f64| {
                let steps = 200_000;
                let width = (to - from) / f64::from(steps);
                (0..steps).map(|step| density(from + (f64::from(step) + 0.5) * width)).sum::<f64>() * width
            };
            let t = student_t(degrees);
            // Beyond 400 there is less than 1e-7, even with three degrees of freedom.
            let outside = sum(t, 400.0) / (sum(0.0, t) + sum(t, 400.0));
            assert!((outside - (1.0 - CONFIDENCE)).abs() < 5e-6, "{degrees}: {outside}");
        }
    }

    #[test]
    fn few_or_scattered_ratios_are_unclear() {
        let mut evidence = Evidence::default();
        for ratio in [0.50f64, 0.52, 0.51] {
            evidence.push(ratio.ln());
            assert_eq!((evidence.verdict(), evidence.ratio()), (Verdict::Unclear, None));
        }
        evidence.push(0.49f64.ln());
        assert_eq!(evidence.verdict(), Verdict::Pays);
        let (ratio, [low, high]) = evidence.ratio().unwrap();
        assert!((ratio - 0.505).abs() < 0.01 && low < ratio && ratio < high && high < 0.6);

        let mut scattered = Evidence::default();
        [0.5f64, 1.5, 0.6, 1.0, 0.4, 0.9].into_iter().for_each(|ratio| scattered.push(ratio.ln()));
        assert_eq!(scattered.verdict(), Verdict::Unclear);
        scattered.push(f64::NAN);
        scattered.push(f64::INFINITY);
        assert_eq!(scattered.len(), 6);
    }

    /// Within the margin nothing is decided, however sure it is.
    #[test]
    fn half_a_percent_is_nothing() {
        let mut evidence = Evidence::default();
        (0..1000).for_each(|_| evidence.push(-0.005));
        assert_eq!(evidence.verdict(), Verdict::Unclear);
        assert!(evidence.is_full());
        let (ratio, [low, high]) = evidence.ratio().unwrap();
        assert!((low..=high).contains(&ratio) && (ratio - 0.995).abs() < 1e-4);
    }

    /// What is clear is remembered shortly: twice 32 excursions that say otherwise outweigh any number.
    #[test]
    fn what_changes_is_noticed() {
        let mut evidence = Evidence::default();
        (0..1000u32).for_each(|n| evidence.push(-0.3 + 0.01 * f64::from(n % 3)));
        assert_eq!((evidence.verdict(), evidence.len()), (Verdict::Pays, 32));
        let flips = (0..64u32).position(|n| {
            evidence.push(0.3 + 0.01 * f64::from(n % 3));
            evidence.verdict() == Verdict::Costs
        });
        assert!(flips.is_some(), "{:?}", evidence.ratio());
    }
}
