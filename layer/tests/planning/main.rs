//! Planning costs a steady frame no heap.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

#[path = "../compose/allocations.rs"]
mod allocations;

use glam::{Quat, Vec3};
use parafovea::config::{Config, Preset, RatesMode};
use parafovea::inputs::gaze::Look;
use parafovea::link::{BACKEND_RATE_ATTACHMENT, CapabilitiesRecord};
use parafovea::planner::{Capabilities, SessionPlanner, ShownView, View};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::geometry::Fov;
use parafovea_core::rate::VULKAN_RATES;

const FRAME_NS: i64 = 11_111_111;

fn capabilities() -> Capabilities {
    let mut record = CapabilitiesRecord {
        backend: BACKEND_RATE_ATTACHMENT,
        texel: [16, 16],
        rate_count: VULKAN_RATES.len() as u32,
        rates: [0; 16],
        is_cpu: 0,
    };
    for (to, rate) in record.rates.iter_mut().zip(VULKAN_RATES) {
        *to = rate.texel();
    }
    Capabilities::from(&record)
}

/// One frame as the OpenXR half goes through it, with a gaze and a resolution that change all the time. Whether rates were
/// handed over.
fn frame(planner: &mut SessionPlanner, config: &Config, number: i64) -> bool {
    let time_ns = number * FRAME_NS;
    let wobble = (number as f32 * 0.02).sin();
    let head = Quat::from_rotation_y(wobble);
    let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
    let views = [0.05, -0.05].map(|cant| View {
        orientation: head * Quat::from_rotation_y(cant),
        position: head * Vec3::X * (-0.64 * cant),
        fov,
    });
    planner.frame_begins(time_ns, 1);
    planner.views.located(&views);
    let direction = Quat::from_rotation_y(0.3 * wobble) * Vec3::NEG_Z;
    planner.look(
        config,
        Look::At { direction, sampled_ns: time_ns - 50_000_000, uncertainty_ns: 0 },
        head,
        time_ns,
    );
    let is_planned = planner.plan(config, true, head, time_ns);
    let is_new = is_planned && planner.new_rates(config, || number as u64).is_some();
    let side = 800 + (100.0 * wobble) as u32;
    planner.views.shown(Some(1), &views.map(|view| ShownView { view, extent: [side, side] }));
    is_new
}

/// With the sound of `heard`, frame by frame.
fn assert_does_not_allocate(config: &Config, heard: impl Fn(i64) -> Option<AudioFeatures>) {
    let mut planner = SessionPlanner::new(capabilities());
    let next = |planner: &mut SessionPlanner, number| {
        planner.listen(heard(number));
        frame(planner, config, number)
    };
    for number in 0..4 {
        next(&mut planner, number);
    }
    let mut handed_over = 0;
    let allocations = allocations::count(|| {
        for number in 4..200 {
            handed_over += usize::from(next(&mut planner, number));
        }
    });
    assert_eq!(allocations, 0);
    assert!(handed_over > 20, "rates were handed over {handed_over} times only");
}

#[test]
fn a_steady_frame_does_not_allocate() {
    assert_does_not_allocate(&Config::of_preset(Preset::Streaming), |_| None);
}

/// With sound that changes, stops, and starts.
#[test]
fn a_steady_frame_with_contrast_and_sound_does_not_allocate() {
    let mut config = Config::of_preset(Preset::Streaming);
    for mode in [RatesMode::AudioVisual, RatesMode::Paper] {
        config.rates.mode = mode;
        assert_does_not_allocate(&config, |number| {
            let gamma_ld = (number % 25) as f32;
            let loud = AudioFeatures {
                loudness_lufs: gamma_ld - 35.0,
                gamma_ld,
                gamma_fq_kilomel: 1.4,
                silent: false,
            };
            match number / 30 % 3 {
                0 => Some(loud),
                1 => Some(AudioFeatures::SILENT),
                _ => None,
            }
        });
    }
}
