//! The creation of shader modules and graphics pipelines.

use super::attach::Rates;
use super::copies::{Copies, room, slice};
use super::pipeline::{PipelineRate, with_rates};
use crate::abi::guard;
use crate::gpu::GpuError;
use crate::vk::device;
use ash::vk;

const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;

impl Rates {
    /// A pipeline is about to be destroyed.
    pub fn forget_pipeline(&self, pipeline: vk::Pipeline) {
        self.pipelines.remove(pipeline);
    }

    /// What is to be set when a pipeline is bound, or what the application sets for it; nothing where its rate is its
    /// own.
    pub fn pipeline_rate(&self, pipeline: vk::Pipeline) -> Option<PipelineRate> {
        self.pipelines.get(pipeline)
    }

    /// `vkCreateGraphicsPipelines`, amended for rate attachments. If that fails, the call is repeated as
    /// the application made it, for all of its pipelines: that keeps the specification's rules on early returns and
    /// pipelines derived from others in the same call.
    ///
    /// # Safety
    ///
    /// The arguments of the call; functions of the device's next layer.
    #[allow(clippy::too_many_arguments, reason = "those of the call")]
    pub unsafe fn create_pipelines(
        &self,
        device: vk::Device,
        cache: vk::PipelineCache,
        count: u32,
        infos: *const vk::GraphicsPipelineCreateInfo<'_>,
        allocator: *const vk::AllocationCallbacks<'_>,
        made: *mut vk::Pipeline,
        (next, destroy): (vk::PFN_vkCreateGraphicsPipelines, Option<vk::PFN_vkDestroyPipeline>),
    ) -> vk::Result {
        // SAFETY: the caller vouches for the arguments; handles are written also where some are null.
        unsafe {
            let mut room = room::<128>();
            let mut copies = Copies::new(&mut room);
            let (amended, rates): (Vec<_>, Vec<_>) = slice(infos, count)
                .iter()
                .map(|info| {
                    with_rates(
                        info,
                        &self.offer,
                        |stage| self.modules.effects(stage),
                        |library| self.pipelines.get(library),
                        &mut copies,
                    )
                })
                .unzip();
            let result = next(device, cache, count, amended.as_ptr(), allocator, made);
            if may_be_ours(result) {
                // Structures of the application that were amended in place become its own again.
                drop((amended, copies));
                GpuError::Call { call: "vkCreateGraphicsPipelines", result }
                    .tell("pipelines stay unchanged, at 1x1");
                for &pipeline in slice(made.cast_const(), count) {
                    if let (Some(destroy), true) = (destroy, pipeline != vk::Pipeline::null()) {
                        destroy(device, pipeline, allocator);
                    }
                }
                if slice(infos, count).iter().any(|info| info.render_pass == vk::RenderPass::null()) {
                    self.leave_rendering_alone();
                }
                return next(device, cache, count, infos, allocator, made);
            }
            for (&pipeline, rate) in slice(made.cast_const(), count).iter().zip(rates) {
                if pipeline != vk::Pipeline::null() && rate != PipelineRate::Fixed {
                    self.pipelines.insert(pipeline, rate);
                }
            }
            result
        }
    }
}

/// Whether a creation may have failed because of our additions, so that it is worth repeating without them. Positive
/// codes are no failures: `PIPELINE_COMPILE_REQUIRED` is the answer to a question of the application's.
pub(super) fn may_be_ours(result: vk::Result) -> bool {
    result.as_raw() < 0 && result != vk::Result::ERROR_DEVICE_LOST
}

/// `vkCreateShaderModule`.
pub unsafe extern "system" fn create_shader_module(
    device: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    module: *mut vk::ShaderModule,
) -> vk::Result {
    guard(
        "vkCreateShaderModule",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_shader_module(device, info, allocator, module), FAILED)
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `module` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_shader_module) else {
                    return FAILED;
                };
                let result = answer.record(next(device, info, allocator, module));
                if result == vk::Result::SUCCESS {
                    if let Some(rates) = known.rates() {
                        rates.modules.add(*module, &*info);
                    }
                    if let Some(masks) = known.masks() {
                        masks.add_shader_module(*module, &*info);
                    }
                }
                result
            }
        },
    )
}

/// `vkDestroyShaderModule`.
pub unsafe extern "system" fn destroy_shader_module(
    device: vk::Device,
    module: vk::ShaderModule,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyShaderModule",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_shader_module(device, module, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_shader_module) else {
                    return;
                };
                if let Some(rates) = known.rates() {
                    rates.modules.forget(module);
                }
                if let Some(masks) = known.masks() {
                    masks.forget_shader_module(module);
                }
                next(device, module, allocator);
                answer.made();
            }
        },
    );
}

/// `vkCreateGraphicsPipelines`.
pub unsafe extern "system" fn create_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Pipeline,
) -> vk::Result {
    guard(
        "vkCreateGraphicsPipelines",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_graphics_pipelines(device, cache, count, infos, allocator, made),
                FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_graphics_pipelines) else {
                    return FAILED;
                };
                let result = answer.record(match known.rates() {
                    Some(rates) => {
                        let functions = (next, known.hooked.destroy_pipeline);
                        rates.create_pipelines(device, cache, count, infos, allocator, made, functions)
                    }
                    None => next(device, cache, count, infos, allocator, made),
                });
                // Where some failed, those are null.
                if let (Some(masks), true) = (known.masks(), result.as_raw() >= 0) {
                    masks.add_pipelines(infos, made, count);
                }
                result
            }
        },
    )
}

/// `vkDestroyPipeline`.
pub unsafe extern "system" fn destroy_pipeline(
    device: vk::Device,
    pipeline: vk::Pipeline,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyPipeline",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_pipeline(device, pipeline, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_pipeline) else { return };
                if let Some(rates) = known.rates() {
                    rates.forget_pipeline(pipeline);
                }
                if let Some(masks) = known.masks() {
                    masks.forget_pipeline(pipeline);
                }
                next(device, pipeline, allocator);
                answer.made();
            }
        },
    );
}
