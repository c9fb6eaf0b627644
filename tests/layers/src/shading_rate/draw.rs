//! Pipelines and rates as they are bound, and draws.

use super::emulator;
use super::rate::{COMMAND_RATE, Rate};
use crate::layer::hooks;
use ash::vk;
use std::ffi::CStr;

const KIND: &str = "command";

/// # Safety
/// As `vkCmdBindPipeline`.
pub(super) unsafe extern "system" fn bind_pipeline(
    buffer: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    pipeline: vk::Pipeline,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(buffer);
        if point == vk::PipelineBindPoint::GRAPHICS {
            let mut state = emulator.state();
            let state = &mut *state;
            let known = state.pipelines.get(&pipeline).cloned();
            if let Some(recording) = state.recordings.get_mut(&buffer) {
                if known.as_ref().is_some_and(|known| !known.dynamic) {
                    recording.set_rate = None;
                }
                recording.pipeline = known;
            }
        }
        (emulator.v1_0().cmd_bind_pipeline)(buffer, point, pipeline);
    }
}

/// # Safety
/// As `vkCmdSetFragmentShadingRateKHR`.
pub(super) unsafe extern "system" fn set_rate(
    buffer: vk::CommandBuffer,
    size: *const vk::Extent2D,
    combiners: *const [vk::FragmentShadingRateCombinerOpKHR; 2],
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(buffer);
        let mut state = emulator.state();
        let state = &mut *state;
        let rate = Rate { size: *size, combiners: *combiners };
        let enabled = emulator.enabled;
        let any = enabled.pipeline || enabled.primitive || enabled.attachment;
        let rule = "VUID-vkCmdSetFragmentShadingRateKHR-pipelineFragmentShadingRate-04509";
        state.findings.require(any, KIND, rule, buffer, || "no feature is enabled".to_owned());
        COMMAND_RATE.check(&emulator, &mut state.findings, rate, buffer);
        if let Some(recording) = state.recordings.get_mut(&buffer) {
            recording.set_rate = Some(rate);
        }
    }
}

/// # Safety
///
/// The buffer is live.
unsafe fn drawn(buffer: vk::CommandBuffer, command: &str, count: u32) {
    // SAFETY: the caller vouches for it.
    let emulator = unsafe { emulator(buffer) };
    let mut state = emulator.state();
    let state = &mut *state;
    if let Some(recording) = state.recordings.get_mut(&buffer) {
        recording.draw(&mut state.findings, buffer, command, count);
    }
}

macro_rules! draws {
    ($($hook:ident -> $next:ident, $name:literal, $count:expr, ($($argument:ident: $type:ty),*);)*) => {
        $(unsafe extern "system" fn $hook(buffer: vk::CommandBuffer, $($argument: $type),*) {
            // SAFETY: the application's valid arguments.
            unsafe {
                drawn(buffer, $name, $count);
                (emulator(buffer).v1_0().$next)(buffer, $($argument),*);
            }
        })*
    };
}

draws! {
    draw -> cmd_draw, "vkCmdDraw", 1,
        (vertices: u32, instances: u32, first_vertex: u32, first_instance: u32);
    draw_indexed -> cmd_draw_indexed, "vkCmdDrawIndexed", 1,
        (indices: u32, instances: u32, first_index: u32, vertex_offset: i32, first_instance: u32);
    draw_indirect -> cmd_draw_indirect, "vkCmdDrawIndirect", count,
        (arguments: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32);
    draw_indexed_indirect -> cmd_draw_indexed_indirect, "vkCmdDrawIndexedIndirect", count,
        (arguments: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32);
}

macro_rules! counted_draws {
    ($($hook:ident -> $next:ident, $name:literal;)*) => {
        /// Draws with their number in a buffer, which count as one.
        $(unsafe extern "system" fn $hook(
            buffer: vk::CommandBuffer,
            arguments: vk::Buffer,
            offset: vk::DeviceSize,
            count: vk::Buffer,
            count_offset: vk::DeviceSize,
            most: u32,
            stride: u32,
        ) {
            // SAFETY: the application's valid arguments.
            unsafe {
                drawn(buffer, $name, 1);
                let Some(next) = emulator(buffer).functions.$next else { return };
                next(buffer, arguments, offset, count, count_offset, most, stride);
            }
        })*
    };
}

counted_draws! {
    draw_indirect_count -> draw_indirect_count, "vkCmdDrawIndirectCount";
    draw_indexed_indirect_count -> draw_indexed_indirect_count, "vkCmdDrawIndexedIndirectCount";
}

pub(super) fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkCmdBindPipeline": PFN_vkCmdBindPipeline = bind_pipeline;
        c"vkCmdDraw": PFN_vkCmdDraw = draw;
        c"vkCmdDrawIndexed": PFN_vkCmdDrawIndexed = draw_indexed;
        c"vkCmdDrawIndirect": PFN_vkCmdDrawIndirect = draw_indirect;
        c"vkCmdDrawIndexedIndirect": PFN_vkCmdDrawIndexedIndirect = draw_indexed_indirect;
        c"vkCmdDrawIndirectCount": PFN_vkCmdDrawIndirectCount = draw_indirect_count;
        c"vkCmdDrawIndirectCountKHR": PFN_vkCmdDrawIndirectCount = draw_indirect_count;
        c"vkCmdDrawIndexedIndirectCount": PFN_vkCmdDrawIndexedIndirectCount = draw_indexed_indirect_count;
        c"vkCmdDrawIndexedIndirectCountKHR":
            PFN_vkCmdDrawIndexedIndirectCount = draw_indexed_indirect_count;
    }
    None
}
