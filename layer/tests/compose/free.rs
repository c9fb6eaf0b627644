//! Images of a virtual swapchain that work of ours still uses: applications that draw on another queue wait for it.

use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::{khr, vk};
use parafovea::kernels::compose::Compose;
use parafovea_trial::{Lack, skip};

/// A submit that the GPU finishes at [`Self::release`]: it waits for a timeline semaphore. An event would be simpler, but the host must
/// not set one that a submitted command buffer waits for (VUID-vkSetEvent-event-09543), and lavapipe 25.0 never sees it.
pub struct BlockedSubmit<'a> {
    vulkan: &'a Vulkan,
    timeline: &'a khr::timeline_semaphore::Device,
    semaphore: vk::Semaphore,
}

impl<'a> BlockedSubmit<'a> {
    /// Submits it. Without timeline semaphores the test is skipped.
    pub fn new(vulkan: &'a Vulkan) -> Self {
        let Some(timeline) = &vulkan.timeline else { skip(&Lack::setup("VK_KHR_timeline_semaphore")) };
        let mut kind = vk::SemaphoreTypeCreateInfo::default()
            .semaphore_type(vk::SemaphoreType::TIMELINE)
            .initial_value(0);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        let values = [Self::RELEASED];
        let mut waits = vk::TimelineSemaphoreSubmitInfo::default().wait_semaphore_values(&values);
        // SAFETY: plain use of a live device on one thread.
        unsafe {
            let semaphores = [vulkan.device.create_semaphore(&info, None).unwrap()];
            let submit = vk::SubmitInfo::default()
                .wait_semaphores(&semaphores)
                .wait_dst_stage_mask(&[vk::PipelineStageFlags::ALL_COMMANDS])
                .push_next(&mut waits);
            vulkan.device.queue_submit(vulkan.queue, &[submit], vk::Fence::null()).unwrap();
            Self { vulkan, timeline, semaphore: semaphores[0] }
        }
    }

    /// Value of the semaphore at which the submit goes on.
    const RELEASED: u64 = 1;

    /// Lets the submit and all later ones finish, and waits for them.
    pub fn release(self) {
        let info = vk::SemaphoreSignalInfo::default().semaphore(self.semaphore).value(Self::RELEASED);
        // SAFETY: the semaphore is live, and no other code uses the queue.
        unsafe {
            self.timeline.signal_semaphore(&info).unwrap();
            self.vulkan.device.device_wait_idle().unwrap();
        }
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
    let blocked = BlockedSubmit::new(&vulkan);
    compose.submit(&[swapchain.job(0, &[])]).unwrap();
    assert_eq!(free(), [false, true, true]);
    blocked.release();
    assert_eq!(free(), [true; 3]);
    vulkan.assert_valid();
}

#[test]
fn an_image_is_not_free_before_it_is_ready() {
    let vulkan = Vulkan::new();
    let shape = shape(vk::Format::R8G8B8A8_SRGB, 16, 16, 1);
    let blocked = BlockedSubmit::new(&vulkan);
    let swapchain = Swapchain::with_images(&vulkan, &shape, 2);
    assert!(!swapchain.app.is_free(0) && !swapchain.app.is_free(1));
    blocked.release();
    assert!(swapchain.app.is_free(0) && swapchain.app.is_free(1));
    vulkan.assert_valid();
}

#[test]
fn nobody_waits_for_a_device_that_is_given_up() {
    let vulkan = Vulkan::new();
    let shape = shape(vk::Format::R8G8B8A8_SRGB, 16, 16, 1);
    let blocked = BlockedSubmit::new(&vulkan);
    let swapchain = Swapchain::with_images(&vulkan, &shape, 2);
    vulkan.gpu.abandon();
    assert!(swapchain.app.is_free(0));
    blocked.release();
}
