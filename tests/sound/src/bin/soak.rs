//! `cargo dev soak sound [--seconds N]`: captures sound for an hour or N seconds, and fails if memory grows.

use anyhow::{Context, Result, ensure};
use parafovea_sound::measure::capture_cost;
use std::time::Duration;

/// An hour.
const SECONDS: u64 = 3600;

/// Allowed growth of memory that is not ours: buffers of the player beside us, and of the allocator, bytes.
const SLACK: u64 = 1 << 20;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seconds = match &arguments[..] {
        [] => SECONDS,
        [option, seconds] if option == "--seconds" => seconds.parse().context("--seconds takes a number")?,
        _ => anyhow::bail!("usage: cargo dev soak sound [--seconds N]"),
    };
    let cost = capture_cost(Duration::from_secs(seconds))?;
    println!(
        "captured sound for {:.0} s, {} sets of features: longest wait {} ms, {:.2} % of a core, {} kB at first, at most {} kB",
        cost.time.as_secs_f64(),
        cost.sets,
        cost.longest_wait.as_millis(),
        100.0 * cost.core_share,
        cost.resident_first / 1024,
        cost.resident_most / 1024,
    );
    ensure!(cost.resident_most <= cost.resident_first + SLACK, "memory grows");
    ensure!(cost.sets + 20 >= 10 * seconds, "features are missing");
    Ok(())
}
