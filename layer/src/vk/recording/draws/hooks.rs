//! Hooks of draws. A draw of the pass that its thread records goes straight down once it is counted.

use super::cached_device::cached_device;
use super::{Counted, Counts, count, count_tracked};
use crate::vk::recording::with_buffer;
use ash::vk;
use std::ffi::c_void;

/// Hooks of draws; `$counts` are the counts of a call.
macro_rules! draws {
    ($($name:ident, $call:literal, $field:ident: ($($argument:ident: $type:ty),*), counts $counts:expr;)*) => {$(
        #[doc = concat!("`", $call, "`.")]
        ///
        /// # Safety
        ///
        /// The valid usage of the call.
        #[allow(clippy::too_many_arguments, reason = "those of the call")]
        pub unsafe extern "system" fn $name(handle: vk::CommandBuffer, $($argument: $type),*) {
            let counts = $counts;
            // SAFETY: the application's own command buffer, which is live.
            if let Some(next) = unsafe { cached_device(handle) }.and_then(|armed| armed.next.$field)
                && count(handle, counts) == Counted::Done
            {
                // SAFETY: the application's own arguments.
                return unsafe { next(handle, $($argument),*) };
            }
            hook!($call, with_buffer, $field(handle $(, $argument)*), |known, next| {
                next();
                if let Some(known) = known.filter(|known| known.armed.follows_passes()) {
                    count_tracked(&known, handle, counts);
                }
            });
        }
    )*};
}

draws! {
    draw, "vkCmdDraw", cmd_draw: (vertices: u32, instances: u32, first_vertex: u32, first_instance: u32),
        counts Counts::of(vertices, instances);
    draw_indexed, "vkCmdDrawIndexed", cmd_draw_indexed: (
        indices: u32, instances: u32, first_index: u32, vertex_offset: i32, first_instance: u32
    ), counts Counts::of(indices, instances);
    draw_indirect, "vkCmdDrawIndirect", cmd_draw_indirect: (
        from: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_indexed_indirect, "vkCmdDrawIndexedIndirect", cmd_draw_indexed_indirect: (
        from: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_indirect_count, "vkCmdDrawIndirectCount", cmd_draw_indirect_count: (
        from: vk::Buffer, offset: vk::DeviceSize, count_buffer: vk::Buffer, count_offset: vk::DeviceSize, most: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_indexed_indirect_count, "vkCmdDrawIndexedIndirectCount", cmd_draw_indexed_indirect_count: (
        from: vk::Buffer, offset: vk::DeviceSize, count_buffer: vk::Buffer, count_offset: vk::DeviceSize, most: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_indirect_count_amd, "vkCmdDrawIndirectCountAMD", cmd_draw_indirect_count_amd: (
        from: vk::Buffer, offset: vk::DeviceSize, count_buffer: vk::Buffer, count_offset: vk::DeviceSize, most: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_indexed_indirect_count_amd, "vkCmdDrawIndexedIndirectCountAMD", cmd_draw_indexed_indirect_count_amd: (
        from: vk::Buffer, offset: vk::DeviceSize, count_buffer: vk::Buffer, count_offset: vk::DeviceSize, most: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_mesh_tasks, "vkCmdDrawMeshTasksEXT", cmd_draw_mesh_tasks: (x: u32, y: u32, z: u32),
        counts Counts::INDIRECT;
    draw_mesh_tasks_indirect, "vkCmdDrawMeshTasksIndirectEXT", cmd_draw_mesh_tasks_indirect: (
        from: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_mesh_tasks_indirect_count, "vkCmdDrawMeshTasksIndirectCountEXT", cmd_draw_mesh_tasks_indirect_count: (
        from: vk::Buffer, offset: vk::DeviceSize, count_buffer: vk::Buffer, count_offset: vk::DeviceSize, most: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_multi, "vkCmdDrawMultiEXT", cmd_draw_multi: (
        draw_count: u32, infos: *const vk::MultiDrawInfoEXT, instances: u32, first_instance: u32, stride: u32
    ), counts Counts::INDIRECT;
    draw_multi_indexed, "vkCmdDrawMultiIndexedEXT", cmd_draw_multi_indexed: (
        draw_count: u32,
        infos: *const vk::MultiDrawIndexedInfoEXT,
        instances: u32,
        first_instance: u32,
        stride: u32,
        vertex_offset: *const i32
    ), counts Counts::INDIRECT;
    draw_byte_count, "vkCmdDrawIndirectByteCountEXT", cmd_draw_indirect_byte_count: (
        instances: u32,
        first_instance: u32,
        counter: vk::Buffer,
        counter_offset: vk::DeviceSize,
        offset: u32,
        vertex_stride: u32
    ), counts Counts::INDIRECT;
    draw_indirect2, "vkCmdDrawIndirect2KHR", cmd_draw_indirect2: (info: *const c_void), counts Counts::INDIRECT;
    draw_indexed_indirect2, "vkCmdDrawIndexedIndirect2KHR", cmd_draw_indexed_indirect2: (info: *const c_void),
        counts Counts::INDIRECT;
    draw_indirect_count2, "vkCmdDrawIndirectCount2KHR", cmd_draw_indirect_count2: (info: *const c_void),
        counts Counts::INDIRECT;
    draw_indexed_indirect_count2, "vkCmdDrawIndexedIndirectCount2KHR", cmd_draw_indexed_indirect_count2: (
        info: *const c_void
    ), counts Counts::INDIRECT;
    draw_mesh_tasks_indirect2, "vkCmdDrawMeshTasksIndirect2EXT", cmd_draw_mesh_tasks_indirect2: (
        info: *const c_void
    ), counts Counts::INDIRECT;
    draw_mesh_tasks_indirect_count2, "vkCmdDrawMeshTasksIndirectCount2EXT", cmd_draw_mesh_tasks_indirect_count2: (
        info: *const c_void
    ), counts Counts::INDIRECT;
    draw_byte_count2, "vkCmdDrawIndirectByteCount2EXT", cmd_draw_indirect_byte_count2: (
        instances: u32,
        first_instance: u32,
        counter: *const c_void,
        counter_offset: u32,
        vertex_stride: u32
    ), counts Counts::INDIRECT;
}
