//! Commands that are recorded once and submitted again.

use crate::pictures::{assert_matches, picture, reference, region};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use glam::Vec3;
use parafovea::kernels::compose::Compose;
use parafovea_core::chroma::ChromaSettings;
use std::ffi::{CStr, c_char};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

const FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;

const SIDE: u32 = 64;

static NEXT: OnceLock<vk::PFN_vkGetDeviceProcAddr> = OnceLock::new();

/// Number of command buffers that were begun.
static RECORDINGS: AtomicU32 = AtomicU32::new(0);

unsafe extern "system" fn counting(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: names are C strings, the device is live, and the function has the type of its name.
    unsafe {
        match CStr::from_ptr(name) {
            name if name == c"vkBeginCommandBuffer" => {
                Some(std::mem::transmute::<vk::PFN_vkBeginCommandBuffer, unsafe extern "system" fn()>(begin))
            }
            _ => NEXT.get().unwrap()(device, name),
        }
    }
}

unsafe extern "system" fn begin(
    commands: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    RECORDINGS.fetch_add(1, Relaxed);
    // SAFETY: every device has that function, of this type, and the arguments are the caller's.
    unsafe {
        let next = NEXT.get().unwrap()(DEVICE.get().unwrap().0, c"vkBeginCommandBuffer".as_ptr()).unwrap();
        let next: vk::PFN_vkBeginCommandBuffer = std::mem::transmute(next);
        next(commands, info)
    }
}

static DEVICE: OnceLock<Device> = OnceLock::new();

struct Device(vk::Device);

// SAFETY: the handle is only passed on.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

/// Frames with other gazes submit the commands of earlier ones, with pictures of their own; other rectangles, images, layouts and
/// swapchains are recorded again, even if a swapchain gets the handles of one that has ended.
#[test]
fn frames_that_differ_in_the_gaze_alone_repeat_commands() {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.set(record.next_get_device_proc_addr).unwrap();
        assert!(DEVICE.set(Device(record.device)).is_ok());
        record.next_get_device_proc_addr = counting;
        record
    });
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let settings = ChromaSettings::default();
    let frame = |compose: &mut Compose, swapchain: &Swapchain, index: u32, rect: [u32; 4], gaze: Vec3| {
        let before = RECORDINGS.load(Relaxed);
        let layers = [picture(SIDE, SIDE, index)];
        let regions = [region(0, rect, gaze, FORMAT, &settings)];
        let shown = swapchain.frame(&vulkan, compose, index, &layers, &regions).unwrap();
        let reference = |before: &[u8]| reference(before, SIDE, FORMAT, 0, &regions);
        assert_matches(&vulkan, &layers[0], reference, &shown[0], |_| false);
        assert_ne!(shown[0], layers[0], "nothing was done");
        (shown, RECORDINGS.load(Relaxed) - before)
    };
    let whole = [0, 0, SIDE, SIDE];
    let gaze = |number: u32| Vec3::new(0.1 * number as f32, -0.05 * number as f32, -1.0);
    for _ in 0..3 {
        let swapchain = Swapchain::new(&vulkan, &shape(FORMAT, SIDE, SIDE, 1));
        // Two images in three slots.
        let recorded: u32 =
            (0..6).map(|number| frame(&mut compose, &swapchain, number % 2, whole, gaze(0)).1).sum();
        assert_eq!(recorded, 6, "a new swapchain");
        let frames: Vec<_> =
            (6..18).map(|number| frame(&mut compose, &swapchain, number % 2, whole, gaze(number))).collect();
        assert_eq!(frames.iter().map(|(_, recorded)| recorded).sum::<u32>(), 0, "another gaze");
        assert!(frames.windows(3).all(|frames| frames[0].0 != frames[2].0), "pictures of another gaze");
        assert_eq!(
            frame(&mut compose, &swapchain, 0, [0, 0, SIDE / 2, SIDE], gaze(0)).1,
            1,
            "another rectangle"
        );
        swapchain.app.left_in(0, vk::ImageLayout::GENERAL);
        vulkan.run(|commands| {
            let layouts = (vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, vk::ImageLayout::GENERAL);
            // SAFETY: the command buffer is being recorded, and the image is live.
            unsafe { vulkan.transition(commands, swapchain.app.images()[0], 1, layouts) };
        });
        let before = RECORDINGS.load(Relaxed);
        compose.submit(&[swapchain.job(0, &[region(0, whole, gaze(0), FORMAT, &settings)])]).unwrap();
        assert_eq!(RECORDINGS.load(Relaxed) - before, 1, "another layout");
        vulkan.idle();
    }
    vulkan.assert_valid();
}
