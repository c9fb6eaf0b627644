//! Times that a source gives its samples, as far as they can be true: some runtimes write another clock's.

/// Plausible ages of a sample when it comes, nanoseconds: runtimes predict a little, and the slowest chains take less than 300 ms.
const AGES_NS: std::ops::RangeInclusive<i64> = -20_000_000..=300_000_000;

/// Time without an implausible one after which times are believed again, nanoseconds: a longer one than the gaze is held.
const HELD_NS: i64 = 1_000_000_000;

/// Verdict on the times of a source.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SampleTimes {
    newest_ns: Option<i64>,
    /// Arrival of the last sample with an implausible time, while none is believed.
    refuted_ns: Option<i64>,
}

impl SampleTimes {
    /// Takes the time of a sample that is there at `now_ns`. Returns whether it is another one than before. A time that stays
    /// is no evidence: the sample is the same, and grows old.
    pub(super) fn take(&mut self, time_ns: i64, now_ns: i64) -> bool {
        let is_new = self.newest_ns.replace(time_ns) != Some(time_ns);
        if is_new && !AGES_NS.contains(&now_ns.saturating_sub(time_ns)) {
            self.refuted_ns = Some(now_ns);
        } else if is_new {
            self.refuted_ns =
                self.refuted_ns.filter(|since_ns| (0..HELD_NS).contains(&now_ns.saturating_sub(*since_ns)));
        }
        is_new
    }

    /// Whether the times of samples are believed.
    pub(super) fn are_believed(&self) -> bool {
        self.refuted_ns.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    #[test]
    fn times_are_believed_that_are_near_and_go_on() {
        for (age_ms, is_believed) in [(-21, false), (-20, true), (0, true), (300, true), (301, false)] {
            let mut times = SampleTimes::default();
            times.take(5000 * MS - age_ms * MS, 5000 * MS);
            assert_eq!(times.are_believed(), is_believed, "{age_ms} ms");
        }
        let mut times = SampleTimes::default();
        for now in [5000, 5400, 9000] {
            assert_eq!(times.take(4900 * MS, now * MS), now == 5000);
            assert!(times.are_believed(), "a sample that stays");
        }
    }

    #[test]
    fn one_that_is_not_is_remembered_for_a_second() {
        let mut times = SampleTimes::default();
        times.take(9000 * MS, 5000 * MS);
        for now in 5001..6200 {
            times.take(now * MS - 30 * MS, now * MS);
            assert_eq!(times.are_believed(), now >= 6000, "at {now} ms");
        }
    }
}
