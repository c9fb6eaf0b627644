//! The functions that we call, from the next layer down.

use super::GpuError;
use crate::link::DeviceRecord;
use ash::vk::{self, Handle};
use std::ffi::{CStr, c_void};

/// Functions of the instance that this crate's `gpu` calls.
const INSTANCE: [&CStr; 5] = [
    c"vkGetPhysicalDeviceFormatProperties",
    c"vkGetPhysicalDeviceImageFormatProperties",
    c"vkGetPhysicalDeviceMemoryProperties",
    c"vkGetPhysicalDeviceProperties",
    c"vkGetPhysicalDeviceQueueFamilyProperties",
];

/// Functions of the device that this crate's `gpu` calls.
const DEVICE: &[&CStr] = &[
    c"vkAllocateCommandBuffers",
    c"vkAllocateDescriptorSets",
    c"vkAllocateMemory",
    c"vkBeginCommandBuffer",
    c"vkBindBufferMemory",
    c"vkBindImageMemory",
    c"vkCmdBeginRenderPass",
    c"vkCmdBindDescriptorSets",
    c"vkCmdBindPipeline",
    c"vkCmdCopyBuffer",
    c"vkCmdCopyBufferToImage",
    c"vkCmdCopyImage",
    c"vkCmdCopyImageToBuffer",
    c"vkCmdDispatch",
    c"vkCmdDispatchIndirect",
    c"vkCmdDraw",
    c"vkCmdEndRenderPass",
    c"vkCmdFillBuffer",
    c"vkCmdPipelineBarrier",
    c"vkCmdResetQueryPool",
    c"vkCmdSetScissor",
    c"vkCmdSetViewport",
    c"vkCmdUpdateBuffer",
    c"vkCmdWriteTimestamp",
    c"vkCreateBuffer",
    c"vkCreateCommandPool",
    c"vkCreateComputePipelines",
    c"vkCreateDescriptorPool",
    c"vkCreateDescriptorSetLayout",
    c"vkCreateFence",
    c"vkCreateFramebuffer",
    c"vkCreateGraphicsPipelines",
    c"vkCreateImage",
    c"vkCreateImageView",
    c"vkCreatePipelineCache",
    c"vkCreatePipelineLayout",
    c"vkCreateQueryPool",
    c"vkCreateRenderPass",
    c"vkCreateSampler",
    c"vkCreateShaderModule",
    c"vkDestroyBuffer",
    c"vkDestroyCommandPool",
    c"vkDestroyDescriptorPool",
    c"vkDestroyDescriptorSetLayout",
    c"vkDestroyFence",
    c"vkDestroyFramebuffer",
    c"vkDestroyImage",
    c"vkDestroyImageView",
    c"vkDestroyPipeline",
    c"vkDestroyPipelineCache",
    c"vkDestroyPipelineLayout",
    c"vkDestroyQueryPool",
    c"vkDestroyRenderPass",
    c"vkDestroySampler",
    c"vkDestroyShaderModule",
    c"vkEndCommandBuffer",
    c"vkFreeMemory",
    c"vkGetBufferMemoryRequirements",
    c"vkGetDeviceQueue",
    c"vkGetFenceStatus",
    c"vkGetImageMemoryRequirements",
    c"vkGetPipelineCacheData",
    c"vkGetQueryPoolResults",
    c"vkMapMemory",
    c"vkQueueSubmit",
    c"vkResetCommandBuffer",
    c"vkResetCommandPool",
    c"vkResetFences",
    c"vkUnmapMemory",
    c"vkUpdateDescriptorSets",
    c"vkWaitForFences",
];

/// Instance and device as ash knows them.
pub(crate) struct Functions {
    pub(crate) instance: ash::Instance,
    pub(crate) device: ash::Device,
}

impl Functions {
    /// Loads all functions, and fails when one that we call is missing: ash would only panic on its call.
    ///
    /// # Safety
    /// `record` is of a live device.
    pub(crate) unsafe fn load(record: &DeviceRecord) -> Result<Self, GpuError> {
        // SAFETY: the handles are live, and the names are C strings.
        let instance_function =
            |name: &CStr| unsafe { (record.next_get_instance_proc_addr)(record.instance, name.as_ptr()) };
        // SAFETY: as above.
        let device_function =
            |name: &CStr| unsafe { (record.next_get_device_proc_addr)(record.device, name.as_ptr()) };
        if let Some(name) = INSTANCE.into_iter().find(|name| instance_function(name).is_none()) {
            return Err(GpuError::Missing(name));
        }
        if let Some(name) = DEVICE.iter().copied().find(|name| device_function(name).is_none()) {
            return Err(GpuError::Missing(name));
        }
        let address =
            |function: vk::PFN_vkVoidFunction| function.map_or(std::ptr::null(), |f| f as *const c_void);
        // SAFETY: any function pointer may be carried as PFN_vkVoidFunction; ash casts it back by its name.
        let submit: vk::PFN_vkVoidFunction = record.queue_submit.map(|submit| unsafe {
            std::mem::transmute::<vk::PFN_vkQueueSubmit, unsafe extern "system" fn()>(submit)
        });
        let own = |name: &CStr| submit.filter(|_| name == c"vkQueueSubmit");
        // Only the names above: inside vkCreateDevice the loader answers the name of a device function by asking every
        // device of the instance, and the newest one has no dispatch table yet.
        let listed = |name: &CStr| INSTANCE.contains(&name).then(|| instance_function(name)).flatten();
        // SAFETY: each pointer is the one that the next layer returns for that name, hence of the named function's type.
        unsafe {
            Ok(Self {
                instance: ash::Instance::load_with(|name| address(listed(name)), record.instance),
                device: ash::Device::load_with(
                    |name| address(own(name).or_else(|| device_function(name))),
                    record.device,
                ),
            })
        }
    }
}

/// Has the Vulkan loader initialise a dispatchable object that did not come through it.
///
/// # Safety
/// `object` is a queue or command buffer of the record's live device.
pub(crate) unsafe fn init_dispatch<H: Handle>(record: &DeviceRecord, object: H) -> Result<(), GpuError> {
    // A dispatchable handle is a pointer on every platform.
    let pointer = object.as_raw() as usize as *mut c_void;
    // SAFETY: the object is one of the record's live device, as `# Safety` demands; the callback is the loader's own.
    unsafe { (record.set_device_loader_data)(record.device, pointer) }
        .result()
        .map_err(GpuError::from_call("vkSetDeviceLoaderData"))
}
