//! Scheduling delay of a thread on a busy machine.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Period of the thread's sleep.
const PERIOD: Duration = Duration::from_millis(5);

/// Threads that a sound passes one after the other: the server's, the listening one and the application's.
const THREADS: f64 = 3.0;

/// Measures, from its start on, the delay of a thread.
pub struct Lateness {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    worst_ns: AtomicU64,
    is_over: AtomicBool,
}

impl Lateness {
    /// Begins to measure.
    pub fn start() -> Self {
        let shared = Arc::new(Shared::default());
        let theirs = shared.clone();
        let measure = move || {
            while !theirs.is_over.load(Ordering::Relaxed) {
                let start = Instant::now();
                std::thread::sleep(PERIOD);
                let late = start.elapsed().saturating_sub(PERIOD);
                theirs.worst_ns.fetch_max(late.as_nanos() as u64, Ordering::Relaxed);
            }
        };
        Self { shared, thread: Some(std::thread::spawn(measure)) }
    }

    /// Allowed delay of sound for that reason, seconds: the worst delay for each of its threads. A few milliseconds on an idle
    /// machine.
    pub fn allowance_s(&self) -> f64 {
        THREADS * self.worst_s()
    }

    /// The worst delay, seconds.
    pub fn worst_s(&self) -> f64 {
        Duration::from_nanos(self.shared.worst_ns.load(Ordering::Relaxed)).as_secs_f64()
    }
}

impl Drop for Lateness {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
        // It does not panic.
        drop(self.thread.take().map(JoinHandle::join));
    }
}
