//! A layer that does nothing: what any layer costs, as the baseline of the overhead bench.

use crate::layer::{Instance, Layer, NextDevice, Tracked};
use ash::vk;
use std::ffi::CStr;

pub(crate) struct PassThrough {
    next: NextDevice,
}

static TRACKED: Tracked<PassThrough> = Tracked::new();

impl Layer for PassThrough {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    unsafe fn create_device(
        _: &Instance,
        _: vk::PhysicalDevice,
        info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result> {
        Ok(Self { next: create(&info)? })
    }

    fn hook(_: &CStr) -> vk::PFN_vkVoidFunction {
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }
}
