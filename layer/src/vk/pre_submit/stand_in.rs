//! Functions of a device that hands out command buffers, and otherwise does nothing.

use crate::link::DeviceRecord;
use ash::vk::{self, Handle};
use std::cell::Cell;
use std::ffi::{c_char, c_void};

thread_local! {
    static ALLOCATED: Cell<u64> = const { Cell::new(0) };
}

/// Number of command buffers that this thread has allocated.
pub fn allocated() -> u64 {
    ALLOCATED.get()
}

/// `vkAllocateCommandBuffers`, of one.
///
/// # Safety
///
/// `commands` has room for one.
pub unsafe extern "system" fn allocate(
    _: vk::Device,
    _: *const vk::CommandBufferAllocateInfo<'_>,
    commands: *mut vk::CommandBuffer,
) -> vk::Result {
    ALLOCATED.set(ALLOCATED.get() + 1);
    // SAFETY: as `# Safety` demands.
    unsafe { *commands = vk::CommandBuffer::from_raw(ALLOCATED.get()) };
    vk::Result::SUCCESS
}

/// Any function that returns a `VkResult` or nothing: it ignores its arguments, and succeeds.
///
/// # Safety
///
/// None.
pub unsafe extern "system" fn nothing() -> vk::Result {
    vk::Result::SUCCESS
}

/// `vkGetInstanceProcAddr` and `vkGetDeviceProcAddr` without any function.
///
/// # Safety
///
/// None.
unsafe extern "system" fn no_function<T>(_: T, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

/// `PFN_vkSetDeviceLoaderData` without effect.
///
/// # Safety
///
/// None.
unsafe extern "system" fn no_data(_: vk::Device, _: *mut c_void) -> vk::Result {
    vk::Result::SUCCESS
}

/// The device's record.
pub fn record() -> DeviceRecord {
    DeviceRecord {
        instance: vk::Instance::null(),
        physical_device: vk::PhysicalDevice::null(),
        device: vk::Device::null(),
        api_version: vk::API_VERSION_1_0,
        next_get_instance_proc_addr: no_function,
        next_get_device_proc_addr: no_function,
        set_device_loader_data: no_data,
        queue_submit: None,
        arming: 0,
        submits_late: 0,
    }
}
