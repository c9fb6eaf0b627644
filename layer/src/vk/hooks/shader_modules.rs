//! Hooks of shader modules and of their identifiers: facts of a module's code are kept by its identifier, so that pipelines
//! made by identifier alone in a later launch get the same treatment.

use crate::abi::guard;
use crate::vk::device::{self, Device};
use crate::vk::shaders::{self, FragmentShaders, KnownShaders, ShaderModules};
use ash::vk;
use std::sync::Arc;

const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;

/// `vkCreateShaderModule`.
pub unsafe extern "system" fn create_shader_module(
    device: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    module: *mut vk::ShaderModule,
) -> vk::Result {
    guard(
        "vkCreateShaderModule",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_shader_module(device, info, allocator, module), FAILED)
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `module` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_shader_module) else {
                    return FAILED;
                };
                let result = answer.record(next(device, info, allocator, module));
                if result == vk::Result::SUCCESS {
                    if let Some(rates) = known.rates() {
                        rates.modules.add(*module, &*info);
                    }
                    if let Some(masks) = known.masks() {
                        masks.add_shader_module(*module, &*info);
                    }
                }
                result
            }
        },
    )
}

/// `vkDestroyShaderModule`.
pub unsafe extern "system" fn destroy_shader_module(
    device: vk::Device,
    module: vk::ShaderModule,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyShaderModule",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_shader_module(device, module, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_shader_module) else {
                    return;
                };
                if let Some(rates) = known.rates() {
                    rates.modules.forget(module);
                }
                if let Some(masks) = known.masks() {
                    masks.forget_shader_module(module);
                }
                next(device, module, allocator);
                answer.made();
            }
        },
    );
}

fn modules(device: &Device) -> Option<&ShaderModules> {
    device.rates().map(|rates| &rates.modules).or_else(|| Some(device.masks()?.shader_modules()))
}

/// Keeps the facts of a module by its identifier.
fn note(identifier: &vk::ShaderModuleIdentifierEXT<'_>, shaders: Option<Arc<FragmentShaders>>) {
    let bytes = identifier.identifier.get(..identifier.identifier_size as usize);
    if let (Some(bytes), Some(shaders)) = (bytes, shaders) {
        KnownShaders::of_process().note(bytes, &shaders);
    }
}

/// `vkGetShaderModuleIdentifierEXT`.
pub unsafe extern "system" fn of_module(
    device: vk::Device,
    module: vk::ShaderModule,
    identifier: *mut vk::ShaderModuleIdentifierEXT<'_>,
) {
    guard(
        "vkGetShaderModuleIdentifierEXT",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, get_shader_module_identifier(device, module, identifier), ())
        },
        |answer| {
            // SAFETY: the application's own arguments; the next layer has written the identifier.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.get_shader_module_identifier)
                else {
                    return;
                };
                next(device, module, identifier);
                answer.made();
                note(&*identifier, modules(&known).and_then(|modules| modules.get(module)));
            }
        },
    );
}

/// `vkGetShaderModuleCreateInfoIdentifierEXT`.
pub unsafe extern "system" fn of_create_info(
    device: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'_>,
    identifier: *mut vk::ShaderModuleIdentifierEXT<'_>,
) {
    guard(
        "vkGetShaderModuleCreateInfoIdentifierEXT",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                get_shader_module_create_info_identifier(device, info, identifier),
                ()
            )
        },
        |answer| {
            // SAFETY: the application's own arguments, which are valid; the next layer has written the identifier.
            unsafe {
                let Some((known, next)) =
                    device::with(device, |next| next.get_shader_module_create_info_identifier)
                else {
                    return;
                };
                next(device, info, identifier);
                answer.made();
                if modules(&known).is_some() {
                    note(&*identifier, shaders::read(&*info).map(Arc::new));
                }
            }
        },
    );
}
