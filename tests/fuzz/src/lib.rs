//! Mutated inputs for all readers of foreign data: seeded and without coverage, so that it needs no special compiler.
//!
//! An input is made from the files in `tests/corpus/TARGET` by flipping, removing, repeating and joining parts. A target panics if
//! an invariant does not hold.

mod targets;

pub use targets::{TARGETS, Target};

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// An input that takes longer hangs.
const SLOWEST: Duration = Duration::from_secs(5);

/// Inputs grow no longer than this, bytes.
const LONGEST: usize = 4096;

/// Parts that texts like these have, and that mean something.
const TOKENS: [&str; 16] = [
    "\n",
    "=",
    "[",
    "]",
    "\"",
    ",",
    "#",
    "{",
    "}",
    "0",
    "-1",
    "1e999",
    "nan",
    "9223372036854775808",
    "\u{feff}",
    "[[",
];

/// Condition for the end.
#[derive(Clone, Copy, Debug)]
pub enum Until {
    /// After so many inputs.
    Executions(u64),
    /// After so long.
    Time(Duration),
}

/// An input that a target does not stand.
#[derive(Debug)]
pub struct Finding {
    /// The input.
    pub input: Vec<u8>,
    /// The failure.
    pub what: String,
}

/// Numbers without a pattern (xorshift), the same for each seed.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) % end.max(1) as u64) as usize
    }
}

/// Runs a target, first with its unchanged corpus; returns the number of its inputs.
///
/// # Errors
/// The first finding.
///
/// # Panics
/// Where the target has no corpus: everything would pass.
pub fn run(target: &Target, seed: u64, until: Until) -> Result<u64, Finding> {
    let corpus = corpus(target.name);
    assert!(!corpus.is_empty(), "{} has no corpus", target.name);
    let mut numbers = Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let start = Instant::now();
    for input in &corpus {
        execute(target, input)?;
    }
    let mut executions = corpus.len() as u64;
    loop {
        let is_over = match until {
            Until::Executions(count) => executions >= count,
            Until::Time(time) => start.elapsed() >= time,
        };
        if is_over {
            return Ok(executions);
        }
        execute(target, &mutated(&corpus, &mut numbers))?;
        executions += 1;
    }
}

fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../corpus").join(name);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths.into_iter().filter_map(|path| std::fs::read(path).ok()).collect()
}

fn execute(target: &Target, input: &[u8]) -> Result<(), Finding> {
    let start = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| (target.execute)(input)));
    let failed = |what: String| Err(Finding { input: input.to_vec(), what });
    match outcome {
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            failed(text.unwrap_or_default())
        }
        Ok(()) if start.elapsed() > SLOWEST => failed(format!("took {:?}", start.elapsed())),
        Ok(()) => Ok(()),
    }
}

/// One of the corpus, changed in a few places.
fn mutated(corpus: &[Vec<u8>], numbers: &mut Numbers) -> Vec<u8> {
    let mut input = corpus[numbers.below(corpus.len())].clone();
    for _ in 0..=numbers.below(6) {
        let at = numbers.below(input.len() + 1);
        let end = (at + numbers.below(16)).min(input.len());
        match numbers.below(8) {
            0 => drop(input.drain(at..end)),
            1 => drop(input.splice(at..at, input[at..end].to_vec())),
            2 => {
                let token = TOKENS[numbers.below(TOKENS.len())].bytes();
                drop(input.splice(at..end, token));
            }
            3 => {
                let other = &corpus[numbers.below(corpus.len())];
                let from = numbers.below(other.len() + 1);
                let to = (from + numbers.below(64)).min(other.len());
                drop(input.splice(at..end, other[from..to].iter().copied()));
            }
            4 => input.truncate(at),
            5 => input.insert(at, numbers.below(256) as u8),
            6 if at < input.len() => {
                input[at] = input[at].wrapping_add(numbers.below(3) as u8).wrapping_sub(1)
            }
            _ if at < input.len() => input[at] ^= 1 << numbers.below(8),
            _ => {}
        }
    }
    input.truncate(LONGEST);
    input
}
