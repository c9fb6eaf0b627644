//! What happens when the device fails us.

use crate::pictures::region;
use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use ash::vk;
use glam::Vec3;
use parafovea::gpu::{Gpu, GpuError};
use parafovea::passes::compose::Compose;
use parafovea_core::chroma::ChromaSettings;
use std::ffi::{CStr, c_char};
use std::sync::OnceLock;

static NEXT: OnceLock<vk::PFN_vkGetDeviceProcAddr> = OnceLock::new();

/// A device whose fences are never signalled in time: the first wait fails, nothing is submitted or destroyed
/// after that, and nobody hangs.
#[test]
fn a_hanging_device_is_given_up() {
    let hooked = Vulkan::with(|mut record| {
        NEXT.set(record.next_get_device_proc_addr).unwrap();
        record.next_get_device_proc_addr = without_fences;
        record
    });
    let Some(vulkan) = hooked else { return };
    let mut compose = Compose::new(vulkan.gpu.clone()).unwrap();
    let format = vk::Format::R8G8B8A8_SRGB;
    let swapchain = Swapchain::new(&vulkan, &shape(format, 64, 64, 1));
    let regions = [region(0, [0, 0, 64, 64], Vec3::NEG_Z, format, &ChromaSettings::default())];
    let results: Vec<_> = (0..5).map(|_| compose.submit(&[swapchain.job(0, &regions)])).collect();
    // The creation of the images was the first of three submits under way.
    let timeout = Err(GpuError::Timeout);
    assert_eq!(results, [Ok(()), Ok(()), timeout, Err(GpuError::Abandoned), Err(GpuError::Abandoned)]);
    drop((compose, swapchain));
    vulkan.assert_valid();
}

unsafe extern "system" fn without_fences(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: names are C strings, and the device is live.
    unsafe {
        if CStr::from_ptr(name) == c"vkWaitForFences" {
            return Some(std::mem::transmute::<vk::PFN_vkWaitForFences, unsafe extern "system" fn()>(
                wait_in_vain,
            ));
        }
        NEXT.get().unwrap()(device, name)
    }
}

unsafe extern "system" fn wait_in_vain(
    _device: vk::Device,
    _count: u32,
    _fences: *const vk::Fence,
    _all: vk::Bool32,
    _timeout: u64,
) -> vk::Result {
    vk::Result::TIMEOUT
}

/// A function that we call is missing: that is said beforehand, where ash would panic on its call.
#[test]
fn missing_functions_are_named() {
    let Some(vulkan) = Vulkan::new() else { return };
    let mut record = vulkan.record;
    record.next_get_device_proc_addr = without_copies;
    // SAFETY: the record is of a live device with this queue, which nobody else uses now.
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
