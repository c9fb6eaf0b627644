//! What `analyze` and `decide` cost on the first Vulkan device, in process CPU time, which on lavapipe is what the device
//! does too, beside copies of the same picture.
//!
//! `cargo run -p parafovea-layer --example kernel_cost`

#![allow(clippy::unwrap_used, reason = "a failed step ends the program")]

#[path = "../tests/compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../tests/compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use parafovea::gpu::AppCommands;
use parafovea::passes::analyze::{Analyze, AnalyzeParams, USAGE, ViewTiles};
use parafovea::passes::decide::{Decide, DecideParams};
use parafovea_core::color::Matrix;
use parafovea_core::kernels::analyze::ContrastSettings;
use std::sync::Arc;
use transfer::Layer;
use vulkan::Vulkan;

const SIDE: u32 = 1024;
const TURNS: usize = 15;

/// CPU time of the process, milliseconds.
fn cpu_ms() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is valid for writes; the clock is one that Linux always has.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

/// Median of some turns, after one that compiles.
fn median(vulkan: &Vulkan, record: impl Fn(vk::CommandBuffer)) -> f64 {
    let turn = || {
        let before = cpu_ms();
        vulkan.run(&record);
        vulkan.idle();
        cpu_ms() - before
    };
    turn();
    let mut costs: Vec<f64> = (0..TURNS).map(|_| turn()).collect();
    costs.sort_by(f64::total_cmp);
    costs[TURNS / 2]
}

fn main() {
    let Some(vulkan) = Vulkan::at(vk::API_VERSION_1_1) else { return };
    let analyze = Analyze::new(&vulkan.gpu).unwrap();
    println!("CPU ms for {SIDE}x{SIDE} pixels, medians of {TURNS}");
    println!("| format | vkCmdCopyImage | vkCmdBlitImage | analyze |");
    println!("|---|---:|---:|---:|");
    for (format, size) in [
        (vk::Format::R8G8B8A8_UNORM, 4),
        (vk::Format::R8G8B8A8_SRGB, 4),
        (vk::Format::R16G16B16A16_SFLOAT, 8),
    ] {
        let extent = vk::Extent2D { width: SIDE, height: SIDE };
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST | USAGE;
        let image = || vulkan.image(vk::ImageCreateFlags::empty(), format, extent, 1, usage);
        let [picture, copy] = [image(), image()];
        let bytes: Vec<u8> =
            (0..SIDE * SIDE * size).map(|i| (i.wrapping_mul(2_654_435_761) >> 26) as u8).collect();
        vulkan.upload(Layer { image: picture, layer: 0, extent }, &bytes);
        let settings = ContrastSettings::default();
        let params = AnalyzeParams::new([0; 2], [SIDE; 2], &settings, 100.0, Matrix::Bt709);
        let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, params.tiles).unwrap());
        let target = analyze.target((picture, format, 0), &params, &tiles).unwrap();
        let analyzed = median(&vulkan, |commands| {
            // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
            let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
            analyze.record(&commands, &target, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
        });
        let layers = vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            layer_count: 1,
            ..Default::default()
        };
        let corners = [vk::Offset3D::default(), vk::Offset3D { x: SIDE as i32, y: SIDE as i32, z: 1 }];
        let (read, write) = (vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        let copied = median(&vulkan, |commands| {
            let region = vk::ImageCopy::default()
                .src_subresource(layers)
                .dst_subresource(layers)
                .extent(extent.into());
            between(&vulkan, commands, [picture, copy], || {
                // SAFETY: the command buffer is being recorded, and both images are live.
                unsafe { vulkan.device.cmd_copy_image(commands, picture, read, copy, write, &[region]) };
            });
        });
        let blitted = median(&vulkan, |commands| {
            let region = vk::ImageBlit::default()
                .src_subresource(layers)
                .dst_subresource(layers)
                .src_offsets(corners)
                .dst_offsets(corners);
            let nearest = vk::Filter::NEAREST;
            between(&vulkan, commands, [picture, copy], || {
                // SAFETY: the command buffer is being recorded, and both images are live.
                unsafe {
                    vulkan.device.cmd_blit_image(commands, picture, read, copy, write, &[region], nearest);
                }
            });
        });
        vulkan.assert_valid();
        println!("| {format:?} | {copied:.2} | {blitted:.2} | {analyzed:.2} |");
    }
    decide_cost(&vulkan);
}

/// Has the first image in the layout to be copied from, and the second one in that to be copied to.
fn between(vulkan: &Vulkan, commands: vk::CommandBuffer, [from, to]: [vk::Image; 2], record: impl FnOnce()) {
    let attachment = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let both = [(from, vk::ImageLayout::TRANSFER_SRC_OPTIMAL), (to, vk::ImageLayout::TRANSFER_DST_OPTIMAL)];
    // SAFETY: the command buffer is being recorded, and both images are live.
    let all = |way: fn(vk::ImageLayout, vk::ImageLayout) -> (vk::ImageLayout, vk::ImageLayout)| unsafe {
        for (image, layout) in both {
            vulkan.transition(commands, image, 1, way(attachment, layout));
        }
    };
    all(|attachment, layout| (attachment, layout));
    record();
    all(|attachment, layout| (layout, attachment));
}

/// One view of 2160 x 2160.
fn decide_cost(vulkan: &Vulkan) {
    let decide = Decide::new(&vulkan.gpu).unwrap();
    let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, [135; 2]).unwrap());
    let target = decide.target(&tiles).unwrap();
    println!("\n| decide, 2160x2160, tiles of 16x16 | CPU ms |");
    println!("|---|---:|");
    for (name, sensitivity) in [("rings alone", 0), ("castleCSF", 1), ("Tursun", 2)] {
        let params = DecideParams {
            gaze_left: [0.0, 0.0, -1.0],
            gaze_right: [0.0, 0.0, -1.0],
            coarsening: 8,
            ring_chords: [0.02, 0.05, 0.1, 0.2],
            coarsening_chords: [0.03, 0.06, 0.11, 0.21],
            levels: [32, 64, 96, 128],
            texels: [4, 5, 9, 10],
            budget: 1.0,
            coarsening_budget: 0.9,
            sensitivity,
            plane_origin: [-1.28, 1.28],
            plane_step: [2.56 / 2160.0, -2.56 / 2160.0],
            extent: [2160; 2],
            texel: [16; 2],
            tiles: [135; 2],
            ..bytemuck::Zeroable::zeroed()
        };
        let decided = median(vulkan, |commands| {
            // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
            let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
            decide.record(&commands, &target, &params, &[]).unwrap();
        });
        println!("| {name} | {decided:.2} |");
    }
}
