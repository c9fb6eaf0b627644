//! The kernel `nearest` on a Vulkan device, beside its reference: each texel of depth in a pass that loads it, and after one; and of colour
//! that is not interpolated.

use super::{EXTENT, mask, whole};
use crate::transfer::Layer;
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::backend::mask::{ColorFill, FillKind, MaskKernels, depth_format};
use parafovea::gpu::{AppCommands, ImagePart};
use parafovea::kernels::fill::SkipBuffer;
use parafovea::kernels::nearest::{NearestCopy, NearestKernels, USAGE};
use parafovea_core::kernels::nearest::{self, NearestParams};
use parafovea_core::mask::{DepthFormat, Mask, MaskView, SkipList, TileRates};
use parafovea_core::rate::VULKAN_RATES;

/// The layout of depth between the copies.
const LAYOUT: vk::ImageLayout = vk::ImageLayout::GENERAL;

type Record =
    fn(&NearestCopy, &AppCommands, (&NearestKernels, &SkipBuffer), (ImagePart, vk::Rect2D), vk::ImageLayout);
type Reference = fn(&mut [u32], &NearestParams, &SkipList);

/// Each entry point, and its reference.
const ENTRIES: [(&str, Record, Reference); 2] =
    [("cover", NearestCopy::cover, nearest::cover), ("fill", NearestCopy::fill, nearest::fill)];

/// A slope with steps: neighbours differ, and all values are depths from 0 to 1.
fn slope(format: DepthFormat) -> Vec<u8> {
    let [width, height] = EXTENT;
    let texels = (0..width * height).map(|index| (index * 37 % 4093) as f32 / 4093.0);
    match format {
        DepthFormat::Unorm16 => texels.flat_map(|depth| ((depth * 65535.0) as u16).to_ne_bytes()).collect(),
        DepthFormat::Unorm24 => {
            texels.flat_map(|depth| ((depth * 16_777_215.0) as u32).to_ne_bytes()).collect()
        }
        DepthFormat::Float32 => texels.flat_map(f32::to_ne_bytes).collect(),
        DepthFormat::Blocks => panic!("no depth"),
    }
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]])).collect()
}

/// A copy of all texels between a buffer and the depth aspect.
fn all_texels() -> vk::BufferImageCopy {
    let [width, height] = EXTENT;
    vk::BufferImageCopy::default()
        .image_subresource(vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::DEPTH,
            mip_level: 0,
            base_array_layer: 0,
            layer_count: 1,
        })
        .image_extent(vk::Extent3D { width, height, depth: 1 })
}

/// Brings the image from one layout to another, after and before everything.
fn change_layout(
    vulkan: &Vulkan,
    commands: vk::CommandBuffer,
    part: ImagePart,
    layouts: [vk::ImageLayout; 2],
) {
    let all = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
    let range = vk::ImageSubresourceRange {
        aspect_mask: part.aspects,
        base_mip_level: 0,
        level_count: 1,
        base_array_layer: 0,
        layer_count: 1,
    };
    let barrier = vk::ImageMemoryBarrier::default()
        .image(part.image)
        .subresource_range(range)
        .src_access_mask(all)
        .dst_access_mask(all)
        .old_layout(layouts[0])
        .new_layout(layouts[1]);
    let stages = vk::PipelineStageFlags::ALL_COMMANDS;
    let flags = vk::DependencyFlags::empty();
    // SAFETY: plain use of Vulkan.
    unsafe { vulkan.device.cmd_pipeline_barrier(commands, stages, stages, flags, &[], &[], &[barrier]) };
}

/// The depth after `record`, which begins with `before`.
fn depth_after(
    vulkan: &Vulkan,
    format: vk::Format,
    before: &[u8],
    record: impl FnOnce(&AppCommands, ImagePart),
) -> Vec<u32> {
    let extent = whole().extent;
    let image = vulkan.depth_image(format, extent, USAGE);
    let part = ImagePart { image, aspects: vk::ImageAspectFlags::DEPTH, level: 0, first_layer: 0, layers: 1 };
    let from = vulkan.staging(before);
    let (to, memory) = vulkan.buffer_of(before.len(), vk::BufferUsageFlags::TRANSFER_DST);
    vulkan.run(|commands| {
        change_layout(vulkan, commands, part, [vk::ImageLayout::UNDEFINED, LAYOUT]);
        // SAFETY: plain use of Vulkan.
        unsafe { vulkan.device.cmd_copy_buffer_to_image(commands, from, image, LAYOUT, &[all_texels()]) };
        change_layout(vulkan, commands, part, [LAYOUT; 2]);
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        record(&unsafe { AppCommands::new(&vulkan.gpu, commands) }, part);
        change_layout(vulkan, commands, part, [LAYOUT; 2]);
        // SAFETY: plain use of Vulkan.
        unsafe { vulkan.device.cmd_copy_image_to_buffer(commands, image, LAYOUT, to, &[all_texels()]) };
        change_layout(vulkan, commands, part, [LAYOUT; 2]);
    });
    vulkan.idle();
    words(&vulkan.read_memory(memory, before.len()))
}

#[test]
fn depth_is_covered_and_filled_as_in_the_reference() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let kernels = NearestKernels::new(&vulkan.gpu).unwrap();
    let part_of_it =
        vk::Rect2D { offset: vk::Offset2D { x: 22, y: 7 }, extent: vk::Extent2D { width: 90, height: 71 } };
    let formats = [vk::Format::D16_UNORM, vk::Format::X8_D24_UNORM_PACK32, vk::Format::D32_SFLOAT];
    let there: Vec<_> = formats.into_iter().filter(|format| vulkan.draws_depth(*format)).collect();
    assert!(there.len() >= 2, "every device has D16 and one of D32 and X8_D24: {there:?}");
    for vulkan_format in there {
        let format = depth_format(vulkan_format).unwrap();
        // The upper bits of a word of 24 bits of depth are undefined after a copy.
        let bits = if format == DepthFormat::Unorm24 { 0x00ff_ffff } else { u32::MAX };
        let before = slope(format);
        for area in [whole(), part_of_it] {
            let (mask, ..) = mask(area);
            let list = SkipBuffer::new(&vulkan.gpu, mask.list().len(), mask.list()).unwrap();
            for (near, (name, record, reference)) in
                [0.0, 1.0].into_iter().flat_map(|near| ENTRIES.map(|entry| (near, entry)))
            {
                let params = NearestParams::of_depth(EXTENT, format, near).unwrap();
                let copy = NearestCopy::new(&vulkan.gpu, &kernels, params, (EXTENT[1], 1), &list).unwrap();
                let result = depth_after(&vulkan, vulkan_format, &before, |commands, depth| {
                    record(&copy, commands, (&kernels, &list), (depth, area), LAYOUT);
                });
                let mut expected = words(&before);
                reference(&mut expected, &params, mask.list());
                assert_ne!(expected, words(&before), "{name}: nothing to do");
                for (index, (found, expected)) in result.iter().zip(&expected).enumerate() {
                    assert_eq!(found & bits, expected & bits, "{name} {format:?} {area:?}: word {index}");
                }
            }
        }
    }
    vulkan.assert_valid();
}

/// Rings of all rates in two layers, each around another point. No side is a multiple of four.
fn rings(extent: [u32; 2]) -> Mask {
    let tiles = extent.map(|side| side.div_ceil(8));
    let rates = |layer: u32| {
        let away = move |x: u32, y: u32| x.abs_diff(tiles[0] / 3 + layer) + y.abs_diff(tiles[1] / 2);
        let tile = move |x, y| VULKAN_RATES[6usize.saturating_sub(away(x, y) as usize / 2)].texel();
        (0..tiles[1]).flat_map(move |y| (0..tiles[0]).map(move |x| tile(x, y))).collect::<Vec<u8>>()
    };
    let layers = [rates(0), rates(1)];
    let mut mask = Mask::new(extent, 2);
    let views: Vec<_> = (0..)
        .zip(&layers)
        .map(|(layer, rates)| {
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: tiles[0], rates };
            MaskView { layer, offset: [0; 2], extent, tiles }
        })
        .collect();
    mask.resolve(&views);
    mask
}

/// Motion, masks and indices beside colour, of each size of texels: all bits as in the reference.
#[test]
fn colour_that_is_not_interpolated_is_filled_as_in_the_reference() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let kernels = MaskKernels::new(&vulkan.gpu).unwrap();
    let size = [131, 117];
    let [width, height] = size;
    let extent = vk::Extent2D { width, height };
    let mask = rings(size);
    let list = SkipBuffer::new(&vulkan.gpu, mask.list().len(), mask.list()).unwrap();
    for format in [
        vk::Format::R8_UNORM,
        vk::Format::R8G8_UNORM,
        vk::Format::R16_SFLOAT,
        vk::Format::R16G16_SFLOAT,
        vk::Format::R8G8B8A8_SNORM,
        vk::Format::R32_UINT,
        vk::Format::R16G16B16A16_UINT,
        vk::Format::R32G32_SFLOAT,
        vk::Format::R32G32B32A32_SFLOAT,
    ] {
        let Some(FillKind::Nearest(texel)) = FillKind::of(format, vk::SampleCountFlags::TYPE_1) else {
            panic!("{format:?} is not copied");
        };
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | USAGE;
        let image = vulkan.image(vk::ImageCreateFlags::empty(), format, extent, 2, usage);
        let length = width * height * texel;
        let layers = [0u32, 1].map(|layer| -> Vec<u8> {
            let noise = |byte: u32| (byte.wrapping_add(layer << 24).wrapping_mul(2_654_435_761) >> 13) as u8;
            (0..length).map(noise).collect()
        });
        let at = |layer: usize| Layer { image, layer: layer as u32, extent };
        for (layer, bytes) in layers.iter().enumerate() {
            vulkan.upload(at(layer), bytes);
        }
        let fill = ColorFill::new(&vulkan.gpu, &kernels, format, (size, 2), &list).unwrap();
        let aspects = vk::ImageAspectFlags::COLOR;
        let part = ImagePart { image, aspects, level: 0, first_layer: 0, layers: 2 };
        vulkan.run(|commands| {
            // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
            let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
            fill.record(&commands, (&kernels, &list), part, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
        });
        let params = NearestParams::of_texels(size, texel).unwrap();
        let row = params.row_words as usize * 4;
        let mut expected = vec![0u32; 2 * params.layer_words as usize];
        let rows = layers.iter().flat_map(|layer| layer.chunks_exact((width * texel) as usize));
        for (to, from) in bytemuck::cast_slice_mut::<_, u8>(&mut expected).chunks_exact_mut(row).zip(rows) {
            to[..from.len()].copy_from_slice(from);
        }
        nearest::fill(&mut expected, &params, mask.list());
        let expected: &[u8] = bytemuck::cast_slice(&expected);
        for (index, before) in layers.iter().enumerate() {
            let after = vulkan.download(at(index), texel as usize);
            assert_ne!(before, &after, "{format:?}: nothing was done");
            let rows = expected.chunks_exact(row).skip(index * height as usize);
            for (y, (found, expected)) in after.chunks_exact((width * texel) as usize).zip(rows).enumerate() {
                assert!(found == &expected[..found.len()], "{format:?}: layer {index}, row {y}");
            }
        }
    }
    vulkan.assert_valid();
}
