//! Identifiers of shader modules: facts of a module's code are kept by its identifier, so that pipelines
//! made by identifier alone in a later launch get the same treatment.

use crate::abi::guard;
use crate::vk::device::{self, Device};
use crate::vk::known_shaders::KnownShaders;
use crate::vk::rates::shader::FragmentShaders;
use crate::vk::shader_modules::{self, ShaderModules};
use ash::vk;
use std::sync::Arc;

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
                    note(&*identifier, shader_modules::read(&*info).map(Arc::new));
                }
            }
        },
    );
}
