//! Draws the scene without OpenXR: a still to look at, or what one eye's image costs.
//!
//! `cargo run -p parafovea-scene --example offscreen -- --png still.png`
//! `cargo run -p parafovea-scene --example offscreen -- --cost`

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use clap::Parser;
use glam::{Quat, vec3};
use parafovea_scene::{camera::Camera, offscreen::Offscreen, scene::SceneName};

#[derive(Parser)]
struct Options {
    /// Write the frame to this file.
    #[arg(long)]
    png: Option<PathBuf>,
    /// Print the process CPU time of a frame.
    #[arg(long)]
    cost: bool,
    #[arg(long, default_value_t = 0)]
    frame: u64,
    /// What is to be seen.
    #[arg(long, value_enum, default_value_t)]
    scene: SceneName,
    #[arg(long)]
    lights: Option<u32>,
    /// Side of the square image.
    #[arg(long, default_value_t = 1024)]
    size: u32,
    /// Turn of the head to the left in degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    yaw: f32,
    /// Turn of the head upwards in degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pitch: f32,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let lights = options.lights.unwrap_or(options.scene.definition().default_lights);
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let mut offscreen = Offscreen::new([options.size; 2], format, options.scene, lights)?;
    // The left eye of the mock runtime's default head.
    let turn =
        Quat::from_rotation_y(options.yaw.to_radians()) * Quat::from_rotation_x(options.pitch.to_radians());
    let edge = 45f32.to_radians();
    let camera = Camera::new(vec3(-0.032, 1.6, 0.0), turn, [-edge, edge, -edge, edge]);
    offscreen.draw(options.frame, &[camera])?;
    if let Some(path) = &options.png {
        let file = std::fs::File::create(path).with_context(|| format!("creating {}", path.display()))?;
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), options.size, options.size);
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header()?.write_image_data(&offscreen.texels()?)?;
    }
    if options.cost {
        const WARM_UP: u64 = 10;
        const FRAMES: u64 = 90;
        let mut costs = Vec::new();
        for frame in 0..WARM_UP + FRAMES {
            let before = process_cpu_time();
            offscreen.draw(options.frame + frame, &[camera])?;
            costs.push(process_cpu_time() - before);
        }
        let mut costs: Vec<_> =
            costs[WARM_UP as usize..].iter().map(|cost| cost.as_secs_f64() * 1e3).collect();
        costs.sort_by(f64::total_cmp);
        println!("{}", offscreen.device_name);
        println!(
            "{0}, CPU ms for one {1}x{1} eye, {2} lights, {3} frames: median {4:.1}, quartiles {5:.1} and {6:.1}",
            options.scene.as_str(),
            options.size,
            lights,
            costs.len(),
            costs[costs.len() / 2],
            costs[costs.len() / 4],
            costs[costs.len() * 3 / 4]
        );
    }
    Ok(())
}

fn process_cpu_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is valid for writes; the clock is one that Linux always has.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
