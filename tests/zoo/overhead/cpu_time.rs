//! CPU time of the calling thread.

/// A point on the thread's CPU clock.
#[derive(Clone, Copy)]
pub struct ThreadTime(libc::timespec);

impl ThreadTime {
    /// Now.
    pub fn now() -> Self {
        let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the structure is valid to write to. The clock exists on every Linux since 2.6.12, so that the
        // call cannot fail.
        unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut now) };
        Self(now)
    }

    /// Nanoseconds from `earlier` to this.
    pub fn since(self, earlier: Self) -> f64 {
        (self.0.tv_sec - earlier.0.tv_sec) as f64 * 1e9 + (self.0.tv_nsec - earlier.0.tv_nsec) as f64
    }
}
