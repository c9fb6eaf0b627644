//! DXVK's Vulkan handles, as Proton's `wineopenxr` uses them.

use crate::com::{Guid, HResult, Object, call, check};
use crate::d3d11::{Device, TextureDescription};
use anyhow::Result;
use ash::vk;
use std::ffi::c_void;
use std::ptr;

/// `IDXGIVkInteropDevice1` of DXVK.
const INTEROP: Guid = Guid::new(0xe2ef5fa5_dc21_4af7_90c4_f67ef6a09324);

/// The Vulkan side of a device.
pub struct Interop {
    object: Object,
}

/// Its handles.
#[derive(Clone, Copy, Default)]
pub struct Handles {
    pub instance: vk::Instance,
    pub physical_device: vk::PhysicalDevice,
    pub device: vk::Device,
    pub queue_index: u32,
    pub queue_family: u32,
}

impl Interop {
    /// Of a device.
    pub fn of(device: &Device) -> Result<Self> {
        Ok(Self { object: device.query(&INTEROP, "IDXGIVkInteropDevice1")? })
    }

    /// The handles.
    pub fn handles(&self) -> Handles {
        let mut handles = Handles::default();
        let mut queue = vk::Queue::null();
        call!(&self.object, 3, &mut handles.instance => *mut vk::Instance, &mut handles.physical_device => *mut vk::PhysicalDevice,
            &mut handles.device => *mut vk::Device; ());
        call!(&self.object, 9, &mut queue => *mut vk::Queue, &mut handles.queue_index => *mut u32, &mut handles.queue_family => *mut u32; ());
        handles
    }

    /// A texture of the runtime's image.
    pub fn texture(&self, description: &TextureDescription, image: vk::Image) -> Result<Object> {
        let mut made: *mut c_void = ptr::null_mut();
        let result = call!(&self.object, 10, description => *const TextureDescription, image => vk::Image, &mut made => *mut *mut c_void; HResult);
        check(result, "CreateTexture2DFromVkImage")?;
        // SAFETY: a reference that the call has returned.
        unsafe { Object::from_raw(made, "CreateTexture2DFromVkImage") }
    }

    /// Has all commands so far submitted.
    pub fn flush(&self) {
        call!(&self.object, 6; ());
    }

    /// Waits until the GPU has executed all commands so far.
    pub fn wait_idle(&self) -> Result<()> {
        self.flush();
        let Handles { instance, device, .. } = self.handles();
        // SAFETY: the loader that is installed as libvulkan.so.1 is taken to be one, and DXVK's handles are live ones of it.
        let device = unsafe {
            let entry = ash::Entry::load()?;
            let instance = ash::Instance::load(entry.static_fn(), instance);
            ash::Device::load(instance.fp_v1_0(), device)
        };
        // SAFETY: the device is live, and DXVK uses its queues at no other time.
        self.locked(|| unsafe { device.device_wait_idle() })?;
        Ok(())
    }

    /// Calls the runtime while DXVK submits nothing.
    pub fn locked<T>(&self, call: impl FnOnce() -> T) -> T {
        call!(&self.object, 7; ());
        let result = call();
        call!(&self.object, 8; ());
        result
    }
}
