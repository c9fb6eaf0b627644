//! Measures the CPU time that an application needs to record draw calls and to submit them, through the Vulkan
//! loader and whatever layers the environment puts there. The draws themselves draw nothing.
//!
//! Prints one JSON object on one line ([`Figures`]).

mod cpu_time;
mod device;
mod pipeline;
mod scene;

use anyhow::{Context, Result};
use clap::Parser;
use cpu_time::ThreadTime;
use device::Device;
use scene::Scene;
use serde::Serialize;

/// Records draw calls and prints, as JSON, the CPU time that each needs.
#[derive(Parser)]
struct Arguments {
    /// How often everything is recorded and submitted.
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Draw calls in a command buffer.
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    draws: u32,
}

/// What is printed. Times are CPU time of the calling thread, in nanoseconds; medians over the rounds, and the
/// fastest, which other work on the machine disturbs least.
#[derive(Serialize)]
struct Figures {
    rounds: u32,
    draws: u32,
    /// Recording, from vkBeginCommandBuffer to vkEndCommandBuffer, divided by the draws.
    record_ns_per_draw: f64,
    record_ns_per_draw_min: f64,
    /// One vkQueueSubmit of the command buffer.
    submit_ns: f64,
    submit_ns_min: f64,
}

/// Rounds at the start that do not count: caches and the driver's own allocations settle in them.
const WARM_UP_ROUNDS: u32 = 3;

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let device = Device::new().context("no Vulkan device")?;
    let scene = Scene::new(&device)?;
    let mut record = Vec::new();
    let mut submit = Vec::new();
    for round in 0..WARM_UP_ROUNDS + arguments.rounds {
        let start = ThreadTime::now();
        let commands = scene.record(arguments.draws)?;
        let recorded = ThreadTime::now();
        device.submit(commands)?;
        let submitted = ThreadTime::now();
        device.wait()?;
        if round >= WARM_UP_ROUNDS {
            record.push(recorded.since(start) / f64::from(arguments.draws));
            submit.push(submitted.since(recorded));
        }
    }
    let (record_ns_per_draw_min, record_ns_per_draw) = least_and_median(record);
    let (submit_ns_min, submit_ns) = least_and_median(submit);
    let figures = Figures {
        rounds: arguments.rounds,
        draws: arguments.draws,
        record_ns_per_draw,
        record_ns_per_draw_min,
        submit_ns,
        submit_ns_min,
    };
    println!("{}", serde_json::to_string(&figures)?);
    Ok(())
}

/// The smallest value and the median of at least one.
fn least_and_median(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let median =
        if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 };
    (values[0], median)
}

#[cfg(test)]
mod tests {
    use super::least_and_median;

    #[test]
    fn median_of_odd_and_even() {
        assert_eq!(least_and_median(vec![3.0, 1.0, 10.0]), (1.0, 3.0));
        assert_eq!(least_and_median(vec![4.0, 1.0, 10.0, 2.0]), (1.0, 3.0));
    }
}
