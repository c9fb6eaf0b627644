//! The cost of the kernels of rates by contrast, and of colour, beside a pass that copies the picture: `cargo dev bench kernels [--json]`.
//!
//! CPU time of the process, which on lavapipe is that of the device too; the kernels take turns, and medians are shown. All are
//! of one view. `analyze` and `decide` are recorded several times in one submit, which in a frame is the application's own, and no part
//! of their cost; `compose` submits by itself.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a bench prints, and fails where a step does")]

mod chroma;
mod copy;
#[path = "../../tests/analyze/pictures.rs"]
#[allow(dead_code, reason = "shared with the tests of analyze")]
mod pictures;
#[path = "../../tests/compose/swapchain.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod swapchain;
#[path = "../../tests/compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../../tests/compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use chroma::Chroma;
use copy::Copy;
use glam::Quat;
use parafovea::gpu::AppCommands;
use parafovea::kernels::analyze::{
    Analyze, AnalyzeParams, AnalyzeTarget, AnalyzedPicture, Levels, USAGE, ViewTiles,
};
use parafovea::kernels::decide::{Decide, DecideParams, DecideTarget};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::color::Matrix;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{ContrastSettings, SETTLED};
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{AudioVisual, EyeInput, PlanInput, PlanSettings, Planner, RateSettings};
use std::sync::Arc;
use transfer::Layer;
use vulkan::Vulkan;

const FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;
const WHITE_CD_M2: f32 = 100.0;

/// Sides of the views: of a small headset, and of the paper's.
const SIDES: [u32; 2] = [1024, 2160];
const TURNS: u64 = 15;

/// Number of times that a submit runs a kernel of pictures, and one of tiles.
const PICTURES: u32 = 2;
const DECISIONS: u32 = 16;

fn main() {
    let json = std::env::args().any(|argument| argument == "--json");
    let vulkan = Vulkan::unchecked(vk::API_VERSION_1_1);
    if !json {
        println!("| view | kernel | CPU ms | x copy |\n|---|---|---:|---:|");
    }
    for side in SIDES {
        for (kernel, ms, ratio) in measured(&vulkan, side) {
            if json {
                println!(
                    r#"{{"bench":"kernels","app":"{side}x{side}","case":"{kernel}","metric":"cpu_median","value":{ms},"unit":"ms","ratio":{ratio}}}"#
                );
            } else {
                println!("| {side} x {side} | {kernel} | {ms:.3} | {ratio:.3} |");
            }
        }
    }
}

/// Kernels, their medians in milliseconds, and the ratio to that of the copy.
fn measured(vulkan: &Vulkan, side: u32) -> Vec<(&'static str, f64, f64)> {
    let extent = vk::Extent2D { width: side, height: side };
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST | USAGE;
    let image = vulkan.image(vk::ImageCreateFlags::empty(), FORMAT, extent, 1, usage);
    vulkan.upload(Layer { image, layer: 0, extent }, &rgba8(side));
    vulkan.idle();

    let mut chroma = Chroma::new(vulkan, side);
    let copy = Copy::new(vulkan, image, FORMAT, extent);
    let settings = ContrastSettings::default();
    let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, settings.tiles([side; 2])).unwrap());
    let analyze = Analyze::new(&vulkan.gpu).unwrap();
    let params = AnalyzeParams::new([0; 2], [side; 2], &settings, WHITE_CD_M2, Matrix::Bt709);
    let [analyzed, settled] = [(); 2].map(|()| {
        let levels = Arc::new(Levels::new(&vulkan.gpu, [side; 2]).unwrap());
        analyze.target((image, FORMAT, 0), &params, (&tiles, &levels)).unwrap()
    });
    let record_analysis = |commands, target: &AnalyzeTarget, same_view| {
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
        let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        analyze.record(&commands, &[AnalyzedPicture { target, layout, comparison: same_view }]);
    };
    vulkan.run(|commands| {
        (0..=1 + SETTLED).for_each(|same_view| record_analysis(commands, &settled, same_view));
    });
    let decide = Decide::new(&vulkan.gpu).unwrap();
    // Nothing is ever measured of these, so that they have no contrast.
    let plain = Arc::new(ViewTiles::new(&vulkan.gpu, settings.tiles([side; 2])).unwrap());
    let [decided, plain] = [&tiles, &plain].map(|tiles| decide.target(tiles).unwrap());
    let record_decision = |commands, target: &DecideTarget, params: &DecideParams| {
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
        let variant = decide.write(&commands, target, params, &[]).unwrap();
        decide.record(&commands, target, variant);
    };

    let mut times = [const { Vec::new() }; 8];
    for turn in 0..TURNS {
        let params = decision(side, turn);
        times[0].push(cpu_ms(vulkan, PICTURES, |commands| copy.record(vulkan, commands)));
        times[1].push(cpu_ms(vulkan, PICTURES, |commands| record_analysis(commands, &analyzed, 0)));
        times[2].push(cpu_ms(vulkan, PICTURES, |commands| record_analysis(commands, &settled, 2)));
        let rings = DecideParams { sensitivity: 0, ..params };
        for (index, target, params) in [(3, &decided, &params), (4, &plain, &params), (5, &plain, &rings)] {
            times[index]
                .push(cpu_ms(vulkan, DECISIONS, |commands| record_decision(commands, target, params)));
        }
        times[6].push(chroma.cpu_ms(PICTURES, false));
        times[7].push(chroma.cpu_ms(PICTURES, true));
    }
    let names = [
        "copy",
        "analyze",
        "analyze, the same again",
        "decide",
        "decide, a plain picture",
        "decide, by rings alone",
        "compose, nothing to do",
        "compose, colour removed",
    ];
    let times = times.map(median);
    names.into_iter().zip(times).map(|(name, ms)| (name, ms, ms / times[0])).collect()
}

/// A picture like a natural one, as the format stores it.
fn rgba8(side: u32) -> Vec<u8> {
    let plane = pictures::plane(pictures::ALL[0], [side; 2]);
    let bytes = |color: &glam::Vec3| [color.x, color.y, color.z, 1.0].map(|x| (x * 255.0) as u8);
    plane.texels().iter().flat_map(bytes).collect()
}

/// The parameters of a decision: sound is heard, and contrast counts.
fn decision(side: u32, frame: u64) -> DecideParams {
    let settings =
        PlanSettings { rates: RateSettings::AudioVisual(AudioVisual::default()), ..PlanSettings::default() };
    let [columns, rows] = ContrastSettings::default().tiles([side; 2]);
    let contrast = ContrastMap { tiles: Plane::filled(columns, rows, TileContrast::default()) };
    let eye = EyeInput {
        offset: [0; 2],
        extent: [side; 2],
        fov: Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 },
        orientation: Quat::IDENTITY,
        contrast: Some(&contrast),
        refresh: false,
    };
    let input = PlanInput {
        time_ns: 0,
        frame,
        frame_rate_hz: 90.0,
        eyes: [eye; 2],
        head: Quat::IDENTITY,
        gaze: GazeState { phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST },
        audio: Some(AudioFeatures {
            loudness_lufs: -20.0,
            gamma_ld: 12.0,
            gamma_fq_kilomel: 1.4,
            silent: false,
        }),
    };
    let params = Planner::new(settings).plan(&input).eyes[0].decision.with_full_rate_period(30, frame);
    assert!(params.sensitivity != 0, "contrast does not count");
    params
}

/// CPU time of the process until the recorded commands, so many times, have run: milliseconds each.
fn cpu_ms(vulkan: &Vulkan, times: u32, record: impl Fn(vk::CommandBuffer)) -> f64 {
    cpu_ms_of(vulkan, times, || vulkan.run(|commands| (0..times).for_each(|_| record(commands))))
}

/// The same for functions that submit by themselves, so many times.
fn cpu_ms_of(vulkan: &Vulkan, times: u32, submit: impl FnOnce()) -> f64 {
    let before = process_cpu_ns();
    submit();
    vulkan.idle();
    (process_cpu_ns() - before) as f64 / 1e6 / f64::from(times)
}

fn process_cpu_ns() -> i64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is valid, and the clock exists on Linux.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
