//! Cost of the gaze: one sample and one state, for eyes that rest, follow and jump.

use criterion::Criterion;
use glam::Vec3;
use parafovea_core::gaze::{GazeSample, GazeSettings, GazeTracker};
use std::hint::black_box;

const STEP_NS: i64 = 8_333_333;

pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gaze");
    // A saccade of 20 degrees in 8 samples and a rest, over and over, so that every sample of both counts.
    group.bench_function("a sample and a state", |bencher| {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut number = 0i64;
        bencher.iter(|| {
            number += 1;
            let (saccade, sample) = (number / 32, (number % 32) as f32);
            let way = (sample / 8.0).min(1.0);
            let way = way * way * (3.0 - 2.0 * way);
            let side = if saccade % 2 == 0 { way } else { 1.0 - way };
            let angle = (20.0 * side - 10.0).to_radians();
            let directions = [Vec3::new(angle.sin(), 0.0, -angle.cos()); 2];
            let time_ns = number * STEP_NS;
            let sample = GazeSample { directions, time_ns, uncertainty_ns: 0, valid: true };
            tracker.push_at(black_box(&sample), time_ns + 50_000_000);
            black_box(tracker.state(time_ns + 55_000_000))
        });
    });
    group.finish();
}
