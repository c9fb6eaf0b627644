//! Hooks of the layouts of descriptor sets and pipelines.

use crate::abi::guard;
use crate::vk::device;
use crate::vk::objects::descriptors;
use ash::vk;

const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;

/// `vkCreateDescriptorSetLayout`.
pub unsafe extern "system" fn create_set_layout(
    device: vk::Device,
    info: *const vk::DescriptorSetLayoutCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    layout: *mut vk::DescriptorSetLayout,
) -> vk::Result {
    guard(
        "vkCreateDescriptorSetLayout",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_descriptor_set_layout(device, info, allocator, layout), FAILED)
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `layout` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_descriptor_set_layout)
                else {
                    return FAILED;
                };
                let result = answer.record(next(device, info, allocator, layout));
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                    armed.objects.descriptors.add_layout(*layout, descriptors::is_open(&*info));
                }
                if let (Some(masks), vk::Result::SUCCESS) = (known.masks(), result) {
                    masks.add_set_layout(*layout, &*info);
                }
                result
            }
        },
    )
}

/// `vkDestroyDescriptorSetLayout`.
pub unsafe extern "system" fn destroy_set_layout(
    device: vk::Device,
    layout: vk::DescriptorSetLayout,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyDescriptorSetLayout",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, destroy_descriptor_set_layout(device, layout, allocator), ())
        },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_descriptor_set_layout)
                else {
                    return;
                };
                if let Some(masks) = known.masks() {
                    masks.forget_set_layout(layout);
                }
                next(device, layout, allocator);
                answer.made();
            }
        },
    );
}

/// `vkCreatePipelineLayout`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::PipelineLayoutCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    layout: *mut vk::PipelineLayout,
) -> vk::Result {
    guard(
        "vkCreatePipelineLayout",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_pipeline_layout(device, info, allocator, layout), FAILED)
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `layout` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_pipeline_layout) else {
                    return FAILED;
                };
                let result = answer.record(next(device, info, allocator, layout));
                if let (Some(masks), vk::Result::SUCCESS) = (known.masks(), result) {
                    masks.add_layout(*layout, &*info);
                }
                result
            }
        },
    )
}

/// `vkDestroyPipelineLayout`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    layout: vk::PipelineLayout,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyPipelineLayout",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_pipeline_layout(device, layout, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_pipeline_layout) else {
                    return;
                };
                if let Some(masks) = known.masks() {
                    masks.forget_layout(layout);
                }
                next(device, layout, allocator);
                answer.made();
            }
        },
    );
}
