//! The depth of the last pictures, of a swapchain that the application draws depth to: copied before it is the runtime's.

use super::Swapchain;
use super::create::runtime_images;
use super::history_memory::depth_is_refused;
use crate::config::{Config, ReuseMode, images_for_reuse, wants_reuse};
use crate::gpu::GpuError;
use crate::kernels::compose::{DepthShape, DepthSource, KeptDepth};
use crate::link::BACKEND_RATE_ATTACHMENT;
use crate::xr::session::{Active, Health, Tools};
use ash::vk;
use openxr_sys as xr;
use std::sync::{Arc, MutexGuard, PoisonError};

/// Whether depth can be copied.
#[derive(Default)]
pub enum Depth {
    /// It is of no eye's view, as far as is known: other views, such as the insets of quad views, are not completed.
    #[default]
    Unasked,
    /// Unknown until it is first copied.
    Unknown,
    Unavailable,
    Available {
        source: DepthSource,
        /// Number of the copy for the image that was released last; `None` if it has none.
        newest: Option<u64>,
    },
}

impl Depth {
    /// Whether copies are of use.
    fn is_asked(&self) -> bool {
        !matches!(self, Self::Unasked)
    }

    /// That of the image which was released last, for an eye's view, if it was copied. From now on it is.
    fn newest(&mut self) -> Option<NewestDepth> {
        match self {
            Self::Available { source, newest: Some(copy) } => {
                Some(NewestDepth { kept: Arc::clone(source.kept()), copy: *copy })
            }
            Self::Unasked => {
                *self = Self::Unknown;
                None
            }
            Self::Available { .. } | Self::Unknown | Self::Unavailable => None,
        }
    }

    /// Copies the depth of an image, which the application left in `layout`.
    fn with_copy(self, index: u32, layout: vk::ImageLayout) -> Self {
        let Self::Available { source, .. } = self else { return self };
        match source.copy(index, layout) {
            Ok(copy) => Self::Available { source, newest: Some(copy) },
            // The device is behind: this image has no depth copy.
            Err(GpuError::Timeout) => Self::Available { source, newest: None },
            Err(error) => {
                error.log("no reprojection with depth");
                Self::Unavailable
            }
        }
    }
}

/// The depth of the image that was released last.
#[derive(Clone, Debug)]
pub struct NewestDepth {
    /// The copies.
    pub kept: Arc<KeptDepth>,
    /// Number of its copy, counted from 1.
    pub copy: u64,
}

/// Whether the depth of a swapchain that is created so may be read: re-used tiles are followed by it as the head moves. Masks need depth
/// for themselves: where it is submitted, nothing is left out by them.
pub fn may_be_kept(active: &Active, config: &Config, info: &xr::SwapchainCreateInfo) -> bool {
    info.usage_flags.contains(xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT)
        && (info.sample_count, info.mip_count, info.face_count) == (1, 1, 1)
        && info.create_flags.is_empty()
        && is_wanted(active, config)
}

fn is_wanted(active: &Active, config: &Config) -> bool {
    wants_reuse(config)
        && config.reuse.mode == ReuseMode::On
        && active.device.capabilities.backend == BACKEND_RATE_ATTACHMENT
}

impl Swapchain {
    /// Copies the depth of the image that the application returns next, where that counts. In this call the queue is the runtime's,
    /// hence ours.
    pub(super) fn keep_depth(&self) {
        if !self.description.can_copy_depth() || !self.depth().is_asked() {
            return;
        }
        let Some(active) = &self.session.active else { return };
        let config = active.plan.config();
        let is_of_use =
            active.health() == Health::Works && is_wanted(active, &config) && active.plan.needs_depth();
        let tools = active.made_tools().filter(|_| is_of_use);
        let index = self.acquired_images().ready();
        // As OpenXR demands, where the Vulkan half does not know the image.
        let image = index.and_then(|index| self.images().get(index as usize).copied());
        let left = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        let left = image.map_or(left, |image| active.device.layout(image));
        // There the application may draw the next depth before it is copied.
        let index = index.filter(|_| image.is_none_or(|image| !active.device.is_used_on_other_queues(image)));
        // Never again after a panic.
        let known = std::mem::replace(&mut *self.depth(), Depth::Unavailable);
        let next = match (known, tools.zip(index)) {
            (Depth::Unknown, Some((tools, index))) => self.make_depth(tools, &config).with_copy(index, left),
            (Depth::Available { source, .. }, Some((_, index))) => {
                Depth::Available { source, newest: None }.with_copy(index, left)
            }
            (Depth::Available { source, .. }, None) => Depth::Available { source, newest: None },
            (known, _) => known,
        };
        *self.depth() = next;
    }

    fn make_depth(&self, tools: &Tools, config: &Config) -> Depth {
        let mut refused = None;
        let mut make = || {
            let images = runtime_images(&self.session, self.handle)
                .map_err(|result| format!("xrEnumerateSwapchainImages returned {result:?}"))?;
            let shape = self.description.depth_shape();
            let count = images_for_reuse(config);
            let taken = super::history_memory(self.session.handle).0;
            DepthSource::within(&tools.gpu, &shape, images, count, |memory| {
                refused = depth_is_refused(count, taken, memory);
                refused.is_none()
            })
            .map_err(|error| refused.map_or_else(|| error.to_string(), |reason| reason.to_string()))
        };
        match make() {
            Ok(source) => {
                let DepthShape { format, extent, array_layers } = *source.kept().shape();
                let (width, height) = (extent.width, extent.height);
                tracing::info!(
                    "depth of {width}x{height}x{array_layers} {format:?}: used for reprojection of head movement"
                );
                Depth::Available { source, newest: None }
            }
            Err(reason) => {
                tracing::info!("no reprojection with depth: {reason}");
                Depth::Unavailable
            }
        }
    }

    /// The depth of the image that the application released last, for an eye's view, if it was copied.
    pub(super) fn newest_depth(&self) -> Option<NewestDepth> {
        self.depth().newest()
    }

    /// Device memory of the copies, bytes.
    pub(super) fn depth_bytes(&self) -> u64 {
        match &*self.depth() {
            Depth::Available { source, .. } => source.kept().bytes(),
            Depth::Unasked | Depth::Unknown | Depth::Unavailable => 0,
        }
    }

    /// Lets the runtime's images go, after the work of ours that uses them.
    pub(super) fn end_keeping_depth(&self) {
        let depth = std::mem::replace(&mut *self.depth(), Depth::Unavailable);
        drop(depth);
    }

    fn depth(&self) -> MutexGuard<'_, Depth> {
        self.depth.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_copied_once_an_eye_shows_it() {
        let mut depth = Depth::default();
        assert!(!depth.is_asked(), "as that of an inset stays");
        assert!(depth.newest().is_none());
        assert!(depth.is_asked());
        depth = Depth::Unavailable;
        assert!(depth.newest().is_none() && matches!(depth, Depth::Unavailable));
    }
}
