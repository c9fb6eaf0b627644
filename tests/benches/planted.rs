//! `cargo dev bench planted [--seeds N] [--gains A,B] [--workers N]`: decisions of the benefit gate with planted costs.

#![allow(clippy::print_stdout, reason = "a bench prints")]

use parafovea_tests::planted::{Decision, SECONDS, decide};
use std::error::Error;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Gains, percent.
const GAINS: [f64; 5] = [30.0, 10.0, 3.0, 0.0, -5.0];

/// Least share of the seeds that is right.
const RIGHT: f64 = 0.95;

/// Most switches of a run.
const SWITCHES: usize = 4;

fn main() -> ExitCode {
    match Request::read(std::env::args().skip(1)).map_err(Into::into).and_then(|request| request.measure()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Request {
    seeds: u64,
    gains: Vec<f64>,
    workers: usize,
}

impl Request {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self { seeds: 100, gains: GAINS.to_vec(), workers: 2 };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().unwrap_or_default();
            let wrong = |value: &str| format!("{argument} does not accept `{value}`");
            match argument.as_str() {
                // `cargo bench` adds the first.
                "--bench" => {}
                "--seeds" => {
                    let value = value();
                    request.seeds = value.parse().map_err(|_| wrong(&value))?;
                }
                "--workers" => {
                    let value = value();
                    request.workers = value.parse().map_err(|_| wrong(&value))?;
                }
                "--gains" => {
                    let value = value();
                    let gains: Result<_, _> = value.split(',').map(str::parse).collect();
                    request.gains = gains.map_err(|_| wrong(&value))?;
                }
                other => {
                    return Err(format!("unknown argument `{other}`; allowed: --seeds, --gains, --workers"));
                }
            }
        }
        Ok(request)
    }

    /// Prints the table. Whether all limits are met.
    fn measure(&self) -> Result<bool, Box<dyn Error>> {
        println!(
            "| gain, % | right after {SECONDS} s, of {} | last switch, s | switches seen | off, % of {SECONDS} s |",
            self.seeds
        );
        println!("|---:|---:|---:|---:|---:|");
        let mut is_met = true;
        for gain in &self.gains {
            let runs = self.run(gain / 100.0)?;
            let right = runs.iter().filter(|run| run.is_right).count();
            let last = runs.iter().map(|run| run.last_switch_s).fold(0.0, f64::max);
            let switches = runs.iter().map(|run| run.switches).max().unwrap_or(0);
            let off = 100.0 * runs.iter().map(|run| run.off).sum::<f64>() / runs.len().max(1) as f64;
            println!("| {gain:.0} | {right} | {last:.1} | {switches} | {off:.1} |");
            is_met &= right as f64 >= RIGHT * self.seeds as f64 && switches <= SWITCHES;
        }
        Ok(is_met)
    }

    /// All seeds of a gain.
    fn run(&self, gain: f64) -> Result<Vec<Decision>, Box<dyn Error>> {
        let (next, done) = (AtomicU64::new(0), Mutex::new(Vec::new()));
        std::thread::scope(|scope| {
            for _ in 0..self.workers {
                scope.spawn(|| {
                    loop {
                        let seed = next.fetch_add(1, Ordering::Relaxed);
                        if seed >= self.seeds {
                            break;
                        }
                        let decision = decide(gain, seed);
                        if let Ok(decision) = &decision
                            && !decision.is_right
                        {
                            eprintln!("gain {gain}, seed {seed}: {decision:?}");
                        }
                        done.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(decision);
                    }
                });
            }
        });
        let done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Ok(done.into_iter().collect::<Result<_, _>>()?)
    }
}
