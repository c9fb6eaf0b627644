//! Pictures that are completed from earlier ones seen from elsewhere, by depth, compared with the reference.

use crate::change::sampler;
use crate::pictures::{FOV, picture, pixel_format, region};
use crate::reuse::{IMAGES, earlier_than};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use glam::{Quat, Vec2, Vec3};
use parafovea::gpu::GpuError;
use parafovea::kernels::change::ChangeRegion;
use parafovea::kernels::compose::{
    Compose, ComposeJob, ComposeParams, ComposeRegion, DepthShape, DepthSource, EarlierImage, Parameters,
    PictureDepth, ReuseRegion,
};
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::geometry::{DepthRange, Nearness, View};
use parafovea_core::kernels::change::ChangeParams;
use parafovea_core::kernels::compose::{DepthPixels, DepthRect, EarlierPixels, PixelFormat, reuse_image};
use parafovea_core::reuse::{
    ComparedTiles, MAX_AGES, Picture, Reuse, STALE, StaleTiles, TileLists, Viewpoint,
};

const EXTENT: [u32; 2] = [150, 93];
const BORDER: f32 = 4.0;
/// Of tiles that are older, parts are taken from newer pictures.
const OLDEST: usize = 2;
const RANGE: DepthRange = DepthRange { min_depth: 0.0, max_depth: 1.0, near_z: 0.1, far_z: f32::INFINITY };

/// A picture with its depth.
struct Frame {
    view: View,
    position: Vec3,
    stale: StaleTiles,
    pixels: Vec<u8>,
    depth: Vec<f32>,
    /// Rectangle of its depth in images of [`Self::depth_extent`].
    rect: DepthRect,
}

impl Frame {
    /// Of hills behind a bar; `coarse`: depth of half the size.
    fn new(number: u32, coarse: bool) -> Self {
        let map: Vec<u8> = (0..10 * 6)
            .map(|tile: u32| {
                let (column, row) = (tile % 10, tile / 10);
                if (column * 5 + row * 3 + column * row * number) % 7 < 5 - number { STALE } else { 0 }
            })
            .collect();
        let mut stale = StaleTiles::default();
        stale.set(EXTENT, [16; 2], &map);
        let orientation = Quat::from_rotation_y((0.7 * number as f32).to_radians());
        let view = View { orientation, plane: FOV.tangents().plane(EXTENT) };
        let scale = if coarse { 2 } else { 1 };
        let rect = DepthRect { offset: [9, 4], extent: EXTENT.map(|side| side.div_ceil(scale)) };
        let [width, height] = Self::depth_extent(rect);
        let depth = (0..width * height)
            .map(|index| {
                let (x, y) = ((index % width) as f32 - 9.0, (index / width) as f32 - 4.0);
                let at = Vec2::new(x, y) * scale as f32 + 0.5;
                let is_bar = (at.x - 70.0 - 4.0 * number as f32).abs() < 13.0;
                let distance =
                    if is_bar { 0.7 } else { 2.5 + (0.11 * at.x).sin() + 0.4 * (0.07 * at.y).cos() };
                1.0 - 0.1 / distance
            })
            .collect();
        Self {
            view,
            position: Vec3::new(-0.01, 0.004, 0.012) * number as f32,
            stale,
            pixels: picture(EXTENT[0], EXTENT[1], 10 * number),
            depth,
            rect,
        }
    }

    fn depth_extent(rect: DepthRect) -> [u32; 2] {
        [rect.extent[0] + 12, rect.extent[1] + 5]
    }

    fn picture(&self) -> Picture<'_> {
        let nearness = Nearness::new(&RANGE).unwrap();
        let viewpoint = Some(Viewpoint { position_m: self.position, nearness });
        Picture { view: self.view, extent: EXTENT, stale: &self.stale, viewpoint }
    }

    fn depth_pixels(&self) -> DepthPixels<'_> {
        let [width, _] = Self::depth_extent(self.rect);
        DepthPixels { values: &self.depth, width, rect: self.rect }
    }
}

fn frames(coarse: bool) -> Vec<Frame> {
    (0..IMAGES).map(|number| Frame::new(number, coarse)).collect()
}

fn reuse(frames: &[Frame]) -> Reuse<'_> {
    let reuse = Reuse::new(frames[0].picture(), frames[1..].iter().map(Frame::picture), true);
    assert!((1..frames.len()).all(|age| reuse.has_moved_since(age)));
    reuse
}

fn lists(frames: &[Frame]) -> TileLists {
    let mut lists = TileLists::default();
    lists.update(&reuse(frames), BORDER, OLDEST);
    lists
}

/// The runtime's swapchain with depth.
pub struct DepthSwapchain {
    images: [vk::Image; 2],
    extent: vk::Extent2D,
    pub source: DepthSource,
    /// The layout in which the application leaves its images.
    left: vk::ImageLayout,
}

const FORMAT: vk::Format = vk::Format::D32_SFLOAT;
pub const DRAWN: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;

impl DepthSwapchain {
    pub fn new(vulkan: &Vulkan, extent: [u32; 2]) -> Self {
        let extent = vk::Extent2D { width: extent[0], height: extent[1] };
        let images = [0, 1].map(|_| {
            let usage = vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::SAMPLED;
            let image = vulkan.depth_image(FORMAT, extent, usage);
            let written = vk::ImageLayout::UNDEFINED;
            vulkan.run(|commands| Self::barrier(vulkan, commands, image, [written, DRAWN]));
            image
        });
        let shape = DepthShape { format: FORMAT, extent, array_layers: 1 };
        let source = DepthSource::new(&vulkan.gpu, &shape, images.to_vec(), IMAGES).unwrap();
        Self { images, extent, source, left: DRAWN }
    }

    /// As an application orders its copies: nothing waits for them but further ones.
    fn barrier(
        vulkan: &Vulkan,
        commands: vk::CommandBuffer,
        image: vk::Image,
        [from, to]: [vk::ImageLayout; 2],
    ) {
        let range = vk::ImageSubresourceRange {
            aspect_mask: vk::ImageAspectFlags::DEPTH,
            base_mip_level: 0,
            level_count: 1,
            base_array_layer: 0,
            layer_count: 1,
        };
        let tests =
            vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
        let scope = |layout| match layout {
            vk::ImageLayout::UNDEFINED => (vk::PipelineStageFlags::TOP_OF_PIPE, vk::AccessFlags::empty()),
            DRAWN => (tests, vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE),
            vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL => {
                (vk::PipelineStageFlags::FRAGMENT_SHADER, vk::AccessFlags::SHADER_READ)
            }
            vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL => {
                (tests, vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ)
            }
            _ => (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE),
        };
        let ((src, src_access), (dst, dst_access)) = (scope(from), scope(to));
        let barrier = vk::ImageMemoryBarrier::default()
            .image(image)
            .old_layout(from)
            .new_layout(to)
            .src_access_mask(src_access)
            .dst_access_mask(dst_access)
            .subresource_range(range);
        let none = vk::DependencyFlags::empty();
        // SAFETY: plain use of Vulkan with live handles.
        unsafe { vulkan.device.cmd_pipeline_barrier(commands, src, dst, none, &[], &[], &[barrier]) };
    }

    /// The application draws depth, and releases the image. Returns the number of the copy.
    fn render(&self, vulkan: &Vulkan, index: u32, values: &[f32]) -> u64 {
        let (image, buffer) = (self.images[index as usize], vulkan.staging(bytemuck::cast_slice(values)));
        let copied = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        let region = vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::DEPTH,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: 1,
            })
            .image_extent(self.extent.into());
        vulkan.run(|commands| {
            Self::barrier(vulkan, commands, image, [DRAWN, copied]);
            // SAFETY: plain use of Vulkan with live handles.
            unsafe { vulkan.device.cmd_copy_buffer_to_image(commands, buffer, image, copied, &[region]) };
            Self::barrier(vulkan, commands, image, [copied, self.left]);
        });
        let copy = self.source.copy(index, self.left).unwrap();
        if self.left != DRAWN {
            vulkan.run(|commands| Self::barrier(vulkan, commands, image, [self.left, DRAWN]));
        }
        copy
    }

    fn depth(&self, copy: u64, rect: DepthRect) -> PictureDepth<'_> {
        PictureDepth { kept: self.source.kept(), copy, array_layer: 0, rect }
    }
}

/// All frames, the oldest first; frame `age` is in image `age` and, of depth, copy `IMAGES - age`.
fn render(vulkan: &Vulkan, swapchain: &Swapchain, depth: &DepthSwapchain, frames: &[Frame]) {
    for (index, frame) in (0..IMAGES).zip(frames).rev() {
        swapchain.render(vulkan, index, std::slice::from_ref(&frame.pixels));
        depth.render(vulkan, index % 2, &frame.depth);
    }
}

fn reuse_region<'a>(frames: &'a [Frame], lists: &'a TileLists, depth: &'a DepthSwapchain) -> ReuseRegion<'a> {
    let [width, height] = EXTENT;
    let rect = frames[0].rect;
    ReuseRegion {
        array_layer: 0,
        rect: vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } },
        reuse: reuse(frames),
        lists,
        earlier: std::array::from_fn(|index| EarlierImage {
            app_index: index as u32 + 1,
            ..EarlierImage::default()
        }),
        border: BORDER,
        depth: Some(depth.depth(u64::from(IMAGES), rect)),
        earlier_depth: std::array::from_fn(|index| {
            let copy = u64::from(IMAGES).checked_sub(index as u64 + 1).filter(|copy| *copy > 0)?;
            Some(depth.depth(copy, rect))
        }),
    }
}

fn reference(frames: &[Frame], format: PixelFormat, regions: &[ComposeRegion]) -> Vec<u8> {
    let width = EXTENT[0];
    let mut pixels = frames[0].pixels.clone();
    let earlier: Vec<_> = frames[1..]
        .iter()
        .map(|frame| {
            let depth = Some(frame.depth_pixels());
            EarlierPixels { pixels: &frame.pixels, width, offset: [0; 2], depth }
        })
        .collect();
    let neutral = ComposeParams::neutral([0; 2], EXTENT);
    let params = regions.first().map_or(neutral, |region| region.params);
    let lists = lists(frames);
    let how = (&reuse(frames), &lists, BORDER);
    reuse_image(&mut pixels, width, format, &params, how, (Some(frames[0].depth_pixels()), &earlier));
    pixels
}

#[test]
fn moved_pictures_match_the_reference() {
    let vulkan = Vulkan::new();
    for format in [vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_UNORM] {
        let swapchain = Swapchain::with_images(&vulkan, &shape(format, EXTENT[0], EXTENT[1], 1), IMAGES);
        let chroma = [region(0, [0, 0, 150, 93], Vec3::NEG_Z, format, &ChromaSettings::default())];
        for (coarse, regions) in [(false, &[][..]), (false, &chroma), (true, &[]), (true, &chroma)] {
            let frames = frames(coarse);
            let depth = DepthSwapchain::new(&vulkan, Frame::depth_extent(frames[0].rect));
            render(&vulkan, &swapchain, &depth, &frames);
            let lists = lists(&frames);
            let region = [reuse_region(&frames, &lists, &depth)];
            let parameters = if coarse { Parameters::OfPixels } else { Parameters::OfVertices };
            let mut compose = Compose::with_parameters(vulkan.gpu.clone(), parameters).unwrap();
            compose.submit(&[ComposeJob { reuse: &region, ..swapchain.job(0, regions) }]).unwrap();
            let result = swapchain.shown(&vulkan, 1, 1, 4).swap_remove(0);
            let expected = reference(&frames, pixel_format(format), regions);
            let pairs = || expected.chunks(4).zip(result.chunks(4));
            // Blending rounds once more.
            let is_near = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).all(|(a, b)| a.abs_diff(*b) <= 2);
            let others = pairs().filter(|pair| !is_near(pair)).count();
            // A pixel exactly on the edge of a tile, or at the bound of the depth comparison, is taken from either side.
            assert!(others <= 40, "{others} of {format:?}, {coarse}");
            let taken = frames[0].pixels.chunks(4).zip(result.chunks(4)).filter(|(a, b)| a != b).count();
            assert!(taken > 4000, "{taken} of {format:?}, {coarse}");
        }
    }
    vulkan.assert_valid();
}

fn change_region<'a>(
    frames: &'a [Frame],
    tiles: &'a ComparedTiles,
    depth: Option<PictureDepth<'a>>,
) -> ChangeRegion<'a> {
    ChangeRegion {
        array_layer: 0,
        offset: [0; 2],
        reuse: reuse(frames),
        tiles,
        earlier: std::array::from_fn(|index| EarlierImage {
            app_index: index as u32 + 1,
            ..EarlierImage::default()
        }),
        view: frames[0].view,
        depth,
    }
}

fn compared(frames: &[Frame]) -> ComparedTiles {
    let mut tiles = ComparedTiles::default();
    tiles.update(&reuse(frames), 3, |_| true);
    tiles
}

#[test]
fn changes_of_what_has_moved_match_the_reference() {
    let vulkan = Vulkan::new();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::with_images(&vulkan, &shape(format, EXTENT[0], EXTENT[1], 1), IMAGES);
    for coarse in [false, true] {
        let mut frames = frames(coarse);
        // All tiles of the newer two are compared with the oldest but one, and tiles that it lacks with newer ones.
        for frame in &mut frames[..2] {
            frame.stale.set(EXTENT, [16; 2], &[0; 60]);
        }
        let depth = DepthSwapchain::new(&vulkan, Frame::depth_extent(frames[0].rect));
        render(&vulkan, &swapchain, &depth, &frames);
        let tiles = compared(&frames);
        let region = change_region(&frames, &tiles, Some(depth.depth(u64::from(IMAGES), frames[0].rect)));
        let changes = [region];
        let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
        compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(0, &[]) }]).unwrap();
        swapchain.shown(&vulkan, 1, 1, 4);
        let mut found = Vec::new();
        compose.changes(|_, _, changes| found.extend_from_slice(changes));
        let mut expected = Vec::new();
        for age in 1..=3 {
            let params = ChangeParams::new(&region.reuse, age, [0; 2], [0; 2], EXTENT).unwrap();
            let params = params.with_depth(frames[0].rect);
            let [newest, earlier] =
                [0, age].map(|frame| sampler(&frames[frame].pixels, EXTENT, pixel_format(format)));
            let [width, _] = Frame::depth_extent(frames[0].rect);
            let value = |[x, y]: [u32; 2]| frames[0].depth[(y * width + x) as usize];
            let of_age = tiles.with_age(age).iter().map(|word| [word & 0xffff, word >> 16]);
            expected.extend(of_age.map(|tile| params.moved_change(tile, value, &newest, &earlier)));
        }
        assert!(expected.len() > 8 && found.len() == expected.len(), "{} of {}", found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() <= 0.01 + 0.02 * expected, "{found}, not {expected}");
        }
    }
    vulkan.assert_valid();
}

#[test]
fn depth_that_is_not_there_is_refused() {
    let vulkan = Vulkan::new();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::with_images(&vulkan, &shape(format, EXTENT[0], EXTENT[1], 1), IMAGES);
    let frames = frames(false);
    let depth = DepthSwapchain::new(&vulkan, Frame::depth_extent(frames[0].rect));
    render(&vulkan, &swapchain, &depth, &frames);
    let (lists, tiles) = (lists(&frames), compared(&frames));
    let good = reuse_region(&frames, &lists, &depth);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let newest = good.depth.unwrap();
    let beyond = DepthRect { offset: [13, 0], ..newest.rect };
    for (what, depth) in [
        ("none", None),
        ("none yet", Some(PictureDepth { copy: 0, ..newest })),
        ("none so far", Some(PictureDepth { copy: newest.copy + 1, ..newest })),
        ("another layer", Some(PictureDepth { array_layer: 1, ..newest })),
        ("beyond the image", Some(PictureDepth { rect: beyond, ..newest })),
        ("nothing", Some(PictureDepth { rect: DepthRect { extent: [0, 5], ..beyond }, ..newest })),
    ] {
        let regions = [ReuseRegion { depth, ..good }];
        let result = compose.submit(&[ComposeJob { reuse: &regions, ..swapchain.job(0, &[]) }]);
        assert!(matches!(result, Err(GpuError::Invalid(_))), "{what}: {result:?}");
        let changes = [change_region(&frames, &tiles, depth)];
        let result = compose.submit(&[ComposeJob { changes: &changes, ..swapchain.job(0, &[]) }]);
        assert!(matches!(result, Err(GpuError::Invalid(_))), "{what}, compared: {result:?}");
    }
    let regions = [ReuseRegion { earlier_depth: [None; MAX_AGES], ..good }];
    let result = compose.submit(&[ComposeJob { reuse: &regions, ..swapchain.job(0, &[]) }]);
    assert!(matches!(result, Err(GpuError::Invalid(_))), "{result:?}");
    depth.render(&vulkan, 0, &frames[0].depth);
    depth.render(&vulkan, 1, &frames[0].depth);
    let regions = [good];
    let result = compose.submit(&[ComposeJob { reuse: &regions, ..swapchain.job(0, &[]) }]);
    assert!(matches!(result, Err(GpuError::Invalid(_))), "overwritten: {result:?}");
    vulkan.assert_valid();
}

#[test]
fn copies_of_depth_are_made_where_they_fit() {
    let vulkan = Vulkan::new();
    let depth = DepthSwapchain::new(&vulkan, [64, 64]);
    let (kept, used) = (depth.source.kept(), vulkan.gpu.memory_used());
    assert!(used >= kept.bytes() && kept.bytes() >= u64::from(IMAGES) * 64 * 64 * 4, "{used}");
    let refused = DepthSource::within(&vulkan.gpu, kept.shape(), depth.images.to_vec(), IMAGES, |memory| {
        assert_eq!(memory.bytes * u64::from(IMAGES), kept.bytes());
        false
    });
    assert!(matches!(refused, Err(GpuError::Unsupported(_))));
    assert_eq!(vulkan.gpu.memory_used(), used, "memory of a refused copy stays");
    vulkan.assert_valid();
}

/// So many frames as an application has them, with depth that it leaves in `left`, each completed from and compared with those before it.
/// Returns a picture of the runtime.
pub fn in_turn(vulkan: &Vulkan, compose: &mut Compose, count: u32, left: vk::ImageLayout) -> Vec<u8> {
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::with_images(vulkan, &shape(format, EXTENT[0], EXTENT[1], 1), IMAGES);
    let frames = frames(false);
    let depth = DepthSwapchain { left, ..DepthSwapchain::new(vulkan, Frame::depth_extent(frames[0].rect)) };
    render(vulkan, &swapchain, &depth, &frames);
    let (lists, tiles) = (lists(&frames), compared(&frames));
    for number in 0..count {
        let index = number % IMAGES;
        swapchain.render(vulkan, index, std::slice::from_ref(&frames[0].pixels));
        let copy = depth.render(vulkan, number % 2, &frames[0].depth);
        let now = depth.depth(copy, frames[0].rect);
        let mut region = [reuse_region(&frames, &lists, &depth)];
        region[0].earlier = earlier_than(index);
        region[0].depth = Some(now);
        region[0].earlier_depth =
            std::array::from_fn(|age| Some(PictureDepth { copy: copy - 1 - (age % 3) as u64, ..now }));
        let change = change_region(&frames, &tiles, Some(now));
        let changes = [ChangeRegion { earlier: earlier_than(index), ..change }];
        let job = ComposeJob { reuse: &region, changes: &changes, ..swapchain.job(index, &[]) };
        compose.submit(&[job]).unwrap();
    }
    swapchain.shown(vulkan, 0, 1, 4).swap_remove(0)
}
