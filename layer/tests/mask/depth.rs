//! The kernel `depth` on a Vulkan device, beside its reference: each texel of depth in a pass that loads it, and after one.

use super::{EXTENT, mask, whole};
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::backend::mask::depth_format;
use parafovea::gpu::{AppCommands, ImagePart};
use parafovea::kernels::depth::{DepthCopy, DepthKernels, USAGE};
use parafovea::kernels::fill::SkipBuffer;
use parafovea_core::kernels::depth::{self, DepthParams};
use parafovea_core::mask::{DepthFormat, SkipList};

/// The layout of depth between the copies.
const LAYOUT: vk::ImageLayout = vk::ImageLayout::GENERAL;

type Record =
    fn(&DepthCopy, &AppCommands, (&DepthKernels, &SkipBuffer), (ImagePart, vk::Rect2D), vk::ImageLayout);
type Reference = fn(&mut [u32], &DepthParams, &SkipList);

/// Each entry point, and its reference.
const ENTRIES: [(&str, Record, Reference); 2] =
    [("cover", DepthCopy::cover, depth::cover), ("fill", DepthCopy::fill, depth::fill)];

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
    let kernels = DepthKernels::new(&vulkan.gpu).unwrap();
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
                let copy = DepthCopy::new(&vulkan.gpu, &kernels, (format, near), (EXTENT, 1), &list).unwrap();
                let result = depth_after(&vulkan, vulkan_format, &before, |commands, depth| {
                    record(&copy, commands, (&kernels, &list), (depth, area), LAYOUT);
                });
                let params = DepthParams::new(EXTENT, format, near).unwrap();
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
