//! Our hooks of the functions of armed devices, as `functions` lists them.

use crate::vk::functions::ArmedTable;
use crate::vk::hooks::{
    descriptors, framebuffers, images, layouts, pipelines, queues, render_passes, shader_modules,
    shader_objects, views,
};
use crate::vk::newer as types;
use crate::vk::recording::{
    binding, buffers, compute, descriptor_buffers, dispatches, draws, generated, heaps, image_layouts,
    passes, pending, queries, rects, rendering, stencil, transfers,
};
use crate::vk::submit;
use ash::vk;
use std::ffi::CStr;

macro_rules! armed_hooks {
    ($($field:ident: $pfn:ident = $name:literal $(since $version:ident, before $extension:literal)? => $hook:path;)*) => {
        /// Our hook for a function of an armed device.
        pub fn armed_hook(name: &CStr) -> vk::PFN_vkVoidFunction {
            $(if name == $name $(|| name == $extension)? {
                let hook: types::$pfn = $hook;
                // SAFETY: PFN_vkVoidFunction may carry any function; the receiver casts it back to the type that
                // belongs to the name.
                return Some(unsafe {
                    std::mem::transmute::<types::$pfn, unsafe extern "system" fn()>(hook)
                });
            })*
            None
        }
    };
}

armed_functions!(armed_hooks);

/// Our hook for a function of an armed device with that table; `None` if the device lacks the function.
pub fn hook_of(table: &ArmedTable, name: &CStr) -> vk::PFN_vkVoidFunction {
    if table.lacks(name) { None } else { armed_hook(name) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pass that ends past our hooks is never filled, and a mask changes results of a query past them.
    #[test]
    fn passes_are_followed_by_the_names_of_every_version() {
        for name in [
            c"vkCmdBeginRenderPass",
            c"vkCmdBeginRenderPass2",
            c"vkCmdBeginRenderPass2KHR",
            c"vkCmdEndRenderPass",
            c"vkCmdEndRenderPass2",
            c"vkCmdEndRenderPass2KHR",
            c"vkCmdBeginRendering",
            c"vkCmdBeginRenderingKHR",
            c"vkCmdEndRendering",
            c"vkCmdEndRenderingKHR",
            c"vkCmdEndRendering2KHR",
            c"vkCmdEndRendering2EXT",
            c"vkCmdBeginQuery",
            c"vkCmdBeginQueryIndexedEXT",
            c"vkCmdEndQuery",
            c"vkCmdEndQueryIndexedEXT",
            c"vkCmdBeginConditionalRenderingEXT",
            c"vkCmdBeginConditionalRendering2EXT",
        ] {
            assert!(armed_hook(name).is_some(), "{name:?}");
        }
    }

    /// A command that binds descriptors past our hooks leaves bindings that are not restored after our work.
    #[test]
    fn descriptors_are_followed_by_the_names_of_every_version() {
        for name in [
            c"vkCmdBindDescriptorSets",
            c"vkCmdBindDescriptorSets2",
            c"vkCmdBindDescriptorSets2KHR",
            c"vkCmdPushDescriptorSet",
            c"vkCmdPushDescriptorSetKHR",
            c"vkCmdPushDescriptorSet2",
            c"vkCmdPushDescriptorSet2KHR",
            c"vkCmdPushDescriptorSetWithTemplate",
            c"vkCmdPushDescriptorSetWithTemplateKHR",
            c"vkCmdPushDescriptorSetWithTemplate2",
            c"vkCmdPushDescriptorSetWithTemplate2KHR",
            c"vkCmdBindDescriptorBuffersEXT",
            c"vkCmdSetDescriptorBufferOffsetsEXT",
            c"vkCmdSetDescriptorBufferOffsets2EXT",
            c"vkCmdBindDescriptorBufferEmbeddedSamplersEXT",
            c"vkCmdBindDescriptorBufferEmbeddedSamplers2EXT",
            c"vkCmdBindSamplerHeapEXT",
            c"vkCmdBindResourceHeapEXT",
            c"vkCmdPushDataEXT",
            c"vkCmdPushConstants",
            c"vkCmdPushConstants2",
            c"vkCmdPushConstants2KHR",
        ] {
            assert!(armed_hook(name).is_some(), "{name:?}");
        }
    }
}
