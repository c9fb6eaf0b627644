//! The functions that can fail, each hooked by either layer.

use super::{Call, Side};
use crate::layer::{device_of, hooks};
use ash::vk;
use ash::vk::Handle;
use std::ffi::{CStr, c_void};
use std::mem::transmute;

/// Key that distinguishes calls of a function.
macro_rules! mark {
    () => {
        0
    };
    ($handle:ident) => {
        $handle.as_raw()
    };
}

/// Each line is a function, its type, its arguments, and, if a failing one has to write its handles, their count and place; then the handle
/// that distinguishes calls on one thread.
macro_rules! functions {
    ($($name:literal $pfn:ident $function:ident($object:ident: $kind:ty $(, $argument:ident: $ty:ty)*)
        $(nulls $count:block)? $(told_by $mark:ident)?;)*) => {
        $(unsafe extern "system" fn $function<S: Side>($object: $kind $(, $argument: $ty)*) -> vk::Result {
            // SAFETY: the caller's own arguments; the name gives the function's type.
            unsafe {
                let Some(layer) = device_of::<S>($object) else { return vk::Result::ERROR_UNKNOWN };
                let Some(next) = layer.next().function($name) else { return vk::Result::ERROR_UNKNOWN };
                let next = transmute::<unsafe extern "system" fn(), vk::$pfn>(next);
                let call = Call { name: $name, mark: mark!($($mark)?) };
                layer.made(call, || next($object $(, $argument)*), || { $($count)? })
            }
        })*

        /// The hook for a function that can fail.
        pub(super) fn hook<S: Side>(name: &CStr) -> vk::PFN_vkVoidFunction {
            hooks! { name; $($name: $pfn = $function::<S>;)* }
            None
        }
    };
}

type Allocator<'a> = *const vk::AllocationCallbacks<'a>;

/// # Safety
///
/// `handles` has room for so many.
unsafe fn null<H: Handle>(handles: *mut H, count: u32) {
    for at in 0..count as usize {
        // SAFETY: the caller vouches for it.
        unsafe { *handles.add(at) = H::from_raw(0) };
    }
}

functions! {
    c"vkAllocateCommandBuffers" PFN_vkAllocateCommandBuffers allocate_command_buffers(
        device: vk::Device, info: *const vk::CommandBufferAllocateInfo<'_>, out: *mut vk::CommandBuffer
    ) nulls { null(out, (*info).command_buffer_count) };
    c"vkAllocateDescriptorSets" PFN_vkAllocateDescriptorSets allocate_descriptor_sets(
        device: vk::Device, info: *const vk::DescriptorSetAllocateInfo<'_>, out: *mut vk::DescriptorSet
    ) nulls { null(out, (*info).descriptor_set_count) };
    c"vkAllocateMemory" PFN_vkAllocateMemory allocate_memory(
        device: vk::Device, info: *const vk::MemoryAllocateInfo<'_>, by: Allocator<'_>, out: *mut vk::DeviceMemory);
    c"vkBeginCommandBuffer" PFN_vkBeginCommandBuffer begin_command_buffer(
        buffer: vk::CommandBuffer, info: *const vk::CommandBufferBeginInfo<'_>);
    c"vkBindBufferMemory" PFN_vkBindBufferMemory bind_buffer_memory(
        device: vk::Device, buffer: vk::Buffer, memory: vk::DeviceMemory, offset: vk::DeviceSize);
    c"vkBindImageMemory" PFN_vkBindImageMemory bind_image_memory(
        device: vk::Device, image: vk::Image, memory: vk::DeviceMemory, offset: vk::DeviceSize);
    c"vkCreateBuffer" PFN_vkCreateBuffer create_buffer(
        device: vk::Device, info: *const vk::BufferCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::Buffer);
    c"vkCreateCommandPool" PFN_vkCreateCommandPool create_command_pool(
        device: vk::Device, info: *const vk::CommandPoolCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::CommandPool);
    c"vkCreateComputePipelines" PFN_vkCreateComputePipelines create_compute_pipelines(
        device: vk::Device, cache: vk::PipelineCache, count: u32, infos: *const vk::ComputePipelineCreateInfo<'_>,
        by: Allocator<'_>, out: *mut vk::Pipeline
    ) nulls { null(out, count) };
    c"vkCreateDescriptorPool" PFN_vkCreateDescriptorPool create_descriptor_pool(
        device: vk::Device, info: *const vk::DescriptorPoolCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::DescriptorPool);
    c"vkCreateDescriptorSetLayout" PFN_vkCreateDescriptorSetLayout create_descriptor_set_layout(
        device: vk::Device, info: *const vk::DescriptorSetLayoutCreateInfo<'_>, by: Allocator<'_>,
        out: *mut vk::DescriptorSetLayout);
    c"vkCreateFence" PFN_vkCreateFence create_fence(
        device: vk::Device, info: *const vk::FenceCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::Fence);
    c"vkCreateFramebuffer" PFN_vkCreateFramebuffer create_framebuffer(
        device: vk::Device, info: *const vk::FramebufferCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::Framebuffer);
    c"vkCreateGraphicsPipelines" PFN_vkCreateGraphicsPipelines create_graphics_pipelines(
        device: vk::Device, cache: vk::PipelineCache, count: u32, infos: *const vk::GraphicsPipelineCreateInfo<'_>,
        by: Allocator<'_>, out: *mut vk::Pipeline
    ) nulls { null(out, count) };
    c"vkCreateImage" PFN_vkCreateImage create_image(
        device: vk::Device, info: *const vk::ImageCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::Image);
    c"vkCreateImageView" PFN_vkCreateImageView create_image_view(
        device: vk::Device, info: *const vk::ImageViewCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::ImageView);
    c"vkCreatePipelineLayout" PFN_vkCreatePipelineLayout create_pipeline_layout(
        device: vk::Device, info: *const vk::PipelineLayoutCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::PipelineLayout);
    c"vkCreateQueryPool" PFN_vkCreateQueryPool create_query_pool(
        device: vk::Device, info: *const vk::QueryPoolCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::QueryPool);
    c"vkCreateRenderPass" PFN_vkCreateRenderPass create_render_pass(
        device: vk::Device, info: *const vk::RenderPassCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::RenderPass);
    c"vkCreateRenderPass2" PFN_vkCreateRenderPass2 create_render_pass2(
        device: vk::Device, info: *const vk::RenderPassCreateInfo2<'_>, by: Allocator<'_>, out: *mut vk::RenderPass);
    c"vkCreateRenderPass2KHR" PFN_vkCreateRenderPass2 create_render_pass2_khr(
        device: vk::Device, info: *const vk::RenderPassCreateInfo2<'_>, by: Allocator<'_>, out: *mut vk::RenderPass);
    c"vkCreateSampler" PFN_vkCreateSampler create_sampler(
        device: vk::Device, info: *const vk::SamplerCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::Sampler);
    c"vkCreateSemaphore" PFN_vkCreateSemaphore create_semaphore(
        device: vk::Device, info: *const vk::SemaphoreCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::Semaphore);
    c"vkCreateShaderModule" PFN_vkCreateShaderModule create_shader_module(
        device: vk::Device, info: *const vk::ShaderModuleCreateInfo<'_>, by: Allocator<'_>, out: *mut vk::ShaderModule);
    c"vkDeviceWaitIdle" PFN_vkDeviceWaitIdle device_wait_idle(device: vk::Device);
    c"vkEndCommandBuffer" PFN_vkEndCommandBuffer end_command_buffer(buffer: vk::CommandBuffer);
    c"vkGetFenceStatus" PFN_vkGetFenceStatus get_fence_status(device: vk::Device, fence: vk::Fence);
    c"vkGetQueryPoolResults" PFN_vkGetQueryPoolResults get_query_pool_results(
        device: vk::Device, pool: vk::QueryPool, first: u32, count: u32, size: usize, data: *mut c_void,
        stride: vk::DeviceSize, flags: vk::QueryResultFlags);
    c"vkMapMemory" PFN_vkMapMemory map_memory(
        device: vk::Device, memory: vk::DeviceMemory, offset: vk::DeviceSize, size: vk::DeviceSize,
        flags: vk::MemoryMapFlags, out: *mut *mut c_void);
    c"vkQueueSubmit" PFN_vkQueueSubmit queue_submit(
        queue: vk::Queue, count: u32, submits: *const vk::SubmitInfo<'_>, fence: vk::Fence) told_by fence;
    c"vkQueueSubmit2" PFN_vkQueueSubmit2 queue_submit2(
        queue: vk::Queue, count: u32, submits: *const vk::SubmitInfo2<'_>, fence: vk::Fence) told_by fence;
    c"vkQueueSubmit2KHR" PFN_vkQueueSubmit2 queue_submit2_khr(
        queue: vk::Queue, count: u32, submits: *const vk::SubmitInfo2<'_>, fence: vk::Fence) told_by fence;
    c"vkQueueWaitIdle" PFN_vkQueueWaitIdle queue_wait_idle(queue: vk::Queue);
    c"vkResetCommandBuffer" PFN_vkResetCommandBuffer reset_command_buffer(
        buffer: vk::CommandBuffer, flags: vk::CommandBufferResetFlags);
    c"vkResetCommandPool" PFN_vkResetCommandPool reset_command_pool(
        device: vk::Device, pool: vk::CommandPool, flags: vk::CommandPoolResetFlags);
    c"vkResetFences" PFN_vkResetFences reset_fences(device: vk::Device, count: u32, fences: *const vk::Fence);
    c"vkWaitForFences" PFN_vkWaitForFences wait_for_fences(
        device: vk::Device, count: u32, fences: *const vk::Fence, all: vk::Bool32, timeout: u64);
}
