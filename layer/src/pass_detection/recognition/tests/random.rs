//! Any stream of events.

use super::application::*;
use crate::pass_detection::*;
use ash::vk;
use proptest::prelude::*;

const FORMATS: [vk::Format; 4] = [LDR, HDR, vk::Format::R32_UINT, vk::Format::D32_SFLOAT];

/// Images of every kind: the last six belong to two swapchains; the second one is flat.
pub fn any_images() -> impl Strategy<Value = Vec<ImageDescription>> {
    let sides = prop::sample::select(vec![0, 1, 100, 200, 240, 400, u32::MAX]);
    let image = (sides.clone(), sides, 0..4usize, 0..7u32, 0..8u32).prop_map(
        |(width, height, format, layers, kind)| ImageDescription {
            layers,
            is_cube: kind == 0,
            samples: if kind == 1 { 4 } else { 1 },
            ..description(ImageKey(0), [width, height], FORMATS[format])
        },
    );
    prop::collection::vec(image, 12).prop_map(|mut images| {
        for (index, image) in images.iter_mut().enumerate() {
            image.key = ImageKey(index as u64);
            image.swapchain = (index >= 6).then_some(SwapchainKey(index as u64 / 9));
        }
        images
    })
}

fn any_target() -> impl Strategy<Value = Target> {
    // One image is never described.
    (
        0..13u64,
        prop_oneof![6 => Just(0u32), 1 => 1..3u32],
        0..3u32,
        prop_oneof![5 => 0..4u32, 1 => any::<u32>()],
    )
        .prop_map(|(image, level, base_layer, layers)| Target {
            image: ImageKey(image),
            level,
            base_layer,
            layers,
        })
}

fn any_reads() -> impl Strategy<Value = Reads> {
    (prop::collection::vec(0..13u64, 0..4), prop::bool::weighted(0.2)).prop_map(|(images, may_read_more)| {
        let mut reads = Reads { may_read_more, ..Reads::default() };
        images.into_iter().for_each(|image| reads.push(ImageKey(image)));
        reads
    })
}

fn any_draws() -> impl Strategy<Value = Option<Draws>> {
    let vertices = prop::sample::select(vec![3, 6, 3000, 1 << 20]);
    let draws = (0..3u32, 0..8u32, vertices, any_reads(), any_reads()).prop_map(
        |(quads, meshes, vertices, read_by_quads, read_by_meshes)| Draws {
            quads,
            meshes,
            vertices,
            read_by_quads,
            read_by_meshes,
        },
    );
    prop::option::weighted(0.7, draws)
}

fn any_pass() -> impl Strategy<Value = Pass> {
    let area = prop_oneof![
        4 => Just([0, 0, 200, 240]),
        2 => Just([0, 0, 400, 240]),
        1 => Just([0, 0, 68, 80]),
        1 => prop::array::uniform4(any::<u32>()),
        1 => prop::array::uniform4(0..300u32),
    ];
    let mask = prop_oneof![3 => Just(0), 1 => Just(3), 1 => any::<u32>()];
    (
        prop::collection::vec(any_target(), 0..3),
        prop::collection::vec(any_target(), 0..2),
        prop::option::of(any_target()),
        area,
        mask,
        any::<bool>(),
        any_draws(),
    )
        .prop_map(|(colors, resolves, depth, area, view_mask, clears_depth, draws)| Pass {
            colors: colors.into(),
            resolves: resolves.into(),
            depth,
            area,
            region: area,
            view_mask,
            facts: PassFacts { clears_depth, ..PassFacts::default() },
            unmasked: None,
            draws,
        })
}

fn any_rect() -> impl Strategy<Value = [i32; 4]> {
    prop_oneof![
        3 => Just([0, 0, 200, 240]),
        1 => Just([0, 240, 200, -240]),
        1 => prop::array::uniform4(any::<i32>()),
    ]
}

pub fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        any_pass().prop_map(Event::Pass),
        (any_target(), any_rect(), any_target(), any_rect()).prop_map(|(from, from_rect, to, to_rect)| {
            Event::Transfer(Transfer { kind: TransferKind::Blit, from, from_rect, to, to_rect })
        }),
    ]
}

pub fn any_shown() -> impl Strategy<Value = Shown> {
    let eye = prop_oneof![Just(Some(Eye::Left)), Just(Some(Eye::Right)), Just(None)];
    let rect = prop_oneof![
        4 => Just([0, 0, 200, 240]),
        1 => Just([200, 0, 200, 240]),
        1 => prop::array::uniform4(any::<u32>()),
    ];
    let view = (eye, 0..2u64, prop::option::of(0..13u64), 0..3u32, rect, any::<bool>()).prop_map(
        |(eye, swapchain, image, layer, rect, is_upside_down)| ShownView {
            eye,
            swapchain: SwapchainKey(swapchain),
            image: image.map(ImageKey),
            layer,
            rect,
            is_upside_down,
        },
    );
    prop::collection::vec(view, 0..5).prop_map(|views| Shown {
        views: views.into(),
        flat: [SwapchainKey(1)].into_iter().collect(),
        ..Shown::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Nothing makes it panic, and kinds of passes that may never be the scene never are.
    #[test]
    fn never_the_wrong_kind(
        images in any_images(),
        frames in prop::collection::vec((prop::collection::vec(any_event(), 0..10), any_shown()), 1..7),
        passes in prop::collection::vec(any_pass(), 1..8),
    ) {
        let describe = |image: ImageKey| images.get(image.0 as usize).copied();
        let mut recognition = Recognition::default();
        for (events, shown) in &frames {
            recognition.frame(events, describe, shown);
            let occurring = events.iter().filter_map(|event| match event {
                Event::Pass(pass) => Some(pass),
                Event::Transfer(_) => None,
            });
            for pass in occurring.chain(&passes) {
                let Ok(found) = recognition.of(pass, events, describe) else { continue };
                prop_assert!(!pass.colors.is_empty());
                prop_assert!(!found.parts.is_empty() && found.how != How::Profile);
                for target in pass.colors.iter().chain(&pass.resolves) {
                    let image = describe(target.image).unwrap();
                    prop_assert!(!image.is_cube && target.level == 0);
                    prop_assert!(image.swapchain != Some(SwapchainKey(1)));
                }
                for part in &found.parts {
                    prop_assert!(part.rect.iter().all(|side| side.is_finite()));
                    prop_assert!(pass.colors.iter().chain(&pass.resolves).any(|target| part.layer < target.layers)
                        || pass.view_mask != 0);
                }
                // An image that becomes flat by a transfer of the last frame is none either.
                for event in events {
                    let Event::Transfer(transfer) = event else { continue };
                    let becomes_flat = describe(transfer.to.image).is_some_and(|to| to.swapchain == Some(SwapchainKey(1)));
                    let is_own = describe(transfer.from.image).is_none_or(|from| from.swapchain.is_none());
                    if becomes_flat && is_own {
                        prop_assert!(pass.colors.iter().all(|target| target.image != transfer.from.image));
                    }
                }
            }
        }
    }
}
