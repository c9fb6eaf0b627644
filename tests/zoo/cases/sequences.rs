//! Random sequences of calls, and their results, which are the same with and without a layer in between.
//!
//! Legal sequences make only calls that the specification allows in each state. Hostile ones make any call at any time, with handles that
//! are destroyed, null or of another kind, and with long chains of unknown structures; but never a wait that cannot end.

mod world;

use crate::app::App;
use crate::failure::Failure;
use crate::options::Options;
use std::hash::{DefaultHasher, Hash, Hasher};
use world::World;

/// Kind of the calls in a sequence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Manner {
    /// Only calls that the specification allows.
    Legal,
    /// Any calls.
    Hostile,
}

/// Numbers without a pattern (xorshift), the same for each seed.
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self((seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) % end.max(1) as u64) as usize
    }

    /// True once in so many times.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }
}

/// Runs the sequences `first` and following, and prints the number of each, its count of calls, and a hash of their results; for a single
/// one, every call.
pub fn run(options: &Options, first: u64, count: u64, manner: Manner) -> Result<(), Failure> {
    let app = App::start(options, &[])?;
    for number in first..first + count {
        let mut world = World::new(&app, Numbers::new(number), manner);
        world.run();
        let trace = world.end();
        if count == 1 {
            trace.iter().for_each(|line| println!("{line}"));
        }
        let mut hasher = DefaultHasher::new();
        trace.hash(&mut hasher);
        println!("sequence {number}: {} calls {:016x}", trace.len(), hasher.finish());
    }
    Ok(())
}
