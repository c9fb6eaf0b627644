//! Work of the application that is not drawing.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Bytes that the work goes through: more than the nearest caches of a core hold, as the state of a game's world is.
const BYTES: usize = 1 << 20;

/// A loop over memory.
#[derive(Default)]
pub struct Simulation {
    /// Made by the first work.
    world: Vec<u64>,
    next: usize,
}

impl Simulation {
    /// Keeps the calling thread busy for so long; without a duration it touches nothing.
    pub fn run(&mut self, duration: Duration) {
        if duration.is_zero() {
            return;
        }
        let start = Instant::now();
        self.world.resize(BYTES / size_of::<u64>(), 1);
        while start.elapsed() < duration {
            for _ in 0..256 {
                // A line of the cache further each time.
                self.next = (self.next + 8) % self.world.len();
                self.world[self.next] = black_box(self.world[self.next].wrapping_mul(3));
            }
        }
    }
}
