//! Parts of graphics pipelines (VK_EXT_graphics_pipeline_library), and the libraries that they are linked from.

use crate::abi::copies::{find, slice};
use crate::vk::newer;
use ash::vk;
pub use ash::vk::GraphicsPipelineLibraryFlagsEXT as Parts;

/// The libraries that a pipeline is linked from.
///
/// # Safety
///
/// The structure's chain is valid.
pub unsafe fn libraries<'c>(info: &vk::GraphicsPipelineCreateInfo<'c>) -> &'c [vk::Pipeline] {
    // SAFETY: the chain is valid, as `# Safety` demands, with so many libraries.
    unsafe {
        find::<vk::PipelineLibraryCreateInfoKHR<'_>>(info.p_next)
            .map_or(&[], |libraries| slice(libraries.p_libraries, libraries.library_count))
    }
}

/// The parts that the structure itself has: pointers to the state of others may be anything.
///
/// # Safety
///
/// The structure's chain is valid.
pub unsafe fn own_parts(info: &vk::GraphicsPipelineCreateInfo<'_>) -> Parts {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        if let Some(library) = find::<vk::GraphicsPipelineLibraryCreateInfoEXT<'_>>(info.p_next) {
            library.flags
        } else if libraries(info).is_empty() {
            Parts::PRE_RASTERIZATION_SHADERS
                | Parts::FRAGMENT_SHADER
                | Parts::VERTEX_INPUT_INTERFACE
                | Parts::FRAGMENT_OUTPUT_INTERFACE
        } else {
            Parts::empty()
        }
    }
}

/// The flags of a pipeline, from its chain if a structure there replaces them.
///
/// # Safety
///
/// The structure's chain is valid.
pub unsafe fn flags(info: &vk::GraphicsPipelineCreateInfo<'_>) -> vk::PipelineCreateFlags2KHR {
    // SAFETY: the chain is valid, as `# Safety` demands.
    let flags2 = unsafe { find::<vk::PipelineCreateFlags2CreateInfoKHR<'_>>(info.p_next) };
    let bits = vk::PipelineCreateFlags2KHR::from_raw(info.flags.as_raw().into());
    flags2.map_or(bits, |flags2| flags2.flags)
}

/// Whether a pipeline is made from binaries, or its data may be captured as binaries (VK_KHR_pipeline_binary). The application keeps them under the
/// key of its own structure, for pipelines of later starts, with this layer or without it.
///
/// # Safety
///
/// The structure's chain is valid.
pub unsafe fn exchanges_binaries(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        flags(info).contains(newer::PIPELINE_CREATE_2_CAPTURE_DATA_KHR)
            || find::<newer::PipelineBinaryInfo>(info.p_next).is_some_and(|binaries| binaries.count > 0)
    }
}

/// The stage of a pipeline's own fragment shader; `None` if the pipeline discards its primitives.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn fragment_stage<'c>(
    info: &vk::GraphicsPipelineCreateInfo<'c>,
) -> Option<&'c vk::PipelineShaderStageCreateInfo<'c>> {
    // SAFETY: the structure is valid, as `# Safety` demands, and has so many stages where the fragment shader is its own.
    unsafe {
        let own = own_parts(info);
        if !own.contains(Parts::FRAGMENT_SHADER) || is_discarded(info, own) {
            return None;
        }
        let stages = slice(info.p_stages, info.stage_count);
        stages.iter().find(|stage| stage.stage == vk::ShaderStageFlags::FRAGMENT)
    }
}

/// The states that commands set.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn dynamic_states<'c>(info: &vk::GraphicsPipelineCreateInfo<'c>) -> &'c [vk::DynamicState] {
    // SAFETY: dynamic state of a valid structure is null or valid, with so many states.
    unsafe {
        info.p_dynamic_state
            .as_ref()
            .map_or(&[], |state| slice(state.p_dynamic_states, state.dynamic_state_count))
    }
}

/// Whether viewports are part of a pipeline, and not set by commands.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn has_static_viewports(info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: the structure is valid, as `# Safety` demands. Viewport state is ignored, and may be anything, where it is of another part or nothing is
    // rasterised.
    unsafe {
        let own = own_parts(info);
        let is_dynamic = |states: &[vk::DynamicState]| {
            states.contains(&vk::DynamicState::VIEWPORT)
                || states.contains(&vk::DynamicState::VIEWPORT_WITH_COUNT)
        };
        own.contains(Parts::PRE_RASTERIZATION_SHADERS)
            && !is_discarded(info, own)
            && !is_dynamic(dynamic_states(info))
    }
}

/// Whether nothing is rasterised, so that much of the state is ignored, and may be anything.
///
/// # Safety
///
/// The structure is valid.
pub unsafe fn is_discarded(info: &vk::GraphicsPipelineCreateInfo<'_>, own: Parts) -> bool {
    // SAFETY: the structure is valid, as `# Safety` demands, and the rasterisation state is of the pre-rasterisation part.
    unsafe {
        own.contains(Parts::PRE_RASTERIZATION_SHADERS)
            && !dynamic_states(info).contains(&vk::DynamicState::RASTERIZER_DISCARD_ENABLE)
            && info
                .p_rasterization_state
                .as_ref()
                .is_some_and(|state| state.rasterizer_discard_enable == vk::TRUE)
    }
}
