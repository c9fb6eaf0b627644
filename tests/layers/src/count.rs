//! Three layers that count an application's draws, with queries.
//!
//! [`Invocations`], the layer `count`, counts the fragment shader invocations of everything in primary command buffers
//! with pipeline statistics, and the draws and submits. A primary command buffer is one query, from just after its begin to
//! just before its end, so that render passes are not touched.
//!
//! [`Samples`], the layer `samples`, counts the samples that pass depth and stencil tests, with precise occlusion queries around render
//! passes: the shaded samples if a driver tests early. It exists because invocations do not show the savings of an early depth test on
//! lavapipe 22.3.6, which counts whole blocks of 4 x 4 pixels before the test (25.0.7 counts behind it). It sits *below* Parafovea,
//! which an occlusion query above would change: Parafovea leaves a pass with such a query alone. It counts only passes that begin while
//! the layer `count`, above, passes on the application's own call ([`application`]), no passes of Parafovea.
//!
//! [`Times`], the layer `times`, counts nanoseconds on the GPU, with a timestamp at the begin and the end of each primary command
//! buffer, both written when all earlier commands are done. It sits below Parafovea, so that Parafovea's submits are timed too.
//!
//! A result is read when the buffer's next use shows that the last has completed: before it is submitted again,
//! recorded again, reset or freed. Nothing else waits. It is read per submit, so that a buffer recorded once and submitted
//! often counts every time. (A buffer that is submitted again while its last submit waits for something that the application
//! does later would wait for ever.)
//!
//! Not counted, with the reason in the report: parts within the application's own queries, as queries of one kind do not nest;
//! secondary command buffers where the device lacks `inheritedQueries`; the samples of suspended passes, of passes begun in secondary
//! command buffers, and of more than [`MOST_PASSES`](buffers::MOST_PASSES) passes in a command buffer. Draws whose number is in a
//! buffer (`vkCmdDrawIndirectCount`) are not among the draws.

mod application;
mod buffers;
mod features;
mod layers;
mod pass;
mod recording;
mod submit;

use crate::functions::functions;
use crate::layer::{Instance, Layer, NextDevice};
use ash::vk;
use buffers::Buffers;
use features::Features;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, MutexGuard, PoisonError};

pub(crate) use layers::{Invocations, Samples, Times};

/// The variable with the file to which each device appends a line, a [`Count`] as JSON, when it is destroyed.
pub const COUNT_FILE_VARIABLE: &str = "PARAFOVEA_TEST_COUNT_FILE";

/// As [`COUNT_FILE_VARIABLE`], for the layer `samples` and its [`SampleCount`].
pub const SAMPLES_FILE_VARIABLE: &str = "PARAFOVEA_TEST_SAMPLES_FILE";

/// As [`COUNT_FILE_VARIABLE`], for the layer `times` and its [`GpuTimes`].
pub const TIMES_FILE_VARIABLE: &str = "PARAFOVEA_TEST_TIMES_FILE";

/// Counts of one device.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize, Deserialize)]
pub struct Count {
    /// Fragment shader invocations, as the device counts them; none when something could not be counted.
    pub fragment_invocations: Option<u64>,
    /// Reason for a missing number.
    pub reason: Option<String>,
    /// Primary command buffers executed.
    pub command_buffers: u64,
    /// Draw calls executed.
    pub draws: u64,
    /// Calls of vkQueueSubmit and vkQueueSubmit2.
    pub queue_submits: u64,
    /// The invocations of each execution of a primary command buffer, in the order in which they were read.
    pub by_submit: Vec<Counted>,
}

/// Counts of one execution of a primary command buffer.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Counted {
    /// CPU time of the process when it was submitted (CLOCK_PROCESS_CPUTIME_ID), nanoseconds.
    pub process_cpu_ns: u64,
    /// The count.
    pub value: u64,
}

/// Samples that passed depth and stencil tests on one device, in the render passes that the application began.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize, Deserialize)]
pub struct SampleCount {
    /// Number of samples; None if something could not be counted.
    pub samples: Option<u64>,
    /// Reason for a missing number.
    pub reason: Option<String>,
    /// Render passes that were executed and counted.
    pub passes: u64,
    /// The samples of each execution of a primary command buffer, in the order in which they were read.
    pub by_submit: Vec<Counted>,
}

/// Times of primary command buffers on one device.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize, Deserialize)]
pub struct GpuTimes {
    /// Each execution of each, in the order in which they were read.
    pub buffers: Vec<GpuTime>,
    /// Reason why these are not all; none where they are.
    pub reason: Option<String>,
}

/// Time of one execution of a primary command buffer.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct GpuTime {
    /// CPU time of the process when it was submitted (CLOCK_PROCESS_CPUTIME_ID), nanoseconds.
    pub process_cpu_ns: u64,
    /// From the end of all before it to its own end, on the GPU, nanoseconds.
    pub gpu_ns: u64,
}

/// Kind of count of a layer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kind {
    Invocations,
    Samples,
    Times,
}

/// A layer that counts.
trait Counting: Layer {
    fn counter(&self) -> &Counter;
}

/// State of a device.
pub(crate) struct Counter {
    kind: Kind,
    next: NextDevice,
    functions: Functions,
    inherited_queries: bool,
    buffers: Mutex<Buffers>,
}

functions! {
    /// The next layer's functions that it may lack.
    Functions {
        queue_submit2: PFN_vkQueueSubmit2 = c"vkQueueSubmit2" | c"vkQueueSubmit2KHR";
        begin_render_pass2: PFN_vkCmdBeginRenderPass2 = c"vkCmdBeginRenderPass2" | c"vkCmdBeginRenderPass2KHR";
        end_render_pass2: PFN_vkCmdEndRenderPass2 = c"vkCmdEndRenderPass2" | c"vkCmdEndRenderPass2KHR";
        begin_rendering: PFN_vkCmdBeginRendering = c"vkCmdBeginRendering" | c"vkCmdBeginRenderingKHR";
        end_rendering: PFN_vkCmdEndRendering = c"vkCmdEndRendering" | c"vkCmdEndRenderingKHR";
    }
}

impl Counter {
    /// # Safety
    ///
    /// As for [`Layer::create_device`].
    unsafe fn new(
        kind: Kind,
        instance: &Instance,
        physical_device: vk::PhysicalDevice,
        info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<Self, vk::Result> {
        // SAFETY: the caller vouches for handle and structure.
        unsafe {
            let features = Features::of(kind, instance, physical_device);
            let (next, missing) = features.amend(info, create)?;
            let families = features::families(instance, physical_device);
            let steps_ns = features.timestamp_period_ns;
            Ok(Self {
                kind,
                functions: Functions::load(|name| next.function(name)),
                inherited_queries: features.inherited_queries,
                buffers: Mutex::new(Buffers::new(
                    kind,
                    next.functions.clone(),
                    (families, steps_ns),
                    missing,
                )),
                next,
            })
        }
    }

    /// State of the command buffers. Held while queries of this layer's own are read, which cannot come back to it.
    fn buffers(&self) -> MutexGuard<'_, Buffers> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
