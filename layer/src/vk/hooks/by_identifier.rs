//! Pipelines whose fragment shaders identifiers alone name (VK_EXT_shader_module_identifier).
//!
//! Such a pipeline must allow the answer `VK_PIPELINE_COMPILE_REQUIRED`, which a driver may give at any time; the application then
//! comes with the code. It is the answer for unknown fragment shaders, as their draws would stay at 1x1 in every launch.

use crate::abi::copies::{find, slice};
use crate::vk::device::Device;
use crate::vk::hooks::shader_modules::{modules, note_code};
use crate::vk::shaders::lacks_code;
use crate::vk::shaders::parts::{flags, fragment_stage};
use ash::vk;
use smallvec::SmallVec;
use vk::PipelineCreateFlags2KHR as Flags;

/// `vkCreateGraphicsPipelines` by `create`, without the pipelines of unknown fragment shaders. A call that derives pipelines from others of the
/// same call stays whole, as it names them by their places.
///
/// # Safety
///
/// The arguments of the call, with which `create` may be called.
pub unsafe fn create<'c>(
    known: &Device,
    (device, infos, count): (vk::Device, *const vk::GraphicsPipelineCreateInfo<'c>, u32),
    made: *mut vk::Pipeline,
    create: impl FnOnce(u32, *const vk::GraphicsPipelineCreateInfo<'c>, *mut vk::Pipeline) -> vk::Result,
) -> vk::Result {
    let Some(modules) = modules(known) else { return create(count, infos, made) };
    // SAFETY: valid usage demands so many structures.
    let asked = unsafe { slice(infos, count) };
    if modules.is_code_requested() {
        for info in asked {
            // SAFETY: valid usage demands valid structures.
            unsafe {
                if let Some(stage) = fragment_stage(info) {
                    note_code(known, device, stage);
                }
            }
        }
    }
    // SAFETY: as above.
    let lack = |info: &_| unsafe { may_be_coarse(known, info) && lacks_code(info) };
    // Once: another thread may bring the code of one meanwhile.
    let lacking: SmallVec<[bool; 16]> = asked.iter().map(lack).collect();
    // SAFETY: as above.
    let has = |info: &_, flag| unsafe { flags(info) }.contains(flag);
    if !lacking.contains(&true) || asked.iter().any(|info| has(info, Flags::DERIVATIVE)) {
        return create(count, infos, made);
    }
    modules.request_code();
    let all = || asked.iter().zip(&lacking).enumerate();
    let ends_call =
        |(_, (info, lacks)): &(usize, (&_, &bool))| **lacks && has(info, Flags::EARLY_RETURN_ON_FAILURE);
    let end = all().find(ends_call).map_or(asked.len(), |(place, _)| place);
    let kept = all().take(end).filter(|(_, (_, lacks))| !**lacks);
    let (places, kept): (Vec<usize>, Vec<_>) = kept.map(|(place, (info, _))| (place, *info)).unzip();
    let mut pipelines = vec![vk::Pipeline::null(); kept.len()];
    let result = if kept.is_empty() {
        vk::Result::PIPELINE_COMPILE_REQUIRED_EXT
    } else {
        create(kept.len() as u32, kept.as_ptr(), pipelines.as_mut_ptr())
    };
    for (place, info) in asked.iter().enumerate() {
        let index = places.binary_search(&place);
        if index.is_err() {
            // SAFETY: as above.
            unsafe { leave_feedback_invalid(info) };
        }
        let pipeline = index.map_or(vk::Pipeline::null(), |index| pipelines[index]);
        // SAFETY: valid usage demands room for so many handles.
        unsafe { made.add(place).write(pipeline) };
    }
    if result.as_raw() < 0 { result } else { vk::Result::PIPELINE_COMPILE_REQUIRED_EXT }
}

/// Whether the effects of a pipeline's fragment shader count: there may be a mask or a rate attachment of ours in its passes.
///
/// # Safety
///
/// The structure is valid.
unsafe fn may_be_coarse(known: &Device, info: &vk::GraphicsPipelineCreateInfo<'_>) -> bool {
    // SAFETY: as `# Safety` demands.
    known.rate_attachments().is_none_or(|rates| unsafe { rates.may_reach(info) })
}

/// Marks the feedback of a pipeline as invalid, as the pipeline is not created.
///
/// # Safety
///
/// The structure is valid.
unsafe fn leave_feedback_invalid(info: &vk::GraphicsPipelineCreateInfo<'_>) {
    // SAFETY: the chain is valid, as `# Safety` demands, with structures to write to.
    unsafe {
        let Some(feedback) = find::<vk::PipelineCreationFeedbackCreateInfo<'_>>(info.p_next) else { return };
        let stages = feedback.p_pipeline_stage_creation_feedbacks;
        let count =
            if stages.is_null() { 0 } else { feedback.pipeline_stage_creation_feedback_count as usize };
        let each = (0..count).map(|index| stages.add(index));
        for feedback in each.chain([feedback.p_pipeline_creation_feedback]) {
            (*feedback).flags = vk::PipelineCreationFeedbackFlags::empty();
        }
    }
}
