//! A layer that counts the fragment shader invocations of everything in primary command buffers, with
//! pipeline statistics queries, and the draws and submits.
//!
//! A primary command buffer is one query, from just after its begin to just before its end, so that render
//! passes are not touched. A result is read when the buffer's next use shows that the last has completed: before it
//! is submitted again, recorded again, reset or freed. Nothing else waits. It is read per submit, so that a
//! buffer recorded once and submitted often counts every time. (A buffer that is submitted again while
//! its last submit waits for something that the application does later would wait for ever.)
//!
//! Not counted, with the reason in the report: an application that uses pipeline statistics itself, as
//! queries of one kind do not nest; secondary command buffers where the device lacks `inheritedQueries`.
//! Draws whose number is in a buffer (`vkCmdDrawIndirectCount`) are not among the draws.

mod buffers;
mod features;
mod recording;
mod submit;

use crate::layer::{Instance, Layer, NextDevice, Tracked, hooks};
use crate::report;
use ash::vk;
use buffers::Buffers;
use features::Features;
use serde::{Deserialize, Serialize};
use std::ffi::CStr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The variable with the file to which each device appends a line, a [`Count`] as JSON, when it is destroyed.
pub const COUNT_FILE_VARIABLE: &str = "PARAFOVEA_TEST_COUNT_FILE";

/// What was counted on one device.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize, Deserialize)]
pub struct Count {
    /// Fragment shader invocations, as the device counts them; none when something could not be counted.
    pub fragment_invocations: Option<u64>,
    /// Why there is no number.
    pub reason: Option<String>,
    /// Primary command buffers executed.
    pub command_buffers: u64,
    /// Draw calls executed.
    pub draws: u64,
    /// Calls of vkQueueSubmit and vkQueueSubmit2.
    pub queue_submits: u64,
}

pub(crate) struct Counter {
    next: NextDevice,
    queue_submit2: Option<vk::PFN_vkQueueSubmit2>,
    inherited_queries: bool,
    buffers: Mutex<Buffers>,
}

static TRACKED: Tracked<Counter> = Tracked::new();

impl Counter {
    /// What is known of the command buffers. Held while queries of this layer's own are read, which cannot
    /// come back to it.
    fn buffers(&self) -> MutexGuard<'_, Buffers> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Layer for Counter {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    unsafe fn create_device(
        instance: &Instance,
        physical_device: vk::PhysicalDevice,
        info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result> {
        // SAFETY: the caller vouches for handle and structure.
        unsafe {
            let features = Features::of(instance, physical_device);
            let (next, missing) = features.amend(info, create)?;
            let function = next.function(c"vkQueueSubmit2").or_else(|| next.function(c"vkQueueSubmit2KHR"));
            let families = features::graphics_families(instance, physical_device);
            Ok(Self {
                queue_submit2: std::mem::transmute::<vk::PFN_vkVoidFunction, Option<vk::PFN_vkQueueSubmit2>>(
                    function,
                ),
                inherited_queries: features.inherited_queries,
                buffers: Mutex::new(Buffers::new(next.functions.clone(), families, missing)),
                next,
            })
        }
    }

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkCreateCommandPool": PFN_vkCreateCommandPool = recording::create_pool;
            c"vkDestroyCommandPool": PFN_vkDestroyCommandPool = recording::destroy_pool;
            c"vkResetCommandPool": PFN_vkResetCommandPool = recording::reset_pool;
            c"vkAllocateCommandBuffers": PFN_vkAllocateCommandBuffers = recording::allocate;
            c"vkFreeCommandBuffers": PFN_vkFreeCommandBuffers = recording::free;
            c"vkBeginCommandBuffer": PFN_vkBeginCommandBuffer = recording::begin;
            c"vkEndCommandBuffer": PFN_vkEndCommandBuffer = recording::end;
            c"vkResetCommandBuffer": PFN_vkResetCommandBuffer = recording::reset;
            c"vkCmdExecuteCommands": PFN_vkCmdExecuteCommands = recording::execute;
            c"vkCmdDraw": PFN_vkCmdDraw = recording::draw;
            c"vkCmdDrawIndexed": PFN_vkCmdDrawIndexed = recording::draw_indexed;
            c"vkCmdDrawIndirect": PFN_vkCmdDrawIndirect = recording::draw_indirect;
            c"vkCmdDrawIndexedIndirect": PFN_vkCmdDrawIndexedIndirect = recording::draw_indexed_indirect;
            c"vkQueueSubmit": PFN_vkQueueSubmit = submit::queue_submit;
            c"vkQueueSubmit2": PFN_vkQueueSubmit2 = submit::queue_submit2;
            c"vkQueueSubmit2KHR": PFN_vkQueueSubmit2 = submit::queue_submit2;
        }
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }

    fn device_destroyed(&self) {
        report::append(COUNT_FILE_VARIABLE, &self.buffers().finish());
    }
}
