//! The functions that make and destroy objects.

use super::{Live, budget};
use crate::faults::{Whose, whose_call};
use crate::layer::{Layer, device_of, hooks};
use ash::vk;
use ash::vk::Handle;
use std::ffi::CStr;
use std::mem::transmute;

type Allocator<'a> = *const vk::AllocationCallbacks<'a>;

/// Each line is a kind of object, its handle, and the functions that make it, each with the description that it takes; after them the function
/// that destroys it.
macro_rules! objects {
    ($($kind:literal $handle:ty:
        $($name:literal $pfn:ident $create:ident($info:ty) $([$memory:ident])?,)*
        ended by $end_name:literal $end_pfn:ident $destroy:ident;)*) => {
        $($(unsafe extern "system" fn $create(
            device: vk::Device, info: *const $info, by: Allocator<'_>, out: *mut $handle,
        ) -> vk::Result {
            // SAFETY: the caller's own arguments; the name gives the function's type.
            unsafe {
                let Some(layer) = device_of::<Live>(device) else { return vk::Result::ERROR_UNKNOWN };
                let Some(next) = layer.next().function($name) else { return vk::Result::ERROR_UNKNOWN };
                let next = transmute::<unsafe extern "system" fn(), vk::$pfn>(next);
                let whose = whose_call($name);
                let result = next(device, info, by, out);
                if result == vk::Result::SUCCESS {
                    let memory = [0 $(, (*info).$memory)?].into_iter().sum();
                    layer.made($kind, (*out).as_raw(), whose, memory);
                }
                result
            }
        })*

        unsafe extern "system" fn $destroy(device: vk::Device, object: $handle, by: Allocator<'_>) {
            // SAFETY: the caller's own arguments; the name gives the function's type.
            unsafe {
                let Some(layer) = device_of::<Live>(device) else { return };
                let Some(next) = layer.next().function($end_name) else { return };
                let next = transmute::<unsafe extern "system" fn(), vk::$end_pfn>(next);
                // Before the driver may use the handle again.
                layer.destroyed($kind, object.as_raw());
                next(device, object, by);
            }
        })*

        /// The hook for a function that makes or destroys objects, and for vkDeviceWaitIdle.
        pub(super) fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
            hooks! { name;
                $($($name: $pfn = $create;)* $end_name: $end_pfn = $destroy;)*
                c"vkCreateGraphicsPipelines": PFN_vkCreateGraphicsPipelines = create_graphics_pipelines;
                c"vkCreateComputePipelines": PFN_vkCreateComputePipelines = create_compute_pipelines;
                c"vkDestroyPipeline": PFN_vkDestroyPipeline = destroy_pipeline;
                c"vkDeviceWaitIdle": PFN_vkDeviceWaitIdle = wait_idle;
            }
            budget::hook(name)
        }
    };
}

objects! {
    "memory" vk::DeviceMemory:
        c"vkAllocateMemory" PFN_vkAllocateMemory allocate_memory(vk::MemoryAllocateInfo<'_>) [allocation_size],
        ended by c"vkFreeMemory" PFN_vkFreeMemory free_memory;
    "buffer" vk::Buffer:
        c"vkCreateBuffer" PFN_vkCreateBuffer create_buffer(vk::BufferCreateInfo<'_>),
        ended by c"vkDestroyBuffer" PFN_vkDestroyBuffer destroy_buffer;
    "image" vk::Image:
        c"vkCreateImage" PFN_vkCreateImage create_image(vk::ImageCreateInfo<'_>),
        ended by c"vkDestroyImage" PFN_vkDestroyImage destroy_image;
    "image view" vk::ImageView:
        c"vkCreateImageView" PFN_vkCreateImageView create_image_view(vk::ImageViewCreateInfo<'_>),
        ended by c"vkDestroyImageView" PFN_vkDestroyImageView destroy_image_view;
    "framebuffer" vk::Framebuffer:
        c"vkCreateFramebuffer" PFN_vkCreateFramebuffer create_framebuffer(vk::FramebufferCreateInfo<'_>),
        ended by c"vkDestroyFramebuffer" PFN_vkDestroyFramebuffer destroy_framebuffer;
    "render pass" vk::RenderPass:
        c"vkCreateRenderPass" PFN_vkCreateRenderPass create_render_pass(vk::RenderPassCreateInfo<'_>),
        c"vkCreateRenderPass2" PFN_vkCreateRenderPass2 create_render_pass2(vk::RenderPassCreateInfo2<'_>),
        c"vkCreateRenderPass2KHR" PFN_vkCreateRenderPass2 create_render_pass2_khr(vk::RenderPassCreateInfo2<'_>),
        ended by c"vkDestroyRenderPass" PFN_vkDestroyRenderPass destroy_render_pass;
    "pipeline layout" vk::PipelineLayout:
        c"vkCreatePipelineLayout" PFN_vkCreatePipelineLayout create_pipeline_layout(vk::PipelineLayoutCreateInfo<'_>),
        ended by c"vkDestroyPipelineLayout" PFN_vkDestroyPipelineLayout destroy_pipeline_layout;
    "shader module" vk::ShaderModule:
        c"vkCreateShaderModule" PFN_vkCreateShaderModule create_shader_module(vk::ShaderModuleCreateInfo<'_>),
        ended by c"vkDestroyShaderModule" PFN_vkDestroyShaderModule destroy_shader_module;
    "descriptor set layout" vk::DescriptorSetLayout:
        c"vkCreateDescriptorSetLayout" PFN_vkCreateDescriptorSetLayout create_set_layout(
            vk::DescriptorSetLayoutCreateInfo<'_>),
        ended by c"vkDestroyDescriptorSetLayout" PFN_vkDestroyDescriptorSetLayout destroy_set_layout;
    "descriptor pool" vk::DescriptorPool:
        c"vkCreateDescriptorPool" PFN_vkCreateDescriptorPool create_descriptor_pool(
            vk::DescriptorPoolCreateInfo<'_>),
        ended by c"vkDestroyDescriptorPool" PFN_vkDestroyDescriptorPool destroy_descriptor_pool;
    "command pool" vk::CommandPool:
        c"vkCreateCommandPool" PFN_vkCreateCommandPool create_command_pool(vk::CommandPoolCreateInfo<'_>),
        ended by c"vkDestroyCommandPool" PFN_vkDestroyCommandPool destroy_command_pool;
    "fence" vk::Fence:
        c"vkCreateFence" PFN_vkCreateFence create_fence(vk::FenceCreateInfo<'_>),
        ended by c"vkDestroyFence" PFN_vkDestroyFence destroy_fence;
    "semaphore" vk::Semaphore:
        c"vkCreateSemaphore" PFN_vkCreateSemaphore create_semaphore(vk::SemaphoreCreateInfo<'_>),
        ended by c"vkDestroySemaphore" PFN_vkDestroySemaphore destroy_semaphore;
    "sampler" vk::Sampler:
        c"vkCreateSampler" PFN_vkCreateSampler create_sampler(vk::SamplerCreateInfo<'_>),
        ended by c"vkDestroySampler" PFN_vkDestroySampler destroy_sampler;
    "query pool" vk::QueryPool:
        c"vkCreateQueryPool" PFN_vkCreateQueryPool create_query_pool(vk::QueryPoolCreateInfo<'_>),
        ended by c"vkDestroyQueryPool" PFN_vkDestroyQueryPool destroy_query_pool;
}

const PIPELINE: &str = "pipeline";

/// # Safety
/// As `vkCreateGraphicsPipelines`.
unsafe extern "system" fn create_graphics_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    by: Allocator<'_>,
    out: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: the caller's own arguments.
    unsafe {
        let Some(layer) = device_of::<Live>(device) else { return vk::Result::ERROR_UNKNOWN };
        let whose = whose_call(c"vkCreateGraphicsPipelines");
        let next = layer.next().functions.fp_v1_0().create_graphics_pipelines;
        let result = next(device, cache, count, infos, by, out);
        made_pipelines(&layer, whose, count, out);
        result
    }
}

/// # Safety
/// As `vkCreateComputePipelines`.
unsafe extern "system" fn create_compute_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::ComputePipelineCreateInfo<'_>,
    by: Allocator<'_>,
    out: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: the caller's own arguments.
    unsafe {
        let Some(layer) = device_of::<Live>(device) else { return vk::Result::ERROR_UNKNOWN };
        let whose = whose_call(c"vkCreateComputePipelines");
        let next = layer.next().functions.fp_v1_0().create_compute_pipelines;
        let result = next(device, cache, count, infos, by, out);
        made_pipelines(&layer, whose, count, out);
        result
    }
}

/// # Safety
///
/// `pipelines` are so many, each null where it was not made.
unsafe fn made_pipelines(layer: &Live, whose: Whose, count: u32, pipelines: *const vk::Pipeline) {
    for at in 0..count as usize {
        // SAFETY: the caller vouches for it.
        let pipeline = unsafe { *pipelines.add(at) };
        if pipeline != vk::Pipeline::null() {
            layer.made(PIPELINE, pipeline.as_raw(), whose, 0);
        }
    }
}

/// # Safety
/// As `vkDestroyPipeline`.
unsafe extern "system" fn destroy_pipeline(device: vk::Device, pipeline: vk::Pipeline, by: Allocator<'_>) {
    // SAFETY: the caller's own arguments.
    unsafe {
        let Some(layer) = device_of::<Live>(device) else { return };
        layer.destroyed(PIPELINE, pipeline.as_raw());
        (layer.next().functions.fp_v1_0().destroy_pipeline)(device, pipeline, by);
    }
}

/// # Safety
/// As `vkDeviceWaitIdle`.
unsafe extern "system" fn wait_idle(device: vk::Device) -> vk::Result {
    // SAFETY: the caller's own argument.
    unsafe {
        let Some(layer) = device_of::<Live>(device) else { return vk::Result::ERROR_UNKNOWN };
        let whose = whose_call(c"vkDeviceWaitIdle");
        let result = (layer.next().functions.fp_v1_0().device_wait_idle)(device);
        if whose == Whose::Application {
            layer.report();
        }
        result
    }
}
