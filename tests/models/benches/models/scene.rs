//! Cost of recognition, and of laying the plan over the pictures of passes: two eyes of 2160 x 2160 with tiles of 16 x 16.

use ash::vk;
use criterion::Criterion;
use parafovea::pass_detection::{
    Event, Eye, Eyes, ImageDescription, ImageKey, Orientation, Part, Pass, PassFacts, Recognition, Shown,
    ShownView, SwapchainKey, Target,
};
use parafovea::rate_map::{DeviceRates, EyeMap, RateImage, Scratch, resolve};
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use std::hint::black_box;

/// Pixels along each side of a view.
const SIDE: u32 = 2160;

/// Passes of a frame.
const PASSES: u64 = 50;

pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("scene");
    let [left, right] = [0, 1].map(eye_map);
    let rates = DeviceRates::new(VULKAN_RATES.into_iter());
    let upright = |eyes| part(eyes, Orientation::Upright);
    let unknown = part(Eyes::Finer, Orientation::Unknown);
    for (name, parts, side) in [
        ("resolve both eyes as planned", [upright(Eyes::Left), upright(Eyes::Right)], SIDE),
        (
            "resolve both eyes at 0.67 of the size",
            [upright(Eyes::Left), upright(Eyes::Right)],
            SIDE * 67 / 100,
        ),
        (
            "resolve the finer of both eyes and ways up at 0.67 of the size, twice",
            [unknown; 2],
            SIDE * 67 / 100,
        ),
    ] {
        let tiles = [side.div_ceil(16); 2];
        let image = RateImage { area: [0, 0, side, side], texel: [16, 16], tiles, layers: 1 };
        let mut out = vec![0; image.len()];
        let mut scratch = Scratch::default();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for part in &parts {
                    resolve(
                        [&left, &right],
                        std::slice::from_ref(part),
                        &image,
                        &rates,
                        &mut scratch,
                        &mut out,
                    );
                }
                black_box(&out);
            });
        });
    }
    let events: Vec<Event> = (0..PASSES).map(|pass| Event::Pass(pass_to(pass))).collect();
    let shown = shown();
    let mut recognition = Recognition::default();
    group.bench_function("learn from a frame of 50 passes", |bencher| {
        bencher.iter(|| recognition.frame(&events, describe, &shown));
    });
    group.bench_function("recognise 50 passes", |bencher| {
        bencher.iter(|| {
            for event in &events {
                if let Event::Pass(pass) = event {
                    black_box(recognition.of(pass, &[], describe)).ok();
                }
            }
        });
    });
    group.finish();
}

fn part(eyes: Eyes, orientation: Orientation) -> Part {
    Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation }
}

/// Rings around a point near the middle.
fn eye_map(eye: u32) -> EyeMap {
    let tiles = SIDE.div_ceil(16);
    let rate = |x: u32, y: u32| {
        let distance = x.abs_diff(60 + 10 * eye).max(y.abs_diff(tiles / 2));
        match distance {
            0..20 => ShadingRate::R1X1,
            20..40 => ShadingRate::R2X2,
            _ => ShadingRate::R4X4,
        }
    };
    let places = (0..tiles).flat_map(|y| (0..tiles).map(move |x| (x, y)));
    let texels: Vec<u8> = places.map(|(x, y)| rate(x, y).texel()).collect();
    let mut map = EyeMap::default();
    map.set([SIDE; 2], [16; 2], [tiles; 2], &texels);
    map
}

/// Images 0 and 1 belong to a swapchain for each eye.
fn describe(image: ImageKey) -> Option<ImageDescription> {
    Some(ImageDescription {
        key: image,
        extent: [SIDE; 2],
        layers: 1,
        format: vk::Format::R16G16B16A16_SFLOAT,
        samples: 1,
        is_cube: false,
        swapchain: (image.0 < 2).then_some(SwapchainKey(image.0)),
    })
}

/// Every image twice, the swapchains' last.
fn pass_to(pass: u64) -> Pass {
    let image = ImageKey((PASSES - 1 - pass) / 2);
    Pass {
        colors: [Target { image, level: 0, base_layer: 0, layers: 1 }].into_iter().collect(),
        resolves: Default::default(),
        depth: None,
        area: [0, 0, SIDE, SIDE],
        region: [0, 0, SIDE, SIDE],
        view_mask: 0,
        facts: PassFacts::default(),
        unmasked: None,
        draws: None,
    }
}

fn shown() -> Shown {
    let view = |(key, eye)| ShownView {
        eye: Some(eye),
        swapchain: SwapchainKey(key),
        image: Some(ImageKey(key)),
        layer: 0,
        rect: [0, 0, SIDE, SIDE],
        is_upside_down: false,
    };
    Shown { views: [(0, Eye::Left), (1, Eye::Right)].map(view).into_iter().collect(), ..Shown::default() }
}
