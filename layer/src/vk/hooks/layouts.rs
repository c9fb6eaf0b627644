//! Hooks of the layouts of descriptor sets and pipelines.

use crate::vk::device;
use crate::vk::objects::descriptors;
use ash::vk;

/// `vkCreateDescriptorSetLayout`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_set_layout(
    device: vk::Device,
    info: *const vk::DescriptorSetLayoutCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    layout: *mut vk::DescriptorSetLayout,
) -> vk::Result {
    hook!(
        "vkCreateDescriptorSetLayout",
        device::with,
        create_descriptor_set_layout(device, info, allocator, layout),
        |known, next| {
            let result = next();
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: both pointers are valid, by valid usage; the call has written the layout.
                let (layout, is_open) = unsafe { (*layout, descriptors::is_open(&*info)) };
                armed.objects.descriptors.add_layout(layout, is_open);
            }
            if let (Some(masks), vk::Result::SUCCESS) = (known.masks(), result) {
                // SAFETY: as above.
                unsafe { masks.add_set_layout(*layout, &*info) };
            }
            result
        }
    )
}

/// `vkDestroyDescriptorSetLayout`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_set_layout(
    device: vk::Device,
    layout: vk::DescriptorSetLayout,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyDescriptorSetLayout",
        device::with,
        destroy_descriptor_set_layout(device, layout, allocator),
        |known, next| {
            if let Some(armed) = &known.armed {
                armed.objects.descriptors.forget_layout(layout);
            }
            if let Some(masks) = known.masks() {
                masks.forget_set_layout(layout);
            }
            next();
        }
    );
}

/// `vkCreatePipelineLayout`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::PipelineLayoutCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    layout: *mut vk::PipelineLayout,
) -> vk::Result {
    hook!(
        "vkCreatePipelineLayout",
        device::with,
        create_pipeline_layout(device, info, allocator, layout),
        |known, next| {
            let result = next();
            if let (Some(masks), vk::Result::SUCCESS) = (known.masks(), result) {
                // SAFETY: both pointers are valid, by valid usage; the call has written the layout.
                unsafe { masks.add_layout(*layout, &*info) };
            }
            result
        }
    )
}

/// `vkDestroyPipelineLayout`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    layout: vk::PipelineLayout,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyPipelineLayout",
        device::with,
        destroy_pipeline_layout(device, layout, allocator),
        |known, next| {
            if let Some(masks) = known.masks() {
                masks.forget_layout(layout);
            }
            next();
        }
    );
}
