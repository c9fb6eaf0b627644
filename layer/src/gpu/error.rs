//! Why GPU work of ours is not possible.

use ash::vk;
use std::ffi::CStr;

/// Why our GPU work is not possible. The application is unaffected: the caller passes its frames through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// A Vulkan function that we need is not there.
    #[error("the device has no function {0:?}")]
    Missing(&'static CStr),
    /// The queue, a format, a size or a usage is not one that we can work with.
    #[error("not supported: {0}")]
    Unsupported(&'static str),
    /// The caller asked for something that makes no sense, such as an image index out of range.
    #[error("refused: {0}")]
    Invalid(&'static str),
    /// A fence of ours was not signalled in time: the device hangs, or is very busy.
    #[error("waited too long for work of ours to finish")]
    Timeout,
    /// The device was given up before, see [`super::Gpu::abandon`].
    #[error("the device was given up")]
    Abandoned,
    /// A Vulkan call failed.
    #[error("{call} returned {result:?}")]
    Call {
        /// The call.
        call: &'static str,
        /// What it returned.
        result: vk::Result,
    },
}

impl GpuError {
    /// For `map_err`: names the call that failed.
    pub(crate) fn from_call(call: &'static str) -> impl Fn(vk::Result) -> Self {
        move |result| Self::Call { call, result }
    }
}
