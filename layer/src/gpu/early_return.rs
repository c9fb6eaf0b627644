//! Objects of an application's pipelines with a test of ours in front of their fragment shader: their own layout with one more set behind,
//! the pipeline itself, and that set.

use super::compute::{ComputeLayout, ComputeSet};
use super::pipeline::{graphics_pipeline, module_of_words};
use super::{DeviceBuffer, Gpu, GpuError, Owned};
use crate::abi::copies::slice;
use ash::vk;
use parafovea_core::mask::EarlyReturnParams;
use smallvec::SmallVec;
use std::sync::Arc;

/// Template, parameters.
const BINDINGS: [vk::DescriptorType; 2] =
    [vk::DescriptorType::STORAGE_BUFFER, vk::DescriptorType::UNIFORM_BUFFER];

/// The layout of the set.
pub(crate) struct ReturnLayout(ComputeLayout);

impl ReturnLayout {
    /// Makes it.
    ///
    /// # Errors
    /// A failed call.
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        ComputeLayout::for_stage(gpu, &BINDINGS, vk::ShaderStageFlags::FRAGMENT).map(Self)
    }

    /// Number of storage buffers that it takes, and of uniform ones.
    pub(crate) const BUFFERS: u32 = 1;
}

/// A pipeline layout of the application's with the set behind its own. The two are compatible for all sets of the
/// application's, and for push constants (Vulkan specification, "Pipeline Layout Compatibility").
pub(crate) struct AppendedLayout {
    handle: Owned<vk::PipelineLayout>,
    set: u32,
}

impl AppendedLayout {
    /// Appends to the layout of `info`.
    ///
    /// # Safety
    /// `info` is valid (valid usage of vkCreatePipelineLayout) on the device of `gpu`, which takes a set and as many buffers more.
    ///
    /// # Errors
    /// A failed call.
    pub(crate) unsafe fn new(
        gpu: &Arc<Gpu>,
        info: &vk::PipelineLayoutCreateInfo<'_>,
        appended: &ReturnLayout,
    ) -> Result<Self, GpuError> {
        // SAFETY: valid usage demands so many layouts.
        let own = unsafe { slice(info.p_set_layouts, info.set_layout_count) };
        let sets: SmallVec<[vk::DescriptorSetLayout; 8]> =
            own.iter().copied().chain([appended.0.set_layout()]).collect();
        let amended = vk::PipelineLayoutCreateInfo {
            set_layout_count: sets.len() as u32,
            p_set_layouts: sets.as_ptr(),
            ..*info
        };
        // SAFETY: the structure is valid with one set more, as `# Safety` demands; the layout is a new one, and no other code destroys it.
        let handle = unsafe {
            let handle = gpu
                .device
                .create_pipeline_layout(&amended, None)
                .map_err(GpuError::from_call("vkCreatePipelineLayout"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_pipeline_layout(handle, None))
        };
        Ok(Self { handle, set: own.len() as u32 })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::PipelineLayout {
        self.handle.handle()
    }

    /// Number of the set.
    pub(crate) fn set(&self) -> u32 {
        self.set
    }
}

/// The set over one template.
pub(crate) struct ReturnSet {
    // In the order in which each may be destroyed.
    set: ComputeSet,
    _params: DeviceBuffer,
    _layout: Arc<ReturnLayout>,
}

impl ReturnSet {
    /// Over the storage buffer `template`, which outlives the result.
    ///
    /// # Errors
    /// A failed call.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        layout: &Arc<ReturnLayout>,
        template: vk::Buffer,
        params: EarlyReturnParams,
    ) -> Result<Self, GpuError> {
        let uniform = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let params = DeviceBuffer::holding(gpu, uniform, bytemuck::bytes_of(&params))?;
        let set = ComputeSet::of_buffers(&layout.0, &[template, params.handle()])?;
        Ok(Self { set, _params: params, _layout: Arc::clone(layout) })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::DescriptorSet {
        self.set.handle()
    }
}

/// A render pass of ours that is compatible with one of the application's.
pub(crate) struct CompatiblePass(Owned<vk::RenderPass>);

impl CompatiblePass {
    /// Takes ownership.
    ///
    /// # Safety
    /// The render pass was created on the device of `gpu`, and is not destroyed elsewhere.
    pub(crate) unsafe fn new(gpu: &Arc<Gpu>, handle: vk::RenderPass) -> Self {
        // SAFETY: the render pass is of this device and no other code destroys it, as `# Safety` demands.
        Self(unsafe { Owned::new(gpu, handle, |device, handle| device.destroy_render_pass(handle, None)) })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::RenderPass {
        self.0.handle()
    }
}

/// Makes the pipeline of `info`, whose stages get modules of this code, one each.
///
/// # Safety
/// But for its modules, `info` is valid (valid usage of vkCreateGraphicsPipelines) on the device of `gpu`, and so is the code.
///
/// # Errors
/// A failed call.
pub(crate) unsafe fn pipeline_of_code(
    gpu: &Arc<Gpu>,
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    code: &[&[u32]],
) -> Result<Owned<vk::Pipeline>, GpuError> {
    // SAFETY: valid usage demands so many stages.
    let mut stages: SmallVec<[vk::PipelineShaderStageCreateInfo<'_>; 4]> =
        unsafe { slice(info.p_stages, info.stage_count) }.into();
    let mut modules: SmallVec<[Owned<vk::ShaderModule>; 4]> = SmallVec::new();
    for (stage, words) in stages.iter_mut().zip(code) {
        // SAFETY: the code is valid, as `# Safety` demands.
        let module = unsafe { module_of_words(gpu, words)? };
        stage.module = module.handle();
        modules.push(module);
    }
    let info = vk::GraphicsPipelineCreateInfo { p_stages: stages.as_ptr(), ..*info };
    // SAFETY: the structure is valid, as `# Safety` demands, with a live module for each stage.
    unsafe { graphics_pipeline(gpu, &info) }
}
