//! The functions that only instances with an offered gaze call below or hook.

use super::{hooks, sources, spaces};
use openxr_sys::pfn;
use std::ffi::CStr;

macro_rules! functions {
    ($($name:literal $field:ident: $pfn:ident => $hook:path;)*) => {
        /// The functions of the layer (or runtime) below, all of OpenXR 1.0.
        #[derive(Clone, Copy)]
        pub struct OfferNext {
            $(pub $field: pfn::$pfn,)*
            /// Of OpenXR 1.1, or of an extension.
            pub locate_spaces: Option<pfn::LocateSpaces>,
        }

        impl OfferNext {
            /// Resolves them, or gives the name of one that is missing.
            ///
            /// # Safety
            ///
            /// For a name, `get` returns the function of that name, or `None`.
            #[allow(clippy::missing_transmute_annotations, reason = "the field gives the type")]
            pub unsafe fn load(get: impl Fn(&CStr) -> Option<pfn::VoidFunction>) -> Result<Self, &'static CStr> {
                let locate = get(c"xrLocateSpaces").or_else(|| get(c"xrLocateSpacesKHR"));
                // SAFETY: `get` returns the function of that name, as `# Safety` demands, and the list gives each name its type; the two
                // names of xrLocateSpaces have one type.
                unsafe {
                    Ok(Self {
                        $($field: std::mem::transmute(get($name).ok_or($name)?),)*
                        locate_spaces: locate.map(|function| {
                            std::mem::transmute::<pfn::VoidFunction, pfn::LocateSpaces>(function)
                        }),
                    })
                }
            }
        }

        /// The hook of that name.
        pub fn hook(name: &CStr) -> Option<pfn::VoidFunction> {
            $(
                if name == $name {
                    let hook: pfn::$pfn = $hook;
                    // SAFETY: any function pointer may be carried as PFN_xrVoidFunction; the receiver casts it back by its name.
                    return Some(unsafe { std::mem::transmute::<pfn::$pfn, pfn::VoidFunction>(hook) });
                }
            )*
            if name == c"xrLocateSpaces" || name == c"xrLocateSpacesKHR" {
                let hook: pfn::LocateSpaces = spaces::locate_many;
                // SAFETY: as above.
                return Some(unsafe { std::mem::transmute::<pfn::LocateSpaces, pfn::VoidFunction>(hook) });
            }
            None
        }
    };
}

functions! {
    c"xrGetSystemProperties" get_system_properties: GetSystemProperties => hooks::get_system_properties;
    c"xrDestroyActionSet" destroy_action_set: DestroyActionSet => hooks::destroy_action_set;
    c"xrDestroyAction" destroy_action: DestroyAction => hooks::destroy_action;
    c"xrGetActionStatePose" get_action_state_pose: GetActionStatePose => hooks::get_action_state_pose;
    c"xrEnumerateBoundSourcesForAction" enumerate_bound_sources:
        EnumerateBoundSourcesForAction => sources::enumerate_bound_sources;
    c"xrGetInputSourceLocalizedName" get_localized_name:
        GetInputSourceLocalizedName => sources::get_localized_name;
    c"xrCreateActionSpace" create_action_space: CreateActionSpace => spaces::create_action_space;
    c"xrLocateSpace" locate_space: LocateSpace => spaces::locate;
}
