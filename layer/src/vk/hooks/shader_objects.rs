//! Hooks of shaders without pipelines.

use crate::abi::copies::slice;
use crate::vk::device;
use ash::vk;

/// `vkCreateShadersEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    device: vk::Device,
    count: u32,
    infos: *const vk::ShaderCreateInfoEXT<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::ShaderEXT,
) -> vk::Result {
    hook!(
        "vkCreateShadersEXT",
        device::with,
        create_shaders(device, count, infos, allocator, made),
        |known, next, answer| {
            let result = answer.record(match known.rate_attachments() {
                Some(rates) => {
                    let functions = (next, known.hooked.destroy_shader);
                    // SAFETY: the application's own arguments, and the next layer's functions for them.
                    unsafe { rates.create_shaders(device, count, infos, allocator, made, functions) }
                }
                // SAFETY: the next layer's function, with the application's own arguments.
                None => unsafe { next(device, count, infos, allocator, made) },
            });
            if let Some(masks) = known.masks() {
                // SAFETY: valid usage demands `count` structures; the call has written as many shaders, null for each one that failed.
                unsafe { masks.add_shader_objects(slice(infos, count), slice(made.cast_const(), count)) };
            }
            result
        }
    )
}

/// `vkDestroyShaderEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    shader: vk::ShaderEXT,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!("vkDestroyShaderEXT", device::with, destroy_shader(device, shader, allocator), |known, next| {
        if let Some(rates) = known.rate_attachments() {
            rates.forget_shader_object(shader);
        }
        if let Some(masks) = known.masks() {
            masks.forget_shader_object(shader);
        }
        next();
    });
}
