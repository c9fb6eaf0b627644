//! How far along the work is, and how long it will still take.

use std::time::Instant;

/// Counts runs and work that is done.
pub struct Progress {
    start: Instant,
    runs: [usize; 2],
    work: [u64; 2],
}

impl Progress {
    /// Nothing of so many runs and so much work is done.
    pub fn new(runs: usize, work: u64) -> Self {
        Self { start: Instant::now(), runs: [0, runs], work: [0, work] }
    }

    /// Says what comes next.
    pub fn next(&mut self, what: &str) {
        self.runs[0] += 1;
        let [done, all] = self.work;
        let left = match done {
            0 => String::new(),
            _ => {
                let seconds =
                    self.start.elapsed().as_secs_f64() * (all.saturating_sub(done)) as f64 / done as f64;
                format!(", {:.0} min left", (seconds / 60.0).ceil())
            }
        };
        eprintln!("[{}/{}{left}] {what}", self.runs[0], self.runs[1]);
    }

    /// So much work is done.
    pub fn add(&mut self, work: u64) {
        self.work[0] += work;
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}
