//! One-point recentring: the user looks at a dot straight ahead, and the angle between the measured gaze and the dot is the tracker's
//! offset.

/// Time for the eyes to find the dot, nanoseconds; its samples are not used. A saccade follows a new target after 200 to 250 ms
/// (Carpenter 1988); the rest is for people.
const SETTLE_NS: i64 = 1_500_000_000;

/// Time of the measurement after that, nanoseconds.
const MEASURED_NS: i64 = 3_000_000_000;

/// Length of a steady fixation, nanoseconds: fixations of a scene last 200 to 400 ms, so this one is intended.
const FIXATION_NS: i64 = 1_000_000_000;

/// Farthest that samples of a fixation are from its centre, degrees: the dispersion threshold of I-DT is 0.5 to 1 degree (Salvucci and
/// Goldberg 2000). Theirs is the range of all samples, which grows with their number and with noise; this is a radius.
const DISPERSION_DEG: f32 = 1.0;

/// Least share of the samples within that: the others are noise.
const STEADY_SHARE: f32 = 0.9;

/// Least share of the samples of a fixation in which the eyes are seen.
const SEEN_SHARE: f32 = 0.5;

/// Fewest samples of a fixation: half of a 30 Hz tracker's.
const LEAST_SAMPLES: usize = 15;

/// Before and after a blink the lids distort the gaze for so long, nanoseconds.
const EYELIDS_NS: i64 = 100_000_000;

/// The largest plausible offset, degrees. Headsets have a mean error of 1 to 2 degrees; more than this is a slipped headset, or a look at
/// something else.
pub const MAX_OFFSET_DEG: f32 = 10.0;

/// Most samples of a measurement: 3 seconds at 600 Hz, and more.
const MOST_SAMPLES: usize = 2048;

/// The offset of an eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeOffset {
    /// Angles to the left and upwards that are added to the gaze, degrees.
    pub offset_deg: [f32; 2],
    /// Root mean square of the distances of the samples from their median, degrees.
    pub spread_deg: f32,
}

/// Why a measurement gave no offset.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecentreFailure {
    /// Too few samples.
    #[error("the eye tracker did not see the eyes long enough")]
    NoGaze,
    /// No steady fixation, or several of them.
    #[error("the gaze did not rest on one point for a second")]
    Unsteady,
    /// An implausible offset, degrees.
    #[error("the gaze was {0:.0} degrees from the dot; more than 10 degrees are not corrected")]
    TooFar(f32),
}

/// A measurement. Allocates nothing once it is made.
#[derive(Clone, Debug)]
pub struct Recentring {
    samples: Vec<Sample>,
    begun_ns: Option<i64>,
    is_over: bool,
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    time_ns: i64,
    /// To the left, upwards; `None` where the eyes are not seen.
    left_up_deg: Option<[f32; 2]>,
}

impl Default for Recentring {
    fn default() -> Self {
        Self { samples: Vec::with_capacity(MOST_SAMPLES), begun_ns: None, is_over: false }
    }
}

impl Recentring {
    /// Takes the gaze of a frame that is shown at `now_ns`, which the first one begins: degrees to the left and upwards of the dot, and when
    /// the eyes looked there, on the same clock; `None` where they are not seen. Samples that come twice count once.
    pub fn push(&mut self, look: Option<([f32; 2], i64)>, now_ns: i64) {
        let begun_ns = *self.begun_ns.get_or_insert(now_ns);
        let passed_ns = now_ns.saturating_sub(begun_ns);
        if self.is_over || passed_ns < SETTLE_NS {
            return;
        }
        if passed_ns >= SETTLE_NS + MEASURED_NS || self.samples.len() == MOST_SAMPLES {
            self.is_over = true;
            return;
        }
        let look = look.filter(|(angles, _)| angles.iter().all(|angle| angle.is_finite()));
        let (left_up_deg, time_ns) = look.map_or((None, now_ns), |(angles, at)| (Some(angles), at));
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

    /// The offset of the steadiest fixation.
    ///
    /// # Errors
    /// The eyes were not seen or did not rest, or the offset is implausible.
    pub fn offset(&self) -> Result<GazeOffset, RecentreFailure> {
        let seen = self.without_blinks();
        if seen.len() < LEAST_SAMPLES {
            return Err(RecentreFailure::NoGaze);
        }
        let steady: Vec<Fixation> =
            (0..seen.len()).filter_map(|first| self.fixation_from(&seen[first..])).collect();
        let steadiest = steady.iter().min_by(|one, other| one.spread_deg.total_cmp(&other.spread_deg));
        let Fixation { centre, spread_deg } = *steadiest.ok_or(RecentreFailure::Unsteady)?;
        // Two steady points: either could be the dot.
        if steady.iter().any(|other| distance(other.centre, centre) > DISPERSION_DEG) {
            return Err(RecentreFailure::Unsteady);
        }
        let far = distance(centre, [0.0; 2]);
        if far > MAX_OFFSET_DEG {
            return Err(RecentreFailure::TooFar(far));
        }
        Ok(GazeOffset { offset_deg: centre.map(|angle| 0.0 - angle), spread_deg })
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

    /// The fixation of [`FIXATION_NS`] that begins with the first of the samples, if there is one.
    fn fixation_from(&self, seen: &[(i64, [f32; 2])]) -> Option<Fixation> {
        let (begin_ns, _) = *seen.first()?;
        let end_ns = begin_ns.saturating_add(FIXATION_NS);
        let length = seen.partition_point(|(time_ns, _)| *time_ns < end_ns);
        // Too short at the end of the measurement.
        seen.get(length)?;
        let all = self.samples.iter().filter(|sample| (begin_ns..end_ns).contains(&sample.time_ns)).count();
        if length < LEAST_SAMPLES || (length as f32) < all as f32 * SEEN_SHARE {
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
        Some(Fixation { centre, spread_deg: (squares / near.len() as f32).sqrt() })
    }
}

#[derive(Clone, Copy, Debug)]
struct Fixation {
    /// Median, degrees to the left and upwards.
    centre: [f32; 2],
    spread_deg: f32,
}

fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

fn distance(one: [f32; 2], other: [f32; 2]) -> f32 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

#[cfg(test)]
mod tests;
