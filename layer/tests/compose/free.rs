//! Images of a virtual swapchain that work of ours still uses: applications that draw on another queue wait for it.

use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::kernels::compose::Compose;

/// A submit that the GPU finishes when the host sets the event.
pub fn block(vulkan: &Vulkan) -> vk::Event {
    let device = &vulkan.device;
    let info = vk::CommandBufferAllocateInfo::default()
        .command_pool(vulkan.pool)
        .level(vk::CommandBufferLevel::PRIMARY)
        .command_buffer_count(1);
    // SAFETY: plain use of a live device on one thread.
    unsafe {
        let event = device.create_event(&vk::EventCreateInfo::default(), None).unwrap();
        let commands = device.allocate_command_buffers(&info).unwrap()[0];
        device.begin_command_buffer(commands, &vk::CommandBufferBeginInfo::default()).unwrap();
        let (host, all) = (vk::PipelineStageFlags::HOST, vk::PipelineStageFlags::ALL_COMMANDS);
        device.cmd_wait_events(commands, &[event], host, all, &[], &[], &[]);
        device.end_command_buffer(commands).unwrap();
        let commands = [commands];
        let submit = vk::SubmitInfo::default().command_buffers(&commands);
        device.queue_submit(vulkan.queue, &[submit], vk::Fence::null()).unwrap();
        event
    }
}

#[test]
fn an_image_is_free_once_the_gpu_is_done_with_its_last_submit() {
    let vulkan = Vulkan::new();
    let shape = shape(vk::Format::R8G8B8A8_SRGB, 16, 16, 1);
    let swapchain = Swapchain::with_images(&vulkan, &shape, 3);
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    swapchain.render(&vulkan, 0, &[vec![7; 16 * 16 * 4]]);
    // SAFETY: no other code uses the device's queues.
    unsafe { vulkan.device.device_wait_idle() }.unwrap();
    let free = || [0, 1, 2].map(|image| swapchain.app.is_free(image));
    assert_eq!(free(), [true; 3], "the device is idle");
    let event = block(&vulkan);
    compose.submit(&[swapchain.job(0, &[])]).unwrap();
    assert_eq!(free(), [false, true, true]);
    // SAFETY: the event is live, and no other code uses the queue.
    unsafe {
        vulkan.device.set_event(event).unwrap();
        vulkan.device.device_wait_idle().unwrap();
    }
    assert_eq!(free(), [true; 3]);
    vulkan.assert_valid();
}

#[test]
fn an_image_is_not_free_before_it_is_ready() {
    let vulkan = Vulkan::new();
    let shape = shape(vk::Format::R8G8B8A8_SRGB, 16, 16, 1);
    let event = block(&vulkan);
    let swapchain = Swapchain::with_images(&vulkan, &shape, 2);
    assert!(!swapchain.app.is_free(0) && !swapchain.app.is_free(1));
    // SAFETY: the event is live, and no other code uses the queue.
    unsafe {
        vulkan.device.set_event(event).unwrap();
        vulkan.device.device_wait_idle().unwrap();
    }
    assert!(swapchain.app.is_free(0) && swapchain.app.is_free(1));
    vulkan.assert_valid();
}

#[test]
fn nobody_waits_for_a_device_that_is_given_up() {
    let vulkan = Vulkan::new();
    let shape = shape(vk::Format::R8G8B8A8_SRGB, 16, 16, 1);
    let event = block(&vulkan);
    let swapchain = Swapchain::with_images(&vulkan, &shape, 2);
    vulkan.gpu.abandon();
    assert!(swapchain.app.is_free(0));
    // SAFETY: the event is live, and no other code uses the queue.
    unsafe {
        vulkan.device.set_event(event).unwrap();
        vulkan.device.device_wait_idle().unwrap();
    }
}
