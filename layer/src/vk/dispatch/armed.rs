//! Our hooks of the functions of armed devices, as `functions` lists them.

use crate::vk::functions::ArmedTable;
use crate::vk::hooks::{
    descriptors, framebuffers, images, layouts, pipelines, queues, render_passes, shader_modules,
    shader_objects, views,
};
use crate::vk::recording::{
    binding, buffers, compute, descriptor_buffers, drawing, draws, image_layouts, passes, pending, queries,
    rendering, stencil, transfers,
};
use crate::vk::submit;
use ash::vk;
use std::ffi::CStr;

macro_rules! armed_hooks {
    ($($field:ident: $pfn:ident = $name:literal $(since $version:ident, before $extension:literal)? => $hook:path;)*) => {
        /// Our hook for a function of an armed device.
        pub fn armed_hook(name: &CStr) -> vk::PFN_vkVoidFunction {
            $(if name == $name $(|| name == $extension)? {
                let hook: vk::$pfn = $hook;
                // SAFETY: PFN_vkVoidFunction may carry any function; the receiver casts it back to the type that
                // belongs to the name.
                return Some(unsafe {
                    std::mem::transmute::<vk::$pfn, unsafe extern "system" fn()>(hook)
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
        ] {
            assert!(armed_hook(name).is_some(), "{name:?}");
        }
    }
}
