//! A graphics pipeline as the application described it, kept so that one can be made later whose fragment shader returns early.

mod arena;
mod codes;

pub use codes::{Code, Codes};

use super::early_return::{EarlyReturn, discards, returning_early};
use crate::abi::copies::{find, slice, words};
use crate::gpu::{AppendedLayout, CompatiblePass, Gpu, GpuError, Owned, pipeline_of_code};
use arena::Arena;
use ash::vk;
use smallvec::SmallVec;
use std::ffi::{CStr, CString, c_void};
use std::sync::Arc;

/// A copy of a pipeline's description. Everything that the description points to is in memory of its own, but modules, layout and render
/// pass, which are not named: those are its own, too.
pub struct Recipe {
    info: vk::GraphicsPipelineCreateInfo<'static>,
    _memory: Arena,
    /// Of each stage.
    codes: SmallVec<[Code; 2]>,
    fragment: Fragment,
    layout: Arc<AppendedLayout>,
    render_pass: Option<Arc<CompatiblePass>>,
}

/// The fragment shader.
struct Fragment {
    stage: usize,
    entry: CString,
    by_view: bool,
}

/// Parts of a recipe outside of the description.
pub struct Ingredients<'a> {
    /// The code of a live module.
    pub code: &'a dyn Fn(vk::ShaderModule) -> Option<Code>,
    /// The layout.
    pub layout: Arc<AppendedLayout>,
    /// The render pass; nothing for dynamic rendering.
    pub render_pass: Option<PassOf>,
}

/// The render pass of a pipeline.
pub struct PassOf {
    /// One that is compatible with it.
    pub compatible: Arc<CompatiblePass>,
    /// The views of the subpass; 0 without multiview.
    pub views: u32,
    /// Whether the subpass has depth or stencil: else that state is ignored, and may be anything.
    pub has_depth: bool,
}

// SAFETY: all pointers in `info` are to `_memory`, which goes where it goes and does not change.
unsafe impl Send for Recipe {}
// SAFETY: as above.
unsafe impl Sync for Recipe {}

/// Flags that say how the application wants its own pipeline made, or related to others.
const NOT_KEPT: vk::PipelineCreateFlags = vk::PipelineCreateFlags::from_raw(
    vk::PipelineCreateFlags::ALLOW_DERIVATIVES.as_raw()
        | vk::PipelineCreateFlags::DERIVATIVE.as_raw()
        | vk::PipelineCreateFlags::FAIL_ON_PIPELINE_COMPILE_REQUIRED.as_raw()
        | vk::PipelineCreateFlags::EARLY_RETURN_ON_FAILURE.as_raw()
        | vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR.as_raw()
        | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR.as_raw(),
);

/// Flags with which nothing is kept: descriptors in buffers, and parts of pipelines.
const NOT_SERVED: vk::PipelineCreateFlags = vk::PipelineCreateFlags::from_raw(
    vk::PipelineCreateFlags::LIBRARY_KHR.as_raw()
        | vk::PipelineCreateFlags::DESCRIPTOR_BUFFER_EXT.as_raw()
        | vk::PipelineCreateFlags::INDIRECT_BINDABLE_NV.as_raw(),
);

impl Recipe {
    /// Keeps the description of a pipeline; `None` where part of it is unknown.
    ///
    /// # Safety
    ///
    /// Valid usage of vkCreateGraphicsPipelines, of a pipeline that is whole, and rasterises to a pass with colour; it is made on
    /// the device of `ingredients`.
    pub unsafe fn of(
        info: &vk::GraphicsPipelineCreateInfo<'_>,
        ingredients: Ingredients<'_>,
    ) -> Option<Self> {
        let mut memory = Arena::default();
        // SAFETY: the caller vouches for the structure, its arrays and chains. Copies point to the arena or nowhere.
        unsafe {
            let stages = slice(info.p_stages, info.stage_count);
            let is_fragment =
                |stage: &vk::PipelineShaderStageCreateInfo<'_>| stage.stage == vk::ShaderStageFlags::FRAGMENT;
            let fragment = stages.iter().position(is_fragment)?;
            let mut codes = SmallVec::new();
            let mut kept = SmallVec::<[vk::PipelineShaderStageCreateInfo<'static>; 4]>::new();
            for stage in stages {
                codes.push(code_of(stage, ingredients.code)?);
                kept.push(stage_of(stage, &mut memory));
            }
            let (views, chain) = chain_of(info, &ingredients, &mut memory)?;
            let entry = CStr::from_ptr(stages[fragment].p_name).to_owned();
            let flags = info.flags;
            let is_dynamic = |state| dynamic_states(info).contains(&state);
            if flags.intersects(NOT_SERVED) || NOT_FOLLOWED.into_iter().any(is_dynamic) {
                return None;
            }
            let has_depth = ingredients.render_pass.as_ref().is_none_or(|pass| pass.has_depth);
            let info = vk::GraphicsPipelineCreateInfo {
                flags: flags & !NOT_KEPT,
                p_next: chain,
                stage_count: kept.len() as u32,
                p_stages: memory.many(&kept),
                p_vertex_input_state: match is_dynamic(vk::DynamicState::VERTEX_INPUT_EXT) {
                    true => std::ptr::null(),
                    false => memory.vertex_input(info.p_vertex_input_state.as_ref())?,
                },
                p_input_assembly_state: memory.plain(info.p_input_assembly_state.as_ref())?.cast(),
                p_tessellation_state: match has_tessellation(stages) {
                    true => memory.plain(info.p_tessellation_state.as_ref())?.cast(),
                    false => std::ptr::null(),
                },
                p_viewport_state: memory.viewport(info.p_viewport_state.as_ref(), dynamic_states(info))?,
                p_rasterization_state: memory.plain(info.p_rasterization_state.as_ref())?.cast(),
                p_multisample_state: memory.multisample(info.p_multisample_state.as_ref())?,
                p_depth_stencil_state: match has_depth {
                    true => memory.plain(info.p_depth_stencil_state.as_ref())?.cast(),
                    false => std::ptr::null(),
                },
                p_color_blend_state: memory.color_blend(info.p_color_blend_state.as_ref())?,
                p_dynamic_state: memory.dynamic(info.p_dynamic_state.as_ref())?,
                subpass: info.subpass,
                base_pipeline_index: -1,
                ..Default::default()
            };
            let fragment = Fragment { stage: fragment, entry, by_view: views != 0 };
            let render_pass = ingredients.render_pass.map(|pass| pass.compatible);
            Some(Self { info, _memory: memory, codes, fragment, layout: ingredients.layout, render_pass })
        }
    }

    /// The layout of the made pipelines.
    pub fn layout(&self) -> &Arc<AppendedLayout> {
        &self.layout
    }

    /// Whether its fragment shader may discard fragments.
    pub fn discards(&self) -> bool {
        discards(self.codes[self.fragment.stage].words())
    }

    /// Makes the pipeline whose fragment shader returns early, see [`EarlyReturn::has_whole_subgroups`].
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] where the shader cannot; a failed call.
    pub fn make(&self, gpu: &Arc<Gpu>, has_whole_subgroups: bool) -> Result<Owned<vk::Pipeline>, GpuError> {
        let Fragment { stage, entry, by_view } = &self.fragment;
        let unknown = GpuError::Unsupported("an early return from a shader that the layer cannot parse");
        let entry = entry.to_str().map_err(|_| unknown)?;
        let wanted = EarlyReturn { entry, set: self.layout.set(), by_view: *by_view, has_whole_subgroups };
        let returning = returning_early(self.codes[*stage].words(), wanted).map_err(|reason| {
            tracing::debug!("no early return: {reason}");
            unknown
        })?;
        let mut codes: SmallVec<[&[u32]; 4]> = self.codes.iter().map(|code| code.words()).collect();
        codes[*stage] = &returning;
        let info = vk::GraphicsPipelineCreateInfo {
            layout: self.layout.handle(),
            render_pass: self.render_pass.as_ref().map_or(vk::RenderPass::null(), |pass| pass.handle()),
            ..self.info
        };
        // SAFETY: the description was valid, layout and render pass are compatible with the application's, and only the
        // fragment shader changed, to one with an interface that has nothing more but the set of the layout.
        unsafe { pipeline_of_code(gpu, &info, &codes) }
    }
}

/// Dynamic state without which a part of the description may be anything.
const NOT_FOLLOWED: [vk::DynamicState; 6] = [
    vk::DynamicState::SAMPLE_MASK_EXT,
    vk::DynamicState::RASTERIZATION_SAMPLES_EXT,
    vk::DynamicState::COLOR_BLEND_ENABLE_EXT,
    vk::DynamicState::COLOR_BLEND_EQUATION_EXT,
    vk::DynamicState::COLOR_BLEND_ADVANCED_EXT,
    vk::DynamicState::COLOR_WRITE_MASK_EXT,
];

/// # Safety
///
/// The structure is valid.
pub unsafe fn dynamic_states<'c>(info: &vk::GraphicsPipelineCreateInfo<'c>) -> &'c [vk::DynamicState] {
    // SAFETY: the caller vouches for it.
    unsafe {
        let dynamic = info.p_dynamic_state.as_ref();
        dynamic.map_or(&[], |dynamic| slice(dynamic.p_dynamic_states, dynamic.dynamic_state_count))
    }
}

fn has_tessellation(stages: &[vk::PipelineShaderStageCreateInfo<'_>]) -> bool {
    stages.iter().any(|stage| stage.stage == vk::ShaderStageFlags::TESSELLATION_CONTROL)
}

/// The code of a stage; nothing where it has more to say than code and a name for tools.
///
/// # Safety
///
/// The stage and its chain are valid.
unsafe fn code_of(
    stage: &vk::PipelineShaderStageCreateInfo<'_>,
    of_module: &dyn Fn(vk::ShaderModule) -> Option<Code>,
) -> Option<Code> {
    // SAFETY: the caller vouches for the chain, and the code in it.
    unsafe {
        let has_other = arena::chain(stage.p_next).any(|found| {
            ![
                vk::StructureType::SHADER_MODULE_CREATE_INFO,
                vk::StructureType::DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
            ]
            .contains(&found.s_type)
        });
        if has_other {
            return None;
        }
        if stage.module != vk::ShaderModule::null() {
            return of_module(stage.module);
        }
        let own = find::<vk::ShaderModuleCreateInfo<'_>>(stage.p_next)?;
        Some(codes::apart(&words(own.p_code.cast(), own.code_size)))
    }
}

/// A stage without its module.
///
/// # Safety
///
/// The stage is valid.
unsafe fn stage_of(
    stage: &vk::PipelineShaderStageCreateInfo<'_>,
    memory: &mut Arena,
) -> vk::PipelineShaderStageCreateInfo<'static> {
    // SAFETY: the caller vouches for name and constants.
    unsafe {
        let constants = stage.p_specialization_info.as_ref().map(|constants| {
            let data = std::slice::from_raw_parts(
                match constants.data_size {
                    0 => std::ptr::NonNull::dangling().as_ptr(),
                    _ => constants.p_data.cast::<u8>(),
                },
                constants.data_size,
            );
            vk::SpecializationInfo {
                map_entry_count: constants.map_entry_count,
                p_map_entries: memory.many(slice(constants.p_map_entries, constants.map_entry_count)),
                data_size: constants.data_size,
                p_data: memory.many(data).cast(),
                ..Default::default()
            }
        });
        vk::PipelineShaderStageCreateInfo {
            flags: stage.flags,
            stage: stage.stage,
            p_name: memory.many(CStr::from_ptr(stage.p_name).to_bytes_with_nul()).cast(),
            p_specialization_info: match constants {
                Some(constants) => memory.many(&[constants]),
                None => std::ptr::null(),
            },
            ..Default::default()
        }
    }
}

/// The views of the pass, and the chain of the description; `None` for an unknown structure.
///
/// # Safety
///
/// Valid usage of vkCreateGraphicsPipelines.
unsafe fn chain_of(
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    ingredients: &Ingredients<'_>,
    memory: &mut Arena,
) -> Option<(u32, *const c_void)> {
    type Flags2<'a> = vk::PipelineCreateFlags2CreateInfoKHR<'a>;
    // SAFETY: the chain is valid, by the valid usage of vkCreateGraphicsPipelines.
    unsafe {
        let mut next: *const c_void = std::ptr::null();
        let mut views = ingredients.render_pass.as_ref().map_or(0, |pass| pass.views);
        for found in arena::chain(info.p_next) {
            match found.s_type {
                vk::StructureType::PIPELINE_RENDERING_CREATE_INFO => {
                    let rendering = &*std::ptr::from_ref(found).cast::<vk::PipelineRenderingCreateInfo<'_>>();
                    // Ignored with a render pass.
                    if ingredients.render_pass.is_none() {
                        views = rendering.view_mask;
                        let formats =
                            slice(rendering.p_color_attachment_formats, rendering.color_attachment_count);
                        let kept = vk::PipelineRenderingCreateInfo {
                            p_next: next,
                            view_mask: rendering.view_mask,
                            color_attachment_count: rendering.color_attachment_count,
                            p_color_attachment_formats: memory.many(formats),
                            depth_attachment_format: rendering.depth_attachment_format,
                            stencil_attachment_format: rendering.stencil_attachment_format,
                            ..Default::default()
                        };
                        next = memory.many(&[kept]).cast();
                    }
                }
                vk::StructureType::PIPELINE_CREATE_FLAGS_2_CREATE_INFO_KHR => {
                    let flags = (*std::ptr::from_ref(found).cast::<Flags2<'_>>()).flags.as_raw();
                    if flags & u64::from(NOT_SERVED.as_raw()) != 0 {
                        return None;
                    }
                    let flags = vk::PipelineCreateFlags2KHR::from_raw(flags & !u64::from(NOT_KEPT.as_raw()));
                    next = memory.many(&[Flags2 { p_next: next, flags, ..Default::default() }]).cast();
                }
                // What the application wants to know of its own.
                vk::StructureType::PIPELINE_CREATION_FEEDBACK_CREATE_INFO
                | vk::StructureType::DEBUG_UTILS_OBJECT_NAME_INFO_EXT => {}
                _ => return None,
            }
        }
        Some((views, next))
    }
}
