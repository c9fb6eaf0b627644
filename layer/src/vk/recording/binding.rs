//! Commands that bind pipelines and shaders, and set their rate.

use super::{drawing, stencil, with_buffer};
use crate::abi::copies::slice;
use crate::abi::guard;
use crate::backend::attachment::commands::SetRate;
use crate::vk::device;
use ash::vk::{self, FragmentShadingRateCombinerOpKHR as Combiner};

/// `vkCmdSetFragmentShadingRateKHR`.
pub unsafe extern "system" fn set_rate(
    buffer: vk::CommandBuffer,
    size: *const vk::Extent2D,
    combiners: *const [Combiner; 2],
) {
    guard(
        "vkCmdSetFragmentShadingRateKHR",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: buffer, cmd_set_fragment_shading_rate(buffer, size, combiners), ())
        },
        |answer| {
            // SAFETY: the application's own arguments, which are valid.
            unsafe {
                let Some((known, next)) = device::with(buffer, |next| next.cmd_set_fragment_shading_rate)
                else {
                    return;
                };
                let Some(rates) = known.rates() else {
                    next(buffer, size, combiners);
                    return answer.made();
                };
                let rate = rates.set_rates.set(buffer, SetRate { size: *size, combiners: *combiners });
                next(buffer, &rate.size, &rate.combiners);
                answer.made();
            }
        },
    );
}

/// `vkCmdBindPipeline`, hooked only where the rate of a pipeline may have to be set, or passes may have masks.
pub unsafe extern "system" fn bind_pipeline(
    buffer: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    pipeline: vk::Pipeline,
) {
    guard(
        "vkCmdBindPipeline",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: buffer, cmd_bind_pipeline(buffer, point, pipeline), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = with_buffer(buffer, |next| next.cmd_bind_pipeline) else {
                    return;
                };
                let bind = |pipeline| {
                    next(buffer, point, pipeline);
                    answer.made();
                };
                let Some(known) = known else { return bind(pipeline) };
                if known.armed.masks.is_some() && point == vk::PipelineBindPoint::GRAPHICS {
                    stencil::changes(&known, buffer);
                }
                match point {
                    vk::PipelineBindPoint::GRAPHICS => {
                        drawing::bind(&known, buffer, pipeline, bind);
                    }
                    _ => bind(pipeline),
                }
                if let (Some(rates), vk::PipelineBindPoint::GRAPHICS) = (&known.armed.rate_attachments, point)
                    && let Some(pipeline) = rates.pipeline_rate(pipeline)
                    && let Some(rate) = rates.set_rates.bound(buffer, pipeline)
                    && let Some(set) = known.armed.next.cmd_set_fragment_shading_rate
                {
                    set(buffer, &rate.size, &rate.combiners);
                }
                if let Some(masks) = &known.armed.masks {
                    match point {
                        vk::PipelineBindPoint::GRAPHICS => {
                            known.recorded().use_pipeline(masks.pipeline(pipeline));
                        }
                        vk::PipelineBindPoint::COMPUTE => known.recorded().compute.bind_pipeline(pipeline),
                        _ => {}
                    }
                }
            }
        },
    );
}

/// `vkCmdBindShadersEXT`.
pub unsafe extern "system" fn bind_shaders(
    buffer: vk::CommandBuffer,
    count: u32,
    stages: *const vk::ShaderStageFlags,
    shaders: *const vk::ShaderEXT,
) {
    guard(
        "vkCmdBindShadersEXT",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: buffer, cmd_bind_shaders(buffer, count, stages, shaders), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(buffer, |next| next.cmd_bind_shaders) else { return };
                let masked = known.masks().zip(super::buffer(buffer));
                if let Some((_, recording)) = &masked {
                    drawing::leave(recording, buffer);
                    stencil::changes(recording, buffer);
                }
                next(buffer, count, stages, shaders);
                answer.made();
                if let Some(rates) = known.rates()
                    && let Some(rate) = rates.shaders_bound(buffer, count, stages, shaders)
                    && let Some(set) = known.hooked.cmd_set_fragment_shading_rate
                {
                    set(buffer, &rate.size, &rate.combiners);
                }
                if let Some((masks, recording)) = masked {
                    let stages = slice(stages, count);
                    let shader = |index| slice(shaders, count).get(index).copied().unwrap_or_default();
                    let mut recorded = recording.recorded();
                    for (index, &stage) in stages.iter().enumerate() {
                        match stage {
                            vk::ShaderStageFlags::COMPUTE => recorded.compute.bind_shader(shader(index)),
                            vk::ShaderStageFlags::FRAGMENT => {
                                recorded.use_pipeline(masks.shader_object(shader(index)));
                                recorded.drawing.bind_more();
                            }
                            // Other stages alone draw no colour, but replace the graphics pipeline as well.
                            _ => recorded.drawing.bind_more(),
                        }
                    }
                }
            }
        },
    );
}
