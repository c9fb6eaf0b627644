//! The CPU time of this process, as the mock runtime records it too: both relate an event to its frame.

/// Nanoseconds of CLOCK_PROCESS_CPUTIME_ID.
pub(crate) fn process_cpu_ns() -> u64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: a structure to write to; the clock is there on every Linux.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut now) };
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}
