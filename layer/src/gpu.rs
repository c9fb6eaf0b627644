//! Everything that records or owns Vulkan objects of ours on the application's device.

use crate::link::DeviceRecord;
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// Why our GPU work is not possible. The application is unaffected: the caller passes its frames through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// A Vulkan function that we need is not there.
    #[error("the device has no function {0:?}")]
    Missing(&'static CStr),
    /// The queue, a format or a size is not one that we can work with.
    #[error("not supported here: {0}")]
    Unsupported(&'static str),
    /// A fence of ours was not signalled in time: the device hangs, or is very busy.
    #[error("waited too long for work of ours to finish")]
    Timeout,
    /// A Vulkan call failed.
    #[error("{call} returned {result}")]
    Call {
        /// The call.
        call: &'static str,
        /// What it returned.
        result: vk::Result,
    },
}

/// One device of the application, with the queue that our work goes to.
pub struct Gpu {
    _queue: vk::Queue,
}

impl Gpu {
    /// Prepares work on queue `queue_index` of family `queue_family`.
    ///
    /// # Safety
    /// `record` is of a live device that outlives the result and everything made with it (or
    /// [`Gpu::abandon`] is called before it dies), and the caller synchronises the queue during every call.
    ///
    /// # Errors
    /// [`GpuError::Missing`], [`GpuError::Unsupported`], or a failed call.
    pub unsafe fn new(_record: &DeviceRecord, _queue_family: u32, _queue_index: u32) -> Result<Arc<Self>, GpuError> {
        Err(GpuError::Unsupported("not built yet"))
    }

    /// The device is lost or about to be destroyed: from now on nothing is waited for and nothing destroyed.
    pub fn abandon(&self) {}
}
