//! Table of OpenXR functions with their implementations, and the version or extension that each needs.

use crate::abi::pointers::{In, Out};
use crate::fault::{Fault, Outcome, section};
use crate::instance::Instance;
use crate::runtime::call;
use crate::{
    actions, debug_utils, events, frame, instance, paths, session, spaces, swapchain, system, timespec,
};
use crate::{views, visibility_mask, vulkan};
use openxr_sys as xr;
use std::ffi::c_char;

/// Version or extension that an instance needs for a function.
#[derive(Clone, Copy)]
enum Availability {
    /// Without an instance, too.
    Global,
    Core,
    Core11,
    Extension(&'static str),
}

use Availability::{Core, Core11, Extension, Global};

const ENABLE: Availability = Extension("XR_KHR_vulkan_enable");
const ENABLE2: Availability = Extension("XR_KHR_vulkan_enable2");
const DEBUG_UTILS: Availability = Extension("XR_EXT_debug_utils");
const TIMESPEC: Availability = Extension("XR_KHR_convert_timespec_time");

macro_rules! functions {
    ($($name:ident: $availability:expr => $module:ident $(:: $function:ident)+;)+) => {
        fn function(name: &str) -> Option<(Availability, *const ())> {
            match name {
                $(stringify!($name) => Some(($availability, $module $(:: $function)+ as *const ())),)+
                _ => None,
            }
        }
    };
}

functions! {
    xrEnumerateInstanceExtensionProperties: Global => instance::enumerate_extensions;
    xrEnumerateApiLayerProperties: Global => instance::enumerate_api_layers;
    xrCreateInstance: Global => instance::create;
    xrGetInstanceProcAddr: Core => self::get_instance_proc_addr;
    xrDestroyInstance: Core => instance::destroy;
    xrGetInstanceProperties: Core => instance::get_properties;
    xrResultToString: Core => instance::result_to_string;
    xrStructureTypeToString: Core => instance::structure_type_to_string;
    xrPollEvent: Core => events::poll;
    xrStringToPath: Core => paths::string_to_path;
    xrPathToString: Core => paths::path_to_string;
    xrGetSystem: Core => system::get;
    xrGetSystemProperties: Core => system::get_properties;
    xrEnumerateEnvironmentBlendModes: Core => system::enumerate_blend_modes;
    xrEnumerateViewConfigurations: Core => system::enumerate_view_configurations;
    xrGetViewConfigurationProperties: Core => system::get_view_configuration_properties;
    xrEnumerateViewConfigurationViews: Core => system::enumerate_view_configuration_views;
    xrCreateSession: Core => session::create;
    xrDestroySession: Core => session::destroy;
    xrBeginSession: Core => session::begin;
    xrEndSession: Core => session::end;
    xrRequestExitSession: Core => session::request_exit;
    xrEnumerateReferenceSpaces: Core => spaces::enumerate_reference_spaces;
    xrCreateReferenceSpace: Core => spaces::create_reference_space;
    xrGetReferenceSpaceBoundsRect: Core => spaces::get_reference_space_bounds;
    xrCreateActionSpace: Core => spaces::create_action_space;
    xrLocateSpace: Core => spaces::locate;
    xrLocateSpaces: Core11 => spaces::locate_many;
    xrDestroySpace: Core => spaces::destroy;
    xrLocateViews: Core => views::locate;
    xrEnumerateSwapchainFormats: Core => swapchain::enumerate_formats;
    xrCreateSwapchain: Core => swapchain::create;
    xrDestroySwapchain: Core => swapchain::destroy;
    xrEnumerateSwapchainImages: Core => swapchain::enumerate_images;
    xrAcquireSwapchainImage: Core => swapchain::acquire;
    xrWaitSwapchainImage: Core => swapchain::wait;
    xrReleaseSwapchainImage: Core => swapchain::release;
    xrWaitFrame: Core => frame::wait;
    xrBeginFrame: Core => frame::begin;
    xrEndFrame: Core => frame::end;
    xrCreateActionSet: Core => actions::create_set;
    xrDestroyActionSet: Core => actions::destroy_set;
    xrCreateAction: Core => actions::create;
    xrDestroyAction: Core => actions::destroy;
    xrSuggestInteractionProfileBindings: Core => actions::bindings::suggest;
    xrAttachSessionActionSets: Core => actions::bindings::attach;
    xrGetCurrentInteractionProfile: Core => actions::bindings::get_current_profile;
    xrEnumerateBoundSourcesForAction: Core => actions::bindings::enumerate_bound_sources;
    xrGetInputSourceLocalizedName: Core => actions::bindings::get_localized_name;
    xrSyncActions: Core => actions::sync::sync;
    xrGetActionStateBoolean: Core => actions::state::get_boolean;
    xrGetActionStateFloat: Core => actions::state::get_float;
    xrGetActionStateVector2f: Core => actions::state::get_vector2f;
    xrGetActionStatePose: Core => actions::state::get_pose;
    xrApplyHapticFeedback: Core => actions::haptics::apply;
    xrStopHapticFeedback: Core => actions::haptics::stop;
    xrGetVulkanInstanceExtensionsKHR: ENABLE => vulkan::enable::get_instance_extensions;
    xrGetVulkanDeviceExtensionsKHR: ENABLE => vulkan::enable::get_device_extensions;
    xrGetVulkanGraphicsDeviceKHR: ENABLE => vulkan::enable::get_graphics_device;
    xrGetVulkanGraphicsRequirementsKHR: ENABLE => vulkan::enable::get_requirements;
    xrCreateVulkanInstanceKHR: ENABLE2 => vulkan::enable2::create_instance;
    xrCreateVulkanDeviceKHR: ENABLE2 => vulkan::enable2::create_device;
    xrGetVulkanGraphicsDevice2KHR: ENABLE2 => vulkan::enable2::get_graphics_device;
    xrGetVulkanGraphicsRequirements2KHR: ENABLE2 => vulkan::enable2::get_requirements;
    xrGetVisibilityMaskKHR: Extension("XR_KHR_visibility_mask") => visibility_mask::get;
    xrCreateDebugUtilsMessengerEXT: DEBUG_UTILS => debug_utils::create_messenger;
    xrDestroyDebugUtilsMessengerEXT: DEBUG_UTILS => debug_utils::destroy_messenger;
    xrSubmitDebugUtilsMessageEXT: DEBUG_UTILS => debug_utils::submit_message;
    xrSetDebugUtilsObjectNameEXT: DEBUG_UTILS => debug_utils::set_object_name;
    xrSessionBeginDebugUtilsLabelRegionEXT: DEBUG_UTILS => debug_utils::begin_label_region;
    xrSessionEndDebugUtilsLabelRegionEXT: DEBUG_UTILS => debug_utils::end_label_region;
    xrSessionInsertDebugUtilsLabelEXT: DEBUG_UTILS => debug_utils::insert_label;
    xrConvertTimespecTimeToTimeKHR: TIMESPEC => timespec::to_time;
    xrConvertTimeToTimespecTimeKHR: TIMESPEC => timespec::from_time;
}

/// Whether the runtime has a function of that name.
pub(crate) fn has(name: &str) -> bool {
    function(name).is_some()
}

/// `xrGetInstanceProcAddr`.
pub(crate) extern "system" fn get_instance_proc_addr(
    instance: xr::Instance,
    name: In<c_char>,
    pointer: Out<Option<xr::pfn::VoidFunction>>,
) -> xr::Result {
    call("xrGetInstanceProcAddr", |runtime| {
        pointer.set("function", None)?;
        let name = name.text("name")?;
        if runtime.scenario.quirks.missing_functions.iter().any(|missing| missing == name) {
            return Ok(xr::Result::ERROR_FUNCTION_UNSUPPORTED);
        }
        let found = if instance == xr::Instance::default() {
            found_without_instance(name)?
        } else {
            match found_with_instance(runtime.instances.get(instance)?, name) {
                Some(found) => found,
                // Asking is not a mistake: loaders ask for every function they know. Nothing is recorded.
                None => return Ok(xr::Result::ERROR_FUNCTION_UNSUPPORTED),
            }
        };
        // SAFETY: function pointers have one layout; any caller casts it to the type that `name` has in the
        // specification, which is the type of our function: its parameter types have the layouts of those in the specification.
        let found = unsafe { std::mem::transmute::<*const (), xr::pfn::VoidFunction>(found) };
        pointer.set("function", Some(found))?;
        Ok(xr::Result::SUCCESS)
    })
}

fn found_without_instance(name: &str) -> Result<*const (), Fault> {
    match function(name) {
        Some((Global, pointer)) => Ok(pointer),
        _ => {
            let message = format!("{name} needs an instance, which is XR_NULL_HANDLE");
            Err(Fault::new(xr::Result::ERROR_HANDLE_INVALID, section::FUNCTION_POINTERS, message))
        }
    }
}

fn found_with_instance(instance: &Instance, name: &str) -> Option<*const ()> {
    let (availability, pointer) = function(name)?;
    let available = match availability {
        Global | Core => true,
        Core11 => instance.is_1_1(),
        Extension(extension) => instance.has(extension),
    };
    available.then_some(pointer)
}

/// The function by which the OpenXR loader gets hold of the runtime.
///
/// Fails, as the loader specification demands, with `XR_ERROR_INITIALIZATION_FAILED` where a structure is not of the
/// kind that interface version 1 has, or the loader cannot do version 1 or no OpenXR 1.x.
///
/// # Safety
/// Both pointers are NULL or valid for the call.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn xrNegotiateLoaderRuntimeInterface(
    loader: *const xr::NegotiateLoaderInfo,
    request: *mut xr::NegotiateRuntimeRequest,
) -> xr::Result {
    // SAFETY: this function's contract.
    let (Some(loader), Some(request)) = (unsafe { loader.as_ref() }, unsafe { request.as_mut() }) else {
        return xr::Result::ERROR_INITIALIZATION_FAILED;
    };
    match negotiate(loader, request) {
        Ok(result) => result,
        Err(fault) => {
            eprintln!("parafovea mock runtime: xrNegotiateLoaderRuntimeInterface: {}", fault.message);
            fault.result
        }
    }
}

/// The only version of the interface between loaders and runtimes there is.
const INTERFACE_VERSION: u32 = 1;

fn negotiate(loader: &xr::NegotiateLoaderInfo, request: &mut xr::NegotiateRuntimeRequest) -> Outcome {
    let failed = |message: &str| {
        Fault::new(
            xr::Result::ERROR_INITIALIZATION_FAILED,
            "OpenXR Loader: Runtime Interface Negotiation",
            message,
        )
    };
    if (loader.struct_type, loader.struct_version)
        != (xr::NegotiateLoaderInfo::TYPE, xr::NegotiateLoaderInfo::VERSION)
        || loader.struct_size != size_of::<xr::NegotiateLoaderInfo>()
    {
        return Err(failed("loaderInfo is no XrNegotiateLoaderInfo of version 1"));
    }
    let expected = (xr::NegotiateRuntimeRequest::TYPE, xr::NegotiateRuntimeRequest::VERSION);
    if (request.struct_type, request.struct_version) != expected
        || request.struct_size != size_of::<xr::NegotiateRuntimeRequest>()
    {
        return Err(failed("runtimeRequest is no XrNegotiateRuntimeRequest of version 1"));
    }
    if !(loader.min_interface_version..=loader.max_interface_version).contains(&INTERFACE_VERSION) {
        return Err(failed("the loader does not know interface version 1"));
    }
    // A loader of OpenXR 1.0 takes any 1.x runtime: it was published to go up to 1.1023.4095.
    if loader.min_api_version.major() > 1 || loader.max_api_version.major() < 1 {
        return Err(failed("the loader is not for OpenXR 1"));
    }
    request.runtime_interface_version = INTERFACE_VERSION;
    request.runtime_api_version = instance::NEWEST_API.min(loader.max_api_version);
    // SAFETY: function pointers have one layout, and so have the parameters: `In` and `Out` are pointers.
    request.get_instance_proc_addr = Some(unsafe {
        std::mem::transmute::<*const (), xr::pfn::GetInstanceProcAddr>(get_instance_proc_addr as *const ())
    });
    Ok(xr::Result::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arguments of the loader of OpenXR `newest`.
    fn loader(newest: xr::Version) -> xr::NegotiateLoaderInfo {
        xr::NegotiateLoaderInfo {
            struct_type: xr::NegotiateLoaderInfo::TYPE,
            struct_version: xr::NegotiateLoaderInfo::VERSION,
            struct_size: size_of::<xr::NegotiateLoaderInfo>(),
            min_interface_version: 1,
            max_interface_version: 1,
            min_api_version: xr::Version::new(1, 0, 0),
            max_api_version: newest,
        }
    }

    fn request() -> xr::NegotiateRuntimeRequest {
        xr::NegotiateRuntimeRequest {
            struct_type: xr::NegotiateRuntimeRequest::TYPE,
            struct_version: xr::NegotiateRuntimeRequest::VERSION,
            struct_size: size_of::<xr::NegotiateRuntimeRequest>(),
            runtime_interface_version: 0,
            runtime_api_version: xr::Version::new(0, 0, 0),
            get_instance_proc_addr: None,
        }
    }

    #[test]
    fn loaders_of_1_0_and_1_1_get_the_runtime() {
        for newest in [(1, 0x3ff, 0xfff), (1, 1, 49)] {
            let mut request = request();
            assert!(negotiate(&loader(xr::Version::new(newest.0, newest.1, newest.2)), &mut request).is_ok());
            assert_eq!((request.runtime_interface_version, request.runtime_api_version.major()), (1, 1));
            assert!(request.get_instance_proc_addr.is_some());
        }
    }

    #[test]
    fn other_loaders_are_refused() {
        let good = || loader(NEWEST);
        let bad = [
            xr::NegotiateLoaderInfo { struct_version: 2, ..good() },
            xr::NegotiateLoaderInfo { struct_size: 8, ..good() },
            xr::NegotiateLoaderInfo { min_interface_version: 2, max_interface_version: 2, ..good() },
            xr::NegotiateLoaderInfo { min_api_version: xr::Version::new(2, 0, 0), ..good() },
        ];
        for loader in bad {
            let refused = negotiate(&loader, &mut request()).unwrap_err();
            assert_eq!(refused.result, xr::Result::ERROR_INITIALIZATION_FAILED);
        }
        let request = &mut xr::NegotiateRuntimeRequest { struct_size: 8, ..request() };
        assert!(negotiate(&good(), request).is_err());
    }

    const NEWEST: xr::Version = instance::NEWEST_API;

    #[test]
    fn without_an_instance_there_are_only_the_functions_that_lead_to_one() {
        assert!(found_without_instance("xrCreateInstance").is_ok());
        let refused = found_without_instance("xrDestroyInstance").unwrap_err();
        assert_eq!(refused.result, xr::Result::ERROR_HANDLE_INVALID);
    }
}
