//! Commands that bind pipelines and shaders, and set their rate.

use super::{Buffer, drawing, stencil, with_buffer};
use crate::abi::copies::slice;
use crate::backend::attachment::RateAttachments;
use crate::backend::attachment::commands::SetRate;
use crate::backend::attachment::pipeline::PipelineRate;
use crate::backend::mask::Masks;
use crate::vk::device;
use crate::vk::functions::ArmedTable;
use ash::vk::{self, FragmentShadingRateCombinerOpKHR as Combiner};

/// `vkCmdSetFragmentShadingRateKHR`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_rate(
    buffer: vk::CommandBuffer,
    size: *const vk::Extent2D,
    combiners: *const [Combiner; 2],
) {
    hook!(
        "vkCmdSetFragmentShadingRateKHR",
        device::with,
        cmd_set_fragment_shading_rate(buffer, size, combiners),
        |known, next, answer| {
            // SAFETY: the next layer's function, with the application's own arguments or valid ones in their place.
            let set = |size: *const _, combiners: *const _| unsafe { next(buffer, size, combiners) };
            match known.rate_attachments() {
                Some(rates) => {
                    // SAFETY: valid usage demands that both pointers are valid.
                    let asked = unsafe { SetRate { size: *size, combiners: *combiners } };
                    let rate = rates.set_rates.set(buffer, asked);
                    set(&rate.size, &rate.combiners);
                }
                None => set(size, combiners),
            }
            answer.made();
        }
    );
}

/// `vkCmdBindPipeline`, hooked only where the rate of a pipeline may have to be set, or passes may have masks.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_pipeline(
    buffer: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    pipeline: vk::Pipeline,
) {
    hook!(
        "vkCmdBindPipeline",
        with_buffer,
        cmd_bind_pipeline(buffer, point, pipeline),
        |known, next, answer| {
            let bind = |pipeline| {
                // SAFETY: the next layer's function, with the application's pipeline or a live substitute for it.
                unsafe { next(buffer, point, pipeline) };
                answer.made();
            };
            let Some(known) = known else { return bind(pipeline) };
            if point == vk::PipelineBindPoint::GRAPHICS {
                if known.armed.masks.is_some() {
                    stencil::changes(&known, buffer);
                }
                // SAFETY: the command buffer is recording and the pipeline live, by the valid usage of vkCmdBindPipeline.
                unsafe { drawing::bind(&known, buffer, pipeline, bind) };
                // SAFETY: as above; the pipeline is bound.
                unsafe { set_rate_of(&known, buffer, pipeline) };
            } else {
                bind(pipeline);
            }
            match (&known.armed.masks, point) {
                (Some(masks), vk::PipelineBindPoint::GRAPHICS) => {
                    known.recorded().use_pipeline(masks.pipeline(pipeline));
                }
                (Some(_), vk::PipelineBindPoint::COMPUTE) => known.recorded().compute.bind_pipeline(pipeline),
                _ => {}
            }
        }
    );
}

/// Sets the rate that a graphics pipeline needs now that it is bound, if it leaves its rate to commands.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording.
unsafe fn set_rate_of(known: &Buffer, handle: vk::CommandBuffer, pipeline: vk::Pipeline) {
    if let Some(rates) = &known.armed.rate_attachments
        && let Some(rate) =
            rates.set_rates.bound(handle, rates.pipeline_rate(pipeline).unwrap_or(PipelineRate::Fixed))
        && let Some(set) = known.armed.next.cmd_set_fragment_shading_rate
    {
        // SAFETY: the command buffer is recording, as `# Safety` demands, and both are valid; the function is there.
        unsafe { set(handle, &rate.size, &rate.combiners) };
    }
}

/// Sets the rate for the next pass, if it differs from the rate in force. `is_left_alone`: whether the pass has no rate attachment of ours.
///
/// # Safety
///
/// `handle` is a command buffer that is recording, of the device of `next`.
pub unsafe fn pass_begins(
    next: &ArmedTable,
    rates: &RateAttachments,
    handle: vk::CommandBuffer,
    is_left_alone: impl FnOnce() -> bool,
) {
    if rates.set_rates.depend_on_pass()
        && let Some(rate) = rates.set_rates.pass_begins(handle, is_left_alone())
        && let Some(set) = next.cmd_set_fragment_shading_rate
    {
        // SAFETY: the command buffer is recording, as `# Safety` demands, and both are valid; the function is there.
        unsafe { set(handle, &rate.size, &rate.combiners) };
    }
}

/// `vkCmdBindShadersEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn bind_shaders(
    buffer: vk::CommandBuffer,
    count: u32,
    stages: *const vk::ShaderStageFlags,
    shaders: *const vk::ShaderEXT,
) {
    hook!(
        "vkCmdBindShadersEXT",
        device::with,
        cmd_bind_shaders(buffer, count, stages, shaders),
        |known, next| {
            let masked = known.masks().zip(super::tracked(buffer));
            if let Some((_, recording)) = &masked {
                // SAFETY: the command buffer is recording, by valid usage.
                unsafe {
                    recording.fill_before_binding(buffer);
                    drawing::leave(recording, buffer);
                }
                stencil::changes(recording, buffer);
            }
            next();
            // SAFETY: valid usage demands `count` stages and shaders, or null for the latter.
            let rate = unsafe {
                known.rate_attachments().and_then(|rates| rates.shaders_bound(buffer, count, stages, shaders))
            };
            if let Some((rate, set)) = rate.zip(known.hooked.cmd_set_fragment_shading_rate) {
                // SAFETY: the command buffer is recording, as above, and both are valid.
                unsafe { set(buffer, &rate.size, &rate.combiners) };
            }
            if let Some((masks, recording)) = masked {
                // SAFETY: as above: `count` stages, and as many shaders or null.
                let (stages, shaders) = unsafe { (slice(stages, count), slice(shaders, count)) };
                note_shaders(&recording, masks, stages, shaders);
            }
        }
    );
}

/// Shaders were bound to stages; without shaders the stages are unbound.
fn note_shaders(known: &Buffer, masks: &Masks, stages: &[vk::ShaderStageFlags], shaders: &[vk::ShaderEXT]) {
    let mut recorded = known.recorded();
    for (index, &stage) in stages.iter().enumerate() {
        let shader = shaders.get(index).copied().unwrap_or_default();
        match stage {
            vk::ShaderStageFlags::COMPUTE => recorded.compute.bind_shader(shader),
            vk::ShaderStageFlags::FRAGMENT => {
                recorded.use_pipeline(masks.shader_object(shader));
                recorded.drawing.bind_more();
            }
            // Other stages alone draw no colour, but replace the graphics pipeline as well.
            _ => recorded.drawing.bind_more(),
        }
    }
}
