//! Hooks of shader modules and of their identifiers: facts of a module's code are kept by its identifier, so that pipelines
//! made by identifier alone in a later launch get the same treatment.

use crate::vk::device::{self, Device};
use crate::vk::shaders::{self, FragmentShaders, KnownShaders, ShaderModules};
use ash::vk;
use std::sync::Arc;

/// `vkCreateShaderModule`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_shader_module(
    device: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    module: *mut vk::ShaderModule,
) -> vk::Result {
    hook!(
        "vkCreateShaderModule",
        device::with,
        create_shader_module(device, info, allocator, module),
        |known, next| {
            let result = next();
            if result == vk::Result::SUCCESS {
                if let Some(rates) = known.rate_attachments() {
                    // SAFETY: both pointers are valid, by valid usage, and the call has written the module.
                    unsafe { rates.modules.add(*module, &*info) };
                }
                if let Some(masks) = known.masks() {
                    // SAFETY: as above.
                    unsafe { masks.add_shader_module(*module, &*info) };
                }
            }
            result
        }
    )
}

/// `vkDestroyShaderModule`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_shader_module(
    device: vk::Device,
    module: vk::ShaderModule,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyShaderModule",
        device::with,
        destroy_shader_module(device, module, allocator),
        |known, next| {
            if let Some(rates) = known.rate_attachments() {
                rates.modules.forget(module);
            }
            if let Some(masks) = known.masks() {
                masks.forget_shader_module(module);
            }
            next();
        }
    );
}

fn modules(device: &Device) -> Option<&ShaderModules> {
    device.rate_attachments().map(|rates| &rates.modules).or_else(|| Some(device.masks()?.shader_modules()))
}

/// Keeps the facts of a module by its identifier.
fn note(identifier: &vk::ShaderModuleIdentifierEXT<'_>, shaders: Option<Arc<FragmentShaders>>) {
    let bytes = identifier.identifier.get(..identifier.identifier_size as usize);
    if let (Some(bytes), Some(shaders)) = (bytes, shaders) {
        KnownShaders::of_process().note(bytes, &shaders);
    }
}

/// `vkGetShaderModuleIdentifierEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn of_module(
    device: vk::Device,
    module: vk::ShaderModule,
    identifier: *mut vk::ShaderModuleIdentifierEXT<'_>,
) {
    hook!(
        "vkGetShaderModuleIdentifierEXT",
        device::with,
        get_shader_module_identifier(device, module, identifier),
        |known, next| {
            next();
            // SAFETY: the pointer is valid, by valid usage, and the call has written the identifier.
            let identifier = unsafe { &*identifier };
            note(identifier, modules(&known).and_then(|modules| modules.get(module)));
        }
    );
}

/// `vkGetShaderModuleCreateInfoIdentifierEXT`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn of_create_info(
    device: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'_>,
    identifier: *mut vk::ShaderModuleIdentifierEXT<'_>,
) {
    hook!(
        "vkGetShaderModuleCreateInfoIdentifierEXT",
        device::with,
        get_shader_module_create_info_identifier(device, info, identifier),
        |known, next| {
            next();
            if modules(&known).is_some() {
                // SAFETY: both pointers are valid, by valid usage, and the call has written the identifier.
                let (identifier, read) = unsafe { (&*identifier, shaders::read(&*info)) };
                note(identifier, read.map(Arc::new));
            }
        }
    );
}
