//! Compute over tiles of two textures: parameters at a dynamic offset, a list, and results that the host reads.

use super::descriptor::{CompareSet, texture_layout};
use super::pipeline::shader_module;
use super::pipeline_layout::PipelineLayout;
use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// A pipeline with its layout.
pub(crate) struct Comparison {
    pipeline: Owned<vk::Pipeline>,
    layout: PipelineLayout,
}

impl Comparison {
    /// Of an entry point of a module of SPIR-V: set 0 is a [`CompareSet`], sets 1 and 2 are of [`super::TextureSets`], and, with
    /// depth, set 3.
    pub(super) fn make(
        gpu: &Arc<Gpu>,
        spirv: &[u8],
        entry: &CStr,
        has_depth: bool,
    ) -> Result<Self, GpuError> {
        let module = shader_module(gpu, spirv)?;
        let (parameters, texture) = (CompareSet::layout(gpu)?, texture_layout(gpu)?);
        let layout = PipelineLayout::new(gpu, parameters, texture, if has_depth { 3 } else { 2 })?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module.handle())
            .name(entry);
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout.handle());
        let cache = gpu.pipeline_cache()?;
        // SAFETY: everything named is live; the build has validated the module and the entry points' interface.
        let pipeline = unsafe {
            let handles = gpu
                .device
                .create_compute_pipelines(cache, &[info], None)
                .map_err(|(_, result)| GpuError::Call { call: "vkCreateComputePipelines", result })?;
            Owned::new(gpu, handles[0], |device, handle| device.destroy_pipeline(handle, None))
        };
        Ok(Self { pipeline, layout })
    }

    pub(super) fn handle(&self) -> vk::Pipeline {
        self.pipeline.handle()
    }

    pub(super) fn layout(&self) -> vk::PipelineLayout {
        self.layout.handle()
    }
}
