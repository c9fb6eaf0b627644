//! Images that the application leaves in another layout than OpenXR has them.

use crate::change::{compared, region as compared_region};
use crate::moved;
use crate::pictures::{picture, region};
use crate::reuse::{IMAGES, frames};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use glam::Vec3;
use parafovea::kernels::compose::{Compose, ComposeJob};
use parafovea_core::chroma::ChromaSettings;

const SIDE: u32 = 96;

const OPTIMAL: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;

/// The application uses an image in `to` after `from`.
fn pass_on(vulkan: &Vulkan, swapchain: &Swapchain, index: u32, from: vk::ImageLayout, to: vk::ImageLayout) {
    let image = swapchain.app.images()[index as usize];
    // SAFETY: the command buffer is being recorded, and the image is live.
    vulkan.run(|commands| unsafe { vulkan.transition(commands, image, 1, (from, to)) });
}

/// Copied, drawn and compared pictures are as of images in the right layout, and the application gets its images back as it left them.
#[test]
fn images_are_taken_and_given_back_as_they_were_left() {
    let format = vk::Format::R8G8B8A8_SRGB;
    let frames = frames([SIDE; 2], 16, 0.0);
    let mut shown = Vec::new();
    for layout in [OPTIMAL, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::GENERAL] {
        let vulkan = Vulkan::new();
        let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
        let mut shape = shape(format, SIDE, SIDE, 1);
        shape.usage |= vk::ImageUsageFlags::SAMPLED;
        let swapchain = Swapchain::with_images(&vulkan, &shape, IMAGES);
        let tiles = compared(&frames);
        let changes = [compared_region(&frames, &tiles)];
        let regions = [region(0, [0, 0, SIDE, SIDE], Vec3::NEG_Z, format, &ChromaSettings::default())];
        for index in 0..IMAGES {
            swapchain.render(&vulkan, index, &[picture(SIDE, SIDE, index)]);
            pass_on(&vulkan, &swapchain, index, OPTIMAL, layout);
            swapchain.app.left_in(index, layout);
        }
        let mut pictures = Vec::new();
        for job in [
            swapchain.job(0, &[]),
            swapchain.job(0, &regions),
            ComposeJob { changes: &changes, ..swapchain.job(0, &[]) },
        ] {
            compose.submit(&[job]).unwrap();
            pictures.extend(swapchain.shown(&vulkan, 1, 1, 4));
        }
        for index in 0..IMAGES {
            pass_on(&vulkan, &swapchain, index, layout, OPTIMAL);
        }
        vulkan.idle();
        vulkan.assert_valid();
        shown.push(pictures);
    }
    assert_ne!(shown[0][0], shown[0][1], "nothing was drawn");
    assert!(shown[1..].iter().all(|pictures| *pictures == shown[0]));
}

/// The same of depth: pictures are as of depth in the layout that OpenXR demands.
#[test]
fn depth_is_taken_and_given_back_as_it_was_left() {
    let pictures = [
        moved::DRAWN,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
    ]
    .map(|left| {
        let vulkan = Vulkan::new();
        let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
        let picture = moved::in_turn(&vulkan, &mut compose, 6, left);
        vulkan.idle();
        vulkan.assert_valid();
        picture
    });
    assert!(pictures[1..].iter().all(|picture| *picture == pictures[0]));
}
