//! The OpenXR functions that the cases call, fetched from the Khronos loader by name.

use crate::failure::Failure;
use openxr_sys::{Instance, pfn};
use std::ffi::{CStr, CString};

/// Fetches one function of an extension: `extension_function!(xr, GetVulkanGraphicsDeviceKHR)`.
macro_rules! extension_function {
    ($xr:expr, $name:ident) => {
        $crate::functions::look_up($xr.get_instance_proc_addr, $xr.instance, concat!("xr", stringify!($name)))
            .map(|function| {
                // SAFETY: the loader returned the function of this name, and `pfn` declares its signature.
                unsafe {
                    std::mem::transmute::<openxr_sys::pfn::VoidFunction, openxr_sys::pfn::$name>(function)
                }
            })
    };
}
pub(crate) use extension_function;

macro_rules! functions {
    ($($field:ident: $name:ident,)*) => {
        /// Functions of OpenXR 1.0 for one instance.
        pub struct Functions {
            $(pub $field: pfn::$name,)*
        }

        impl Functions {
            /// Fetches all of them.
            pub fn load(get: pfn::GetInstanceProcAddr, instance: Instance) -> Result<Self, Failure> {
                Ok(Self {
                    // SAFETY: the loader returned the function of this name, and `pfn` declares its signature.
                    $($field: unsafe {
                        std::mem::transmute::<pfn::VoidFunction, pfn::$name>(
                            look_up(get, instance, concat!("xr", stringify!($name)))?,
                        )
                    },)*
                })
            }
        }
    };
}

functions! {
    destroy_instance: DestroyInstance,
    poll_event: PollEvent,
    get_system: GetSystem,
    get_system_properties: GetSystemProperties,
    enumerate_views: EnumerateViewConfigurationViews,
    create_session: CreateSession,
    destroy_session: DestroySession,
    begin_session: BeginSession,
    end_session: EndSession,
    request_exit_session: RequestExitSession,
    create_reference_space: CreateReferenceSpace,
    create_action_space: CreateActionSpace,
    destroy_space: DestroySpace,
    enumerate_bound_sources: EnumerateBoundSourcesForAction,
    get_localized_name: GetInputSourceLocalizedName,
    locate_space: LocateSpace,
    locate_views: LocateViews,
    wait_frame: WaitFrame,
    begin_frame: BeginFrame,
    end_frame: EndFrame,
    create_swapchain: CreateSwapchain,
    destroy_swapchain: DestroySwapchain,
    enumerate_images: EnumerateSwapchainImages,
    acquire_image: AcquireSwapchainImage,
    wait_image: WaitSwapchainImage,
    release_image: ReleaseSwapchainImage,
    string_to_path: StringToPath,
    create_action_set: CreateActionSet,
    create_action: CreateAction,
    destroy_action_set: DestroyActionSet,
    destroy_action: DestroyAction,
    suggest_bindings: SuggestInteractionProfileBindings,
    attach_action_sets: AttachSessionActionSets,
    sync_actions: SyncActions,
    get_boolean: GetActionStateBoolean,
    get_pose: GetActionStatePose,
    get_current_profile: GetCurrentInteractionProfile,
}

/// Asks the loader for one function.
pub fn look_up(
    get: pfn::GetInstanceProcAddr,
    instance: Instance,
    name: &str,
) -> Result<pfn::VoidFunction, Failure> {
    let missing = || Failure::Function(name.to_owned());
    let c_name = CString::new(name).map_err(|_| missing())?;
    let mut function = None;
    // SAFETY: `get` is the loader's, the name ends with a zero, the output is a function pointer or null.
    unsafe { get(instance, c_name.as_ptr(), &mut function) };
    function.ok_or_else(missing)
}

/// Copies a name into an OpenXR array of characters, truncated to its size.
pub fn characters<const N: usize>(name: &CStr) -> [std::ffi::c_char; N] {
    let mut characters = [0; N];
    for (to, from) in characters.iter_mut().take(N - 1).zip(name.to_bytes()) {
        *to = *from as std::ffi::c_char;
    }
    characters
}
