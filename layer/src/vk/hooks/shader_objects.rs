//! Hooks of shaders without pipelines.

use crate::abi::copies::slice;
use crate::abi::guard;
use crate::vk::device;
use ash::vk;

const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;

/// `vkCreateShadersEXT`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    count: u32,
    infos: *const vk::ShaderCreateInfoEXT<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::ShaderEXT,
) -> vk::Result {
    guard(
        "vkCreateShadersEXT",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_shaders(device, count, infos, allocator, made), FAILED)
        },
        |answer| {
            // SAFETY: `device` is live, by the valid usage of vkCreateShadersEXT.
            let found = unsafe { device::with(device, |next| next.create_shaders) };
            let Some((known, next)) = found else { return FAILED };
            let result = answer.record(match known.rates() {
                Some(rates) => {
                    let functions = (next, known.hooked.destroy_shader);
                    // SAFETY: the application's own arguments, and the next layer's functions for them.
                    unsafe { rates.create_shaders(device, count, infos, allocator, made, functions) }
                }
                // SAFETY: the next layer's function, with the application's own arguments.
                None => unsafe { next(device, count, infos, allocator, made) },
            });
            if let Some(masks) = known.masks() {
                // SAFETY: the same valid usage demands `count` structures; the call has written as many shaders, null for those that failed.
                unsafe { masks.add_shader_objects(slice(infos, count), slice(made.cast_const(), count)) };
            }
            result
        },
    )
}

/// `vkDestroyShaderEXT`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    shader: vk::ShaderEXT,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyShaderEXT",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_shader(device, shader, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_shader) else { return };
                if let Some(rates) = known.rates() {
                    rates.forget_shader_object(shader);
                }
                if let Some(masks) = known.masks() {
                    masks.forget_shader_object(shader);
                }
                next(device, shader, allocator);
                answer.made();
            }
        },
    );
}
