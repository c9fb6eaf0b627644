//! Cost of `perception`.

use criterion::{Criterion, Throughput};
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{Aggregation, Buffers, ContrastSettings, analyze, tiles};
use parafovea_core::perception::csf::{Stimulus, VisualField, castle, tursun};
use parafovea_core::perception::{BandFrequencies, ContrastMap};
use std::hint::black_box;

pub fn benches(criterion: &mut Criterion) {
    sensitivity(criterion);
    contrast(criterion);
}

fn sensitivity(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("csf");
    let stimulus = Stimulus { eccentricity_deg: 12.0, ..Stimulus::default() };
    group.bench_function("castle achromatic", |b| {
        b.iter(|| castle::achromatic(black_box(&stimulus), VisualField::Worst));
    });
    group.bench_function("castle red-green", |b| {
        b.iter(|| castle::red_green(black_box(&stimulus), VisualField::Worst));
    });
    group.bench_function("tursun", |b| b.iter(|| tursun::sensitivity(black_box(6.0), 12.0, 80.0)));
    let falls = BandFrequencies::Response
        .cpd(20.0)
        .map(|frequency_cpd| castle::achromatic_fall(&Stimulus { frequency_cpd, ..stimulus }));
    group.bench_function("tile of 4 bands by prepared fall", |b| {
        b.iter(|| black_box(&falls).map(|fall| fall.at(black_box(12.0), VisualField::Worst)));
    });
    let table = castle::FovealTable::new(0.0, 0.6);
    group.bench_function("tile of 4 bands by table", |b| {
        b.iter(|| {
            table
                .falls(black_box(5.0), black_box(40.0))
                .map(|fall| fall.at(black_box(12.0), VisualField::Worst))
        });
    });
    group.finish();
}

fn contrast(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("analyze");
    let picture = Plane::from_fn(1024, 1024, |x, y| {
        (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) as f32 / 4.3e7
    });
    let (mut buffers, mut map) = (Buffers::default(), ContrastMap::default());
    group.throughput(Throughput::Elements(1024 * 1024));
    for aggregation in [Aggregation::Peak, Aggregation::Mean] {
        let settings = ContrastSettings { aggregation, ..ContrastSettings::default() };
        group.bench_function(format!("1024x1024 {aggregation:?}"), |b| {
            b.iter(|| analyze(black_box(&picture), &settings, &mut buffers, &mut map));
        });
    }
    group
        .bench_function("1024x1024 pyramid alone", |b| b.iter(|| buffers.pyramid.build(black_box(&picture))));
    group.bench_function("1024x1024 tiles alone", |b| {
        b.iter(|| tiles(black_box(&picture), &ContrastSettings::default(), &mut buffers, &mut map));
    });
    group.finish();
}
