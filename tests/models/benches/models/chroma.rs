//! Cost of `chroma`.

use criterion::{Criterion, Throughput};
use glam::Vec3;
use parafovea_core::chroma::{ChromaSettings, ChromaTemporalFilter, Curves, Mode};
use parafovea_core::geometry::Fov;
use parafovea_core::kernels::compose::{ComposeParams, PixelFormat, compose_image};
use std::{hint::black_box, time::Duration};

pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chroma");
    group.sample_size(20).measurement_time(Duration::from_secs(1)).warm_up_time(Duration::from_millis(300));
    let default = ChromaSettings::default();
    group.bench_function("curves of a frame", |b| b.iter(|| Curves::new(black_box(&default))));
    group.bench_function("temporal filter of a frame", |b| {
        let mut filter = ChromaTemporalFilter::default();
        let mut frame = 0i64;
        b.iter(|| {
            frame += 1;
            // A saccade of 20 degrees every 30 frames.
            let gaze = Vec3::new(if frame / 30 % 2 == 0 { -0.18 } else { 0.18 }, 0.0, -1.0);
            filter.update(Some(gaze), frame * 11_111_111, black_box(&default))
        });
    });
    const SIDE: u32 = 256;
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
    for (name, mode) in
        [("256 x 256 pixels, default", Mode::Default), ("256 x 256 pixels, paper", Mode::Paper)]
    {
        let settings = ChromaSettings { mode, ..default };
        let params = ComposeParams::new([0, 0], [SIDE, SIDE], fov, Vec3::NEG_Z, &settings, true);
        let mut pixels: Vec<u8> = (0..SIDE * SIDE * 4).map(|i| (i * 37 % 251) as u8).collect();
        group.bench_function(name, |b| {
            b.iter(|| compose_image(black_box(&mut pixels), SIDE, PixelFormat::Rgba8Unorm, &params));
        });
    }
    group.finish();
}
