//! CPU time, from the operating system.

/// CPU time that all threads of this process have spent, nanoseconds; `None` if the system does not report it.
pub fn process_cpu_ns() -> Option<u64> {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the structure is valid to write to.
    let result = unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut now) };
    let (seconds, nanoseconds) = (u64::try_from(now.tv_sec).ok()?, u64::try_from(now.tv_nsec).ok()?);
    (result == 0).then(|| seconds * 1_000_000_000 + nanoseconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_time() {
        let start = process_cpu_ns().unwrap();
        let mut sum = 0u64;
        while process_cpu_ns().unwrap() - start < 1_000_000 {
            sum = std::hint::black_box(sum.wrapping_add(1));
        }
        assert!(sum > 0 && process_cpu_ns().unwrap() >= start + 1_000_000);
    }
}
