//! The layer `samples`.

use super::recording::counting_of_device;
use super::{Counter, Counting, Kind, SAMPLES_FILE_VARIABLE, SampleCount, pass, recording, submit};
use crate::layer::{Instance, Layer, NextDevice, Tracked, hooks};
use crate::report;
use ash::vk;
use std::ffi::CStr;

/// Counts the samples that pass depth and stencil tests in render passes that the application begins.
pub(crate) struct Samples(Counter);

static TRACKED: Tracked<Samples> = Tracked::new();

impl Counting for Samples {
    fn counter(&self) -> &Counter {
        &self.0
    }
}

impl Layer for Samples {
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
        unsafe { Counter::new(Kind::Samples, instance, physical_device, info, create).map(Self) }
    }

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkCreateQueryPool": PFN_vkCreateQueryPool = create_query_pool;
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
        let count = SampleCount { samples: sums.counted(), reason: sums.reason, passes: sums.passes };
        report::append(SAMPLES_FILE_VARIABLE, &count);
    }
}

/// An application that makes occlusion queries would begin them while one of this layer's is active.
unsafe extern "system" fn create_query_pool(
    device: vk::Device,
    info: *const vk::QueryPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::QueryPool,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let samples = counting_of_device::<Samples>(device);
        if (*info).query_type == vk::QueryType::OCCLUSION {
            samples.counter().buffers().give_up("the application has occlusion queries itself");
        }
        (samples.next().functions.fp_v1_0().create_query_pool)(device, info, allocator, pool)
    }
}
