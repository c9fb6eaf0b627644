//! Lists of OpenXR functions that the layer calls below and hooks.

/// Declares a structure of functions below, and the answer of `xrGetInstanceProcAddr` for hooked functions.
///
/// A line `c"xrName" field: Type => hook;` gives the field of the structure, its loader and its hook; a line without `=> hook` is only called.
/// After `optional:` are functions that may be missing, with all of their names.
macro_rules! functions {
    (
        $(#[$about:meta])* $structure:ident;
        $($name:literal $field:ident: $pfn:ident $(=> $hook:path)?;)*
        $(optional: $($($others:literal)|+ $optional:ident: $other:ident => $its_hook:path;)*)?
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy)]
        pub struct $structure {
            $(pub $field: openxr_sys::pfn::$pfn,)*
            $($(pub $optional: Option<openxr_sys::pfn::$other>,)*)?
        }

        impl $structure {
            /// Resolves every function beforehand, or gives the name of one that is missing.
            ///
            /// # Safety
            ///
            /// For a name, `get` returns the function of that name, or `None`.
            #[allow(clippy::missing_transmute_annotations, reason = "the field gives the type")]
            pub unsafe fn load(
                get: impl Fn(&std::ffi::CStr) -> Option<openxr_sys::pfn::VoidFunction>,
            ) -> Result<Self, &'static std::ffi::CStr> {
                // SAFETY: `get` returns the function of that name, as `# Safety` demands, and the list
                // gives each name its type; all names of one function have one type.
                unsafe {
                    Ok(Self {
                        $($field: std::mem::transmute(get($name).ok_or($name)?),)*
                        $($($optional: None$(.or_else(|| get($others)))+
                            .map(|function| std::mem::transmute::<
                                openxr_sys::pfn::VoidFunction,
                                openxr_sys::pfn::$other,
                            >(function)),)*)?
                    })
                }
            }
        }

        /// Our hook for a function.
        pub fn hook(name: &std::ffi::CStr) -> Option<openxr_sys::pfn::VoidFunction> {
            $($(
                if name == $name {
                    let hook: openxr_sys::pfn::$pfn = $hook;
                    // SAFETY: any function pointer may be carried as PFN_xrVoidFunction; the receiver casts
                    // it back by its name.
                    return Some(unsafe {
                        std::mem::transmute::<openxr_sys::pfn::$pfn, openxr_sys::pfn::VoidFunction>(hook)
                    });
                }
            )?)*
            $($(
                if [$($others),+].contains(&name) {
                    let hook: openxr_sys::pfn::$other = $its_hook;
                    // SAFETY: as above.
                    return Some(unsafe {
                        std::mem::transmute::<openxr_sys::pfn::$other, openxr_sys::pfn::VoidFunction>(hook)
                    });
                }
            )*)?
            None
        }
    };
}
pub(super) use functions;
