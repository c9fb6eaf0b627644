//! Slow drift of the mean gaze: a headset that slipped on the head moves the gaze of its eye tracker by a constant angle (Niehorster et al.
//! 2020, "The impact of slippage on the data quality of head-worn eye trackers").
//!
//! Eyes are turned towards the head's middle most of the time, for any content: large shifts of the gaze turn the head as well (Stahl 1999;
//! Sidenmark and Gellersen 2019, in virtual reality), and on pictures the fixations are around the middle (Tatler 2007). So the mean
//! direction from the head, over minutes, is about the same as before, unless the headset moved. The estimate is for people to judge: a
//! game that moves to the side of the view looks the same.

/// Time of one mean, nanoseconds: some thirty fixations.
const BLOCK_NS: i64 = 10_000_000_000;

/// Least time in fixations of such a mean, nanoseconds.
const LEAST_NS: i64 = 3_000_000_000;

/// Longest time that one frame counts, nanoseconds.
const LONGEST_FRAME_NS: i64 = 100_000_000;

/// Number of means at the begin that the later ones are compared with: five minutes.
const FIRST_BLOCKS: usize = 30;

/// Number of the newest means: 110 seconds, so that a slip is known within two minutes.
const NEWEST_BLOCKS: usize = 11;

/// The least drift that is reported, degrees: the error of headsets' eye trackers.
const LEAST_DEG: f64 = 2.0;

/// The least drift that is reported, in standard errors of the difference of the means: along both axes together, one of 3000 differences is
/// larger by chance.
const LEAST_ERRORS: f64 = 4.0;

/// Compares the mean gaze of the last two minutes with that of the first five. Holds no clock, and allocates nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct GazeDrift {
    newest_ns: Option<i64>,
    block: Block,
    first: Moments,
    newest: [[f64; 2]; NEWEST_BLOCKS],
    /// Number of the means since the first ones.
    since_first: usize,
}

/// A mean that is under way.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    passed_ns: i64,
    fixated_ns: i64,
    sum: [f64; 2],
}

/// Mean and squared deviations of the first means (Welford 1962).
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    count: usize,
    mean: [f64; 2],
    squares: [f64; 2],
}

impl GazeDrift {
    /// Takes the gaze of a frame that is shown at `now_ns`: degrees to the left and upwards of the head's forward direction; `None` unless
    /// the eyes fixate something.
    pub fn push(&mut self, fixated_deg: Option<[f32; 2]>, now_ns: i64) {
        let before_ns = self.newest_ns.replace(now_ns).unwrap_or(now_ns);
        let passed_ns = now_ns.saturating_sub(before_ns).clamp(0, LONGEST_FRAME_NS);
        self.block.passed_ns += passed_ns;
        if let Some(angles) = fixated_deg.filter(|angles| angles.iter().all(|angle| angle.abs() <= 180.0)) {
            self.block.fixated_ns += passed_ns;
            for (sum, angle) in self.block.sum.iter_mut().zip(angles) {
                *sum += f64::from(angle) * passed_ns as f64;
            }
        }
        if self.block.passed_ns >= BLOCK_NS {
            let Block { fixated_ns, sum, .. } = std::mem::take(&mut self.block);
            if fixated_ns >= LEAST_NS {
                self.end_block(sum.map(|sum| sum / fixated_ns as f64));
            }
        }
    }

    fn end_block(&mut self, mean: [f64; 2]) {
        if self.first.count < FIRST_BLOCKS {
            self.first.add(mean);
        } else {
            self.newest[self.since_first % NEWEST_BLOCKS] = mean;
            self.since_first += 1;
        }
    }

    /// The distance of the mean gaze of the last two minutes from that of the first five, degrees; `None` if it is not known yet, or no larger
    /// than by chance.
    pub fn drift_deg(&self) -> Option<f32> {
        if self.since_first < NEWEST_BLOCKS {
            return None;
        }
        let moved = [0, 1].map(|axis| {
            let newest = self.newest.iter().map(|mean| mean[axis]).sum::<f64>() / NEWEST_BLOCKS as f64;
            newest - self.first.mean[axis]
        });
        let shares = 1.0 / NEWEST_BLOCKS as f64 + 1.0 / FIRST_BLOCKS as f64;
        let errors: f64 = (0..2).map(|axis| moved[axis].powi(2) / (self.first.variance(axis) * shares)).sum();
        let drift_deg = moved[0].hypot(moved[1]);
        // Without any variance, the errors are infinite, or no number for no drift.
        (drift_deg >= LEAST_DEG && errors >= LEAST_ERRORS.powi(2)).then_some(drift_deg as f32)
    }
}

impl Moments {
    fn add(&mut self, value: [f64; 2]) {
        self.count += 1;
        let Self { count, mean, squares } = self;
        for ((mean, squares), value) in mean.iter_mut().zip(squares).zip(value) {
            let from_mean = value - *mean;
            *mean += from_mean / *count as f64;
            *squares += from_mean * (value - *mean);
        }
    }

    fn variance(&self, axis: usize) -> f64 {
        self.squares[axis] / (self.count.max(2) - 1) as f64
    }
}

#[cfg(test)]
mod tests;
