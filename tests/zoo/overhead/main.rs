//! Programs for the benches, run through the Vulkan loader and the layers of the environment: one that measures the CPU time of
//! recording, one that shades pixels of a chosen cost.

mod buffer;
mod cpu_time;
mod device;
mod headset;
mod pass;
mod pipeline;
mod recording;
mod scene;
mod shading;
mod style;
mod target;

use anyhow::Result;
use clap::Parser;

/// The application of Parafovea's benches.
#[derive(Parser)]
enum Command {
    /// Records draw calls and prints, as JSON, the CPU time that each needs.
    Record(recording::Recording),
    /// Is an OpenXR application whose pixels cost a chosen amount.
    Shade(shading::Shading),
}

fn main() -> Result<()> {
    match Command::parse() {
        Command::Record(recording) => recording::run(&recording),
        Command::Shade(shading) => shading::run(&shading),
    }
}
