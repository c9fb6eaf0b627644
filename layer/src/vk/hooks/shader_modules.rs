//! Hooks of shader modules and of their identifiers: facts of a module's code are kept by its identifier, so that pipelines
//! made by identifier alone in a later launch get the same treatment.

use crate::vk::chain::extension;
use crate::vk::device::{self, Device};
use crate::vk::shaders::{self, Effects, FragmentShaders, KnownShaders, ShaderModules};
use ash::vk;
use std::ffi::CStr;
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

/// The modules of a device; `None` without rate attachments or masks.
pub fn modules(device: &Device) -> Option<&ShaderModules> {
    device.rate_attachments().map(|rates| &rates.modules).or_else(|| Some(device.masks()?.shader_modules()))
}

/// Keeps the facts of a module by its identifier.
fn note(identifier: &vk::ShaderModuleIdentifierEXT<'_>, shaders: Option<Arc<FragmentShaders>>) {
    let bytes = identifier.identifier.get(..identifier.identifier_size as usize);
    if let (Some(bytes), Some(shaders)) = (bytes, shaders) {
        KnownShaders::of_process().note(bytes, &shaders);
    }
}

/// Keeps the facts of a stage's code by the identifier that the driver gives to it: an application that has the identifier from an earlier
/// launch does not ask for it again. Code that is not understood is kept as unknown.
///
/// # Safety
///
/// The stage is valid, and the application has enabled identifiers on the device.
pub unsafe fn note_code(known: &Device, device: vk::Device, stage: &vk::PipelineShaderStageCreateInfo<'_>) {
    let mut identifier = vk::ShaderModuleIdentifierEXT::default();
    // SAFETY: device and stage are valid, as `# Safety` demands, and so is a module or code in it.
    let shaders = unsafe {
        let info = extension::<vk::ShaderModuleCreateInfo<'_>>(stage.p_next);
        let hooked = &known.hooked;
        if stage.module != vk::ShaderModule::null() {
            let Some(get) = hooked.get_shader_module_identifier else { return };
            get(device, stage.module, &mut identifier);
            modules(known).and_then(|modules| modules.get(stage.module))
        } else if let (Some(info), Some(get)) = (info, hooked.get_shader_module_create_info_identifier) {
            get(device, info, &mut identifier);
            shaders::read(info).map(Arc::new)
        } else {
            return;
        }
    };
    // SAFETY: a valid stage has a name.
    let name = unsafe { CStr::from_ptr(stage.p_name) }.to_string_lossy();
    let unknown = || Arc::new(FragmentShaders::from_iter([(name.into(), Effects::UNKNOWN)]));
    note(&identifier, Some(shaders.unwrap_or_else(unknown)));
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
