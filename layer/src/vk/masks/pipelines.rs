//! What pipelines do that a mask must know.

use super::recipe::{Ingredients, PassOf, Recipe, dynamic_states};
use super::{Masks, Returning};
use crate::gpu::is_left;
use crate::mask::PipelineFacts;
use crate::vk::rates::pipeline::{Parts, is_discarded, libraries, own_parts};
use crate::vk::shader_modules::ShaderModules;
use ash::vk;
use std::slice;
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Masks {
    /// A shader module was created.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateShaderModule).
    pub unsafe fn add_shader_module(&self, module: vk::ShaderModule, info: &vk::ShaderModuleCreateInfo<'_>) {
        // SAFETY: the caller vouches for the code.
        unsafe {
            self.modules.add(module, info);
            self.codes.add(module, info);
        }
    }

    /// A shader module is about to be destroyed.
    pub fn forget_shader_module(&self, module: vk::ShaderModule) {
        self.modules.forget(module);
        self.codes.forget(module);
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
                if !dynamic_states(info).iter().all(|state| is_left(*state)) {
                    self.extends_dynamic.store(true, Ordering::Relaxed);
                }
                if pipeline != vk::Pipeline::null() {
                    let mut facts = self.facts(info);
                    match self.recipe(info, facts) {
                        Some(returning) => {
                            facts.returns = returning.facts();
                            self.returning.insert(pipeline, Arc::new(returning));
                        }
                        None => drop(self.returning.remove(pipeline)),
                    }
                    self.pipelines.insert(pipeline, facts);
                }
            }
        }
    }

    /// A pipeline is about to be destroyed.
    pub fn forget_pipeline(&self, pipeline: vk::Pipeline) {
        self.pipelines.remove(pipeline);
        drop(self.returning.remove(pipeline));
    }

    /// What a pipeline does.
    pub fn pipeline(&self, pipeline: vk::Pipeline) -> PipelineFacts {
        self.pipelines.get(pipeline).unwrap_or(PipelineFacts::UNKNOWN)
    }

    /// What it takes to have the fragment shader of a pipeline return early; nothing where it must not, or something is not known.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreateGraphicsPipelines.
    unsafe fn recipe(
        &self,
        info: &vk::GraphicsPipelineCreateInfo<'_>,
        facts: PipelineFacts,
    ) -> Option<Returning> {
        let whole = Parts::PRE_RASTERIZATION_SHADERS
            | Parts::FRAGMENT_SHADER
            | Parts::VERTEX_INPUT_INTERFACE
            | Parts::FRAGMENT_OUTPUT_INTERFACE;
        // What a fragment shader does besides drawing, it does for every fragment.
        if facts.have_side_effects {
            return None;
        }
        // SAFETY: the caller vouches for the structure; what belongs to a whole pipeline is valid.
        unsafe {
            if own_parts(info) != whole || !libraries(info).is_empty() || is_discarded(info, whole) {
                return None;
            }
            let stages = slice::from_raw_parts(info.p_stages, info.stage_count as usize);
            let mesh = vk::ShaderStageFlags::MESH_EXT | vk::ShaderStageFlags::TASK_EXT;
            if stages.iter().any(|stage| mesh.contains(stage.stage)) {
                return None;
            }
            let fragment = stages.iter().find(|stage| stage.stage == vk::ShaderStageFlags::FRAGMENT)?;
            let render_pass = match info.render_pass {
                pass if pass == vk::RenderPass::null() => None,
                pass => {
                    let known = self.compatible.get(pass)?;
                    let subpass = known.description.subpasses.get(info.subpass as usize)?;
                    if subpass.colors.iter().all(Option::is_none) {
                        return None;
                    }
                    let (views, has_depth) = (subpass.view_mask, subpass.depth.is_some());
                    Some(PassOf { compatible: known.pass, views, has_depth })
                }
            };
            let layout = self.layout(info.layout)?;
            let code = |module| self.codes.get(module);
            let recipe = Recipe::of(info, Ingredients { code: &code, layout, render_pass })?;
            let effects = self.modules.effects(fragment);
            let by_alpha = dynamic_states(info).contains(&vk::DynamicState::ALPHA_TO_COVERAGE_ENABLE_EXT)
                || info
                    .p_multisample_state
                    .as_ref()
                    .is_some_and(|state| state.alpha_to_coverage_enable == vk::TRUE);
            let changes_coverage =
                by_alpha || effects.writes_depth_stencil || effects.uses_sample_mask || recipe.discards();
            Some(Returning::new(recipe, !changes_coverage))
        }
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
