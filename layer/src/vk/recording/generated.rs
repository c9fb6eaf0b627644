//! Device-generated draws (`VK_EXT_device_generated_commands`, which vkd3d-proton uses for indirect execution). They may use pipelines named by a
//! buffer of the application.

use super::draws::{Counts, count_tracked};
use super::{Buffer, drawing, with_buffer};
use crate::backend::mask::PipelineFacts;
use crate::vk::newer::GeneratedCommandsInfo;
use ash::vk;

/// Stages of commands that draw.
const DRAWING: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::ALL_GRAPHICS.as_raw()
        | vk::ShaderStageFlags::TASK_EXT.as_raw()
        | vk::ShaderStageFlags::MESH_EXT.as_raw(),
);

/// `vkCmdExecuteGeneratedCommandsEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn execute(
    handle: vk::CommandBuffer,
    is_preprocessed: vk::Bool32,
    info: *const GeneratedCommandsInfo,
) {
    hook!(
        "vkCmdExecuteGeneratedCommandsEXT",
        with_buffer,
        cmd_execute_generated_commands(handle, is_preprocessed, info),
        |known, next| {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
            next();
            // SAFETY: valid usage demands a valid structure.
            let (stages, set) = unsafe { ((*info).shader_stages, (*info).indirect_execution_set) };
            if let Some(known) = known.filter(|_| stages.intersects(DRAWING)) {
                note_draws(&known, handle, set != 0);
            }
        }
    );
}

/// `vkCmdExecuteGeneratedCommandsNV`, which may choose shader groups of a pipeline.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn execute_nv(
    handle: vk::CommandBuffer,
    is_preprocessed: vk::Bool32,
    info: *const vk::GeneratedCommandsInfoNV<'_>,
) {
    hook!(
        "vkCmdExecuteGeneratedCommandsNV",
        with_buffer,
        cmd_execute_generated_commands_nv(handle, is_preprocessed, info),
        |known, next| {
            // SAFETY: the command buffer is recording, by valid usage.
            unsafe { drawing::leave_for_command(known.as_deref(), handle) };
            next();
            // SAFETY: valid usage demands a valid structure.
            let point = unsafe { (*info).pipeline_bind_point };
            if let Some(known) = known.filter(|_| point == vk::PipelineBindPoint::GRAPHICS) {
                note_draws(&known, handle, true);
            }
        }
    );
}

/// Counts them as indirect draws, with unknown pipelines if `chooses_pipelines`.
fn note_draws(known: &Buffer, handle: vk::CommandBuffer, chooses_pipelines: bool) {
    if chooses_pipelines && known.armed.masks.is_some() {
        known.recorded().use_pipeline(PipelineFacts::UNKNOWN);
    }
    if known.armed.follows_passes() {
        count_tracked(known, handle, Counts::INDIRECT);
    }
}
