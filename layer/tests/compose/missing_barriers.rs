//! Missing-barrier mutation tests: every barrier is needed, and validation finds a missing one.

use crate::pictures::{FOV, picture, region};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use crate::{change, moved, reuse};
use ash::vk;
use glam::Vec3;
use parafovea::gpu::barrier::{ALL, ImageBarrier};
use parafovea::kernels::compose::{Compose, RUNTIME_USAGE, RuntimeImages};
use parafovea::kernels::debug_view::{DebugView, DebugViewJob, DebugViewParams, DebugViewPass, MapShape};
use parafovea_core::chroma::ChromaSettings;
use parafovea_trial::{Lack, skip};
use std::ffi::{CStr, c_char};
use std::sync::Mutex;

/// The barrier that is left out, and the function that gets all others.
static DROPPED: Mutex<Option<ImageBarrier>> = Mutex::new(None);
static NEXT: Mutex<Option<(vk::PFN_vkGetDeviceProcAddr, vk::PFN_vkCmdPipelineBarrier)>> = Mutex::new(None);

/// Two frames with work and four without, so that each image is used again after either; then some that are completed
/// from earlier ones.
fn frames(vulkan: &Vulkan) {
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(vulkan, &shape(format, 64, 64, 1));
    let whole = [region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &ChromaSettings::default())];
    for (frame, regions) in [&whole[..], &whole, &[], &[], &[], &[]].into_iter().enumerate() {
        let layers = [picture(64, 64, frame as u32)];
        swapchain.frame(vulkan, &mut compose, frame as u32 % 2, &layers, regions).unwrap();
    }
    reuse::in_turn(vulkan, &mut compose, 6);
    change::in_turn(vulkan, &mut compose, 6);
    moved::in_turn(vulkan, &mut compose, 6, moved::DRAWN);
    drawn_over(vulkan);
}

/// A picture that an application copied into the runtime's image, and lets nothing wait for but further copies, is drawn over.
fn drawn_over(vulkan: &Vulkan) {
    const DRAWN: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    const COPIED: vk::ImageLayout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
    let shape = shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 1);
    let image = vulkan.runtime_image(shape.format, shape.extent, 1, shape.usage | RUNTIME_USAGE);
    let images = RuntimeImages::new(&vulkan.gpu, &shape, vec![image]).unwrap();
    let range = vk::ImageSubresourceRange {
        aspect_mask: vk::ImageAspectFlags::COLOR,
        base_mip_level: 0,
        level_count: 1,
        base_array_layer: 0,
        layer_count: 1,
    };
    // SAFETY: plain use of Vulkan with live handles.
    vulkan.run(|commands| unsafe {
        vulkan.transition(commands, image, 1, (DRAWN, COPIED));
        let colour = vk::ClearColorValue { float32: [0.5; 4] };
        vulkan.device.cmd_clear_color_image(commands, image, COPIED, &colour, &[range]);
        let barrier = vk::ImageMemoryBarrier::default()
            .image(image)
            .old_layout(COPIED)
            .new_layout(DRAWN)
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::TRANSFER_READ)
            .subresource_range(range);
        let copies = vk::PipelineStageFlags::TRANSFER;
        let none = vk::DependencyFlags::empty();
        vulkan.device.cmd_pipeline_barrier(commands, copies, copies, none, &[], &[], &[barrier]);
    });
    let params =
        DebugViewParams::new(DebugView::Gaze, [0; 2], [64; 2], FOV, Vec3::NEG_Z, &MapShape::default());
    let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let job = DebugViewJob {
        eye: 0,
        runtime: &images,
        runtime_index: 0,
        array_layer: 0,
        layout,
        params,
        map: None,
    };
    let mut pass = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    pass.submit(&[job]).unwrap();
}

#[test]
fn with_all_barriers_nothing_is_reported() {
    let vulkan = Vulkan::new();
    frames(&vulkan);
    vulkan.assert_valid();
}

#[test]
fn each_missing_barrier_is_reported() {
    for dropped in ALL {
        *DROPPED.lock().unwrap() = Some(dropped);
        let vulkan = Vulkan::with(|mut record| {
            let next = record.next_get_device_proc_addr;
            // SAFETY: the device is live, and the function is of the named type.
            let barrier = unsafe {
                std::mem::transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCmdPipelineBarrier>(next(
                    record.device,
                    c"vkCmdPipelineBarrier".as_ptr(),
                ))
            };
            *NEXT.lock().unwrap() = Some((next, barrier));
            record.next_get_device_proc_addr = get_device_proc_addr;
            record
        });
        if !vulkan.validated {
            skip(&Lack::setup("the Vulkan validation layer, which reports missing barriers"));
        }
        frames(&vulkan);
        assert!(!vulkan.messages().is_empty(), "nobody misses {}", dropped.name);
    }
}

unsafe extern "system" fn get_device_proc_addr(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: names are C strings, and the device is live.
    unsafe {
        if CStr::from_ptr(name) == c"vkCmdPipelineBarrier" {
            return Some(std::mem::transmute::<vk::PFN_vkCmdPipelineBarrier, unsafe extern "system" fn()>(
                pipeline_barrier,
            ));
        }
        let (next, _) = NEXT.lock().unwrap().unwrap();
        next(device, name)
    }
}

#[allow(clippy::too_many_arguments, reason = "the signature is Vulkan's")]
unsafe extern "system" fn pipeline_barrier(
    commands: vk::CommandBuffer,
    src_stage: vk::PipelineStageFlags,
    dst_stage: vk::PipelineStageFlags,
    flags: vk::DependencyFlags,
    memory_count: u32,
    memory: *const vk::MemoryBarrier<'_>,
    buffer_count: u32,
    buffers: *const vk::BufferMemoryBarrier<'_>,
    image_count: u32,
    images: *const vk::ImageMemoryBarrier<'_>,
) {
    let (_, next) = NEXT.lock().unwrap().unwrap();
    let dropped = DROPPED.lock().unwrap().unwrap();
    // SAFETY: our recorder passes one image barrier or none; everything else is passed on.
    unsafe {
        let is_dropped = images.as_ref().is_some_and(|image| {
            let signature = (image.old_layout, image.new_layout, src_stage, dst_stage);
            image_count > 0
                && signature == (dropped.old_layout, dropped.new_layout, dropped.src_stage, dropped.dst_stage)
        });
        if !is_dropped {
            next(
                commands,
                src_stage,
                dst_stage,
                flags,
                memory_count,
                memory,
                buffer_count,
                buffers,
                image_count,
                images,
            );
        }
    }
}
