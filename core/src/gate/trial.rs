//! Costs of one A/B trial, in up to four segments with the technique on and off in alternation.

use super::comparison::{Comparison, Sample};

/// Most points of a segment; once it is full, groups of frames become one point each.
const ROOM: usize = 128;

/// Frames of a group.
const GROUP: usize = 8;

/// Segments of a trial; even ones have the state that is kept.
pub(super) const SEGMENTS: usize = 4;

/// Most points of a trial.
pub(super) const MOST_POINTS: usize = SEGMENTS * ROOM;

/// Frames ahead of a trial that count as its first segment.
pub(super) const RECENT: usize = 32;

/// A cost, and when it was.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    pub(super) time_ns: i64,
    /// Natural logarithm of nanoseconds.
    pub(super) ln: f32,
    /// Natural logarithm of the frame's pixels.
    pub(super) ln_pixels: f32,
}

/// The newest costs outside of trials, in order.
#[derive(Clone, Debug)]
pub(super) struct RecentCosts {
    costs: [Cost; RECENT],
    len: usize,
}

impl Default for RecentCosts {
    fn default() -> Self {
        Self { costs: [Cost::default(); RECENT], len: 0 }
    }
}

impl RecentCosts {
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    pub(super) fn push(&mut self, cost: Cost) {
        if self.len == RECENT {
            self.costs.copy_within(1.., 0);
            self.len -= 1;
        }
        self.costs[self.len] = cost;
        self.len += 1;
    }

    /// Removes costs before `since_ns`, and returns the others.
    pub(super) fn since(&mut self, since_ns: i64) -> &[Cost] {
        let old = self.costs[..self.len].iter().take_while(|cost| cost.time_ns < since_ns).count();
        self.costs.copy_within(old..self.len, 0);
        self.len -= old;
        &self.costs[..self.len]
    }
}

/// Costs between two switches. Allocates nothing.
#[derive(Clone, Copy, Debug)]
struct Segment {
    points: [Sample; ROOM],
    len: usize,
    /// Frames in each point: 1 or [`GROUP`].
    per_point: usize,
    group: [Sample; GROUP],
    in_group: usize,
    frames: usize,
}

impl Segment {
    const EMPTY: Self = Self {
        points: [Sample::ZERO; ROOM],
        len: 0,
        per_point: 1,
        group: [Sample::ZERO; GROUP],
        in_group: 0,
        frames: 0,
    };

    fn push(&mut self, sample: Sample) {
        if self.per_point == 1 && self.len == ROOM {
            let groups = self.points;
            for (point, group) in self.points.iter_mut().zip(groups.chunks_exact(GROUP)) {
                *point = trimmed_mean(group);
            }
            (self.len, self.per_point) = (ROOM / GROUP, GROUP);
        }
        if self.len == ROOM {
            return;
        }
        self.frames += 1;
        if self.per_point == 1 {
            self.points[self.len] = sample;
            self.len += 1;
            return;
        }
        self.group[self.in_group] = sample;
        self.in_group += 1;
        if self.in_group == GROUP {
            self.points[self.len] = trimmed_mean(&self.group);
            self.len += 1;
            self.in_group = 0;
        }
    }
}

/// Mean time, and mean cost and pixels without the frames of the least and the greatest cost.
fn trimmed_mean(group: &[Sample]) -> Sample {
    let count = group.len() as f32;
    let sum = |of: fn(&Sample) -> f32| group.iter().map(of).sum::<f32>();
    let (mut least, mut most) = (group[0], group[0]);
    for sample in group {
        least = if sample.cost < least.cost { *sample } else { least };
        // Of equal costs the last, so that these are two frames.
        most = if sample.cost >= most.cost { *sample } else { most };
    }
    let trimmed = |of: fn(&Sample) -> f32| (sum(of) - of(&least) - of(&most)) / (count - 2.0);
    Sample {
        at_s: sum(|sample| sample.at_s) / count,
        cost: trimmed(|sample| sample.cost),
        pixels: trimmed(|sample| sample.pixels),
    }
}

/// The costs of a trial.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    began_ns: i64,
    is_kept_on: bool,
    segments: [Segment; SEGMENTS],
    at: usize,
    /// [`Cost::ln_pixels`] of the first cost.
    first_ln_pixels: Option<f32>,
}

impl Trial {
    /// Begins the second segment now; `recent` costs are the first.
    pub(super) fn begin(now_ns: i64, is_kept_on: bool, recent: &[Cost]) -> Self {
        let segments = [Segment::EMPTY; SEGMENTS];
        let mut trial = Self { began_ns: now_ns, is_kept_on, segments, at: 0, first_ln_pixels: None };
        recent.iter().for_each(|&cost| trial.push(cost));
        trial.at = 1;
        trial
    }

    /// Number of the current segment, 1 to 3.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Whether the technique is on in the current segment.
    pub(super) fn is_on(&self) -> bool {
        self.is_kept_on == self.at.is_multiple_of(2)
    }

    /// Frames that count in the current segment, and in the one before.
    pub(super) fn frames(&self) -> [usize; 2] {
        [self.at, self.at - 1].map(|at| self.segments[at].frames)
    }

    /// Begins the next segment.
    pub(super) fn switch(&mut self) {
        self.at = (self.at + 1).min(SEGMENTS - 1);
    }

    pub(super) fn push(&mut self, cost: Cost) {
        let at_s = cost.time_ns.saturating_sub(self.began_ns) as f64 / 1e9;
        let pixels = cost.ln_pixels - *self.first_ln_pixels.get_or_insert(cost.ln_pixels);
        self.segments[self.at].push(Sample { at_s: at_s as f32, cost: cost.ln, pixels });
    }

    /// The comparison so far.
    pub(super) fn compare(&self) -> Option<Comparison> {
        let segments = self.segments[..=self.at].iter().map(|segment| {
            let weight = segment.per_point as f32;
            (&segment.points[..segment.len], weight)
        });
        Comparison::of(segments, self.is_kept_on)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_costs_go() {
        let mut recent = RecentCosts::default();
        (0..40).for_each(|time_ns| recent.push(Cost { time_ns, ln: 1.0, ln_pixels: 0.0 }));
        assert_eq!(recent.since(0).first().unwrap().time_ns, 8);
        assert_eq!(recent.since(30).len(), 10);
        recent.clear();
        assert!(recent.since(i64::MIN).is_empty());
    }

    /// More frames than points: none is lost, and an outlier in each group does not show.
    #[test]
    fn groups_keep_the_mean() {
        let mut segment = Segment::EMPTY;
        let sample = |at_s: u16, cost| Sample { at_s: f32::from(at_s), cost, pixels: 0.5 };
        (0..1000).for_each(|frame| segment.push(sample(frame, if frame % 8 == 5 { 9.0 } else { 2.0 })));
        assert_eq!((segment.frames, segment.len, segment.per_point), (1000, 125, 8));
        let is_mean = |point: &Sample| (point.cost - 2.0).abs() < 1e-6 && point.pixels == 0.5;
        assert!(segment.points[..segment.len].iter().all(is_mean));
        (0..1000).for_each(|frame| segment.push(sample(frame, 2.0)));
        assert_eq!((segment.frames, segment.len), (1024, ROOM));
    }

    /// A hitch with other pixels leaves the cost per pixel unchanged: an application with dynamic resolution reacts to the frame before.
    #[test]
    fn pixels_of_dropped_costs_are_dropped() {
        let sample = |frame: usize| match frame {
            5 => Sample { at_s: 0.0, cost: 9.0, pixels: -2.0 },
            _ => Sample { at_s: 0.0, cost: 2.0 + 0.1 * frame as f32, pixels: 0.1 * frame as f32 },
        };
        let group: Vec<Sample> = (0..GROUP).map(sample).collect();
        let point = trimmed_mean(&group);
        assert!((point.cost - point.pixels - 2.0).abs() < 1e-5, "{point:?}");
        let alike = [Sample { at_s: 1.0, cost: 3.0, pixels: 0.25 }; GROUP];
        assert_eq!(trimmed_mean(&alike), alike[0]);
    }

    #[test]
    fn stretches_alternate() {
        let mut trial = Trial::begin(0, false, &[]);
        let mut sides = vec![trial.is_on()];
        for _ in 0..2 {
            trial.switch();
            sides.push(trial.is_on());
        }
        assert_eq!(sides, [true, false, true]);
    }
}
