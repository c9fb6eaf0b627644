//! Limit of the work in an interval of time, for any number of packets.

use std::time::Duration;

/// Length of an interval, nanoseconds: a late frame or two, for a sender of too much.
const INTERVAL_NS: i64 = 20_000_000;

/// Packets that are decoded in an interval: 6400 a second. An eye tracker of 240 Hz, with a packet for each of six values, sends 1440.
const MOST_DECODED: u32 = 128;

/// Packets that are looked at in an interval: 25 600 a second. A sender of whole faces, with a packet for each of 150 values, sends
/// 13 500 a second at 90 Hz, and those about the eyes may be the last.
const MOST_PACKETS: u32 = 512;

/// Packets of the current interval.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    begun_ns: i64,
    packets: u32,
    decoded: u32,
}

impl Budget {
    /// Counts a packet that came at `now_ns`, and was decoded or only looked at. Returns the time for which nothing more is to be
    /// read, if the interval has had its share.
    pub fn spend(&mut self, is_decoded: bool, now_ns: i64) -> Option<Duration> {
        let passed_ns = now_ns.saturating_sub(self.begun_ns);
        if !(0..INTERVAL_NS).contains(&passed_ns) {
            *self = Self { begun_ns: now_ns, ..Self::default() };
        }
        self.packets += 1;
        self.decoded += u32::from(is_decoded);
        if self.packets < MOST_PACKETS && self.decoded < MOST_DECODED {
            return None;
        }
        let left_ns = INTERVAL_NS - now_ns.saturating_sub(self.begun_ns);
        Some(Duration::from_nanos(left_ns.clamp(0, INTERVAL_NS) as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Packets of a second that are read, of so many.
    fn read_of(per_second: i64, is_decoded: bool) -> i64 {
        let (mut budget, mut now_ns, mut read) = (Budget::default(), 1, 0);
        while now_ns < 1_000_000_000 {
            read += 1;
            let wait = budget.spend(is_decoded, now_ns).unwrap_or_default().as_nanos() as i64;
            // Packets that arrived meanwhile are dropped.
            now_ns += wait.max(1_000_000_000 / per_second);
        }
        read
    }

    #[test]
    fn a_flood_is_read_in_part_and_a_tracker_whole() {
        for (per_second, is_decoded, expected) in [
            (120, true, 119..=121),
            (1440, true, 1439..=1441),
            (10_000, true, 6000..=6401),
            (1_000_000, true, 6000..=6401),
            (13_500, false, 13_499..=13_501),
            (1_000_000, false, 25_000..=25_601),
        ] {
            let read = read_of(per_second, is_decoded);
            assert!(expected.contains(&read), "{read} of {per_second}");
        }
    }

    #[test]
    fn a_clock_that_goes_back_begins_an_interval() {
        let mut budget = Budget::default();
        for now_ns in [0, i64::MAX, 0, i64::MIN, i64::MAX] {
            assert_eq!(budget.spend(true, now_ns), None);
        }
    }
}
