//! The mask of a pass that is being recorded.

use super::Pending;
use crate::backend::mask::{DepthWork, MaskMap};
use crate::gpu::{AppCommands, ImagePart};
use crate::pass_detection::Unmasked;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// A pass that is being recorded with a mask.
pub struct OpenMask {
    pub(super) map: Arc<MaskMap>,
    pub(super) method: OpenMethod,
    /// Whether nothing is filled after it, because nothing is coarse.
    pub(super) is_unfilled: bool,
    /// Images that are filled after it, with their formats and layouts then.
    pub(super) fills: SmallVec<[(ImagePart, vk::Format, vk::ImageLayout); 4]>,
    /// The same of several samples, depth among it.
    pub(super) pending: SmallVec<[Pending; 2]>,
}

/// Method that keeps its skipped fragments from being shaded.
pub(super) enum OpenMethod {
    Template(OpenDepth),
    Return(OpenEarlyReturn),
}

/// The early return of a pass's fragment shaders.
#[derive(Debug, Clone, Copy)]
pub struct OpenEarlyReturn {
    /// The set that they read.
    pub set: vk::DescriptorSet,
    /// Whether only those do that cover the same samples, with the same depth.
    pub keeps_coverage: bool,
    /// Reason for a missing template.
    pub(super) instead: Unmasked,
}

/// Depth of a pass with a template.
pub(super) struct OpenDepth {
    /// Its depth, as the template takes it.
    pub(super) depth: ImagePart,
    /// Whether an earlier pass of the command buffer had the template, which still holds.
    pub(super) is_covered: bool,
    /// Whether it has several samples.
    pub(super) is_multisampled: bool,
    pub(super) layouts: [vk::ImageLayout; 2],
    /// Further work on that depth, in this area, and its layout after the pass.
    pub(super) work: DepthWork,
    pub(super) area: vk::Rect2D,
    pub(super) final_layout: vk::ImageLayout,
}

impl OpenMask {
    /// Reason why it has no template, if it has none.
    pub(super) fn instead(&self) -> Option<Unmasked> {
        self.returns().map(|by| by.instead)
    }

    /// The mask of a template.
    pub fn template(&self) -> Option<&Arc<MaskMap>> {
        match self.method {
            OpenMethod::Template(_) => Some(&self.map),
            OpenMethod::Return(_) => None,
        }
    }

    /// Images of several samples that are filled after it.
    pub fn pending(&self) -> &[Pending] {
        &self.pending
    }

    /// The early return of its fragment shaders; `None` if it has a template.
    pub fn returns(&self) -> Option<OpenEarlyReturn> {
        match self.method {
            OpenMethod::Return(by) => Some(by),
            OpenMethod::Template(_) => None,
        }
    }

    /// Whether the commands ahead of the pass bind compute state and sets: a copied template does not.
    pub fn binds_ahead(&self) -> bool {
        match &self.method {
            OpenMethod::Template(depth) => depth.work.covers && !depth.is_covered,
            OpenMethod::Return(_) => false,
        }
    }

    /// Records the commands ahead of the pass.
    pub(super) fn record_ahead(&self, commands: &AppCommands) {
        match &self.method {
            OpenMethod::Template(depth) if depth.is_covered => {}
            OpenMethod::Template(depth) if depth.work.covers => {
                self.map.cover(commands, depth.depth, depth.area, depth.layouts[0]);
            }
            OpenMethod::Template(depth) => {
                self.map.begin(commands, depth.depth, depth.area, depth.layouts);
            }
            OpenMethod::Return(_) => {}
        }
    }

    /// Records the commands after it.
    pub(super) fn record_after(&self, commands: &AppCommands) {
        for &(part, format, layout) in &self.fills {
            self.map.end(commands, part, format, layout);
        }
        if let OpenMethod::Template(depth) = &self.method
            && depth.work.fills
            && !depth.is_multisampled
        {
            self.map.fill_depth(commands, depth.depth, depth.area, depth.final_layout);
        }
    }
}
