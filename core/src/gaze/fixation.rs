//! A steady look at a dot, among the samples of an eye tracker.

/// Farthest that samples of a fixation are from its centre, degrees: the dispersion threshold of I-DT is 0.5 to 1 degree (Salvucci and
/// Goldberg 2000). Theirs is the range of all samples, which grows with their number and with noise; this is a radius.
pub(super) const DISPERSION_DEG: f32 = 1.0;

/// Least share of the samples within that: the others are noise.
const STEADY_SHARE: f32 = 0.9;

/// Least share of the samples of a fixation in which the eyes are seen.
const SEEN_SHARE: f32 = 0.5;

/// Fewest samples a second of a fixation: half of a 30 Hz tracker's.
const LEAST_RATE_HZ: i64 = 15;

/// Most samples a second that are kept, and more than trackers have.
const MOST_RATE_HZ: i64 = 680;

/// Before and after a blink the lids distort the gaze for so long, nanoseconds.
const EYELIDS_NS: i64 = 100_000_000;

const SECOND_NS: i64 = 1_000_000_000;

/// Times of a look at a dot, nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct DotTiming {
    /// For the eyes to find the dot; its samples are not used.
    pub settle_ns: i64,
    /// Of the measurement after that.
    pub measured_ns: i64,
    /// Length of a steady fixation.
    pub fixation_ns: i64,
}

impl DotTiming {
    fn least_samples(self) -> usize {
        (self.fixation_ns * LEAST_RATE_HZ / SECOND_NS) as usize
    }

    fn most_samples(self) -> usize {
        (self.measured_ns * MOST_RATE_HZ / SECOND_NS) as usize
    }
}

/// Reason why a look at a dot gave no fixation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoFixation {
    /// Too few samples.
    Unseen,
    /// No steady fixation, or several of them.
    Unsteady,
}

/// A steady fixation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Fixation {
    /// Median, degrees to the left and upwards.
    pub centre_deg: [f32; 2],
    /// Root mean square of the distances of the samples from their median, degrees.
    pub spread_deg: f32,
}

/// A look at a dot. Allocates nothing once it is made.
#[derive(Clone, Debug)]
pub(super) struct DotLook {
    timing: DotTiming,
    samples: Vec<Sample>,
    begun_ns: Option<i64>,
    /// From the last seen gaze to the display of its frame, nanoseconds: unseen eyes are as old when they are reported.
    age_ns: i64,
    is_over: bool,
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    time_ns: i64,
    /// To the left, upwards; `None` where the eyes are not seen.
    left_up_deg: Option<[f32; 2]>,
}

impl DotLook {
    /// Begins without samples.
    pub fn new(timing: DotTiming) -> Self {
        let samples = Vec::with_capacity(timing.most_samples());
        Self { timing, samples, begun_ns: None, age_ns: 0, is_over: false }
    }

    /// Takes the gaze of a frame that is shown at `now_ns`, which the first one begins: degrees to the left and upwards, and when
    /// the eyes looked there, on the same clock; `None` where they are not seen. Samples that come twice count once.
    pub fn push(&mut self, look: Option<([f32; 2], i64)>, now_ns: i64) {
        let begun_ns = *self.begun_ns.get_or_insert(now_ns);
        let passed_ns = now_ns.saturating_sub(begun_ns);
        let DotTiming { settle_ns, measured_ns, .. } = self.timing;
        if self.is_over || passed_ns < settle_ns {
            return;
        }
        if passed_ns >= settle_ns + measured_ns || self.samples.len() == self.timing.most_samples() {
            self.is_over = true;
            return;
        }
        let look = look.filter(|(angles, _)| angles.iter().all(|angle| angle.is_finite()));
        if let Some((_, at)) = look {
            self.age_ns = now_ns.saturating_sub(at);
        }
        let unseen = (None, now_ns.saturating_sub(self.age_ns));
        let (left_up_deg, time_ns) = look.map_or(unseen, |(angles, at)| (Some(angles), at));
        let is_repeated = self.samples.last().is_some_and(|last| {
            last.time_ns == time_ns && last.left_up_deg.is_some() == left_up_deg.is_some()
        });
        if !is_repeated {
            self.samples.push(Sample { time_ns, left_up_deg });
        }
    }

    /// Whether no more samples are needed.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// The steadiest fixation. Allocates.
    pub fn fixation(&self) -> Result<Fixation, NoFixation> {
        let seen = self.without_blinks();
        if seen.len() < self.timing.least_samples() {
            return Err(NoFixation::Unseen);
        }
        let steady: Vec<Fixation> =
            (0..seen.len()).filter_map(|first| self.fixation_from(&seen[first..])).collect();
        let steadiest = steady.iter().min_by(|one, other| one.spread_deg.total_cmp(&other.spread_deg));
        let steadiest = *steadiest.ok_or(NoFixation::Unsteady)?;
        // Two steady points: either could be the dot.
        if steady.iter().any(|other| distance(other.centre_deg, steadiest.centre_deg) > DISPERSION_DEG) {
            return Err(NoFixation::Unsteady);
        }
        Ok(steadiest)
    }

    /// The samples with a gaze, but those next to a blink, in the order of time.
    fn without_blinks(&self) -> Vec<(i64, [f32; 2])> {
        let blinks: Vec<i64> = self
            .samples
            .iter()
            .filter(|sample| sample.left_up_deg.is_none())
            .map(|sample| sample.time_ns)
            .collect();
        let is_clear = |time_ns: i64| {
            blinks.iter().all(|blink_ns| time_ns.saturating_sub(*blink_ns).saturating_abs() > EYELIDS_NS)
        };
        let mut seen: Vec<(i64, [f32; 2])> = self
            .samples
            .iter()
            .filter_map(|sample| Some((sample.time_ns, sample.left_up_deg?)))
            .filter(|(time_ns, _)| is_clear(*time_ns))
            .collect();
        seen.sort_by_key(|(time_ns, _)| *time_ns);
        seen
    }

    /// The fixation of [`DotTiming::fixation_ns`] that begins with the first of the samples, if there is one.
    fn fixation_from(&self, seen: &[(i64, [f32; 2])]) -> Option<Fixation> {
        let (begin_ns, _) = *seen.first()?;
        let end_ns = begin_ns.saturating_add(self.timing.fixation_ns);
        let length = seen.partition_point(|(time_ns, _)| *time_ns < end_ns);
        // Too short at the end of the measurement.
        seen.get(length)?;
        let all = self.samples.iter().filter(|sample| (begin_ns..end_ns).contains(&sample.time_ns)).count();
        if length < self.timing.least_samples() || (length as f32) < all as f32 * SEEN_SHARE {
            return None;
        }
        let angles = || seen[..length].iter().map(|(_, angles)| *angles);
        let centre = [0, 1].map(|axis| median(angles().map(|angles| angles[axis]).collect()));
        let near: Vec<f32> = angles()
            .map(|angles| distance(angles, centre))
            .filter(|distance| *distance <= DISPERSION_DEG)
            .collect();
        if (near.len() as f32) < length as f32 * STEADY_SHARE {
            return None;
        }
        let squares: f32 = near.iter().map(|distance| distance * distance).sum();
        Some(Fixation { centre_deg: centre, spread_deg: (squares / near.len() as f32).sqrt() })
    }
}

fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

/// Between two directions near each other, degrees.
pub(super) fn distance(one: [f32; 2], other: [f32; 2]) -> f32 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    /// Samples of closing and opening lids do not count, with a latency of 120 ms as little as without.
    #[test]
    fn samples_next_to_a_blink_are_left_out_whatever_their_age() {
        for age_ms in [0, 120] {
            let timing = DotTiming { settle_ns: 0, measured_ns: 2_000 * MS, fixation_ns: 300 * MS };
            let mut look = DotLook::new(timing);
            for frame in 0..100 {
                let now_ns = (1_000 + frame * 10) * MS;
                let is_closed = (40..60).contains(&frame);
                look.push((!is_closed).then_some(([1.0, 2.0], now_ns - age_ms * MS)), now_ns);
            }
            let nearest_ms = look.without_blinks().into_iter().map(|(time_ns, _)| {
                let blink = [40, 59].map(|frame| (1_000 + frame * 10 - age_ms) * MS);
                blink.map(|blink_ns| (time_ns - blink_ns).abs() / MS)[usize::from(time_ns > blink[1])]
            });
            assert_eq!(nearest_ms.min(), Some(EYELIDS_NS / MS + 10), "{age_ms} ms old");
        }
    }
}
