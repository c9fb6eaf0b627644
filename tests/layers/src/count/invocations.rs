//! The layer `count`.

use super::{COUNT_FILE_VARIABLE, Count, Counter, Counting, Kind, pass, recording, submit};
use crate::layer::{Instance, Layer, NextDevice, Tracked, hooks};
use crate::report;
use ash::vk;
use std::ffi::CStr;

/// Counts fragment shader invocations, and notes which render passes the application begins.
pub(crate) struct Invocations(Counter);

static TRACKED: Tracked<Invocations> = Tracked::new();

impl Counting for Invocations {
    fn counter(&self) -> &Counter {
        &self.0
    }
}

impl Layer for Invocations {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    unsafe fn create_device(
        instance: &Instance,
        physical_device: vk::PhysicalDevice,
        info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result> {
        // SAFETY: the caller's own promises.
        unsafe { Counter::new(Kind::Invocations, instance, physical_device, info, create).map(Self) }
    }

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkCmdDraw": PFN_vkCmdDraw = recording::draw;
            c"vkCmdDrawIndexed": PFN_vkCmdDrawIndexed = recording::draw_indexed;
            c"vkCmdDrawIndirect": PFN_vkCmdDrawIndirect = recording::draw_indirect;
            c"vkCmdDrawIndexedIndirect": PFN_vkCmdDrawIndexedIndirect = recording::draw_indexed_indirect;
        }
        recording::hook::<Self>(name)
            .or_else(|| submit::hook::<Self>(name))
            .or_else(|| pass::hook::<Self>(name))
    }

    fn next(&self) -> &NextDevice {
        &self.0.next
    }

    fn device_destroyed(&self) {
        let sums = self.0.buffers().finish();
        let count = Count {
            fragment_invocations: sums.counted(),
            reason: sums.reason,
            command_buffers: sums.command_buffers,
            draws: sums.draws,
            queue_submits: sums.queue_submits,
        };
        report::append(COUNT_FILE_VARIABLE, &count);
    }
}
