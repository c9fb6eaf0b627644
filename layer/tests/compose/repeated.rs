//! Commands that are recorded once and submitted again.

use crate::change::{self, compared};
use crate::pictures::{assert_matches, picture, pixel_format, reference as plain_reference, region};
use crate::reuse::{self, Frame, IMAGES, earlier_than, frames, reference, reuse_region};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use glam::Vec3;
use parafovea::kernels::change::ChangeRegion;
use parafovea::kernels::compose::{Compose, ComposeJob, ComposeRegion, ReuseRegion};
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::reuse::TileLists;
use std::cell::Cell;
use std::ffi::{CStr, c_char};
use std::sync::OnceLock;

const FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;

const SIDE: u32 = 64;

/// As in [`reuse`].
const OLDEST: usize = 1;

static NEXT: OnceLock<vk::PFN_vkGetDeviceProcAddr> = OnceLock::new();

thread_local! {
    /// The device of this thread's test.
    static DEVICE: Cell<vk::Device> = const { Cell::new(vk::Device::null()) };
    /// Number of command buffers that this thread began.
    static RECORDINGS: Cell<u32> = const { Cell::new(0) };
}

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
    RECORDINGS.set(RECORDINGS.get() + 1);
    // SAFETY: every device has that function, of this type, and the arguments are the caller's.
    unsafe {
        let next = NEXT.get().unwrap()(DEVICE.get(), c"vkBeginCommandBuffer".as_ptr()).unwrap();
        let next: vk::PFN_vkBeginCommandBuffer = std::mem::transmute(next);
        next(commands, info)
    }
}

/// A device that counts recordings.
fn counted() -> Vulkan {
    Vulkan::with(|mut record| {
        NEXT.get_or_init(|| record.next_get_device_proc_addr);
        DEVICE.set(record.device);
        record.next_get_device_proc_addr = counting;
        record
    })
}

/// Number of recordings in `run`, and its result.
fn recorded<T>(run: impl FnOnce() -> T) -> (T, u32) {
    let before = RECORDINGS.get();
    let result = run();
    (result, RECORDINGS.get() - before)
}

/// Completed and compared pictures repeat the commands of earlier frames, with tiles of other number, size and age in each. Copies of tiles
/// are recorded in every frame.
#[test]
fn completed_pictures_repeat_commands_too() {
    let vulkan = counted();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::with_images(&vulkan, &shape(FORMAT, 150, 93, 1), IMAGES);
    let chroma = [region(0, [0, 0, 150, 93], Vec3::NEG_Z, FORMAT, &ChromaSettings::default())];
    let mut frame = |number: u32, frames: &[Frame], (regions, is_compared): (&[ComposeRegion], bool)| {
        let index = number % IMAGES;
        for (age, frame) in (0..).zip(frames) {
            swapchain.render(&vulkan, (index + IMAGES - age) % IMAGES, std::slice::from_ref(&frame.pixels));
        }
        let (mut lists, tiles) = (TileLists::default(), compared(frames));
        lists.update(&reuse::reuse(frames, true), 4.0, OLDEST);
        let earlier = earlier_than(index);
        let completed = [ReuseRegion { earlier, ..reuse_region(frames, &lists, true, 4.0) }];
        let changes = [ChangeRegion { earlier, ..change::region(frames, &tiles) }];
        let job = ComposeJob {
            reuse: &completed,
            changes: if is_compared { &changes } else { &[] },
            ..swapchain.job(index, regions)
        };
        let ((), recordings) = recorded(|| compose.submit(&[job]).unwrap());
        let shown = swapchain.shown(&vulkan, job.runtime_index, 1, 4).swap_remove(0);
        let expected = reference(frames, pixel_format(FORMAT), (regions, true, 4.0));
        let others = expected.iter().zip(&shown).filter(|(a, b)| a.abs_diff(**b) > 2).count();
        assert!(others <= 80, "{others} in frame {number}");
        let mut found = 0;
        compose.changes(|_, tiles, _| found += tiles.len());
        assert_eq!(found, if is_compared { tiles.count() } else { 0 }, "frame {number}");
        (shown, recordings)
    };
    // The most tiles first, for which room is made.
    let turned = [(8, 1.7), (16, -3.1), (32, 0.8)].map(|(texel, speed)| frames([150, 93], texel, speed));
    // All compared up to the third picture; the last set with younger ones, too.
    let compared_alike =
        [(8, 1.7), (16, -1.1), (8, 9.0)].map(|(texel, speed)| frames([150, 93], texel, speed));
    let ages = compared_alike.each_ref().map(|frames| {
        let tiles = compared(frames);
        (1..=3).map(|age| !tiles.with_age(age).is_empty()).collect::<Vec<_>>()
    });
    assert!(ages.iter().all(|ages| ages[2]) && ages[0] != ages[2], "{ages:?}");
    let still = frames([150, 93], 16, 0.0);
    let whole = &chroma[..];
    for (sets, how) in [
        (&turned, (&[][..], false)),
        (&turned, (whole, false)),
        (&compared_alike, (&[], true)),
        (&compared_alike, (whole, true)),
    ] {
        // Four images in three slots.
        let first: u32 = (0..12).map(|number| frame(number, &sets[0], how).1).sum();
        assert_eq!(first, 12, "new commands");
        let later: Vec<_> =
            (12..36).map(|number| frame(number, &sets[number as usize % sets.len()], how)).collect();
        assert_eq!(later.iter().map(|(_, recordings)| recordings).sum::<u32>(), 0, "other tiles");
        assert!(later.windows(2).all(|frames| frames[0].0 != frames[1].0), "pictures of other tiles");
        let copied: u32 = (36..48).map(|number| frame(number, &still, how).1).sum();
        assert_eq!(copied, 12, "tiles of pictures that have not moved");
    }
    let mut lists = TileLists::default();
    lists.update(&reuse::reuse(&turned[0], true), 4.0, OLDEST);
    (lists.full[1], lists.partial[1], lists.seam[1]) = Default::default();
    for number in 0..12 {
        let region = reuse_region(&turned[0], &lists, true, 4.0);
        let completed = [ReuseRegion { earlier: earlier_than(number % IMAGES), ..region }];
        let job = ComposeJob { reuse: &completed, ..swapchain.job(number % IMAGES, &[]) };
        assert_eq!(recorded(|| compose.submit(&[job]).unwrap()).1, 0, "no tiles of the second picture");
    }
    vulkan.assert_valid();
}

/// Frames with other gazes submit the commands of earlier ones, with pictures of their own; other rectangles, images, layouts and
/// swapchains are recorded again, even if a swapchain gets the handles of one that has ended.
#[test]
fn frames_that_differ_in_the_gaze_alone_repeat_commands() {
    let vulkan = counted();
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let settings = ChromaSettings::default();
    let frame = |compose: &mut Compose, swapchain: &Swapchain, index: u32, rect: [u32; 4], gaze: Vec3| {
        let layers = [picture(SIDE, SIDE, index)];
        let regions = [region(0, rect, gaze, FORMAT, &settings)];
        let (shown, recordings) =
            recorded(|| swapchain.frame(&vulkan, compose, index, &layers, &regions).unwrap());
        let reference = |before: &[u8]| plain_reference(before, SIDE, FORMAT, 0, &regions);
        assert_matches(&vulkan, &layers[0], reference, &shown[0], |_| false);
        assert_ne!(shown[0], layers[0], "nothing was done");
        (shown, recordings)
    };
    let whole = [0, 0, SIDE, SIDE];
    let gaze = |number: u32| Vec3::new(0.1 * number as f32, -0.05 * number as f32, -1.0);
    for _ in 0..3 {
        let swapchain = Swapchain::new(&vulkan, &shape(FORMAT, SIDE, SIDE, 1));
        // Two images in three slots.
        let first: u32 =
            (0..6).map(|number| frame(&mut compose, &swapchain, number % 2, whole, gaze(0)).1).sum();
        assert_eq!(first, 6, "a new swapchain");
        let frames: Vec<_> =
            (6..18).map(|number| frame(&mut compose, &swapchain, number % 2, whole, gaze(number))).collect();
        assert_eq!(frames.iter().map(|(_, recordings)| recordings).sum::<u32>(), 0, "another gaze");
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
        let regions = [region(0, whole, gaze(0), FORMAT, &settings)];
        let ((), recordings) = recorded(|| compose.submit(&[swapchain.job(0, &regions)]).unwrap());
        assert_eq!(recordings, 1, "another layout");
        vulkan.idle();
    }
    vulkan.assert_valid();
}
