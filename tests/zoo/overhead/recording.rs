//! Measures the CPU time that an application needs to record render passes with draw calls and to submit them. The draws
//! themselves draw nothing. With `--openxr` it is an OpenXR application: each round is a frame, whose last two passes draw to
//! the images of the eyes.
//!
//! Prints one JSON object on one line ([`Figures`]).

use crate::cpu_time::ThreadTime;
use crate::device::Device;
use crate::headset::{Headset, Session};
use crate::scene::{Amount, SIZE, Scene};
use crate::style::Style;
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

/// Recorded work.
#[derive(Args)]
pub struct Recording {
    /// Number of times that everything is recorded and submitted.
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Draw calls in a command buffer.
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    draws: u32,
    /// Render passes in a command buffer, among which the draw calls are spread.
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(2..))]
    passes: u32,
    /// Way to record render passes.
    #[arg(long, value_enum, default_value_t = Style::RenderPass)]
    style: Style,
    /// Act as an OpenXR application.
    #[arg(long)]
    openxr: bool,
}

/// The printed results. Times are CPU time of the calling thread, in nanoseconds; medians over the rounds, and the fastest, which other
/// work on the machine disturbs least.
#[derive(Serialize)]
struct Figures {
    rounds: u32,
    draws: u32,
    passes: u32,
    /// Recording, from vkBeginCommandBuffer to vkEndCommandBuffer, divided by the draws.
    record_ns_per_draw: f64,
    record_ns_per_draw_min: f64,
    /// One vkQueueSubmit of the command buffer.
    submit_ns: f64,
    submit_ns_min: f64,
}

/// Rounds at the start that do not count: caches and the driver's own allocations settle in them, and a layer may need a few frames to
/// recognise passes.
const WARM_UP_ROUNDS: u32 = 8;

/// Measures, and prints [`Figures`].
pub fn run(arguments: &Recording) -> Result<()> {
    let headset = if arguments.openxr { Some(Headset::new()?) } else { None };
    let device = Device::new(arguments.style, headset.as_ref()).context("no Vulkan device")?;
    let mut session = headset.map(|headset| headset.begin_session(&device, SIZE)).transpose()?;
    let figures = measure(arguments, &device, session.as_mut())?;
    println!("{}", serde_json::to_string(&figures)?);
    Ok(())
}

fn measure(arguments: &Recording, device: &Device, mut session: Option<&mut Session>) -> Result<Figures> {
    let images = |eye: usize| session.as_ref().map_or(&[][..], |session| &session.eyes[eye].images[..]);
    let scene = Scene::new(device, arguments.style, [images(0), images(1)])?;
    let amount = Amount { passes: arguments.passes, draws: arguments.draws };
    let mut record = Vec::new();
    let mut submit = Vec::new();
    for round in 0..WARM_UP_ROUNDS + arguments.rounds {
        let frame = session.as_mut().map(|session| session.begin_frame()).transpose()?;
        let eyes = frame.as_ref().map(|frame| frame.images);
        let start = ThreadTime::now();
        let commands = scene.record(amount, eyes)?;
        let recorded = ThreadTime::now();
        device.submit(commands)?;
        let submitted = ThreadTime::now();
        if let (Some(session), Some(frame)) = (&mut session, &frame) {
            session.end_frame(frame)?;
        }
        device.wait()?;
        if round >= WARM_UP_ROUNDS {
            record.push(recorded.since(start) / f64::from(arguments.draws));
            submit.push(submitted.since(recorded));
        }
    }
    let (record_ns_per_draw_min, record_ns_per_draw) = least_and_median(record);
    let (submit_ns_min, submit_ns) = least_and_median(submit);
    Ok(Figures {
        rounds: arguments.rounds,
        draws: arguments.draws,
        passes: arguments.passes,
        record_ns_per_draw,
        record_ns_per_draw_min,
        submit_ns,
        submit_ns_min,
    })
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
