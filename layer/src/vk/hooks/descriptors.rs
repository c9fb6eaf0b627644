//! Hooks of descriptor sets.

use crate::abi::copies::slice;
use crate::abi::guard;
use crate::vk::device;
use crate::vk::objects::descriptors::reads_image;
use ash::vk;

/// `vkAllocateDescriptorSets`.
pub unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::DescriptorSetAllocateInfo<'_>,
    sets: *mut vk::DescriptorSet,
) -> vk::Result {
    const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;
    guard(
        "vkAllocateDescriptorSets",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, allocate_descriptor_sets(device, info, sets), FAILED) },
        // SAFETY: the application's own arguments: as many layouts and, on success, sets as `info` says.
        |answer| unsafe {
            let Some((known, next)) = device::with(device, |next| next.allocate_descriptor_sets) else {
                return FAILED;
            };
            let result = answer.record(next(device, info, sets));
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                let count = (*info).descriptor_set_count;
                for (set, layout) in slice(sets, count).iter().zip(slice((*info).p_set_layouts, count)) {
                    armed.objects.descriptors.add_set(*set, *layout);
                }
            }
            result
        },
    )
}

/// `vkUpdateDescriptorSets`.
pub unsafe extern "system" fn update(
    device: vk::Device,
    write_count: u32,
    writes: *const vk::WriteDescriptorSet<'_>,
    copy_count: u32,
    copies: *const vk::CopyDescriptorSet<'_>,
) {
    guard(
        "vkUpdateDescriptorSets",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                update_descriptor_sets(device, write_count, writes, copy_count, copies),
                ()
            )
        },
        |answer| {
            // SAFETY: `device` is live, by the valid usage of vkUpdateDescriptorSets.
            let found = unsafe { device::with(device, |next| next.update_descriptor_sets) };
            let Some((known, next)) = found else { return };
            // SAFETY: the next layer's function, with the application's own arguments.
            unsafe { next(device, write_count, writes, copy_count, copies) };
            answer.made();
            let Some(armed) = &known.armed else { return };
            // SAFETY: the same valid usage demands so many writes and copies.
            let (writes, copies) = unsafe { (slice(writes, write_count), slice(copies, copy_count)) };
            let descriptors = &armed.objects.descriptors;
            for write in writes.iter().filter(|write| reads_image(write.descriptor_type)) {
                // SAFETY: writes of this type have so many images, by the same valid usage.
                let images = unsafe { slice(write.p_image_info, write.descriptor_count) };
                for (element, image) in (write.dst_array_element..).zip(images) {
                    let attachment = descriptors.attachment(&armed.objects, image.image_view);
                    descriptors.write(write.dst_set, (write.dst_binding, element), attachment);
                }
            }
            for copy in copies {
                if descriptors.may_read(copy.src_set) {
                    descriptors.open(copy.dst_set);
                }
            }
        },
    );
}

/// `vkUpdateDescriptorSetWithTemplate`, whose data only the template tells.
pub unsafe extern "system" fn update_with_template(
    device: vk::Device,
    set: vk::DescriptorSet,
    template: vk::DescriptorUpdateTemplate,
    data: *const std::ffi::c_void,
) {
    guard(
        "vkUpdateDescriptorSetWithTemplate",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                update_descriptor_set_with_template(device, set, template, data),
                ()
            )
        },
        // SAFETY: as above.
        |answer| unsafe {
            let Some((known, next)) = device::with(device, |next| next.update_descriptor_set_with_template)
            else {
                return;
            };
            next(device, set, template, data);
            answer.made();
            if let Some(armed) = &known.armed {
                armed.objects.descriptors.open(set);
            }
        },
    );
}
