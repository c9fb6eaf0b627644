//! Cost of `geometry`.

use criterion::{Criterion, Throughput};
use glam::{Quat, Vec2, Vec3};
use parafovea_core::geometry::{
    Fov, ImagePlane, PixelRect, Reprojection, View, eccentricity, pixels_per_degree, tile_eccentricity,
};
use std::{hint::black_box, time::Duration};

/// Tiles along each side of a view of 2160 x 2160 pixels.
const SIDE: u32 = 135;

fn plane() -> ImagePlane {
    Fov { left: -0.9, right: 0.8, up: 0.85, down: -0.9 }.tangents().plane([2160, 2160])
}

/// The upper left corners of all tiles of a view.
fn tiles() -> impl Iterator<Item = Vec2> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| Vec2::new(x as f32, y as f32) * 16.0))
}

pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("geometry of 18,225 tiles");
    group.sample_size(20).measurement_time(Duration::from_secs(1)).warm_up_time(Duration::from_millis(300));
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    let (plane, gaze) = (black_box(plane()), black_box(Vec3::new(0.2, -0.1, -1.0)));
    group.bench_function("eccentricity of the centres", |b| {
        b.iter(|| tiles().map(|at| eccentricity(gaze, plane.direction(at + 8.0))).fold(0.0, f32::max));
    });
    group.bench_function("least and greatest eccentricity", |b| {
        let rect = |min: Vec2| PixelRect { min, max: min + 16.0 };
        b.iter(|| tiles().map(|at| tile_eccentricity(&plane, rect(at), gaze).min).fold(0.0, f32::max));
    });
    group.bench_function("pixels per degree of the centres", |b| {
        b.iter(|| tiles().map(|at| pixels_per_degree(&plane, at + 8.0)).fold(0.0, f32::max));
    });
    let view = |orientation| View { orientation, plane };
    let to = view(Quat::from_rotation_y(0.02) * Quat::from_rotation_x(-0.01));
    group.bench_function("reprojection of the centres", |b| {
        b.iter(|| {
            let map = Reprojection::between(&view(Quat::IDENTITY), black_box(&to));
            map.map(|map| tiles().filter_map(|at| map.pixel(at + 8.0)).sum::<Vec2>())
        });
    });
    group.finish();
}
