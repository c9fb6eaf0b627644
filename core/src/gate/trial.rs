//! Costs of one A/B trial, in up to four segments with the technique on and off in alternation.

use super::estimate::{Estimate, Point};

/// Most points of a segment; once it is full, groups of frames become one point each.
const ROOM: usize = 128;

/// Frames of a group.
const GROUP: usize = 8;

/// Segments of a trial; even ones have the state that is kept.
pub(super) const SEGMENTS: usize = 4;

/// Frames ahead of a trial that count as its first segment.
pub(super) const RECENT: usize = 32;

/// A cost, and when it was.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    pub(super) time_ns: i64,
    /// Natural logarithm of nanoseconds.
    pub(super) ln: f32,
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
    points: [(f32, f32); ROOM],
    len: usize,
    /// Frames in each point: 1 or [`GROUP`].
    per_point: usize,
    group: [(f32, f32); GROUP],
    in_group: usize,
    frames: usize,
}

impl Segment {
    const EMPTY: Self = Self {
        points: [(0.0, 0.0); ROOM],
        len: 0,
        per_point: 1,
        group: [(0.0, 0.0); GROUP],
        in_group: 0,
        frames: 0,
    };

    fn push(&mut self, at_s: f32, cost: f32) {
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
            self.points[self.len] = (at_s, cost);
            self.len += 1;
            return;
        }
        self.group[self.in_group] = (at_s, cost);
        self.in_group += 1;
        if self.in_group == GROUP {
            self.points[self.len] = trimmed_mean(&self.group);
            self.len += 1;
            self.in_group = 0;
        }
    }
}

/// Mean time, and mean cost without the least and the greatest.
fn trimmed_mean(group: &[(f32, f32)]) -> (f32, f32) {
    let count = group.len() as f32;
    let at_s = group.iter().map(|point| point.0).sum::<f32>() / count;
    let costs = group.iter().map(|point| point.1);
    let (least, most) =
        costs.clone().fold((f32::MAX, f32::MIN), |(least, most), cost| (least.min(cost), most.max(cost)));
    (at_s, (costs.sum::<f32>() - least - most) / (count - 2.0))
}

/// The costs of a trial.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    began_ns: i64,
    is_kept_on: bool,
    segments: [Segment; SEGMENTS],
    at: usize,
}

impl Trial {
    /// Begins the second segment now; `recent` costs are the first.
    pub(super) fn begin(now_ns: i64, is_kept_on: bool, recent: &[Cost]) -> Self {
        let mut trial = Self { began_ns: now_ns, is_kept_on, segments: [Segment::EMPTY; SEGMENTS], at: 0 };
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
        self.segments[self.at].push(at_s as f32, cost.ln);
    }

    /// The estimate so far. Before the third segment a drift cannot be distinguished from a saving, and no drift is assumed.
    pub(super) fn estimate(&self) -> Option<Estimate> {
        let mut points = [Point::default(); SEGMENTS * ROOM];
        let mut len = 0;
        for (at, segment) in self.segments.iter().enumerate() {
            let is_on = self.is_kept_on == (at % 2 == 0);
            for &(at_s, cost) in &segment.points[..segment.len] {
                points[len] = Point { at_s, cost, weight: segment.per_point as f32, is_on };
                len += 1;
            }
        }
        Estimate::of(&mut points[..len], self.at > 1, &mut [0.0; SEGMENTS * ROOM])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_costs_go() {
        let mut recent = RecentCosts::default();
        (0..40).for_each(|time_ns| recent.push(Cost { time_ns, ln: 1.0 }));
        assert_eq!(recent.since(0).first().unwrap().time_ns, 8);
        assert_eq!(recent.since(30).len(), 10);
        recent.clear();
        assert!(recent.since(i64::MIN).is_empty());
    }

    /// More frames than points: none is lost, and an outlier in each group does not show.
    #[test]
    fn groups_keep_the_mean() {
        let mut segment = Segment::EMPTY;
        (0..1000).for_each(|frame| segment.push(frame as f32, if frame % 8 == 5 { 9.0 } else { 2.0 }));
        assert_eq!((segment.frames, segment.len, segment.per_point), (1000, 125, 8));
        assert!(segment.points[..segment.len].iter().all(|point| (point.1 - 2.0).abs() < 1e-6));
        (0..1000).for_each(|frame| segment.push(frame as f32, 2.0));
        assert_eq!((segment.frames, segment.len), (1024, ROOM));
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
