//! Cost of `avpm` and `frco`.

use criterion::{Criterion, Throughput};
use parafovea_core::avpm::BudgetSettings;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::frco::{Block, by_half_octaves, half_octaves_within, visual_loss};
use parafovea_core::perception::BANDS;
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use std::hint::black_box;
use std::time::Duration;

/// Tiles of two eyes of 2160 x 2160.
const TILES: usize = 36_450;

pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("avpm");
    group.sample_size(20).measurement_time(Duration::from_secs(1)).warm_up_time(Duration::from_millis(300));

    group.bench_function("budget", |bencher| {
        let settings = BudgetSettings::default();
        bencher.iter(|| settings.budget(black_box(12.0), black_box(1.5), black_box(false)));
    });
    group.finish();

    let mut group = criterion.benchmark_group("frco");
    group.sample_size(20).measurement_time(Duration::from_secs(1)).warm_up_time(Duration::from_millis(300));
    group.throughput(Throughput::Elements(TILES as u64));
    let bands = tiles();
    group.bench_function("rates, 36450 tiles", |bencher| {
        let mut out = vec![ShadingRate::R1X1; TILES];
        bencher.iter(|| {
            let rates = by_half_octaves(black_box(&VULKAN_RATES));
            for (out, bands) in out.iter_mut().zip(black_box(&bands)) {
                *out = rates[usize::from(half_octaves_within(*bands, 0.5))];
            }
            black_box(&mut out);
        });
    });
    group.bench_function("visual loss, 36450 tiles", |bencher| {
        bencher.iter(|| {
            let block = |bands: &[f32; BANDS]| Block {
                band_sensitivity: *bands,
                rate: ShadingRate::R2X2,
                pixels: 256,
            };
            visual_loss(black_box(&bands).iter().map(block))
        });
    });
    let eccentricities: Vec<f32> = (0..TILES).map(|i| i as f32 * (70.0 / TILES as f32)).collect();
    group.bench_function("fixed foveation, 36450 tiles", |bencher| {
        bencher.iter(|| FixedFoveation::L1_C1.mean_shading_rate(black_box(&eccentricities), &VULKAN_RATES));
    });
    group.finish();
}

/// Sensitivities whose loss is spread around the budget, without a pattern that a branch could learn.
fn tiles() -> Vec<[f32; BANDS]> {
    let noise =
        |i: usize, band: usize| ((i * 4 + band) as u32).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32;
    (0..TILES).map(|i| std::array::from_fn(|band| noise(i, band))).collect()
}
