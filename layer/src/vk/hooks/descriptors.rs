//! Hooks of descriptor sets.

use crate::abi::copies::slice;
use crate::vk::device;
use crate::vk::objects::descriptors::written_views;
use ash::vk;

/// `vkAllocateDescriptorSets`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::DescriptorSetAllocateInfo<'_>,
    sets: *mut vk::DescriptorSet,
) -> vk::Result {
    hook!(
        "vkAllocateDescriptorSets",
        device::with,
        allocate_descriptor_sets(device, info, sets),
        |known, next| {
            let result = next();
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result)
                && !armed.ignores_runtime()
            {
                // SAFETY: the pointer is valid, by valid usage, with so many layouts; the call has written as many sets.
                let (pool, sets, layouts) = unsafe {
                    let count = (*info).descriptor_set_count;
                    (
                        (*info).descriptor_pool,
                        slice(sets.cast_const(), count),
                        slice((*info).p_set_layouts, count),
                    )
                };
                armed.objects.descriptors.add_sets(pool, sets, layouts);
            }
            result
        }
    )
}

/// `vkFreeDescriptorSets`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn free(
    device: vk::Device,
    pool: vk::DescriptorPool,
    count: u32,
    sets: *const vk::DescriptorSet,
) -> vk::Result {
    hook!(
        "vkFreeDescriptorSets",
        device::with,
        free_descriptor_sets(device, pool, count, sets),
        |known, next| {
            if let Some(armed) = &known.armed {
                // SAFETY: valid usage demands so many sets.
                armed.objects.descriptors.free_sets(pool, unsafe { slice(sets, count) });
            }
            next()
        }
    )
}

/// `vkResetDescriptorPool`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn reset_pool(
    device: vk::Device,
    pool: vk::DescriptorPool,
    flags: vk::DescriptorPoolResetFlags,
) -> vk::Result {
    hook!("vkResetDescriptorPool", device::with, reset_descriptor_pool(device, pool, flags), |known, next| {
        if let Some(armed) = &known.armed {
            armed.objects.descriptors.clear_pool(pool);
        }
        next()
    })
}

/// `vkDestroyDescriptorPool`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::DescriptorPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyDescriptorPool",
        device::with,
        destroy_descriptor_pool(device, pool, allocator),
        |known, next| {
            if let Some(armed) = &known.armed {
                armed.objects.descriptors.forget_pool(pool);
            }
            next();
        }
    );
}

/// `vkUpdateDescriptorSets`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn update(
    device: vk::Device,
    write_count: u32,
    writes: *const vk::WriteDescriptorSet<'_>,
    copy_count: u32,
    copies: *const vk::CopyDescriptorSet<'_>,
) {
    hook!(
        "vkUpdateDescriptorSets",
        device::with,
        update_descriptor_sets(device, write_count, writes, copy_count, copies),
        |known, next| {
            next();
            let Some(armed) = known.armed.as_ref().filter(|armed| !armed.ignores_runtime()) else { return };
            // SAFETY: valid usage demands so many writes and copies.
            let (writes, copies) = unsafe { (slice(writes, write_count), slice(copies, copy_count)) };
            let descriptors = &armed.objects.descriptors;
            for write in writes {
                // SAFETY: the writes are valid, by valid usage.
                for (at, view) in unsafe { written_views(write) } {
                    descriptors.write(write.dst_set, at, descriptors.attachment(&armed.objects, view));
                }
            }
            for copy in copies {
                if descriptors.may_read(copy.src_set) {
                    descriptors.open(copy.dst_set);
                }
            }
        }
    );
}

/// `vkCreateDescriptorUpdateTemplate`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_template(
    device: vk::Device,
    info: *const vk::DescriptorUpdateTemplateCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    template: *mut vk::DescriptorUpdateTemplate,
) -> vk::Result {
    hook!(
        "vkCreateDescriptorUpdateTemplate",
        device::with,
        create_descriptor_update_template(device, info, allocator, template),
        |known, next| {
            let result = next();
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: the pointers are valid, by valid usage, with so many entries; the call has written the template.
                let (info, template, entries) = unsafe {
                    let info = &*info;
                    let count = info.descriptor_update_entry_count;
                    (info, *template, slice(info.p_descriptor_update_entries, count))
                };
                armed.objects.descriptors.add_template(template, entries, info.pipeline_bind_point);
            }
            result
        }
    )
}

/// `vkDestroyDescriptorUpdateTemplate`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_template(
    device: vk::Device,
    template: vk::DescriptorUpdateTemplate,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyDescriptorUpdateTemplate",
        device::with,
        destroy_descriptor_update_template(device, template, allocator),
        |known, next| {
            if let Some(armed) = &known.armed {
                armed.objects.descriptors.forget_template(template);
            }
            next();
        }
    );
}

/// `vkUpdateDescriptorSetWithTemplate`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn update_with_template(
    device: vk::Device,
    set: vk::DescriptorSet,
    template: vk::DescriptorUpdateTemplate,
    data: *const std::ffi::c_void,
) {
    hook!(
        "vkUpdateDescriptorSetWithTemplate",
        device::with,
        update_descriptor_set_with_template(device, set, template, data),
        |known, next| {
            next();
            let Some(armed) = known.armed.as_ref().filter(|armed| !armed.ignores_runtime()) else { return };
            let descriptors = &armed.objects.descriptors;
            let Some(template) = descriptors.template(template) else { return descriptors.open(set) };
            // SAFETY: valid usage demands the data that the template describes.
            for (at, view) in unsafe { template.views(data) } {
                descriptors.write(set, at, descriptors.attachment(&armed.objects, view));
            }
        }
    );
}
