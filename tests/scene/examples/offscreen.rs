//! Draws a scene without OpenXR: a still to look at, or the cost of one eye's image.
//!
//! `cargo run -p parafovea-scene --example offscreen -- --png still.png`
//! `cargo run -p parafovea-scene --example offscreen -- --cost`

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use clap::Parser;
use glam::{Quat, Vec3, vec3};
use parafovea_scene::camera::Camera;
use parafovea_scene::offscreen::Offscreen;
use parafovea_scene::options::parse_foveation;
use parafovea_scene::renderer::Foveation;
use parafovea_scene::scene::{SceneName, time_of};
use parafovea_scene::script::{Script, head::EYE_HEIGHT_M};

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
    /// The scene.
    #[arg(long, value_enum, default_value_t)]
    scene: SceneName,
    #[arg(long)]
    lights: Option<u32>,
    /// Side of the square image.
    #[arg(long, default_value_t = 1024)]
    size: u32,
    /// Fixed foveation, as the application's option of that name.
    #[arg(long, value_parser = parse_foveation)]
    foveation: Option<Foveation>,
    /// Turn of the head to the left in degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    yaw: f32,
    /// Turn of the head upwards in degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pitch: f32,
    /// Move the head as in the scene's script, and print the position of the gaze in the image.
    #[arg(long, conflicts_with_all = ["yaw", "pitch"])]
    scripted: bool,
}

/// Half the angle that the picture shows, degrees.
const EDGE_DEG: f32 = 45.0;

/// Position of the left eye of the mock runtime's default headset on the head, metres.
const LEFT_EYE: Vec3 = vec3(-0.032, 0.0, 0.0);

fn camera(eye: Vec3, turn: Quat) -> Camera {
    let edge = EDGE_DEG.to_radians();
    Camera::new(eye, turn, [-edge, edge, -edge, edge])
}

fn main() -> Result<()> {
    let options = Options::parse();
    let lights = options.lights.unwrap_or(options.scene.definition().default_lights);
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let mut offscreen = Offscreen::new([options.size; 2], format, options.scene, lights)?;
    offscreen.set_foveation(options.foveation);
    let script = options.scripted.then(|| Script::new(options.scene));
    let camera_of = |frame: u64| match &script {
        Some(script) => {
            let head = script.head.at(time_of(frame));
            camera(head.world_position() + head.orientation() * LEFT_EYE, head.orientation())
        }
        None => {
            let turn = Quat::from_rotation_y(options.yaw.to_radians())
                * Quat::from_rotation_x(options.pitch.to_radians());
            camera(Vec3::Y * EYE_HEIGHT_M + LEFT_EYE, turn)
        }
    };
    // The scripted gaze, or the centre of the view.
    let gaze_of = |frame: u64| {
        let gaze = script.as_ref().map_or(Vec3::NEG_Z, |script| script.gaze.at(time_of(frame)).direction);
        camera_of(frame).orientation * gaze
    };
    offscreen.draw_gazing(options.frame, &[camera_of(options.frame)], gaze_of(options.frame))?;
    if let Some(script) = &script {
        let gaze = script.gaze.at(time_of(options.frame));
        let point = gaze.direction * gaze.distance_m - LEFT_EYE;
        let half = options.size as f32 / 2.0;
        let [x, y] = [point.x, -point.y].map(|across| half + half * across / -point.z);
        println!("{:?} on texel ({x:.0}, {y:.0}), {:.2} m away", gaze.phase, gaze.distance_m);
    }
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
            let frame = options.frame + frame;
            offscreen.draw_gazing(frame, &[camera_of(frame)], gaze_of(frame))?;
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
