//! Cost of `schedule`: two eyes of 2160 x 2160 pixels in tiles of 16, 36,450 tiles.

use criterion::Criterion;
use glam::{Quat, Vec3};
use parafovea_core::geometry::{Fov, View};
use parafovea_core::schedule::{CellAges, Phase, Schedule, TileCells, UpdateConfiguration};
use std::hint::black_box;
use std::time::Duration;

const EXTENT: [u32; 2] = [2160, 2160];
const TILE_SIZE: u32 = 16;

pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("schedule");
    group.sample_size(20).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    let schedule = Schedule {
        configuration: UpdateConfiguration::F11223,
        phase: Phase::Staggered,
        ..Schedule::default()
    };
    let mut ages = CellAges::new();
    let mut cells = [TileCells::default(), TileCells::default()];
    let mut frame = 0;

    group.bench_function("advance", |bencher| {
        bencher.iter(|| {
            frame += 1;
            ages.advance(&schedule, frame, black_box([gaze(frame); 2]));
        });
    });
    group.bench_function("tile_cells, two eyes", |bencher| {
        bencher.iter(|| update(&mut cells, black_box(frame)));
    });
    let mut due = [0, 1].map(|eye: usize| {
        let [columns, rows] = cells[eye].tiles();
        vec![false; columns as usize * rows as usize]
    });
    group.bench_function("due_tiles, 36450 tiles", |bencher| {
        bencher.iter(|| {
            for eye in 0..2 {
                ages.due_tiles(&cells[eye], eye, black_box(&mut due[eye]));
            }
        });
    });
    group.bench_function("all, two eyes of 2160x2160", |bencher| {
        bencher.iter(|| {
            frame += 1;
            ages.advance(&schedule, frame, [gaze(frame); 2]);
            ages.finish(0);
            update(&mut cells, frame);
            for eye in 0..2 {
                ages.due_tiles(&cells[eye], eye, black_box(&mut due[eye]));
            }
        });
    });
    group.finish();
}

/// A gaze that wanders, so that regions move over the cells.
fn gaze(frame: u64) -> Vec3 {
    let angle = frame as f32 * 0.01;
    Vec3::new(0.3 * angle.sin(), 0.2 * angle.cos(), -1.0)
}

/// Two asymmetric eyes on a head that turns.
fn update(cells: &mut [TileCells; 2], frame: u64) {
    for (eye, cells) in cells.iter_mut().enumerate() {
        let side = [-1.0, 1.0][eye];
        let fov = Fov { left: -0.9 + 0.05 * side, right: 0.9 + 0.05 * side, up: 0.85, down: -0.9 };
        let orientation = Quat::from_rotation_y(frame as f32 * 0.005);
        cells.update(&View { orientation, plane: fov.tangents().plane(EXTENT) }, EXTENT, TILE_SIZE);
    }
}
