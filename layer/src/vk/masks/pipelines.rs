//! What pipelines do that a mask must know.

use super::Masks;
use crate::mask::PipelineFacts;
use crate::vk::rates::pipeline::{Parts, is_discarded, libraries, own_parts};
use crate::vk::shader_modules::ShaderModules;
use ash::vk;
use std::slice;

impl Masks {
    /// A shader module was created.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateShaderModule).
    pub unsafe fn add_shader_module(&self, module: vk::ShaderModule, info: &vk::ShaderModuleCreateInfo<'_>) {
        // SAFETY: the caller vouches for the code.
        unsafe { self.modules.add(module, info) };
    }

    /// A shader module is about to be destroyed.
    pub fn forget_shader_module(&self, module: vk::ShaderModule) {
        self.modules.forget(module);
    }

    /// Facts of modules' fragment shaders.
    pub fn shader_modules(&self) -> &ShaderModules {
        &self.modules
    }

    /// Pipelines are made of `infos`.
    ///
    /// # Safety
    ///
    /// The structures are valid (valid usage of vkCreateGraphicsPipelines); as many pipelines were written, some of which
    /// may be null.
    pub unsafe fn add_pipelines(
        &self,
        infos: *const vk::GraphicsPipelineCreateInfo<'_>,
        pipelines: *const vk::Pipeline,
        count: u32,
    ) {
        if count == 0 {
            return;
        }
        // SAFETY: the caller vouches for both arrays.
        unsafe {
            let infos = slice::from_raw_parts(infos, count as usize);
            let pipelines = slice::from_raw_parts(pipelines, count as usize);
            for (info, &pipeline) in infos.iter().zip(pipelines) {
                if pipeline != vk::Pipeline::null() {
                    self.pipelines.insert(pipeline, self.facts(info));
                }
            }
        }
    }

    /// A pipeline is about to be destroyed.
    pub fn forget_pipeline(&self, pipeline: vk::Pipeline) {
        self.pipelines.remove(pipeline);
    }

    /// What a pipeline does.
    pub fn pipeline(&self, pipeline: vk::Pipeline) -> PipelineFacts {
        self.pipelines.get(pipeline).unwrap_or(PipelineFacts::UNKNOWN)
    }

    /// # Safety
    ///
    /// Valid usage of vkCreateGraphicsPipelines.
    unsafe fn facts(&self, info: &vk::GraphicsPipelineCreateInfo<'_>) -> PipelineFacts {
        // SAFETY: the caller vouches for the structure and its chain; the parts that are its own are valid.
        unsafe {
            let mut facts = PipelineFacts::default();
            for &library in libraries(info) {
                facts.see(self.pipeline(library));
            }
            let own = own_parts(info);
            if !own.contains(Parts::FRAGMENT_SHADER) || is_discarded(info, own) {
                return facts;
            }
            let stages = match info.stage_count {
                0 => &[][..],
                count => slice::from_raw_parts(info.p_stages, count as usize),
            };
            for stage in stages.iter().filter(|stage| stage.stage == vk::ShaderStageFlags::FRAGMENT) {
                let effects = self.modules.effects(stage);
                facts.have_side_effects |= effects.stores || effects.interlocks;
            }
            let is_dynamic = |state| {
                info.p_dynamic_state.as_ref().is_some_and(|dynamic| match dynamic.dynamic_state_count {
                    0 => false,
                    count => slice::from_raw_parts(dynamic.p_dynamic_states, count as usize).contains(&state),
                })
            };
            if let Some(tests) = info.p_depth_stencil_state.as_ref() {
                let tests_stencil = tests.stencil_test_enable == vk::TRUE
                    || is_dynamic(vk::DynamicState::STENCIL_TEST_ENABLE);
                let keeps = |face: &vk::StencilOpState| {
                    [face.fail_op, face.pass_op, face.depth_fail_op]
                        .iter()
                        .all(|op| *op == vk::StencilOp::KEEP)
                };
                let keeps =
                    keeps(&tests.front) && keeps(&tests.back) && !is_dynamic(vk::DynamicState::STENCIL_OP);
                facts.write_stencil |= tests_stencil && !keeps;
            }
            if let Some(tests) = info.p_depth_stencil_state.as_ref()
                && tests.depth_test_enable == vk::TRUE
            {
                facts.directions.see(tests.depth_compare_op);
            }
            facts
        }
    }
}
