//! Effects of pipelines that a mask must know.

use super::recipe::{Ingredients, PassOf, Recipe};
use super::{EarlyReturnPipeline, Masks};
use crate::abi::copies::{find, slice};
use crate::backend::mask::{DynamicStencil, PipelineFacts};
use crate::gpu::is_left;
use crate::vk::shaders::ShaderModules;
use crate::vk::shaders::parts::{Parts, dynamic_states, is_discarded, libraries, own_parts};
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Masks {
    /// A shader module was created.
    ///
    /// # Safety
    ///
    /// `info` is valid (valid usage of vkCreateShaderModule).
    pub unsafe fn add_shader_module(&self, module: vk::ShaderModule, info: &vk::ShaderModuleCreateInfo<'_>) {
        // SAFETY: the code is valid, by the valid usage of vkCreateShaderModule.
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
        // SAFETY: both arrays have so many elements, as `# Safety` demands.
        let (infos, pipelines) = unsafe { (slice(infos, count), slice(pipelines, count)) };
        for (info, &pipeline) in infos.iter().zip(pipelines) {
            // SAFETY: the structure is valid, as `# Safety` demands.
            if !unsafe { dynamic_states(info) }.iter().all(|state| is_left(*state)) {
                self.extends_dynamic.store(true, Ordering::Relaxed);
            }
            if pipeline != vk::Pipeline::null() {
                // SAFETY: as above.
                let (mut facts, returning) = unsafe {
                    let facts = self.facts(info);
                    (facts, self.recipe(info, facts))
                };
                match returning {
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

    /// A pipeline is about to be destroyed.
    pub fn forget_pipeline(&self, pipeline: vk::Pipeline) {
        self.pipelines.remove(pipeline);
        drop(self.returning.remove(pipeline));
    }

    /// Effects of a pipeline.
    pub fn pipeline(&self, pipeline: vk::Pipeline) -> PipelineFacts {
        self.pipelines.get(pipeline).unwrap_or(PipelineFacts::UNKNOWN)
    }

    /// The recipe of a pipeline whose fragment shader returns early; `None` where it must not, or something is unknown.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreateGraphicsPipelines.
    unsafe fn recipe(
        &self,
        info: &vk::GraphicsPipelineCreateInfo<'_>,
        facts: PipelineFacts,
    ) -> Option<EarlyReturnPipeline> {
        let whole = Parts::PRE_RASTERIZATION_SHADERS
            | Parts::FRAGMENT_SHADER
            | Parts::VERTEX_INPUT_INTERFACE
            | Parts::FRAGMENT_OUTPUT_INTERFACE;
        // Side effects of a fragment shader must occur for every fragment.
        if facts.have_side_effects {
            return None;
        }
        // SAFETY: valid usage demands a valid chain, and rasterisation state of the pipelines that have all parts.
        if unsafe { own_parts(info) != whole || !libraries(info).is_empty() || is_discarded(info, whole) } {
            return None;
        }
        // SAFETY: as above: such pipelines have so many stages, and valid multisample and dynamic state.
        let (stages, multisample, dynamic) = unsafe {
            let stages = slice(info.p_stages, info.stage_count);
            (stages, info.p_multisample_state.as_ref(), dynamic_states(info))
        };
        let mesh = vk::ShaderStageFlags::MESH_EXT | vk::ShaderStageFlags::TASK_EXT;
        if stages.iter().any(|stage| mesh.contains(stage.stage)) {
            return None;
        }
        let fragment = stages.iter().find(|stage| stage.stage == vk::ShaderStageFlags::FRAGMENT)?;
        let render_pass = match info.render_pass {
            // SAFETY: valid usage demands a valid chain.
            pass if pass == vk::RenderPass::null() && unsafe { renders_colour(info) } => None,
            pass if pass == vk::RenderPass::null() => return None,
            pass => Some(self.pass_of(pass, info.subpass)?),
        };
        let layout = self.layout(info.layout)?;
        // SAFETY: the pipeline has all parts and rasterises, to a pass with colour where it has a render pass; layout and pass are of
        // this device.
        let recipe = unsafe { Recipe::of(info, Ingredients { codes: &self.codes, layout, render_pass })? };
        // SAFETY: the stage is valid, as above.
        let effects = unsafe { self.modules.effects(fragment) };
        let by_alpha = dynamic.contains(&vk::DynamicState::ALPHA_TO_COVERAGE_ENABLE_EXT)
            || multisample.is_some_and(|state| state.alpha_to_coverage_enable == vk::TRUE);
        let changes_coverage =
            by_alpha || effects.writes_depth_stencil || effects.uses_sample_mask || recipe.discards();
        Some(EarlyReturnPipeline::new(recipe, !changes_coverage))
    }

    /// A subpass as recipes take it; `None` if it has no colour, or is unknown.
    fn pass_of(&self, pass: vk::RenderPass, subpass: u32) -> Option<PassOf> {
        let known = self.compatible.get(pass)?;
        let subpass = known.description.subpasses.get(subpass as usize)?;
        if subpass.colors.iter().all(Option::is_none) {
            return None;
        }
        let (views, has_depth) = (subpass.view_mask, subpass.depth.is_some());
        Some(PassOf { compatible: known.pass, views, has_depth })
    }

    /// Whether the pipeline's subpass, of a render pass, has depth or stencil; false if it is unknown.
    fn has_depth(&self, info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
        let known = self.compatible.get(info.render_pass);
        let subpass = known.as_ref().and_then(|known| known.description.subpasses.get(info.subpass as usize));
        subpass.is_some_and(|subpass| subpass.depth.is_some())
    }

    /// # Safety
    ///
    /// Valid usage of vkCreateGraphicsPipelines.
    unsafe fn facts(&self, info: &vk::GraphicsPipelineCreateInfo<'_>) -> PipelineFacts {
        let mut facts = PipelineFacts::default();
        // SAFETY: valid usage demands a valid chain.
        let (libraries, own) = unsafe { (libraries(info), own_parts(info)) };
        for &library in libraries {
            facts.see(self.pipeline(library));
        }
        // SAFETY: valid usage demands valid state of the parts that are its own.
        if !own.contains(Parts::FRAGMENT_SHADER) || unsafe { is_discarded(info, own) } {
            return facts;
        }
        // Without depth and stencil in the pass, valid usage leaves the pointer open.
        let has_depth = if info.render_pass == vk::RenderPass::null() {
            // SAFETY: valid usage demands a valid chain.
            unsafe { may_render_depth(info, own) }
        } else {
            self.has_depth(info)
        };
        // SAFETY: as above: stages and tests are of the part with the fragment shader, and dynamic state of all.
        let (stages, tests, dynamic) = unsafe {
            let stages = slice(info.p_stages, info.stage_count);
            let tests = if has_depth { info.p_depth_stencil_state.as_ref() } else { None };
            (stages, tests, dynamic_states(info))
        };
        for stage in stages.iter().filter(|stage| stage.stage == vk::ShaderStageFlags::FRAGMENT) {
            // SAFETY: the stage is valid, as above.
            let effects = unsafe { self.modules.effects(stage) };
            facts.have_side_effects |= effects.stores || effects.interlocks;
        }
        let is_dynamic = |state| dynamic.contains(&state);
        let (write_stencil, dynamic_stencil) = stencil(tests, is_dynamic);
        facts.write_stencil |= write_stencil;
        facts.dynamic_stencil = dynamic_stencil;
        if let Some(tests) = tests
            && tests.depth_test_enable == vk::TRUE
            && !is_dynamic(vk::DynamicState::DEPTH_COMPARE_OP)
        {
            facts.directions.see(tests.depth_compare_op);
        }
        facts
    }
}

/// The formats of a pipeline's attachments in dynamic rendering; `None` if there are none.
///
/// # Safety
///
/// The structure's chain is valid.
unsafe fn formats<'c>(
    info: &vk::GraphicsPipelineCreateInfo<'c>,
) -> Option<&'c vk::PipelineRenderingCreateInfo<'c>> {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe { find(info.p_next) }
}

/// Whether a pipeline for dynamic rendering has colour attachments: without any, its blend state may be anything
/// (VUID-VkGraphicsPipelineCreateInfo-renderPass-09037).
///
/// # Safety
///
/// The structure's chain is valid, with formats if it is whole.
unsafe fn renders_colour(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands, with so many formats.
    unsafe {
        let colours = formats(info).map(|of| slice(of.p_color_attachment_formats, of.color_attachment_count));
        colours.is_some_and(|colours| colours.iter().any(|format| *format != vk::Format::UNDEFINED))
    }
}

/// Whether a pipeline for dynamic rendering may have a depth or stencil attachment. Without one, its depth and stencil state may be anything
/// (VUID-VkGraphicsPipelineCreateInfo-renderPass-09036); a part without the output interface, which has the formats, has valid state.
///
/// # Safety
///
/// The structure's chain is valid.
pub unsafe fn may_render_depth(info: &vk::GraphicsPipelineCreateInfo<'_>, own: Parts) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands.
    let formats = unsafe { formats(info) };
    !own.contains(Parts::FRAGMENT_OUTPUT_INTERFACE)
        || formats.is_some_and(|of| {
            [of.depth_attachment_format, of.stencil_attachment_format] != [vk::Format::UNDEFINED; 2]
        })
}

/// Whether a pipeline may write stencil, and the dynamic state of that. Where all of it is, the structure may be missing
/// (VK_EXT_extended_dynamic_state3).
fn stencil(
    tests: Option<&vk::PipelineDepthStencilStateCreateInfo<'_>>,
    is_dynamic: impl Fn(vk::DynamicState) -> bool,
) -> (bool, DynamicStencil) {
    let set = DynamicStencil {
        test: is_dynamic(vk::DynamicState::STENCIL_TEST_ENABLE),
        op: is_dynamic(vk::DynamicState::STENCIL_OP),
    };
    let keeps = |face: &vk::StencilOpState| {
        [face.fail_op, face.pass_op, face.depth_fail_op].iter().all(|op| *op == vk::StencilOp::KEEP)
    };
    let may_test = set.test || tests.is_some_and(|tests| tests.stencil_test_enable == vk::TRUE);
    let keeps = !set.op && tests.is_none_or(|tests| keeps(&tests.front) && keeps(&tests.back));
    (may_test && !keeps, set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stencil_is_written_by_a_test_that_does_not_keep_it() {
        let replace = vk::StencilOpState { pass_op: vk::StencilOp::REPLACE, ..Default::default() };
        let off = vk::PipelineDepthStencilStateCreateInfo::default();
        let on = off.stencil_test_enable(true);
        let writes = on.back(replace);
        let [fixed, all] = [false, true].map(|all| move |_| all);
        let of = |tests, is_dynamic: &dyn Fn(vk::DynamicState) -> bool| stencil(tests, is_dynamic).0;
        assert_eq!([of(Some(&off), &fixed), of(Some(&on), &fixed), of(None, &fixed)], [false; 3]);
        assert!(of(Some(&writes), &fixed));
        // Dynamic state overrides the structure, and does without it.
        assert_eq!([of(Some(&off), &all), of(None, &all)], [true; 2]);
        assert_eq!(stencil(None, all).1, DynamicStencil { test: true, op: true });
        let test_alone = |state| state == vk::DynamicState::STENCIL_TEST_ENABLE;
        assert_eq!([of(Some(&off), &test_alone), of(Some(&off.front(replace)), &test_alone)], [false, true]);
    }

    /// Valid usage leaves the pointers to other state open.
    #[test]
    fn formats_tell_the_attachments_of_dynamic_rendering() {
        let whole = Parts::FRAGMENT_SHADER | Parts::FRAGMENT_OUTPUT_INTERFACE;
        let colours = [vk::Format::UNDEFINED, vk::Format::R8G8B8A8_SRGB];
        let attachments = |colours: &[vk::Format], depth, stencil| {
            let mut rendering = vk::PipelineRenderingCreateInfo::default()
                .color_attachment_formats(colours)
                .depth_attachment_format(depth)
                .stencil_attachment_format(stencil);
            let info = vk::GraphicsPipelineCreateInfo::default().push_next(&mut rendering);
            // SAFETY: a valid chain.
            unsafe { (renders_colour(&info), may_render_depth(&info, whole)) }
        };
        let (none, depth) = (vk::Format::UNDEFINED, vk::Format::D32_SFLOAT);
        assert_eq!(attachments(&colours, none, none), (true, false));
        assert_eq!(attachments(&colours[..1], depth, none), (false, true));
        assert_eq!(attachments(&[], none, vk::Format::S8_UINT), (false, true));
        let unchained = vk::GraphicsPipelineCreateInfo::default();
        // SAFETY: no chain.
        unsafe {
            assert!(!renders_colour(&unchained) && !may_render_depth(&unchained, whole));
            assert!(may_render_depth(&unchained, Parts::FRAGMENT_SHADER), "another part has the formats");
        }
    }
}
