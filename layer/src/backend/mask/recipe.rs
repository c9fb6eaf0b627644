//! A graphics pipeline as the application described it, kept so that one can be made later whose fragment shader returns early.

mod arena;
mod codes;

pub use codes::{Code, Codes};

use super::early_return::{EarlyReturn, NoEarlyReturn, discards, returning_early};
use super::pipelines::may_render_depth;
use crate::abi::copies::{find, slice, words};
use crate::gpu::{AppendedLayout, CompatiblePass, Gpu, GpuError, Owned, pipeline_of_code};
use crate::vk::newer::PIPELINE_CREATE_2_CAPTURE_DATA_KHR;
use crate::vk::shaders::parts::{dynamic_states, own_parts};
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
    /// The code of live modules.
    pub codes: &'a Codes,
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

/// Flags that concern only the creation of the application's own pipeline, or its relation to others.
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
        // SAFETY: valid usage demands so many stages.
        let stages = unsafe { slice(info.p_stages, info.stage_count) };
        let is_fragment =
            |stage: &vk::PipelineShaderStageCreateInfo<'_>| stage.stage == vk::ShaderStageFlags::FRAGMENT;
        let fragment = stages.iter().position(is_fragment)?;
        let mut codes = SmallVec::new();
        let mut kept = SmallVec::<[vk::PipelineShaderStageCreateInfo<'static>; 4]>::new();
        for stage in stages {
            // SAFETY: valid usage demands valid stages.
            let (code, stage) = unsafe { (code_of(stage, ingredients.codes)?, stage_of(stage, &mut memory)) };
            codes.push(code);
            kept.push(stage);
        }
        // SAFETY: valid usage demands a valid chain, a name of the entry point, and valid dynamic states.
        let ((views, chain), entry, dynamic) = unsafe {
            let chain = chain_of(info, &ingredients, &mut memory)?;
            (chain, CStr::from_ptr(stages[fragment].p_name).to_owned(), dynamic_states(info))
        };
        if info.flags.intersects(NOT_SERVED) || NOT_FOLLOWED.iter().any(|state| dynamic.contains(state)) {
            return None;
        }
        let has_depth = match &ingredients.render_pass {
            Some(pass) => pass.has_depth,
            // SAFETY: valid usage demands a valid chain.
            None => unsafe { may_render_depth(info, own_parts(info)) },
        };
        // SAFETY: the pipeline is whole, and rasterises to a pass with colour, as `# Safety` demands.
        let state = unsafe { state_of(info, has_tessellation(stages), has_depth, &mut memory)? };
        let info = vk::GraphicsPipelineCreateInfo {
            flags: info.flags & !NOT_KEPT,
            p_next: chain,
            stage_count: kept.len() as u32,
            p_stages: memory.many(&kept),
            subpass: info.subpass,
            base_pipeline_index: -1,
            ..state
        };
        let fragment = Fragment { stage: fragment, entry, by_view: views != 0 };
        let render_pass = ingredients.render_pass.map(|pass| pass.compatible);
        Some(Self { info, _memory: memory, codes, fragment, layout: ingredients.layout, render_pass })
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
        let entry = entry.to_str().map_err(|_| refusal(NoEarlyReturn::Unknown))?;
        let wanted = EarlyReturn { entry, set: self.layout.set(), by_view: *by_view, has_whole_subgroups };
        let returning = returning_early(self.codes[*stage].words(), wanted).map_err(refusal)?;
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

fn refusal(reason: NoEarlyReturn) -> GpuError {
    GpuError::Unsupported(match reason {
        NoEarlyReturn::Unknown => "an early return from a shader that the layer cannot parse",
        NoEarlyReturn::Subgroups => "an early return from a shader with subgroup operations",
        NoEarlyReturn::Position => {
            "an early return from a shader without access to the position of its fragment"
        }
    })
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

fn has_tessellation(stages: &[vk::PipelineShaderStageCreateInfo<'_>]) -> bool {
    stages.iter().any(|stage| stage.stage == vk::ShaderStageFlags::TESSELLATION_CONTROL)
}

/// The code of a stage; `None` if it is not kept, or if the chain has more than code and a name for tools.
///
/// # Safety
///
/// The stage and its chain are valid.
unsafe fn code_of(stage: &vk::PipelineShaderStageCreateInfo<'_>, codes: &Codes) -> Option<Code> {
    const KNOWN: [vk::StructureType; 2] =
        [vk::StructureType::SHADER_MODULE_CREATE_INFO, vk::StructureType::DEBUG_UTILS_OBJECT_NAME_INFO_EXT];
    // SAFETY: the chain is valid, as `# Safety` demands.
    if unsafe { arena::chain(stage.p_next) }.any(|found| !KNOWN.contains(&found.s_type)) {
        return None;
    }
    if stage.module != vk::ShaderModule::null() {
        return codes.get(stage.module);
    }
    // SAFETY: as above; a valid structure of this type has so many bytes of code.
    let code = unsafe {
        let own = find::<vk::ShaderModuleCreateInfo<'_>>(stage.p_next)?;
        words(own.p_code.cast(), own.code_size)
    };
    codes.keep(&code)
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
    // SAFETY: the pointer is null or valid, as `# Safety` demands.
    let constants = unsafe { stage.p_specialization_info.as_ref() }.map(|constants| {
        // SAFETY: a valid structure has so many entries, and so many bytes of data.
        let (entries, data) = unsafe {
            let data = match constants.data_size {
                0 => &[],
                size => std::slice::from_raw_parts(constants.p_data.cast::<u8>(), size),
            };
            (slice(constants.p_map_entries, constants.map_entry_count), data)
        };
        vk::SpecializationInfo {
            map_entry_count: constants.map_entry_count,
            p_map_entries: memory.many(entries),
            data_size: constants.data_size,
            p_data: memory.many(data).cast(),
            ..Default::default()
        }
    });
    // SAFETY: a valid stage has a name.
    let name = unsafe { CStr::from_ptr(stage.p_name) };
    vk::PipelineShaderStageCreateInfo {
        flags: stage.flags,
        stage: stage.stage,
        p_name: memory.many(name.to_bytes_with_nul()).cast(),
        p_specialization_info: match constants {
            Some(constants) => memory.many(&[constants]),
            None => std::ptr::null(),
        },
        ..Default::default()
    }
}

/// A pipeline's state without stages, chain, layout and render pass; `None` for state with an unknown structure.
///
/// # Safety
///
/// Valid usage of vkCreateGraphicsPipelines, of a pipeline that is whole and rasterises to a pass with colour; `has_tessellation` is
/// whether its stages have tessellation, `has_depth` whether that pass has depth or stencil.
unsafe fn state_of(
    info: &vk::GraphicsPipelineCreateInfo<'_>,
    has_tessellation: bool,
    has_depth: bool,
    memory: &mut Arena,
) -> Option<vk::GraphicsPipelineCreateInfo<'static>> {
    // SAFETY: valid usage demands that dynamic state is null or valid.
    let dynamic = unsafe { dynamic_states(info) };
    let has_vertex_input = !dynamic.contains(&vk::DynamicState::VERTEX_INPUT_EXT);
    // SAFETY: each pointer is null or valid where it is not ignored (VkGraphicsPipelineCreateInfo).
    let (vertex_input, tessellation, depth_stencil) = unsafe {
        (
            if has_vertex_input { info.p_vertex_input_state.as_ref() } else { None },
            if has_tessellation { info.p_tessellation_state.as_ref() } else { None },
            if has_depth { info.p_depth_stencil_state.as_ref() } else { None },
        )
    };
    // SAFETY: as above; no other pointer of such a pipeline is ignored, and valid structures have valid arrays and chains.
    unsafe {
        Some(vk::GraphicsPipelineCreateInfo {
            p_vertex_input_state: memory.vertex_input(vertex_input)?,
            p_input_assembly_state: memory.plain(info.p_input_assembly_state.as_ref())?.cast(),
            p_tessellation_state: memory.plain(tessellation)?.cast(),
            p_viewport_state: memory.viewport(info.p_viewport_state.as_ref(), dynamic)?,
            p_rasterization_state: memory.plain(info.p_rasterization_state.as_ref())?.cast(),
            p_multisample_state: memory.multisample(info.p_multisample_state.as_ref())?,
            p_depth_stencil_state: memory.plain(depth_stencil)?.cast(),
            p_color_blend_state: memory.color_blend(info.p_color_blend_state.as_ref())?,
            p_dynamic_state: memory.dynamic(info.p_dynamic_state.as_ref())?,
            ..Default::default()
        })
    }
}

/// The kept flags of an application's pipeline; `None` if nothing is kept. A substitute captures no binaries: the application would never release
/// them, and captures exclude a pipeline cache (VUID-vkCreateGraphicsPipelines-pNext-09617).
fn kept_flags(flags: vk::PipelineCreateFlags2KHR) -> Option<vk::PipelineCreateFlags2KHR> {
    let flags = flags.as_raw();
    let not_kept = u64::from(NOT_KEPT.as_raw()) | PIPELINE_CREATE_2_CAPTURE_DATA_KHR.as_raw();
    let is_served = flags & u64::from(NOT_SERVED.as_raw()) == 0;
    is_served.then(|| vk::PipelineCreateFlags2KHR::from_raw(flags & !not_kept))
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
    let mut next: *const c_void = std::ptr::null();
    let mut views = ingredients.render_pass.as_ref().map_or(0, |pass| pass.views);
    // SAFETY: valid usage demands a valid chain.
    for found in unsafe { arena::chain(info.p_next) } {
        match found.s_type {
            // Ignored with a render pass.
            vk::StructureType::PIPELINE_RENDERING_CREATE_INFO if ingredients.render_pass.is_some() => {}
            vk::StructureType::PIPELINE_RENDERING_CREATE_INFO => {
                // SAFETY: a valid structure of this type is one of these, with so many formats.
                let (rendering, formats) = unsafe {
                    let found = &*std::ptr::from_ref(found).cast::<vk::PipelineRenderingCreateInfo<'_>>();
                    (found, slice(found.p_color_attachment_formats, found.color_attachment_count))
                };
                views = rendering.view_mask;
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
            vk::StructureType::PIPELINE_CREATE_FLAGS_2_CREATE_INFO_KHR => {
                // SAFETY: a valid structure of this type is one of these.
                let flags = unsafe { (*std::ptr::from_ref(found).cast::<Flags2<'_>>()).flags };
                let flags = kept_flags(flags)?;
                next = memory.many(&[Flags2 { p_next: next, flags, ..Default::default() }]).cast();
            }
            // Feedback and names of the application's own pipeline.
            vk::StructureType::PIPELINE_CREATION_FEEDBACK_CREATE_INFO
            | vk::StructureType::DEBUG_UTILS_OBJECT_NAME_INFO_EXT => {}
            _ => return None,
        }
    }
    Some((views, next))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_of_the_applications_own_pipeline_are_not_kept() {
        let of =
            |flags: vk::PipelineCreateFlags| vk::PipelineCreateFlags2KHR::from_raw(flags.as_raw().into());
        let kept = of(vk::PipelineCreateFlags::DISABLE_OPTIMIZATION);
        let own = of(vk::PipelineCreateFlags::DERIVATIVE) | PIPELINE_CREATE_2_CAPTURE_DATA_KHR;
        assert_eq!(kept_flags(kept | own), Some(kept));
        assert_eq!(kept_flags(kept | of(vk::PipelineCreateFlags::LIBRARY_KHR)), None);
    }
}
