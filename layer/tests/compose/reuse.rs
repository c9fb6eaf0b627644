//! Pictures that are completed from earlier ones, compared with the reference.

use crate::FORMATS;
use crate::free::BlockedSubmit;
use crate::pictures::{FOV, picture, pixel_format, region};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use crate::{allocations, is_untouched};
use ash::vk;
use glam::{Quat, Vec3};
use parafovea::gpu::GpuError;
use parafovea::kernels::compose::{
    Compose, ComposeJob, ComposeParams, ComposeRegion, EarlierImage, Parameters, ReuseRegion,
};
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::geometry::View;
use parafovea_core::kernels::compose::{EarlierPixels, PixelFormat, reuse_image};
use parafovea_core::reuse::{MAX_AGES, Picture, Reuse, STALE, StaleTiles, TileLists};

/// Number of the application's images: one more than there are ages here.
pub const IMAGES: u32 = 4;

/// Of tiles that are older, parts are taken from newer pictures.
const OLDEST: usize = 1;

/// A picture with its pixels and stale tiles.
pub struct Frame {
    pub view: View,
    pub extent: [u32; 2],
    stale: StaleTiles,
    pub pixels: Vec<u8>,
}

impl Frame {
    fn new(extent: [u32; 2], texel: u32, number: u32, yaw_deg: f32) -> Self {
        let [columns, rows] = extent.map(|side| side.div_ceil(texel));
        let map: Vec<u8> = (0..columns * rows)
            .map(|tile| {
                let (column, row) = (tile % columns, tile / columns);
                // Now most are stale, before fewer.
                let is_stale = (column * 5 + row * 3 + column * row * number) % 7 < 5 - number;
                if is_stale { STALE } else { 0 }
            })
            .collect();
        let mut stale = StaleTiles::default();
        stale.set(extent, [texel; 2], &map);
        let orientation =
            Quat::from_rotation_y(yaw_deg.to_radians()) * Quat::from_rotation_x(0.3 * yaw_deg.to_radians());
        let view = View { orientation, plane: FOV.tangents().plane(extent) };
        Self { view, extent, stale, pixels: picture(extent[0], extent[1], 10 * number) }
    }

    fn picture(&self) -> Picture<'_> {
        Picture { view: self.view, extent: self.extent, stale: &self.stale, viewpoint: None }
    }
}

/// The newest frame and three before it, at this speed of the head, degrees a frame.
pub fn frames(extent: [u32; 2], texel: u32, speed: f32) -> Vec<Frame> {
    (0..IMAGES).map(|age| Frame::new(extent, texel, age, speed * age as f32)).collect()
}

pub fn reuse(frames: &[Frame], turns: bool) -> Reuse<'_> {
    Reuse::new(frames[0].picture(), frames[1..].iter().map(Frame::picture), turns)
}

/// Frame `age` is in image `age`.
fn whole(frames: &[Frame]) -> vk::Rect2D {
    let [width, height] = frames[0].extent;
    vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } }
}

pub fn reuse_region<'a>(
    frames: &'a [Frame],
    lists: &'a TileLists,
    turns: bool,
    border: f32,
) -> ReuseRegion<'a> {
    let earlier =
        std::array::from_fn(|index| EarlierImage { app_index: index as u32 + 1, ..EarlierImage::default() });
    ReuseRegion {
        array_layer: 0,
        rect: whole(frames),
        reuse: reuse(frames, turns),
        lists,
        earlier,
        border,
        depth: None,
        earlier_depth: [None; MAX_AGES],
    }
}

/// The device's picture of the frames.
fn completed(
    vulkan: &Vulkan,
    swapchain: &Swapchain,
    frames: &[Frame],
    (regions, turns, border): (&[ComposeRegion], bool, f32),
) -> Vec<u8> {
    for (index, frame) in (0..).zip(frames) {
        swapchain.render(vulkan, index, std::slice::from_ref(&frame.pixels));
    }
    let mut lists = TileLists::default();
    lists.update(&reuse(frames, turns), border, OLDEST);
    let region = [reuse_region(frames, &lists, turns, border)];
    let [picture, same] = [Parameters::OfVertices, Parameters::OfPixels].map(|parameters| {
        let mut compose = Compose::with_parameters(vulkan.gpu.clone(), parameters).unwrap();
        compose.submit(&[ComposeJob { reuse: &region, ..swapchain.job(0, regions) }]).unwrap();
        swapchain.shown(vulkan, 1, 1, 4).swap_remove(0)
    });
    assert!(picture == same, "both shaders draw the same");
    picture
}

pub fn reference(
    frames: &[Frame],
    format: PixelFormat,
    (regions, turns, border): (&[ComposeRegion], bool, f32),
) -> Vec<u8> {
    let width = frames[0].extent[0];
    let mut pixels = frames[0].pixels.clone();
    let earlier: Vec<_> = frames[1..]
        .iter()
        .map(|frame| EarlierPixels { pixels: &frame.pixels, width, offset: [0; 2], depth: None })
        .collect();
    let neutral = ComposeParams::neutral([0; 2], frames[0].extent);
    let params = regions.first().map_or(neutral, |region| region.params);
    let reuse = reuse(frames, turns);
    let mut lists = TileLists::default();
    lists.update(&reuse, border, OLDEST);
    reuse_image(&mut pixels, width, format, &params, (&reuse, &lists, border), (None, &earlier));
    pixels
}

#[test]
fn earlier_pictures_match_the_reference() {
    let vulkan = Vulkan::new();
    let extent = [150, 93];
    for format in FORMATS {
        let swapchain = Swapchain::with_images(&vulkan, &shape(format, extent[0], extent[1], 1), IMAGES);
        let chroma = [region(0, [0, 0, 150, 93], Vec3::NEG_Z, format, &ChromaSettings::default())];
        for (speed, turns, border, regions) in [
            (0.0, true, 0.0, &[][..]),
            (0.0, true, 4.0, &chroma[..]),
            (1.7, true, 0.0, &[]),
            (1.7, true, 4.0, &[]),
            (-3.1, true, 4.0, &chroma),
            (1.7, false, 0.0, &chroma),
            (40.0, true, 4.0, &chroma),
        ] {
            let frames = frames(extent, 16, speed);
            let how = (regions, turns, border);
            let result = completed(&vulkan, &swapchain, &frames, how);
            let expected = reference(&frames, pixel_format(format), how);
            let mut others = 0;
            for (index, (expected, result)) in expected.chunks(4).zip(result.chunks(4)).enumerate() {
                // Blending rounds once more.
                let is_near = expected
                    .iter()
                    .zip(result)
                    .all(|(a, b)| a.abs_diff(*b) <= if border > 0.0 { 2 } else { 1 });
                let at = (index as u32 % extent[0], index as u32 / extent[0]);
                assert!(
                    is_near || speed != 0.0,
                    "{format:?} {speed} {border}: {result:?} instead of {expected:?} at {at:?}"
                );
                others += usize::from(!is_near);
            }
            // Pixels that lie on the edge of a tile to the last bit are taken from either side.
            assert!(others <= 20, "{others} of {format:?} {speed} {border}");
            assert_ne!(result, frames[0].pixels, "nothing was done");
        }
    }
    vulkan.assert_valid();
}

/// Whole pictures that were stale in every tile for all frames but the last: the result is that one.
#[test]
fn a_still_view_gives_an_identical_picture() {
    let vulkan = Vulkan::new();
    let extent = [64, 48];
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 48, 1), IMAGES);
    let mut frames = frames(extent, 8, 0.0);
    for frame in &mut frames[..3] {
        frame.stale.set(extent, [8; 2], &[STALE; 48]);
    }
    frames[3].stale.clear();
    for border in [0.0, 4.0] {
        let result = completed(&vulkan, &swapchain, &frames, (&[], true, border));
        assert!(result == frames[3].pixels);
    }
    vulkan.assert_valid();
}

/// An application that draws on another queue waits for all that read an image.
#[test]
fn images_of_earlier_pictures_are_in_use_too() {
    let vulkan = Vulkan::new();
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 48, 1), IMAGES + 1);
    let frames = frames([64, 48], 8, 0.0);
    for (index, frame) in (0..).zip(&frames) {
        swapchain.render(&vulkan, index, std::slice::from_ref(&frame.pixels));
    }
    let mut lists = TileLists::default();
    lists.update(&reuse(&frames, true), 4.0, OLDEST);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let blocked = BlockedSubmit::new(&vulkan);
    let region = [reuse_region(&frames, &lists, true, 4.0)];
    compose.submit(&[ComposeJob { reuse: &region, ..swapchain.job(0, &[]) }]).unwrap();
    assert_eq!([0, 1, 2, 3, 4].map(|image| swapchain.app.is_free(image)), [false, false, false, false, true]);
    blocked.release();
    assert!((0..IMAGES).all(|image| swapchain.app.is_free(image)));
    vulkan.assert_valid();
}

/// A region that is completed on the right half of the second layer leaves everything else alone.
#[test]
fn only_the_region_changes() {
    let vulkan = Vulkan::new();
    let (format, width, height) = (vk::Format::R8G8B8A8_UNORM, 128u32, 48u32);
    let swapchain = Swapchain::with_images(&vulkan, &shape(format, width, height, 2), IMAGES);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let frames = frames([64, 48], 16, 0.5);
    let images: Vec<_> =
        (0..IMAGES).map(|image| [picture(width, height, image), picture(width, height, image + 9)]).collect();
    for (index, layers) in (0..).zip(&images) {
        swapchain.render(&vulkan, index, layers);
    }
    let mut lists = TileLists::default();
    lists.update(&reuse(&frames, true), 4.0, OLDEST);
    let offset = [64, 0];
    let earlier =
        std::array::from_fn(|index| EarlierImage { app_index: index as u32 + 1, array_layer: 1, offset });
    let rect =
        vk::Rect2D { offset: vk::Offset2D { x: 64, y: 0 }, extent: vk::Extent2D { width: 64, height: 48 } };
    let region = ReuseRegion { array_layer: 1, rect, earlier, ..reuse_region(&frames, &lists, true, 4.0) };
    compose.submit(&[ComposeJob { reuse: &[region], ..swapchain.job(0, &[]) }]).unwrap();
    let shown = swapchain.shown(&vulkan, 1, 2, 4);
    assert!(shown[0] == images[0][0], "the other layer");
    let mut expected = images[0][1].clone();
    let before: Vec<_> = images[1..]
        .iter()
        .map(|image| EarlierPixels { pixels: &image[1], width, offset, depth: None })
        .collect();
    let params = ComposeParams::neutral(offset, [64, 48]);
    let how = (&reuse(&frames, true), &lists, 4.0);
    reuse_image(&mut expected, width, pixel_format(format), &params, how, (None, &before));
    let others = expected.iter().zip(&shown[1]).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(others <= 40, "{others}");
    for (index, texel) in shown[1].chunks(4).enumerate().filter(|(index, _)| index % 128 < 64) {
        assert_eq!(texel, &images[0][1][index * 4..][..4], "texel {index}");
    }
    vulkan.assert_valid();
}

#[test]
fn steady_frames_with_earlier_pictures_do_not_allocate() {
    let vulkan = Vulkan::new();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::with_images(&vulkan, &shape(format, 96, 96, 1), IMAGES);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let frames = frames([96, 96], 16, 1.0);
    let chroma = [region(0, [0, 0, 96, 96], Vec3::NEG_Z, format, &ChromaSettings::default())];
    assert!(!is_untouched(0, 96, 0, &chroma));
    let mut lists = TileLists::default();
    let mut frame = |index: u32| {
        lists.update(&reuse(&frames, true), 4.0, OLDEST);
        let mut region = [reuse_region(&frames, &lists, true, 4.0)];
        region[0].earlier = earlier_than(index);
        compose.submit(&[ComposeJob { reuse: &region, ..swapchain.job(index, &chroma) }]).unwrap();
    };
    // Until each pair of images was in each slot.
    (0..12).for_each(|number| frame(number % IMAGES));
    let allocations = allocations::count(|| (12..30).for_each(|number| frame(number % IMAGES)));
    assert_eq!(allocations, 0);
    vulkan.assert_valid();
}

/// So many frames as an application has them: its images in turn, each completed from those before it.
pub fn in_turn(vulkan: &Vulkan, compose: &mut Compose, count: u32) {
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::with_images(vulkan, &shape(format, 64, 64, 1), IMAGES);
    let frames = frames([64, 64], 16, 1.0);
    let mut lists = TileLists::default();
    lists.update(&reuse(&frames, true), 4.0, OLDEST);
    for number in 0..count {
        let index = number % IMAGES;
        swapchain.render(vulkan, index, &[picture(64, 64, number)]);
        let mut region = [reuse_region(&frames, &lists, true, 4.0)];
        region[0].earlier = earlier_than(index);
        compose.submit(&[ComposeJob { reuse: &region, ..swapchain.job(index, &[]) }]).unwrap();
    }
    swapchain.shown(vulkan, 0, 1, 4);
}

/// Locations of the pictures before that of image `index`.
pub fn earlier_than(index: u32) -> [EarlierImage; MAX_AGES] {
    std::array::from_fn(|age| EarlierImage {
        app_index: (index + IMAGES - 1 - (age % 3) as u32) % IMAGES,
        ..EarlierImage::default()
    })
}

#[test]
fn earlier_pictures_that_are_not_there_are_refused() {
    let vulkan = Vulkan::new();
    let swapchain = Swapchain::with_images(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 48, 1), IMAGES);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let frames = frames([64, 48], 16, 0.0);
    let mut lists = TileLists::default();
    lists.update(&reuse(&frames, true), 4.0, OLDEST);
    let good = reuse_region(&frames, &lists, true, 4.0);
    let with = |image: EarlierImage| {
        let mut region = good;
        region.earlier = [image; MAX_AGES];
        region
    };
    let there = EarlierImage { app_index: 1, ..EarlierImage::default() };
    let mut outside = good;
    outside.rect.offset.x = 1;
    for (what, region) in [
        ("the newest image", with(EarlierImage { app_index: 0, ..there })),
        ("an index out of range", with(EarlierImage { app_index: IMAGES, ..there })),
        ("a layer out of range", with(EarlierImage { array_layer: 1, ..there })),
        ("a rectangle beyond the image", with(EarlierImage { offset: [0, 1], ..there })),
        ("a region beyond the image", outside),
        ("another layer", ReuseRegion { array_layer: 1, ..good }),
    ] {
        let regions = [region];
        let result = compose.submit(&[ComposeJob { reuse: &regions, ..swapchain.job(0, &[]) }]);
        assert!(matches!(result, Err(GpuError::Invalid(_))), "{what}: {result:?}");
    }
    compose.submit(&[ComposeJob { reuse: &[good], ..swapchain.job(0, &[]) }]).unwrap();
    vulkan.assert_valid();
}
