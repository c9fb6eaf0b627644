//! Render passes.

mod describe;

use crate::pass_detection::PassFacts;
use ash::vk;
use smallvec::SmallVec;

/// A live render pass, as the application created it.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderPass {
    /// Its attachments.
    pub attachments: Vec<Attachment>,
    /// Its subpasses.
    pub subpasses: Vec<Subpass>,
    /// Attachments that any subpass draws colour to, each once.
    pub colors: SmallVec<[u32; 8]>,
    /// Attachments that any subpass resolves colour to, each once.
    pub resolves: SmallVec<[u32; 4]>,
    /// The first subpass's depth attachment, or that of the first that has one.
    pub depth: Option<u32>,
    /// The views of all subpasses (multiview); 0 without.
    pub view_mask: u32,
    /// Facts of every instance of it.
    pub facts: PassFacts,
}

/// One attachment of a render pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attachment {
    /// Its format.
    pub format: vk::Format,
    /// Samples of a pixel.
    pub samples: vk::SampleCountFlags,
    /// The load of colour or depth at the begin.
    pub load: vk::AttachmentLoadOp,
    /// The store of colour or depth at the end.
    pub store: vk::AttachmentStoreOp,
    /// The load of stencil at the begin.
    pub stencil_load: vk::AttachmentLoadOp,
    /// The store of stencil at the end.
    pub stencil_store: vk::AttachmentStoreOp,
    /// Layout at the begin.
    pub initial_layout: vk::ImageLayout,
    /// Layout at the end.
    pub final_layout: vk::ImageLayout,
}

impl Attachment {
    /// Whether it has stencil that is stored.
    pub fn stores_stencil(&self) -> bool {
        describe::has_stencil(self.format) && self.stencil_store == vk::AttachmentStoreOp::STORE
    }
}

/// One subpass. Attachments are named by their index in the render pass.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Subpass {
    /// Colour attachments, by location.
    pub colors: SmallVec<[Option<u32>; 4]>,
    /// The resolve target of each of `colors`; empty without resolves.
    pub resolves: SmallVec<[Option<u32>; 4]>,
    /// Depth attachment, with its layout.
    pub depth: Option<(u32, vk::ImageLayout)>,
    /// Input attachments.
    pub inputs: SmallVec<[Option<u32>; 4]>,
    /// Multiview's mask; 0 without.
    pub view_mask: u32,
    /// Whether the application gives it rates of its own, or a density map.
    pub has_own_rates: bool,
    /// Whether depth or stencil is resolved at its end.
    pub resolves_depth: bool,
}

#[cfg(test)]
mod tests;
