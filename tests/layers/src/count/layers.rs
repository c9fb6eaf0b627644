//! The layers themselves: counts, hooks besides the common ones, and report of each.

use super::buffers::Sums;
use super::recording::{counting_of_device, draw, draw_indexed, draw_indexed_indirect, draw_indirect};
use super::{
    COUNT_FILE_VARIABLE, Count, Counted, Counter, Counting, GpuTime, GpuTimes, Kind, SAMPLES_FILE_VARIABLE,
    SampleCount, TIMES_FILE_VARIABLE, pass, recording, submit,
};
use crate::layer::{Instance, Layer, NextDevice, Tracked, hooks};
use crate::report;
use ash::vk;
use std::ffi::CStr;

macro_rules! counting_layers {
    ($($(#[$doc:meta])* $layer:ident: $kind:expr, $hook:path, $report:path;)*) => {$(
        $(#[$doc])*
        pub(crate) struct $layer(Counter);

        impl Counting for $layer {
            fn counter(&self) -> &Counter {
                &self.0
            }
        }

        impl Layer for $layer {
            fn tracked() -> &'static Tracked<Self> {
                static TRACKED: Tracked<$layer> = Tracked::new();
                &TRACKED
            }

            /// # Safety
            /// As [`Layer::create_device`].
            unsafe fn create_device(
                instance: &Instance,
                physical_device: vk::PhysicalDevice,
                info: vk::DeviceCreateInfo<'_>,
                create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
            ) -> Result<Self, vk::Result> {
                // SAFETY: the caller's own promises.
                unsafe { Counter::new($kind, instance, physical_device, info, create).map(Self) }
            }

            fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
                $hook(name)
                    .or_else(|| recording::hook::<Self>(name))
                    .or_else(|| submit::hook::<Self>(name))
                    .or_else(|| pass::hook::<Self>(name))
            }

            fn next(&self) -> &NextDevice {
                &self.0.next
            }

            fn device_destroyed(&self) {
                $report(self.0.buffers().finish());
            }
        }
    )*};
}

counting_layers! {
    /// Counts fragment shader invocations, and notes which render passes the application begins.
    Invocations: Kind::Invocations, draws, report_invocations;
    /// Counts the samples that pass depth and stencil tests in render passes that the application begins.
    Samples: Kind::Samples, query_pools, report_samples;
    /// Times primary command buffers.
    Times: Kind::Times, nothing_more, report_times;
}

fn draws(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkCmdDraw": PFN_vkCmdDraw = draw;
        c"vkCmdDrawIndexed": PFN_vkCmdDrawIndexed = draw_indexed;
        c"vkCmdDrawIndirect": PFN_vkCmdDrawIndirect = draw_indirect;
        c"vkCmdDrawIndexedIndirect": PFN_vkCmdDrawIndexedIndirect = draw_indexed_indirect;
    }
    None
}

fn query_pools(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkCreateQueryPool": PFN_vkCreateQueryPool = create_query_pool;
    }
    None
}

fn nothing_more(_: &CStr) -> vk::PFN_vkVoidFunction {
    None
}

fn report_invocations(sums: Sums) {
    let count = Count {
        fragment_invocations: sums.counted(),
        reason: sums.reason,
        command_buffers: sums.command_buffers,
        draws: sums.draws,
        queue_submits: sums.queue_submits,
        by_submit: sums.by_submit,
    };
    report::append(COUNT_FILE_VARIABLE, &count);
}

fn report_samples(sums: Sums) {
    let count = SampleCount {
        samples: sums.counted(),
        reason: sums.reason,
        passes: sums.passes,
        by_submit: sums.by_submit,
    };
    report::append(SAMPLES_FILE_VARIABLE, &count);
}

fn report_times(sums: Sums) {
    let time = |taken: Counted| GpuTime { process_cpu_ns: taken.process_cpu_ns, gpu_ns: taken.value };
    let buffers = sums.by_submit.into_iter().map(time).collect();
    report::append(TIMES_FILE_VARIABLE, &GpuTimes { buffers, reason: sums.reason });
}

/// An application that makes occlusion queries would begin them while one of the layer `samples` is active.
///
/// # Safety
/// As `vkCreateQueryPool`.
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
