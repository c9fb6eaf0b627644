//! The cost of the parts of a mask on the first Vulkan device, in process CPU time, which on lavapipe includes the device's: the figures of
//! `tests/baselines/mask.md`.
//!
//! `cargo run -p parafovea-layer --example mask_cost`

#![allow(clippy::unwrap_used, reason = "a failed step ends the program")]

#[path = "../tests/mask/application.rs"]
#[allow(dead_code, reason = "shared with the tests of mask")]
mod application;
#[path = "../tests/compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../tests/compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use application::{Application, COLOR, Setup};
use ash::vk;
use parafovea::backend::mask::{DepthWork, Eligible, MaskKernels, MaskMap};
use parafovea::gpu::AppCommands;
use parafovea::pass_detection::{Eyes, Orientation, Part};
use parafovea::rate_map::RateImage;
use parafovea_core::mask::{DepthFormat, TemplateDepths};
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use std::sync::Arc;
use vulkan::Vulkan;

const SIDE: u32 = 1024;
const TEXEL: u32 = 16;
const TILES: u32 = SIDE / TEXEL;
const TURNS: usize = 15;

/// CPU time of the process, milliseconds.
fn cpu_ms() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is valid for writes; the clock is one that Linux always has.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

/// Median of some turns.
fn median(mut turn: impl FnMut()) -> f64 {
    let mut costs: Vec<f64> = (0..TURNS)
        .map(|_| {
            let before = cpu_ms();
            turn();
            cpu_ms() - before
        })
        .collect();
    costs.sort_by(f64::total_cmp);
    costs[TURNS / 2]
}

/// Rings around the middle: 1x1 up to a third of the half side, 4x4 from two thirds on.
fn rings() -> Vec<u8> {
    let half = TILES as f32 / 2.0;
    let rate = |tile: u32| {
        let (x, y) = ((tile % TILES) as f32 + 0.5 - half, (tile / TILES) as f32 + 0.5 - half);
        let into = (x.hypot(y) / half - 0.33) * 3.0;
        let fraction = 1.0 - into.clamp(0.0, 1.0) * 15.0 / 16.0;
        VULKAN_RATES.into_iter().find(|rate| rate.fraction() >= fraction).unwrap_or(ShadingRate::R1X1).texel()
    };
    (0..TILES * TILES).map(rate).collect()
}

fn main() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let area = vk::Rect2D { extent: vk::Extent2D { width: SIDE, height: SIDE }, ..Default::default() };
    let setup = Setup { depth: vk::Format::D32_SFLOAT, compare: vk::CompareOp::LESS, clear: 1.0, area };
    let application = Application::new(&vulkan, setup, [SIDE; 2]);
    let kernels = Arc::new(MaskKernels::new(&vulkan.gpu).unwrap());
    let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
    let eligible = Eligible { depths, format: DepthFormat::Float32, drawn: None, work: DepthWork::default() };
    let image = RateImage { area: [0, 0, SIDE, SIDE], texel: [TEXEL; 2], tiles: [TILES; 2], layers: 1 };
    let part =
        Part { eyes: Eyes::Left, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation: Orientation::Upright };
    let uniform = |rate: ShadingRate| vec![rate.texel(); (TILES * TILES) as usize];
    println!("CPU ms for {SIDE}x{SIDE} pixels, medians of {TURNS}");
    println!(
        "| rates | shaded | resolve and stage | upload | template to depth | fill | ns a filled pixel |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|");
    for (name, rates) in [
        ("1x1", uniform(ShadingRate::R1X1)),
        ("checker, 1/2", uniform(ShadingRate::R2X1)),
        ("1/4", uniform(ShadingRate::R2X2)),
        ("1/16", uniform(ShadingRate::R4X4)),
        ("rings", rings()),
    ] {
        let map = MaskMap::new(&vulkan.gpu, &kernels, eligible, [SIDE; 2], 1).unwrap();
        map.prepare(COLOR).unwrap();
        let mut staging = vec![0; map.staging_len()];
        let stage = median(|| map.stage(&[part], &image, &rates, &mut staging));
        let skipped =
            f64::from(u32::from_ne_bytes([staging[12], staging[13], staging[14], staging[15]])) * 16.0;
        let buffer = vulkan.staging(&staging);
        let recorded = |record: &dyn Fn(&AppCommands)| {
            median(|| {
                vulkan.run(|commands| {
                    // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                    record(&unsafe { AppCommands::new(&vulkan.gpu, commands) });
                });
                vulkan.idle();
            })
        };
        let upload = recorded(&|commands| map.upload(commands, buffer, 0));
        let template = recorded(&|commands| {
            map.begin(commands, application.depth_part(), area, application.depth_layouts());
        });
        let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let filling = recorded(&|commands| map.end(commands, application.color_part(), COLOR, layout));
        let each = if skipped > 0.0 { format!("{:.1}", filling * 1e6 / skipped) } else { String::new() };
        let shaded = 1.0 - skipped / f64::from(SIDE * SIDE);
        println!(
            "| {name} | {shaded:.3} | {stage:.2} | {upload:.2} | {template:.2} | {filling:.2} | {each} |"
        );
    }
}
