//! The next layer's functions that this layer calls, resolved beforehand.

use super::newer as types;
use ash::vk::{self, API_VERSION_1_1, API_VERSION_1_2, API_VERSION_1_3};
use std::ffi::CStr;

/// Newer than the headers of `ash`.
const API_VERSION_1_4: u32 = vk::make_api_version(0, 1, 4, 0);

macro_rules! table {
    ($table:ident; $($name:literal: $pfn:ident => $field:ident;)*) => {
        /// The next layer's functions that this layer calls.
        pub struct $table {
            $(pub $field: vk::$pfn,)*
        }

        impl $table {
            /// Resolves every function beforehand; `None` when one is missing.
            ///
            /// # Safety
            ///
            /// For a name, `get` returns the function of that name, or `None`.
            pub unsafe fn load(get: impl Fn(&CStr) -> vk::PFN_vkVoidFunction) -> Option<Self> {
                Some(Self {
                    // SAFETY: `get` returns the function of that name, as this function requires, and the list gives
                    // each name its type.
                    $($field: unsafe {
                        std::mem::transmute::<unsafe extern "system" fn(), vk::$pfn>(get($name)?)
                    },)*
                })
            }
        }
    };
}

table! {
    InstanceTable;
    c"vkDestroyInstance": PFN_vkDestroyInstance => destroy_instance;
    c"vkGetPhysicalDeviceProperties": PFN_vkGetPhysicalDeviceProperties => physical_device_properties;
    c"vkEnumerateDeviceExtensionProperties": PFN_vkEnumerateDeviceExtensionProperties =>
        enumerate_device_extensions;
}

table! {
    DeviceTable;
    c"vkDestroyDevice": PFN_vkDestroyDevice => destroy_device;
}

/// Invokes the macro `$with` with every function of armed devices, of which a device may lack some. A line is the field of the table and
/// its type, the name, where the function came into Vulkan's core later the version and the extension's name for it, and our hook.
macro_rules! armed_functions {
    ($with:ident) => {
        $with! {
            create_image: PFN_vkCreateImage = c"vkCreateImage" => images::create;
            image_memory_requirements: PFN_vkGetDeviceImageMemoryRequirements = c"vkGetDeviceImageMemoryRequirements"
                since API_VERSION_1_3, before c"vkGetDeviceImageMemoryRequirementsKHR" => images::memory_requirements;
            destroy_image: PFN_vkDestroyImage = c"vkDestroyImage" => images::destroy;
            create_image_view: PFN_vkCreateImageView = c"vkCreateImageView" => views::create;
            destroy_image_view: PFN_vkDestroyImageView = c"vkDestroyImageView" => views::destroy;
            create_render_pass: PFN_vkCreateRenderPass = c"vkCreateRenderPass" => render_passes::create;
            create_render_pass2: PFN_vkCreateRenderPass2 = c"vkCreateRenderPass2"
                since API_VERSION_1_2, before c"vkCreateRenderPass2KHR" => render_passes::create2;
            destroy_render_pass: PFN_vkDestroyRenderPass = c"vkDestroyRenderPass" => render_passes::destroy;
            create_framebuffer: PFN_vkCreateFramebuffer = c"vkCreateFramebuffer" => framebuffers::create;
            destroy_framebuffer: PFN_vkDestroyFramebuffer = c"vkDestroyFramebuffer" => framebuffers::destroy;
            get_device_queue: PFN_vkGetDeviceQueue = c"vkGetDeviceQueue" => queues::get;
            get_device_queue2: PFN_vkGetDeviceQueue2 = c"vkGetDeviceQueue2" => queues::get2;
            create_descriptor_set_layout: PFN_vkCreateDescriptorSetLayout = c"vkCreateDescriptorSetLayout"
                => layouts::create_set_layout;
            destroy_descriptor_set_layout: PFN_vkDestroyDescriptorSetLayout = c"vkDestroyDescriptorSetLayout"
                => layouts::destroy_set_layout;
            allocate_descriptor_sets: PFN_vkAllocateDescriptorSets = c"vkAllocateDescriptorSets" => descriptors::allocate;
            free_descriptor_sets: PFN_vkFreeDescriptorSets = c"vkFreeDescriptorSets" => descriptors::free;
            reset_descriptor_pool: PFN_vkResetDescriptorPool = c"vkResetDescriptorPool" => descriptors::reset_pool;
            destroy_descriptor_pool: PFN_vkDestroyDescriptorPool = c"vkDestroyDescriptorPool"
                => descriptors::destroy_pool;
            update_descriptor_sets: PFN_vkUpdateDescriptorSets = c"vkUpdateDescriptorSets" => descriptors::update;
            update_descriptor_set_with_template: PFN_vkUpdateDescriptorSetWithTemplate =
                c"vkUpdateDescriptorSetWithTemplate"
                since API_VERSION_1_1, before c"vkUpdateDescriptorSetWithTemplateKHR" => descriptors::update_with_template;
            create_descriptor_update_template: PFN_vkCreateDescriptorUpdateTemplate =
                c"vkCreateDescriptorUpdateTemplate"
                since API_VERSION_1_1, before c"vkCreateDescriptorUpdateTemplateKHR" => descriptors::create_template;
            destroy_descriptor_update_template: PFN_vkDestroyDescriptorUpdateTemplate =
                c"vkDestroyDescriptorUpdateTemplate"
                since API_VERSION_1_1, before c"vkDestroyDescriptorUpdateTemplateKHR" => descriptors::destroy_template;
            create_pipeline_layout: PFN_vkCreatePipelineLayout = c"vkCreatePipelineLayout" => layouts::create;
            destroy_pipeline_layout: PFN_vkDestroyPipelineLayout = c"vkDestroyPipelineLayout" => layouts::destroy;
            create_query_pool: PFN_vkCreateQueryPool = c"vkCreateQueryPool" => queues::create_query_pool;
            destroy_query_pool: PFN_vkDestroyQueryPool = c"vkDestroyQueryPool" => queues::destroy_query_pool;

            create_command_pool: PFN_vkCreateCommandPool = c"vkCreateCommandPool" => buffers::create_pool;
            destroy_command_pool: PFN_vkDestroyCommandPool = c"vkDestroyCommandPool" => buffers::destroy_pool;
            reset_command_pool: PFN_vkResetCommandPool = c"vkResetCommandPool" => buffers::reset_pool;
            allocate_command_buffers: PFN_vkAllocateCommandBuffers = c"vkAllocateCommandBuffers" => buffers::allocate;
            free_command_buffers: PFN_vkFreeCommandBuffers = c"vkFreeCommandBuffers" => buffers::free;
            begin_command_buffer: PFN_vkBeginCommandBuffer = c"vkBeginCommandBuffer" => buffers::begin;
            end_command_buffer: PFN_vkEndCommandBuffer = c"vkEndCommandBuffer" => pending::end_buffer;
            reset_command_buffer: PFN_vkResetCommandBuffer = c"vkResetCommandBuffer" => buffers::reset;
            cmd_execute_commands: PFN_vkCmdExecuteCommands = c"vkCmdExecuteCommands" => buffers::execute;

            cmd_begin_render_pass: PFN_vkCmdBeginRenderPass = c"vkCmdBeginRenderPass" => passes::begin;
            cmd_begin_render_pass2: PFN_vkCmdBeginRenderPass2 = c"vkCmdBeginRenderPass2"
                since API_VERSION_1_2, before c"vkCmdBeginRenderPass2KHR" => passes::begin2;
            cmd_end_render_pass: PFN_vkCmdEndRenderPass = c"vkCmdEndRenderPass" => passes::end;
            cmd_end_render_pass2: PFN_vkCmdEndRenderPass2 = c"vkCmdEndRenderPass2"
                since API_VERSION_1_2, before c"vkCmdEndRenderPass2KHR" => passes::end2;
            cmd_begin_rendering: PFN_vkCmdBeginRendering = c"vkCmdBeginRendering"
                since API_VERSION_1_3, before c"vkCmdBeginRenderingKHR" => rendering::begin;
            cmd_end_rendering: PFN_vkCmdEndRendering = c"vkCmdEndRendering"
                since API_VERSION_1_3, before c"vkCmdEndRenderingKHR" => rendering::end;
            cmd_end_rendering2: PFN_vkCmdEndRendering2 = c"vkCmdEndRendering2KHR" => rendering::end2;
            cmd_end_rendering2_ext: PFN_vkCmdEndRendering2 = c"vkCmdEndRendering2EXT" => rendering::end2_ext;
            create_shader_module: PFN_vkCreateShaderModule = c"vkCreateShaderModule" => shader_modules::create_shader_module;
            destroy_shader_module: PFN_vkDestroyShaderModule = c"vkDestroyShaderModule"
                => shader_modules::destroy_shader_module;
            get_shader_module_identifier: PFN_vkGetShaderModuleIdentifierEXT = c"vkGetShaderModuleIdentifierEXT"
                => shader_modules::of_module;
            get_shader_module_create_info_identifier: PFN_vkGetShaderModuleCreateInfoIdentifierEXT =
                c"vkGetShaderModuleCreateInfoIdentifierEXT" => shader_modules::of_create_info;
            create_graphics_pipelines: PFN_vkCreateGraphicsPipelines = c"vkCreateGraphicsPipelines"
                => pipelines::create_pipelines;
            destroy_pipeline: PFN_vkDestroyPipeline = c"vkDestroyPipeline" => pipelines::destroy_pipeline;
            cmd_bind_pipeline: PFN_vkCmdBindPipeline = c"vkCmdBindPipeline" => binding::bind_pipeline;
            cmd_set_fragment_shading_rate: PFN_vkCmdSetFragmentShadingRateKHR = c"vkCmdSetFragmentShadingRateKHR"
                => binding::set_rate;
            create_shaders: PFN_vkCreateShadersEXT = c"vkCreateShadersEXT" => shader_objects::create;
            destroy_shader: PFN_vkDestroyShaderEXT = c"vkDestroyShaderEXT" => shader_objects::destroy;
            cmd_bind_shaders: PFN_vkCmdBindShadersEXT = c"vkCmdBindShadersEXT" => binding::bind_shaders;

            cmd_draw: PFN_vkCmdDraw = c"vkCmdDraw" => draws::draw;
            cmd_draw_indexed: PFN_vkCmdDrawIndexed = c"vkCmdDrawIndexed" => draws::draw_indexed;
            cmd_draw_indirect: PFN_vkCmdDrawIndirect = c"vkCmdDrawIndirect" => draws::draw_indirect;
            cmd_draw_indexed_indirect: PFN_vkCmdDrawIndexedIndirect = c"vkCmdDrawIndexedIndirect"
                => draws::draw_indexed_indirect;
            cmd_draw_indirect_count: PFN_vkCmdDrawIndirectCount = c"vkCmdDrawIndirectCount"
                since API_VERSION_1_2, before c"vkCmdDrawIndirectCountKHR" => draws::draw_indirect_count;
            cmd_draw_indexed_indirect_count: PFN_vkCmdDrawIndexedIndirectCount = c"vkCmdDrawIndexedIndirectCount"
                since API_VERSION_1_2, before c"vkCmdDrawIndexedIndirectCountKHR" => draws::draw_indexed_indirect_count;
            cmd_draw_indirect_count_amd: PFN_vkCmdDrawIndirectCount = c"vkCmdDrawIndirectCountAMD"
                => draws::draw_indirect_count_amd;
            cmd_draw_indexed_indirect_count_amd: PFN_vkCmdDrawIndexedIndirectCount = c"vkCmdDrawIndexedIndirectCountAMD"
                => draws::draw_indexed_indirect_count_amd;
            cmd_draw_mesh_tasks: PFN_vkCmdDrawMeshTasksEXT = c"vkCmdDrawMeshTasksEXT" => draws::draw_mesh_tasks;
            cmd_draw_mesh_tasks_indirect: PFN_vkCmdDrawMeshTasksIndirectEXT = c"vkCmdDrawMeshTasksIndirectEXT"
                => draws::draw_mesh_tasks_indirect;
            cmd_draw_mesh_tasks_indirect_count: PFN_vkCmdDrawMeshTasksIndirectCountEXT =
                c"vkCmdDrawMeshTasksIndirectCountEXT" => draws::draw_mesh_tasks_indirect_count;
            cmd_draw_multi: PFN_vkCmdDrawMultiEXT = c"vkCmdDrawMultiEXT" => draws::draw_multi;
            cmd_draw_multi_indexed: PFN_vkCmdDrawMultiIndexedEXT = c"vkCmdDrawMultiIndexedEXT"
                => draws::draw_multi_indexed;
            cmd_draw_indirect_byte_count: PFN_vkCmdDrawIndirectByteCountEXT = c"vkCmdDrawIndirectByteCountEXT"
                => draws::draw_byte_count;
            cmd_draw_indirect2: PFN_vkCmdWithInfo = c"vkCmdDrawIndirect2KHR" => draws::draw_indirect2;
            cmd_draw_indexed_indirect2: PFN_vkCmdWithInfo = c"vkCmdDrawIndexedIndirect2KHR"
                => draws::draw_indexed_indirect2;
            cmd_draw_indirect_count2: PFN_vkCmdWithInfo = c"vkCmdDrawIndirectCount2KHR" => draws::draw_indirect_count2;
            cmd_draw_indexed_indirect_count2: PFN_vkCmdWithInfo = c"vkCmdDrawIndexedIndirectCount2KHR"
                => draws::draw_indexed_indirect_count2;
            cmd_draw_mesh_tasks_indirect2: PFN_vkCmdWithInfo = c"vkCmdDrawMeshTasksIndirect2EXT"
                => draws::draw_mesh_tasks_indirect2;
            cmd_draw_mesh_tasks_indirect_count2: PFN_vkCmdWithInfo = c"vkCmdDrawMeshTasksIndirectCount2EXT"
                => draws::draw_mesh_tasks_indirect_count2;
            cmd_draw_indirect_byte_count2: PFN_vkCmdDrawIndirectByteCount2EXT = c"vkCmdDrawIndirectByteCount2EXT"
                => draws::draw_byte_count2;
            cmd_execute_generated_commands: PFN_vkCmdExecuteGeneratedCommandsEXT = c"vkCmdExecuteGeneratedCommandsEXT"
                => generated::execute;
            cmd_execute_generated_commands_nv: PFN_vkCmdExecuteGeneratedCommandsNV = c"vkCmdExecuteGeneratedCommandsNV"
                => generated::execute_nv;

            cmd_set_viewport: PFN_vkCmdSetViewport = c"vkCmdSetViewport" => rects::set_viewport;
            cmd_set_scissor: PFN_vkCmdSetScissor = c"vkCmdSetScissor" => rects::set_scissor;
            cmd_set_viewport_with_count: PFN_vkCmdSetViewportWithCount = c"vkCmdSetViewportWithCount"
                since API_VERSION_1_3, before c"vkCmdSetViewportWithCountEXT" => rects::set_viewport_with_count;
            cmd_set_scissor_with_count: PFN_vkCmdSetScissorWithCount = c"vkCmdSetScissorWithCount"
                since API_VERSION_1_3, before c"vkCmdSetScissorWithCountEXT" => rects::set_scissor_with_count;

            cmd_bind_descriptor_sets: PFN_vkCmdBindDescriptorSets = c"vkCmdBindDescriptorSets" => compute::bind_sets;
            cmd_push_descriptor_set: PFN_vkCmdPushDescriptorSetKHR = c"vkCmdPushDescriptorSet"
                since API_VERSION_1_4, before c"vkCmdPushDescriptorSetKHR" => compute::push_set;
            cmd_push_descriptor_set_with_template: PFN_vkCmdPushDescriptorSetWithTemplateKHR =
                c"vkCmdPushDescriptorSetWithTemplate"
                since API_VERSION_1_4, before c"vkCmdPushDescriptorSetWithTemplateKHR" => compute::push_set_with_template;
            cmd_bind_descriptor_sets2: PFN_vkCmdBindDescriptorSets2KHR = c"vkCmdBindDescriptorSets2"
                since API_VERSION_1_4, before c"vkCmdBindDescriptorSets2KHR" => compute::bind_sets2;
            cmd_push_descriptor_set2: PFN_vkCmdPushDescriptorSet2KHR = c"vkCmdPushDescriptorSet2"
                since API_VERSION_1_4, before c"vkCmdPushDescriptorSet2KHR" => compute::push_set2;
            cmd_push_descriptor_set_with_template2: PFN_vkCmdPushDescriptorSetWithTemplate2KHR =
                c"vkCmdPushDescriptorSetWithTemplate2"
                since API_VERSION_1_4, before c"vkCmdPushDescriptorSetWithTemplate2KHR" => compute::push_set_with_template2;
            cmd_bind_descriptor_buffers: PFN_vkCmdBindDescriptorBuffersEXT = c"vkCmdBindDescriptorBuffersEXT"
                => descriptor_buffers::bind;
            cmd_set_descriptor_buffer_offsets: PFN_vkCmdSetDescriptorBufferOffsetsEXT =
                c"vkCmdSetDescriptorBufferOffsetsEXT" => descriptor_buffers::set_offsets;
            cmd_set_descriptor_buffer_offsets2: PFN_vkCmdSetDescriptorBufferOffsets2EXT =
                c"vkCmdSetDescriptorBufferOffsets2EXT" => descriptor_buffers::set_offsets2;
            cmd_bind_descriptor_buffer_embedded_samplers: PFN_vkCmdBindDescriptorBufferEmbeddedSamplersEXT =
                c"vkCmdBindDescriptorBufferEmbeddedSamplersEXT" => descriptor_buffers::bind_samplers;
            cmd_bind_descriptor_buffer_embedded_samplers2: PFN_vkCmdBindDescriptorBufferEmbeddedSamplers2EXT =
                c"vkCmdBindDescriptorBufferEmbeddedSamplers2EXT" => descriptor_buffers::bind_samplers2;
            cmd_bind_sampler_heap: PFN_vkCmdBindHeap = c"vkCmdBindSamplerHeapEXT" => heaps::bind_samplers;
            cmd_bind_resource_heap: PFN_vkCmdBindHeap = c"vkCmdBindResourceHeapEXT" => heaps::bind_resources;
            cmd_push_data: PFN_vkCmdPushData = c"vkCmdPushDataEXT" => heaps::push_data;
            cmd_push_constants: PFN_vkCmdPushConstants = c"vkCmdPushConstants" => heaps::push_constants;
            cmd_push_constants2: PFN_vkCmdPushConstants2KHR = c"vkCmdPushConstants2"
                since API_VERSION_1_4, before c"vkCmdPushConstants2KHR" => heaps::push_constants2;

            cmd_set_stencil_test_enable: PFN_vkCmdSetStencilTestEnable = c"vkCmdSetStencilTestEnable"
                since API_VERSION_1_3, before c"vkCmdSetStencilTestEnableEXT" => stencil::set_test;
            cmd_set_stencil_op: PFN_vkCmdSetStencilOp = c"vkCmdSetStencilOp"
                since API_VERSION_1_3, before c"vkCmdSetStencilOpEXT" => stencil::set_op;

            cmd_clear_attachments: PFN_vkCmdClearAttachments = c"vkCmdClearAttachments" => passes::clear_attachments;

            cmd_begin_query: PFN_vkCmdBeginQuery = c"vkCmdBeginQuery" => queries::begin;
            cmd_end_query: PFN_vkCmdEndQuery = c"vkCmdEndQuery" => queries::end;
            cmd_begin_query_indexed: PFN_vkCmdBeginQueryIndexedEXT = c"vkCmdBeginQueryIndexedEXT"
                => queries::begin_indexed;
            cmd_end_query_indexed: PFN_vkCmdEndQueryIndexedEXT = c"vkCmdEndQueryIndexedEXT" => queries::end_indexed;
            cmd_begin_conditional_rendering2: PFN_vkCmdWithInfo = c"vkCmdBeginConditionalRendering2EXT"
                => queries::begin_conditional2;
            cmd_begin_conditional_rendering: PFN_vkCmdBeginConditionalRenderingEXT =
                c"vkCmdBeginConditionalRenderingEXT" => queries::begin_conditional;
            cmd_end_conditional_rendering: PFN_vkCmdEndConditionalRenderingEXT =
                c"vkCmdEndConditionalRenderingEXT" => queries::end_conditional;

            cmd_dispatch: PFN_vkCmdDispatch = c"vkCmdDispatch" => dispatches::dispatch;
            cmd_dispatch_base: PFN_vkCmdDispatchBase = c"vkCmdDispatchBase"
                since API_VERSION_1_1, before c"vkCmdDispatchBaseKHR" => dispatches::dispatch_base;
            cmd_dispatch_indirect: PFN_vkCmdDispatchIndirect = c"vkCmdDispatchIndirect" => dispatches::dispatch_indirect;

            cmd_pipeline_barrier: PFN_vkCmdPipelineBarrier = c"vkCmdPipelineBarrier" => image_layouts::pipeline_barrier;
            cmd_pipeline_barrier2: PFN_vkCmdPipelineBarrier2 = c"vkCmdPipelineBarrier2"
                since API_VERSION_1_3, before c"vkCmdPipelineBarrier2KHR" => image_layouts::pipeline_barrier2;

            cmd_set_event: PFN_vkCmdSetEvent = c"vkCmdSetEvent" => pending::set_event;
            cmd_set_event2: PFN_vkCmdSetEvent2 = c"vkCmdSetEvent2"
                since API_VERSION_1_3, before c"vkCmdSetEvent2KHR" => pending::set_event2;
            cmd_wait_events: PFN_vkCmdWaitEvents = c"vkCmdWaitEvents" => pending::wait_events;
            cmd_wait_events2: PFN_vkCmdWaitEvents2 = c"vkCmdWaitEvents2"
                since API_VERSION_1_3, before c"vkCmdWaitEvents2KHR" => pending::wait_events2;

            cmd_copy_image: PFN_vkCmdCopyImage = c"vkCmdCopyImage" => transfers::copy;
            cmd_copy_image2: PFN_vkCmdCopyImage2 = c"vkCmdCopyImage2"
                since API_VERSION_1_3, before c"vkCmdCopyImage2KHR" => transfers::copy2;
            cmd_blit_image: PFN_vkCmdBlitImage = c"vkCmdBlitImage" => transfers::blit;
            cmd_blit_image2: PFN_vkCmdBlitImage2 = c"vkCmdBlitImage2"
                since API_VERSION_1_3, before c"vkCmdBlitImage2KHR" => transfers::blit2;
            cmd_resolve_image: PFN_vkCmdResolveImage = c"vkCmdResolveImage" => transfers::resolve;
            cmd_resolve_image2: PFN_vkCmdResolveImage2 = c"vkCmdResolveImage2"
                since API_VERSION_1_3, before c"vkCmdResolveImage2KHR" => transfers::resolve2;

            queue_submit: PFN_vkQueueSubmit = c"vkQueueSubmit" => submit::submit;
            queue_submit2: PFN_vkQueueSubmit2 = c"vkQueueSubmit2"
                since API_VERSION_1_3, before c"vkQueueSubmit2KHR" => submit::submit2;
        }
    };
}

macro_rules! armed_table {
    ($($field:ident: $pfn:ident = $name:literal $(since $version:ident, before $extension:literal)? => $hook:path;)*) => {
        /// The next layer's functions under the hooks of armed devices; `None` for a function that the device lacks.
        #[derive(Clone, Copy)]
        pub struct ArmedTable {
            $(pub $field: Option<types::$pfn>,)*
        }

        impl ArmedTable {
            /// Resolves every function beforehand. Of two names the core's is taken where the version has it, which
            /// is the one that both the application asked for and the device has: layers below may answer for names
            /// that the driver lacks.
            ///
            /// # Safety
            ///
            /// For a name, `get` returns the function of that name, or `None`.
            pub unsafe fn load(version: u32, get: impl Fn(&CStr) -> vk::PFN_vkVoidFunction) -> Self {
                Self {
                    $($field: {
                        let name: &CStr = $name;
                        $(let name = if version >= $version { name } else { $extension };)?
                        // SAFETY: `get` returns the function of that name, as this function requires, and the list gives each name its type.
                        unsafe {
                            std::mem::transmute::<vk::PFN_vkVoidFunction, Option<types::$pfn>>(get(name))
                        }
                    },)*
                }
            }

            /// Whether the device lacks the function of that name, which has a hook.
            pub fn lacks(&self, name: &CStr) -> bool {
                $(if name == $name $(|| name == $extension)? {
                    return self.$field.is_none();
                })*
                false
            }
        }
    };
}

armed_functions!(armed_table);
