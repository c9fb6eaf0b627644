//! Pipeline layouts that keep their descriptor set layouts alive.
//!
//! The specification lets an application destroy a set layout once the pipeline layout is made, but binding sets of
//! another set layout then relies on a comparison with a destroyed object: newer validation reports each such bind,
//! and drivers have had bugs there.

use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;

/// A pipeline layout with the set layouts that it was made from.
pub(super) struct PipelineLayout {
    // Dropped in this order.
    handle: Owned<vk::PipelineLayout>,
    _sets: [Owned<vk::DescriptorSetLayout>; 2],
}

impl PipelineLayout {
    /// Set 0 has the layout `parameters`, and each of the `textures` sets after it, at most 3, the layout `texture`.
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        parameters: Owned<vk::DescriptorSetLayout>,
        texture: Owned<vk::DescriptorSetLayout>,
        textures: usize,
    ) -> Result<Self, GpuError> {
        let sets = [parameters.handle(), texture.handle(), texture.handle(), texture.handle()];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets[..=textures]);
        // SAFETY: the device and both set layouts are live.
        let handle = unsafe {
            let handle = gpu
                .device
                .create_pipeline_layout(&info, None)
                .map_err(GpuError::from_call("vkCreatePipelineLayout"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_pipeline_layout(handle, None))
        };
        Ok(Self { handle, _sets: [parameters, texture] })
    }

    /// The handle, valid as long as `self`.
    pub(super) fn handle(&self) -> vk::PipelineLayout {
        self.handle.handle()
    }
}
