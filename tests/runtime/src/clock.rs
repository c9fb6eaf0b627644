//! Time: as it passes outside, or one refresh period a frame.

use crate::scenario;
use std::time::Duration;

/// Display time of the first frame of a simulated clock, in nanoseconds: OpenXR times are positive.
const SIMULATED_START_NS: i64 = 1_000_000_000;

/// The runtime's clock. Times are `XrTime`: nanoseconds; on the real clock, of `CLOCK_MONOTONIC`.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    mode: scenario::ClockMode,
    period_ns: i64,
    /// Display time of the first frame.
    first: Option<i64>,
    /// Display time of the newest frame.
    newest: Option<i64>,
}

/// Answer of `xrWaitFrame` for a frame, and the time for which it blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slot {
    pub display_time: i64,
    pub wait: Duration,
}

impl Clock {
    pub fn new(settings: &scenario::Clock) -> Self {
        let period_ns = (1e9 / settings.refresh_hz).round() as i64;
        Self { mode: settings.mode, period_ns, first: None, newest: None }
    }

    pub fn period_ns(&self) -> i64 {
        self.period_ns
    }

    /// The next frame, given the time of `CLOCK_MONOTONIC` in nanoseconds. On the real clock a frame is shown one
    /// period after `xrWaitFrame` wakes up, at a multiple of the period since the first; late ones skip some.
    pub fn next(&mut self, monotonic_ns: i64) -> Slot {
        let slot = match (self.mode, self.newest) {
            (scenario::ClockMode::Simulated, None) => {
                Slot { display_time: SIMULATED_START_NS, wait: Duration::ZERO }
            }
            (scenario::ClockMode::Simulated, Some(newest)) => {
                Slot { display_time: newest + self.period_ns, wait: Duration::ZERO }
            }
            (scenario::ClockMode::Real, None) => {
                Slot { display_time: monotonic_ns + self.period_ns, wait: Duration::ZERO }
            }
            (scenario::ClockMode::Real, Some(newest)) => {
                let late = (monotonic_ns - newest).max(0);
                let display_time =
                    newest + self.period_ns * (1 + (late + self.period_ns - 1) / self.period_ns);
                let wait = display_time - self.period_ns - monotonic_ns;
                Slot { display_time, wait: Duration::from_nanos(wait.max(0).unsigned_abs()) }
            }
        };
        self.first.get_or_insert(slot.display_time);
        self.newest = Some(slot.display_time);
        slot
    }

    /// Now, given the time of `CLOCK_MONOTONIC`; simulated time stands still between frames.
    pub fn now(&self, monotonic_ns: i64) -> i64 {
        match self.mode {
            scenario::ClockMode::Simulated => self.newest.unwrap_or(SIMULATED_START_NS),
            scenario::ClockMode::Real => monotonic_ns,
        }
    }

    /// The scenario's time in seconds: 0 is the display time of the first frame.
    pub fn scenario_seconds(&self, time: i64) -> f64 {
        self.first.map_or(0.0, |first| (time - first) as f64 / 1e9)
    }
}

/// `CLOCK_MONOTONIC` in nanoseconds.
pub(crate) fn monotonic_ns() -> i64 {
    read(libc::CLOCK_MONOTONIC)
}

/// CPU time of the whole process in nanoseconds.
pub(crate) fn process_cpu_ns() -> i64 {
    read(libc::CLOCK_PROCESS_CPUTIME_ID)
}

/// CPU time of the calling thread in nanoseconds.
pub(crate) fn thread_cpu_ns() -> i64 {
    read(libc::CLOCK_THREAD_CPUTIME_ID)
}

/// Most memory that the process has had resident so far, KiB.
pub(crate) fn peak_memory_kib() -> i64 {
    // SAFETY: all zeros are a value of this structure of integers.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: the pointer is valid; RUSAGE_SELF always is there, so that the call cannot fail.
    unsafe { libc::getrusage(libc::RUSAGE_SELF, &mut usage) };
    usage.ru_maxrss
}

fn read(clock: libc::clockid_t) -> i64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is valid; these clocks exist on Linux, so that the call cannot fail.
    unsafe { libc::clock_gettime(clock, &mut time) };
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(mode: scenario::ClockMode) -> Clock {
        Clock::new(&scenario::Clock { mode, refresh_hz: 100.0, ..scenario::Clock::default() })
    }

    #[test]
    fn simulated_time_advances_a_period_a_frame_and_never_waits() {
        let mut clock = clock(scenario::ClockMode::Simulated);
        let times: Vec<_> = (0..3).map(|n| clock.next(n * 777).display_time).collect();
        assert_eq!(times, [1_000_000_000, 1_010_000_000, 1_020_000_000]);
        assert_eq!(clock.scenario_seconds(1_020_000_000), 0.02);
    }

    #[test]
    fn real_time_waits_for_the_next_period_and_skips_missed_ones() {
        let mut clock = clock(scenario::ClockMode::Real);
        assert_eq!(clock.next(0), Slot { display_time: 10_000_000, wait: Duration::ZERO });
        assert_eq!(clock.next(4_000_000), Slot { display_time: 20_000_000, wait: Duration::from_millis(6) });
        assert_eq!(clock.next(35_000_000).display_time, 50_000_000);
    }
}
