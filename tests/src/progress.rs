//! Progress of the work, and an estimate of the time left.

use std::time::Instant;

/// Counts finished work, and prints it before each step.
pub struct Progress {
    start: Instant,
    done: u64,
    all: u64,
}

impl Progress {
    /// Nothing of so much work is done. The unit is the caller's: work of equal amounts should take equal time.
    pub fn new(all: u64) -> Self {
        Self { start: Instant::now(), done: 0, all }
    }

    /// Prints the next step to standard error.
    pub fn next(&self, step: &str) {
        eprintln!("{}", line(step, self.done, self.all, self.seconds()));
    }

    /// Takes note that so much work is done.
    pub fn add(&mut self, work: u64) {
        self.done += work;
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

/// A step with the share of the work that is done, and the time that the rest takes if it goes on as it did; no time at the start, when
/// nothing is known.
fn line(step: &str, done: u64, all: u64, elapsed_s: f64) -> String {
    let percent = (100 * done).checked_div(all).unwrap_or(100).min(100);
    let left = match done {
        0 => String::new(),
        _ => format!(", {} left", duration(elapsed_s * all.saturating_sub(done) as f64 / done as f64)),
    };
    format!("[{percent:>3} %{left}] {step}")
}

/// Seconds up to a minute and a half, then whole minutes.
fn duration(seconds: f64) -> String {
    if seconds < 90.0 { format!("{seconds:.0} s") } else { format!("{:.0} min", (seconds / 60.0).ceil()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_as_the_work_before_it() {
        assert_eq!(line("a scene", 0, 40, 3.0), "[  0 %] a scene");
        assert_eq!(line("a scene", 10, 40, 3.0), "[ 25 %, 9 s left] a scene");
        assert_eq!(line("a scene", 10, 40, 100.0), "[ 25 %, 5 min left] a scene");
        assert_eq!(line("more than all", 50, 40, 100.0), "[100 %, 0 s left] more than all");
    }
}
