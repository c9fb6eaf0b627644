//! How much is done in a time, whatever arrives.

use std::time::Duration;

/// Length of an interval, nanoseconds: a late frame or two, for whoever sends too much.
const INTERVAL_NS: i64 = 20_000_000;

/// Packets that are read in an interval: 6400 a second. A sender of whole faces, with a packet for each of about 60 values, sends
/// 5400 a second at 90 Hz.
const MOST_PACKETS: u32 = 128;

/// Packets of the current interval.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    begun_ns: i64,
    packets: u32,
}

impl Budget {
    /// A packet came at `now_ns`; for how long nothing more is to be read, where the interval has had its share.
    pub fn spend(&mut self, now_ns: i64) -> Option<Duration> {
        let passed_ns = now_ns.saturating_sub(self.begun_ns);
        if !(0..INTERVAL_NS).contains(&passed_ns) {
            *self = Self { begun_ns: now_ns, packets: 0 };
        }
        self.packets += 1;
        if self.packets < MOST_PACKETS {
            return None;
        }
        let left_ns = INTERVAL_NS - now_ns.saturating_sub(self.begun_ns);
        Some(Duration::from_nanos(left_ns.clamp(0, INTERVAL_NS) as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_is_read_in_part_and_a_tracker_whole() {
        for (per_second, at_most) in [(120, 120), (5400, 5400), (10_000, 6400), (1_000_000, 6400)] {
            let (mut budget, mut now_ns, mut read) = (Budget::default(), 1, 0);
            let apart_ns = 1_000_000_000 / per_second;
            while now_ns < 1_000_000_000 {
                read += 1;
                let wait = budget.spend(now_ns).unwrap_or_default().as_nanos() as i64;
                // What came meanwhile is dropped.
                now_ns += wait.max(apart_ns);
            }
            assert!(read <= at_most + 1, "{read} of {per_second}");
            assert!(read >= (per_second - 1).min(6000), "{read} of {per_second}");
        }
    }

    #[test]
    fn a_clock_that_goes_back_begins_an_interval() {
        let mut budget = Budget::default();
        for now_ns in [0, i64::MAX, 0, i64::MIN, i64::MAX] {
            assert_eq!(budget.spend(now_ns), None);
        }
    }
}
