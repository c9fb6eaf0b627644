//! Devices that fail or are behind, and calls about submits under way.

use crate::moved::{DRAWN, DepthSwapchain};
use crate::pictures::{FOV, region};
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use glam::Vec3;
use parafovea::gpu::{Gpu, GpuError};
use parafovea::kernels::compose::Compose;
use parafovea::kernels::debug_view::{DebugView, DebugViewJob, DebugViewParams, DebugViewPass, MapShape};
use parafovea_core::chroma::ChromaSettings;
use std::ffi::{CStr, c_char};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicU32};
use std::sync::{Mutex, OnceLock};
use std::time::Duration;

static NEXT: OnceLock<vk::PFN_vkGetDeviceProcAddr> = OnceLock::new();

/// While set, nothing that was submitted has finished.
static BEHIND: AtomicBool = AtomicBool::new(true);

/// Number of waits in vain.
static WAITS: AtomicU32 = AtomicU32::new(0);

/// A device whose fences are not signalled in time: it is waited for once, then only asked, so that frames go on; nothing is submitted
/// meanwhile, and everything is once it comes again.
#[test]
fn a_device_that_is_behind_is_used_again_once_it_comes() {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.get_or_init(|| record.next_get_device_proc_addr);
        record.next_get_device_proc_addr = with_late_fences;
        record
    });
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(&vulkan, &shape(format, 64, 64, 1));
    let regions = [region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &ChromaSettings::default())];
    let mut submit = || compose.submit(&[swapchain.job(0, &regions)]);
    let results: Vec<_> = (0..5).map(|_| submit()).collect();
    let timeout = Err(GpuError::Timeout);
    assert_eq!(results, [Ok(()), Ok(()), Ok(()), timeout, timeout]);
    assert_eq!(WAITS.load(Relaxed), 1);
    BEHIND.store(false, Relaxed);
    let comes = |_| {
        std::thread::sleep(Duration::from_millis(10));
        submit() == Ok(())
    };
    assert!((0..1000).any(comes), "it never comes again");
    drop((compose, swapchain));
    vulkan.assert_valid();
}

unsafe extern "system" fn with_late_fences(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the arguments are the caller's.
    unsafe { with_fences(device, name, wait_late, status_late) }
}

/// The next function of that name, or one of these in its place.
///
/// # Safety
///
/// The valid usage of vkGetDeviceProcAddr.
unsafe fn with_fences(
    device: vk::Device,
    name: *const c_char,
    wait: vk::PFN_vkWaitForFences,
    status: vk::PFN_vkGetFenceStatus,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: names are C strings, the device is live, and the functions have the types of these names.
    unsafe {
        match CStr::from_ptr(name) {
            name if name == c"vkWaitForFences" => {
                Some(std::mem::transmute::<vk::PFN_vkWaitForFences, unsafe extern "system" fn()>(wait))
            }
            name if name == c"vkGetFenceStatus" => {
                Some(std::mem::transmute::<vk::PFN_vkGetFenceStatus, unsafe extern "system" fn()>(status))
            }
            _ => NEXT.get().unwrap()(device, name),
        }
    }
}

unsafe extern "system" fn wait_late(
    device: vk::Device,
    count: u32,
    fences: *const vk::Fence,
    all: vk::Bool32,
    timeout: u64,
) -> vk::Result {
    if BEHIND.load(Relaxed) {
        WAITS.fetch_add(1, Relaxed);
        return vk::Result::TIMEOUT;
    }
    // SAFETY: the arguments are the caller's.
    unsafe { next_wait(device, count, fences, all, timeout) }
}

/// # Safety
///
/// The valid usage of vkWaitForFences.
unsafe fn next_wait(
    device: vk::Device,
    count: u32,
    fences: *const vk::Fence,
    all: vk::Bool32,
    timeout: u64,
) -> vk::Result {
    // SAFETY: the device has that function, of this type, and the arguments are the caller's.
    unsafe {
        let next = NEXT.get().unwrap()(device, c"vkWaitForFences".as_ptr()).unwrap();
        let next: vk::PFN_vkWaitForFences = std::mem::transmute(next);
        next(device, count, fences, all, timeout)
    }
}

unsafe extern "system" fn status_late(device: vk::Device, fence: vk::Fence) -> vk::Result {
    if BEHIND.load(Relaxed) {
        return vk::Result::NOT_READY;
    }
    // SAFETY: the arguments are the caller's.
    unsafe { next_status(device, fence) }
}

/// # Safety
///
/// The valid usage of vkGetFenceStatus.
unsafe extern "system" fn next_status(device: vk::Device, fence: vk::Fence) -> vk::Result {
    // SAFETY: the device has that function, of this type, and the arguments are the caller's.
    unsafe {
        let next = NEXT.get().unwrap()(device, c"vkGetFenceStatus".as_ptr()).unwrap();
        let next: vk::PFN_vkGetFenceStatus = std::mem::transmute(next);
        next(device, fence)
    }
}

/// A driver whose waits end before their time: the layer goes on by asking, so that images are not destroyed in use.
#[test]
fn a_wait_that_ends_early_goes_on() {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.get_or_init(|| record.next_get_device_proc_addr);
        record.next_get_device_proc_addr = with_early_waits;
        record
    });
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(&vulkan, &shape(format, 1024, 1024, 1));
    let regions = [region(0, [0, 0, 1024, 1024], Vec3::NEG_Z, format, &ChromaSettings::default())];
    let results: Vec<_> = (0..8).map(|_| compose.submit(&[swapchain.job(0, &regions)])).collect();
    assert_eq!(results, [Ok(()); 8]);
    // Right after its last submit.
    drop((compose, swapchain));
    vulkan.assert_valid();
}

unsafe extern "system" fn with_early_waits(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the arguments are the caller's.
    unsafe { with_fences(device, name, early_wait, next_status) }
}

unsafe extern "system" fn early_wait(
    _: vk::Device,
    _: u32,
    _: *const vk::Fence,
    _: vk::Bool32,
    _: u64,
) -> vk::Result {
    vk::Result::TIMEOUT
}

/// Number of calls about fences of [`a_device_that_keeps_up_is_asked_about_a_third_of_the_submits`].
static ASKED: AtomicU32 = AtomicU32::new(0);

/// The newest submit answers for the earlier ones.
#[test]
fn a_device_that_keeps_up_is_asked_about_a_third_of_the_submits() {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.get_or_init(|| record.next_get_device_proc_addr);
        record.next_get_device_proc_addr = with_counted_fences;
        record
    });
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(&vulkan, &shape(format, 64, 64, 1));
    let regions = [region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &ChromaSettings::default())];
    let mut submit = || {
        compose.submit(&[swapchain.job(0, &regions)]).unwrap();
        // SAFETY: the device is live, and no other thread uses its queues.
        unsafe { vulkan.device.device_wait_idle() }.unwrap();
    };
    (0..3).for_each(|_| submit());
    ASKED.store(0, Relaxed);
    (0..30).for_each(|_| submit());
    assert_eq!(ASKED.load(Relaxed), 10);
    drop((compose, swapchain));
    vulkan.assert_valid();
}

unsafe extern "system" fn with_counted_fences(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the arguments are the caller's.
    unsafe { with_fences(device, name, counted_wait, counted_status) }
}

unsafe extern "system" fn counted_wait(
    device: vk::Device,
    count: u32,
    fences: *const vk::Fence,
    all: vk::Bool32,
    timeout: u64,
) -> vk::Result {
    ASKED.fetch_add(1, Relaxed);
    // SAFETY: the arguments are the caller's.
    unsafe { next_wait(device, count, fences, all, timeout) }
}

unsafe extern "system" fn counted_status(device: vk::Device, fence: vk::Fence) -> vk::Result {
    ASKED.fetch_add(1, Relaxed);
    // SAFETY: the arguments are the caller's.
    unsafe { next_status(device, fence) }
}

/// Fences of the submits of the frame under way.
static OF_FRAME: Mutex<Vec<vk::Fence>> = Mutex::new(Vec::new());

/// Number of waits for them.
static WAITS_IN_FRAME: AtomicU32 = AtomicU32::new(0);

/// No submit of a frame waits for another one of it: CPU and GPU would take turns.
#[test]
fn a_frame_with_four_submits_does_not_wait_for_itself() {
    let vulkan = Vulkan::with(|mut record| {
        NEXT.get_or_init(|| record.next_get_device_proc_addr);
        record.next_get_device_proc_addr = with_a_frame_under_way;
        record
    });
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let mut debug_view = DebugViewPass::new(vulkan.gpu.clone()).unwrap();
    let swapchain = Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 64, 64, 1));
    let depth = [0, 1].map(|_| DepthSwapchain::new(&vulkan, [64, 64]));
    let map = MapShape { extent: [64; 2], texel: [16; 2], tiles: [4; 2] };
    let view = DebugViewJob {
        eye: 0,
        runtime: &swapchain.runtime,
        runtime_index: 1,
        array_layer: 0,
        layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        params: DebugViewParams::new(DebugView::Gaze, [0; 2], [64; 2], FOV, Vec3::NEG_Z, &map),
        map: None,
    };
    for _ in 0..8 {
        vulkan.idle();
        OF_FRAME.lock().unwrap().clear();
        for depth in &depth {
            depth.source.copy(0, DRAWN).unwrap();
        }
        compose.submit(&[swapchain.job(0, &[])]).unwrap();
        assert!(debug_view.submit(&[view]).unwrap());
        assert_eq!(OF_FRAME.lock().unwrap().len(), 4);
    }
    // Applications create several swapchains in one frame.
    vulkan.idle();
    OF_FRAME.lock().unwrap().clear();
    let new = [0; 8].map(|_| Swapchain::new(&vulkan, &shape(vk::Format::R8G8B8A8_SRGB, 16, 16, 1)));
    assert_eq!(OF_FRAME.lock().unwrap().len(), new.len());
    assert_eq!(WAITS_IN_FRAME.load(Relaxed), 0);
    vulkan.idle();
    OF_FRAME.lock().unwrap().clear();
    drop((compose, debug_view, depth, swapchain, new));
    vulkan.assert_valid();
}

unsafe extern "system" fn with_a_frame_under_way(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: names are C strings, and the function has the type of its name; the arguments are the caller's.
    unsafe {
        if CStr::from_ptr(name) != c"vkQueueSubmit" {
            return with_fences(device, name, wait_noted, status_noted);
        }
        NEXT_SUBMIT.get_or_init(|| {
            let next = NEXT.get().unwrap()(device, name).unwrap();
            std::mem::transmute::<unsafe extern "system" fn(), vk::PFN_vkQueueSubmit>(next)
        });
        Some(std::mem::transmute::<vk::PFN_vkQueueSubmit, unsafe extern "system" fn()>(submit_noted))
    }
}

static NEXT_SUBMIT: OnceLock<vk::PFN_vkQueueSubmit> = OnceLock::new();

unsafe extern "system" fn submit_noted(
    queue: vk::Queue,
    count: u32,
    infos: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    OF_FRAME.lock().unwrap().push(fence);
    // SAFETY: the arguments are the caller's.
    unsafe { NEXT_SUBMIT.get().unwrap()(queue, count, infos, fence) }
}

unsafe extern "system" fn wait_noted(
    device: vk::Device,
    count: u32,
    fences: *const vk::Fence,
    all: vk::Bool32,
    timeout: u64,
) -> vk::Result {
    // SAFETY: there are so many fences; the arguments are the caller's.
    unsafe {
        let fences_of_frame = OF_FRAME.lock().unwrap().clone();
        let is_of_frame = |index: u32| fences_of_frame.contains(&*fences.add(index as usize));
        WAITS_IN_FRAME.fetch_add((0..count).any(is_of_frame).into(), Relaxed);
        next_wait(device, count, fences, all, timeout)
    }
}

unsafe extern "system" fn status_noted(device: vk::Device, fence: vk::Fence) -> vk::Result {
    if OF_FRAME.lock().unwrap().contains(&fence) {
        return vk::Result::NOT_READY;
    }
    // SAFETY: the arguments are the caller's.
    unsafe { next_status(device, fence) }
}

/// A function that we call is missing: that is said beforehand, where ash would panic on its call.
#[test]
fn missing_functions_are_named() {
    let vulkan = Vulkan::new();
    let mut record = vulkan.record;
    record.next_get_device_proc_addr = without_copies;
    // SAFETY: the record is of a live device with this queue, which no other code uses now.
    let result = unsafe { Gpu::new(&record, 0, 0) };
    assert!(
        matches!(result, Err(GpuError::Missing(name)) if name == c"vkCmdCopyImage"),
        "{:?}",
        result.err()
    );
}

unsafe extern "system" fn without_copies(_device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    unsafe extern "system" fn never_called() {}
    // SAFETY: names are C strings.
    let name = unsafe { CStr::from_ptr(name) };
    (name != c"vkCmdCopyImage").then_some(never_called as unsafe extern "system" fn())
}
