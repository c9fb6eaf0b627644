//! Hooks of instances: creation and destruction.

use crate::abi::copies::{Copies, room};
use crate::abi::{Enablement, guard};
use crate::backend::attachment;
use crate::config::Arming;
#[cfg(not(test))]
use crate::config::{Demands, Environment};
use crate::vk::chain::{self, NextInstance, Saved};
use crate::vk::dispatch_key::DispatchKey;
use crate::vk::functions::InstanceTable;
use crate::vk::instance::{self, Instance};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// `vkCreateInstance`. Fails with `ERROR_INITIALIZATION_FAILED` when the caller is not a Vulkan loader or
/// the layer below lacks functions of Vulkan 1.0.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: `info` and `instance` are valid, by the valid usage of vkCreateInstance; the loader's structure in the chain is valid, by
    // the layer interface.
    let before = unsafe { Saved::of(instance, chain::instance_link(info)) };
    guard(
        "vkCreateInstance",
        // SAFETY: as above, and all is as it was before the hook.
        || unsafe {
            before.restore();
            create_tracked(info, allocator, instance, false)
        },
        |answer| {
            let enablement = Enablement::of_process();
            let enabled = enablement == Enablement::Enabled;
            // SAFETY: the application's own arguments.
            let result = answer.record(unsafe { create_tracked(info, allocator, instance, enabled) });
            if result == vk::Result::SUCCESS {
                tracing::info!("Vulkan instance: {enablement}");
            }
            result
        },
    )
}

/// Creates an instance and tracks it; its devices are armed if it is `enabled`.
///
/// # Safety
///
/// The arguments of vkCreateInstance, as a Vulkan loader hands them to a layer.
unsafe fn create_tracked(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
    enabled: bool,
) -> vk::Result {
    const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;
    // SAFETY: `info` is valid, by the valid usage of vkCreateInstance; the chain is as the loader made it.
    let Some(next) = (unsafe { chain::advance_instance(info) }) else { return FAILED };
    let name = c"vkCreateInstance".as_ptr();
    // SAFETY: the loader gave the pointer; a null instance is right for this name, which gives the type.
    let create = unsafe {
        std::mem::transmute::<vk::PFN_vkVoidFunction, Option<vk::PFN_vkCreateInstance>>((next
            .get_instance_proc_addr)(
            vk::Instance::null(),
            name,
        ))
    };
    let Some(create) = create else { return FAILED };
    // SAFETY: the application's own arguments; the loader's structure is advanced.
    let result = unsafe { create_below(create, info, allocator, instance, enabled) };
    // SAFETY: where the call succeeded, `instance` points to a live instance of the next layer.
    if result == vk::Result::SUCCESS && unsafe { track(info, *instance, next, enabled) }.is_none() {
        return FAILED;
    }
    result
}

/// Creates the instance with the extensions of rate attachments where it is `enabled`, or exactly as the application asks where that fails
/// or it is not.
///
/// # Safety
///
/// The arguments of vkCreateInstance, with which `create` may be called.
unsafe fn create_below(
    create: vk::PFN_vkCreateInstance,
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
    enabled: bool,
) -> vk::Result {
    if enabled && demands().arming == Arming::Rates {
        let mut room = room::<64>();
        let mut copies = Copies::new(&mut room);
        // SAFETY: `info` is valid for the time of the call, as `# Safety` demands.
        let amended = unsafe {
            let version = requested_version((*info).p_application_info.as_ref());
            attachment::create::instance(&*info, version, &mut copies)
        };
        if let Some(amended) = amended {
            // SAFETY: the handle and the loader's structure are valid, as `# Safety` demands, and no other code writes to them.
            unsafe {
                let before = Saved::of(instance, chain::instance_link(info));
                let result = create(&amended, allocator, instance);
                if result == vk::Result::SUCCESS {
                    return result;
                }
                before.restore();
            }
        }
    }
    // SAFETY: the arguments are valid, as `# Safety` demands, and as they were.
    unsafe { create(info, allocator, instance) }
}

/// Begins to track an instance.
///
/// # Safety
///
/// `info` is valid, and `handle` a live instance of the layer that `next` names.
unsafe fn track(
    info: *const vk::InstanceCreateInfo<'_>,
    handle: vk::Instance,
    next: NextInstance,
    enabled: bool,
) -> Option<()> {
    // SAFETY: the instance is live, as `# Safety` demands; vkGetInstanceProcAddr returns its function of a name, or null.
    let (key, table) = unsafe {
        let get = |name: &CStr| (next.get_instance_proc_addr)(handle, name.as_ptr());
        (DispatchKey::of(handle)?, InstanceTable::load(get)?)
    };
    // SAFETY: `info` is valid, as `# Safety` demands: the pointer is null or to a valid structure.
    let application = unsafe { (*info).p_application_info.as_ref() };
    let instance = Instance {
        handle,
        enabled,
        api_version: requested_version(application),
        // SAFETY: as above.
        engine: unsafe { engine(application) },
        next: table,
        get_instance_proc_addr: next.get_instance_proc_addr,
        get_physical_device_proc_addr: next.get_physical_device_proc_addr,
    };
    instance::insert(key, Arc::new(instance));
    Some(())
}

/// `vkDestroyInstance`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(instance: vk::Instance, allocator: *const vk::AllocationCallbacks<'_>) {
    // SAFETY: the application vouches that the instance is null or live until the call down.
    let key = unsafe { DispatchKey::of(instance) };
    let Some((key, known)) = key.and_then(|key| Some((key, instance::get(key)?))) else { return };
    let destroy = || {
        instance::remove(key);
        // SAFETY: the next layer's function with the application's own arguments.
        unsafe { (known.next.destroy_instance)(instance, allocator) }
    };
    guard("vkDestroyInstance", destroy, |answer| {
        destroy();
        answer.made();
    });
}

/// The version that an application asked for: without an answer it is 1.0 (VkApplicationInfo::apiVersion).
fn requested_version(application: Option<&vk::ApplicationInfo<'_>>) -> u32 {
    application.map_or(0, |application| application.api_version).max(vk::API_VERSION_1_0)
}

/// # Safety
///
/// The structure is valid.
unsafe fn engine(application: Option<&vk::ApplicationInfo<'_>>) -> String {
    // SAFETY: the name is null or a string, by the valid usage of VkApplicationInfo.
    let name = application.and_then(|application| unsafe { application.engine_name_as_c_str() });
    name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The demands of this process's configuration on a new device.
#[cfg(not(test))]
pub fn demands() -> Demands {
    Demands::of_process(&Environment::of_process(Enablement::of_process() == Enablement::Elevated))
}

#[cfg(test)]
pub use crate::vk::tests::demands;
