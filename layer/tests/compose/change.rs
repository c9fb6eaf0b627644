//! Tiles that are compared with earlier pictures, against the reference.

use crate::moved::{DRAWN, DepthSwapchain};
use crate::pictures::{picture, pixel_format};
use crate::reuse::{Frame, IMAGES, earlier_than, frames, reuse};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use crate::{FORMATS, allocations};
use ash::vk;
use glam::{Quat, Vec2, Vec3};
use parafovea::gpu::GpuError;
use parafovea::kernels::change::ChangeRegion;
use parafovea::kernels::compose::{Compose, ComposeJob, EarlierImage};
use parafovea_core::geometry::View;
use parafovea_core::kernels::change::ChangeParams;
use parafovea_core::kernels::compose::PixelFormat;
use parafovea_core::reuse::{ComparedTiles, MAX_AGES};

/// Tiles are compared with pictures of at most this age.
const OLDEST: usize = 3;

/// One set of changes: the given view, the tiles, and the change of each.
type Found = (View, Vec<u32>, Vec<f32>);

pub fn region<'a>(frames: &'a [Frame], tiles: &'a ComparedTiles) -> ChangeRegion<'a> {
    let earlier =
        std::array::from_fn(|index| EarlierImage { app_index: index as u32 + 1, ..EarlierImage::default() });
    ChangeRegion {
        array_layer: 0,
        offset: [0; 2],
        reuse: reuse(frames, true),
        tiles,
        earlier,
        view: View { orientation: Quat::from_rotation_y(0.4), plane: frames[0].view.plane },
        depth: None,
    }
}

pub fn compared(frames: &[Frame]) -> ComparedTiles {
    let mut tiles = ComparedTiles::default();
    tiles.update(&reuse(frames, true), OLDEST, |_| true);
    tiles
}

fn findings(compose: &mut Compose) -> Vec<Found> {
    let mut all = Vec::new();
    compose.changes(|view, tiles, changes| all.push((*view, tiles.to_vec(), changes.to_vec())));
    all
}

/// Linearly interpolating sampler of a texture with these pixels.
pub fn sampler(pixels: &[u8], extent: [u32; 2], format: PixelFormat) -> impl Fn(Vec2) -> Vec3 {
    let size = Vec2::new(extent[0] as f32, extent[1] as f32);
    move |at| {
        let point = at * size - 0.5;
        let (base, share) = (point.floor(), point - point.floor());
        let texel = |right: f32, down: f32| {
            let at = (base + Vec2::new(right, down)).clamp(Vec2::ZERO, size - 1.0).as_uvec2();
            let index = ((at.y * extent[0] + at.x) * 4) as usize;
            format.decode(&pixels[index..index + 4])
        };
        let row = |down: f32| texel(0.0, down).lerp(texel(1.0, down), share.x);
        row(0.0).lerp(row(1.0), share.y)
    }
}

#[test]
fn changes_match_the_reference() {
    let vulkan = Vulkan::new();
    let (extent, mut count, mut greatest) = ([150, 93], 0, 0.0f32);
    for format in FORMATS {
        let swapchain = Swapchain::with_images(&vulkan, &shape(format, extent[0], extent[1], 1), IMAGES);
        for speed in [0.0, 0.8, -1.7] {
            let frames = frames(extent, 8, speed);
            for (index, frame) in (0..).zip(&frames) {
                swapchain.render(&vulkan, index, std::slice::from_ref(&frame.pixels));
            }
            let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
            let tiles = compared(&frames);
            let region = region(&frames, &tiles);
            let changes = [region];
            compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(0, &[]) }]).unwrap();
            swapchain.shown(&vulkan, 1, 1, 4);
            let found = findings(&mut compose);
            assert!(findings(&mut compose).is_empty(), "handed out twice");
            let [(view, words, found)] = &found[..] else { panic!("{} pictures", found.len()) };
            assert_eq!((*view, words.len()), (region.view, tiles.count()));
            assert!(!words.is_empty(), "at {speed}");
            count += words.len();
            let mut at = 0;
            for age in 1..=OLDEST {
                let params = ChangeParams::new(&region.reuse, age, [0; 2], [0; 2], extent).unwrap();
                let samplers =
                    [0, age].map(|frame| sampler(&frames[frame].pixels, extent, pixel_format(format)));
                for word in tiles.with_age(age) {
                    let tile = [word & 0xffff, word >> 16];
                    let expected = params.change(tile, &samplers[0], &samplers[1]);
                    let is_near = (found[at] - expected).abs() <= 0.01 + 0.02 * expected;
                    assert!(
                        is_near && words[at] == *word,
                        "{format:?} at {speed}: {} instead of {expected} in {tile:?}",
                        found[at]
                    );
                    at += 1;
                }
            }
            greatest = found.iter().copied().fold(greatest, f32::max);
        }
    }
    assert!(count > 200 && greatest > 0.1, "{count} tiles, changes of up to {greatest}");
    vulkan.assert_valid();
}

/// The same pictures in every image: nothing has changed, to the last bit.
#[test]
fn a_still_scene_has_not_changed() {
    let vulkan = Vulkan::new();
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 96, 96, 1), IMAGES);
    let frames = frames([96, 96], 16, 0.0);
    for index in 0..IMAGES {
        swapchain.render(&vulkan, index, &[picture(96, 96, 0)]);
    }
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let tiles = compared(&frames);
    let changes = [region(&frames, &tiles)];
    compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(0, &[]) }]).unwrap();
    swapchain.shown(&vulkan, 1, 1, 4);
    let found = findings(&mut compose);
    assert!(found.len() == 1 && !found[0].2.is_empty());
    assert!(found[0].2.iter().all(|change| *change == 0.0), "{found:?}");
    vulkan.assert_valid();
}

#[test]
fn steady_frames_that_are_compared_do_not_allocate() {
    let vulkan = Vulkan::new();
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 96, 96, 1), IMAGES);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let frames = frames([96, 96], 16, 0.0);
    let mut tiles = ComparedTiles::default();
    let mut seen = 0;
    let mut frame = |index: u32| {
        tiles.update(&reuse(&frames, true), OLDEST, |_| true);
        let changes = [ChangeRegion { earlier: earlier_than(index), ..region(&frames, &tiles) }];
        compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(index, &[]) }]).unwrap();
        compose.changes(|_, tiles, _| seen += tiles.len());
    };
    // Until each pair of images was in each slot.
    (0..12).for_each(|number| frame(number % IMAGES));
    let allocations = allocations::count(|| (12..30).for_each(|number| frame(number % IMAGES)));
    assert_eq!(allocations, 0);
    swapchain.shown(&vulkan, 1, 1, 4);
    assert!(seen > 0);
    vulkan.assert_valid();
}

/// A GPU that is behind whenever findings are taken, in an application with a depth swapchain for each eye.
#[test]
fn findings_are_kept_until_they_are_taken() {
    let vulkan = Vulkan::new();
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 96, 96, 1), IMAGES);
    let depth = [0, 1].map(|_| DepthSwapchain::new(&vulkan, [96, 96]));
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let frames = frames([96, 96], 16, 0.0);
    let tiles = compared(&frames);
    let changes = [region(&frames, &tiles)];
    let mut frame = || {
        compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(0, &[]) }]).unwrap();
        vulkan.idle();
        for depth in &depth {
            depth.source.copy(0, DRAWN).unwrap();
        }
        vulkan.idle();
    };
    (0..5).for_each(|_| frame());
    let found = findings(&mut compose);
    assert_eq!(found.len(), 5);
    assert!(found.iter().all(|each| *each == found[0] && each.1.len() == tiles.count()), "{found:?}");
    assert!(findings(&mut compose).is_empty(), "handed out twice");
    vulkan.assert_valid();
}

/// Findings do not add up if nobody takes them.
#[test]
fn findings_that_nobody_takes_are_dropped() {
    let vulkan = Vulkan::new();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    in_turn(&vulkan, &mut compose, 10);
    let allocations = allocations::count(|| compose.changes(|_, _, _| {}));
    assert_eq!(allocations, 0);
    in_turn(&vulkan, &mut compose, 100);
    let found = findings(&mut compose).len();
    assert!((4..=6).contains(&found), "{found}");
}

#[test]
fn pictures_that_are_not_there_are_not_compared() {
    let vulkan = Vulkan::new();
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 48, 1), IMAGES);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let frames = frames([64, 48], 16, 0.0);
    let tiles = compared(&frames);
    let there = EarlierImage { app_index: 1, ..EarlierImage::default() };
    for image in [EarlierImage { app_index: 0, ..there }, EarlierImage { array_layer: 1, ..there }] {
        let changes = [ChangeRegion { earlier: [image; MAX_AGES], ..region(&frames, &tiles) }];
        let result = compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(0, &[]) }]);
        assert!(matches!(result, Err(GpuError::Invalid(_))), "{image:?}: {result:?}");
    }
    assert!(findings(&mut compose).is_empty());
    vulkan.assert_valid();
}

/// So many frames as an application has them, each compared with those before it.
pub fn in_turn(vulkan: &Vulkan, compose: &mut Compose, count: u32) {
    let swapchain = Swapchain::with_images(vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 1), IMAGES);
    let frames = frames([64, 64], 16, 0.0);
    let tiles = compared(&frames);
    assert!(tiles.count() > 0);
    for number in 0..count {
        let index = number % IMAGES;
        swapchain.render(vulkan, index, &[picture(64, 64, number)]);
        let changes = [ChangeRegion { earlier: earlier_than(index), ..region(&frames, &tiles) }];
        compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(index, &[]) }]).unwrap();
    }
    swapchain.shown(vulkan, 0, 1, 4);
}
