//! Reasons why GPU work of ours is not possible.

use ash::vk;
use std::ffi::CStr;
use std::sync::{Mutex, PoisonError};

/// Reason why GPU work of ours is not possible. The application is unaffected: the caller passes its frames through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// A Vulkan function that we need is not there.
    #[error("the device has no function {}", .0.to_string_lossy())]
    Missing(&'static CStr),
    /// A queue, format, size or usage that the layer does not support.
    #[error("not supported: {0}")]
    Unsupported(&'static str),
    /// The caller asked for something that makes no sense, such as an image index out of range.
    #[error("refused: {0}")]
    Invalid(&'static str),
    /// A fence of ours was not signalled in time: the device hangs, or is very busy.
    #[error("timed out waiting for the layer's own work")]
    Timeout,
    /// The layer has stopped using the device, see [`super::Gpu::abandon`].
    #[error("the layer stopped using this device after a failure")]
    Abandoned,
    /// A Vulkan call failed.
    #[error("{call} returned {result:?}")]
    Call {
        /// The call.
        call: &'static str,
        /// Its result.
        result: vk::Result,
    },
}

impl GpuError {
    /// For `map_err`: names the call that failed.
    pub(crate) fn from_call(call: &'static str) -> impl Fn(vk::Result) -> Self {
        move |result| Self::Call { call, result }
    }

    /// Logs the loss from this error, each loss once: as a warning where it is the first consequence of a cause, as information where
    /// others came before it.
    pub(crate) fn log(self, given_up: &str) {
        match self.first_line(given_up) {
            Some(Line::Cause) => tracing::warn!("{given_up}: {self}"),
            Some(Line::Consequence) => tracing::info!("{given_up}: {self}"),
            None => {}
        }
    }

    fn first_line(self, given_up: &str) -> Option<Line> {
        static LOGGED: Mutex<Vec<(GpuError, Vec<String>)>> = Mutex::new(Vec::new());
        let cause = match self {
            // Every call returns this result once the device is lost.
            Self::Call { result: vk::Result::ERROR_DEVICE_LOST, .. } => {
                Self::Call { call: "", result: vk::Result::ERROR_DEVICE_LOST }
            }
            other => other,
        };
        let mut logged = LOGGED.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((_, consequences)) = logged.iter_mut().find(|(known, _)| *known == cause) else {
            logged.push((cause, vec![given_up.to_owned()]));
            // Something else was logged before the device was given up.
            return Some(if cause == Self::Abandoned { Line::Consequence } else { Line::Cause });
        };
        if consequences.iter().any(|known| known == given_up) || consequences.len() >= MOST_CONSEQUENCES {
            return None;
        }
        consequences.push(given_up.to_owned());
        Some(Line::Consequence)
    }
}

/// So many are logged of each cause.
const MOST_CONSEQUENCES: usize = 32;

/// A line that the log does not have yet.
#[derive(Debug, PartialEq, Eq)]
enum Line {
    Cause,
    Consequence,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_told_once_and_so_is_each_of_its_consequences() {
        let call = |call| GpuError::Call { call, result: vk::Result::ERROR_OUT_OF_HOST_MEMORY };
        let one = call("a call of a test");
        assert_eq!(one.first_line("a"), Some(Line::Cause));
        assert_eq!(one.first_line("b"), Some(Line::Consequence));
        assert_eq!([one.first_line("a"), one.first_line("b")], [None, None]);
        assert_eq!(call("another call of a test").first_line("a"), Some(Line::Cause));
        assert_eq!(GpuError::Abandoned.first_line("a"), Some(Line::Consequence));
        for number in 0..2 * MOST_CONSEQUENCES {
            one.first_line(&number.to_string());
        }
        assert_eq!(one.first_line("c"), None);
    }

    #[test]
    fn a_lost_device_is_told_of_once_whoever_finds_it() {
        let lost = |call| GpuError::Call { call, result: vk::Result::ERROR_DEVICE_LOST };
        assert_eq!(lost("vkQueueSubmit").first_line("a"), Some(Line::Cause));
        assert_eq!(lost("vkWaitForFences").first_line("b"), Some(Line::Consequence));
    }
}
