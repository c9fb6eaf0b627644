//! Recognition and laying in steady frames: nothing on the heap.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

#[path = "../compose/allocations.rs"]
mod allocations;

use ash::vk;
use parafovea::pass_detection::{
    Event, Eye, ImageDescription, ImageKey, Pass, PassFacts, Recognition, Shown, ShownView, SwapchainKey,
    Target, Transfer, TransferKind,
};
use parafovea::rate_map::{DeviceRates, EyeMap, RateImage, Scratch, resolve};
use parafovea_core::rate::VULKAN_RATES;
use smallvec::{SmallVec, smallvec};

const EYE: [u32; 2] = [2160, 2160];

fn describe(image: ImageKey) -> Option<ImageDescription> {
    Some(ImageDescription {
        key: image,
        extent: EYE,
        layers: 1,
        format: vk::Format::R8G8B8A8_SRGB,
        samples: 1,
        is_cube: false,
        swapchain: (image.0 < 3).then_some(SwapchainKey(1)),
    })
}

fn target(image: u64) -> Target {
    Target { image: ImageKey(image), level: 0, base_layer: 0, layers: 1 }
}

fn pass(image: u64) -> Event {
    Event::Pass(Pass {
        colors: smallvec![target(image)],
        resolves: SmallVec::new(),
        depth: None,
        area: [0, 0, EYE[0], EYE[1]],
        region: [0, 0, EYE[0], EYE[1]],
        view_mask: 0,
        facts: PassFacts::default(),
        unmasked: None,
        draws: None,
    })
}

/// Image 10 is the scene; four more images are created in each frame. One of a ring of swapchain images shows the scene.
fn record(frame: u64, log: &mut Vec<Event>) -> Shown {
    let swapchain_image = frame % 3;
    log.clear();
    log.extend([10, 11, swapchain_image].map(pass));
    log.extend((0..4).map(|index| pass(100 + frame * 4 + index)));
    let rect = [0, 0, EYE[0] as i32, EYE[1] as i32];
    for from in [10, 100 + frame * 4] {
        log.push(Event::Transfer(Transfer {
            kind: TransferKind::Copy,
            from: target(from),
            from_rect: rect,
            to: target(swapchain_image),
            to_rect: rect,
        }));
    }
    let view = ShownView {
        eye: Some(Eye::Left),
        swapchain: SwapchainKey(1),
        image: Some(ImageKey(swapchain_image)),
        layer: 0,
        rect: [0, 0, EYE[0], EYE[1]],
        is_upside_down: false,
    };
    Shown { views: smallvec![view], ..Shown::default() }
}

#[test]
fn a_steady_frame_does_not_allocate() {
    let mut recognition = Recognition::default();
    let mut log = Vec::new();
    let mut map = EyeMap::default();
    let rates = DeviceRates::new(VULKAN_RATES.into_iter());
    let mut scratch = Scratch::default();
    let mut out = vec![0; 68 * 68];
    let mut matched = 0;
    let mut frame = |frame: u64| {
        let shown = record(frame, &mut log);
        for (earlier, event) in log.iter().enumerate() {
            if let Event::Pass(pass) = event
                && let Ok(found) = recognition.of(pass, &log[..earlier], describe)
            {
                let tiles = [EYE[0].div_ceil(16), EYE[1].div_ceil(16)];
                map.set(EYE, [16, 16], tiles, &[10; 135 * 135]);
                let image = RateImage { area: pass.area, texel: [32, 32], tiles: [68, 68], layers: 1 };
                resolve([&map, &map], &found.parts, &image, &rates, &mut scratch, &mut out);
                matched += 1;
            }
        }
        recognition.frame(&log, describe, &shown);
        recognition.log_new_verdicts(|_, _| {});
    };
    // Longer than images are remembered that no longer occur.
    (0..300).for_each(&mut frame);
    assert_eq!(allocations::count(|| (300..900).for_each(&mut frame)), 0);
    assert!(matched > 900 * 2);
}
