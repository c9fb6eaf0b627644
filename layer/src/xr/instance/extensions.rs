//! The extensions that an instance is created with.

use openxr_sys as xr;
use openxr_sys::pfn;
use std::ffi::{CStr, c_char};
use std::mem::transmute;
use std::ptr;

/// Eye gaze as an input action.
const EYE_GAZE: &CStr = c"XR_EXT_eye_gaze_interaction";

/// Eye gaze in an application's list of extensions.
#[derive(Debug)]
pub enum EyeGaze {
    /// The application asks for it.
    AskedFor {
        /// Its other extensions.
        others: Vec<*const c_char>,
        /// Whether the runtime lists its extensions, and not this one.
        is_missing: bool,
    },
    /// It does not: its extensions, with eye gaze added.
    Added(Vec<*const c_char>),
    /// It does not, and the runtime has no eye gaze.
    Missing,
    /// The list is malformed; the runtime will report it.
    Unreadable,
}

impl EyeGaze {
    /// Reads the list. `offered` is the runtime's own, if known. An extension that it lacks is asked for all the same, by creating an
    /// instance with it, because such lists are not always right (peers: VectorXR on SteamVR and Pimax): unless a structure in the chain may
    /// report the failures meanwhile to the application.
    ///
    /// # Safety
    ///
    /// `info` is valid, and stays so while the names are used.
    pub unsafe fn of(info: &xr::InstanceCreateInfo, offered: Option<&[xr::ExtensionProperties]>) -> Self {
        let count = info.enabled_extension_count as usize;
        let asked: &[*const c_char] = match info.enabled_extension_names.is_null() {
            true if count == 0 => &[],
            true => return Self::Unreadable,
            // SAFETY: xrCreateInstance demands an array of that many names.
            false => unsafe { std::slice::from_raw_parts(info.enabled_extension_names, count) },
        };
        if asked.iter().any(|name| name.is_null()) {
            return Self::Unreadable;
        }
        // SAFETY: xrCreateInstance demands that each is a C string.
        let is_it = |name: *const c_char| unsafe { CStr::from_ptr(name) } == EYE_GAZE;
        if asked.iter().any(|&name| is_it(name)) {
            let others = asked.iter().copied().filter(|&name| !is_it(name)).collect();
            return Self::AskedFor {
                others,
                is_missing: offered.is_some_and(|offered| !lists(offered, EYE_GAZE)),
            };
        }
        if let Some(offered) = offered {
            // SAFETY: as above.
            let mut texts = asked.iter().map(|&name| unsafe { CStr::from_ptr(name) });
            let has = |name: &CStr| lists(offered, name);
            if !has(EYE_GAZE) && texts.all(has) && !info.next.is_null() {
                return Self::Missing;
            }
        }
        let mut names = asked.to_vec();
        names.push(EYE_GAZE.as_ptr());
        Self::Added(names)
    }
}

fn lists(offered: &[xr::ExtensionProperties], name: &CStr) -> bool {
    offered.iter().any(|extension| is_named(extension, name))
}

fn is_named(extension: &xr::ExtensionProperties, name: &CStr) -> bool {
    let characters = extension.extension_name.iter().map(|&character| character as u8);
    characters.take_while(|&byte| byte != 0).eq(name.to_bytes().iter().copied())
}

/// The extensions of the runtime; `None` without a usable answer.
///
/// # Safety
///
/// `get` is the `xrGetInstanceProcAddr` of the loader's end of the chain, which takes questions without an instance: other
/// layers may not.
pub unsafe fn offered(get: pfn::GetInstanceProcAddr) -> Option<Vec<xr::ExtensionProperties>> {
    let mut function = None;
    let name = c"xrEnumerateInstanceExtensionProperties";
    // SAFETY: the function takes questions without an instance, as `# Safety` demands; a name and a place for the result.
    let result = unsafe { get(xr::Instance::default(), name.as_ptr(), &mut function) };
    let function = function.filter(|_| result == xr::Result::SUCCESS)?;
    // SAFETY: the function of that name has that type.
    let enumerate =
        unsafe { transmute::<pfn::VoidFunction, pfn::EnumerateInstanceExtensionProperties>(function) };
    let mut count = 0;
    // SAFETY: no layer's name, and a place for the count.
    let result = unsafe { enumerate(ptr::null(), 0, &mut count, ptr::null_mut()) };
    if result.into_raw() < 0 || count == 0 {
        return None;
    }
    let blank = xr::ExtensionProperties {
        ty: xr::ExtensionProperties::TYPE,
        next: ptr::null_mut(),
        extension_name: [0; xr::MAX_EXTENSION_NAME_SIZE],
        extension_version: 0,
    };
    let mut extensions = vec![blank; count as usize];
    // SAFETY: an array of the capacity that is passed, and a place for the count.
    let result = unsafe { enumerate(ptr::null(), count, &mut count, extensions.as_mut_ptr()) };
    extensions.truncate(count as usize);
    (result == xr::Result::SUCCESS && !extensions.is_empty()).then_some(extensions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(names: &[*const c_char]) -> xr::InstanceCreateInfo {
        // SAFETY: the structure is plain data, for which all zero is a valid value.
        let mut info: xr::InstanceCreateInfo = unsafe { std::mem::zeroed() };
        info.enabled_extension_count = names.len() as u32;
        info.enabled_extension_names = names.as_ptr();
        info
    }

    fn extension(name: &CStr) -> xr::ExtensionProperties {
        // SAFETY: as above.
        let mut extension: xr::ExtensionProperties = unsafe { std::mem::zeroed() };
        for (to, from) in extension.extension_name.iter_mut().zip(name.to_bytes()) {
            *to = *from as c_char;
        }
        extension
    }

    #[test]
    fn is_added_once_and_last() {
        let vulkan = c"XR_KHR_vulkan_enable2".as_ptr();
        let of = |names: &[*const c_char]| {
            // SAFETY: the names are literals.
            unsafe { EyeGaze::of(&info(names), None) }
        };
        let EyeGaze::Added(names) = of(&[vulkan]) else { panic!("it is not added") };
        // SAFETY: as above.
        let texts: Vec<_> = names.iter().map(|&name| unsafe { CStr::from_ptr(name) }).collect();
        assert_eq!(texts, [c"XR_KHR_vulkan_enable2", EYE_GAZE]);
        assert!(matches!(of(&[]), EyeGaze::Added(names) if names.len() == 1));
        assert!(
            matches!(of(&[EYE_GAZE.as_ptr(), vulkan]), EyeGaze::AskedFor { others, is_missing: false } if others == [vulkan])
        );
        assert!(matches!(of(&[ptr::null()]), EyeGaze::Unreadable));
    }

    #[test]
    fn a_list_is_believed_where_it_is_right_and_a_try_could_be_heard() {
        let vulkan = c"XR_KHR_vulkan_enable2";
        let of = |offered: &[&CStr], is_listening: bool| {
            let offered: Vec<_> = offered.iter().map(|name| extension(name)).collect();
            let names = [vulkan.as_ptr()];
            let mut info = info(&names);
            info.next = if is_listening { ptr::from_ref(&vulkan).cast() } else { ptr::null() };
            // SAFETY: the names are literals, and the chain is not looked into.
            unsafe { EyeGaze::of(&info, Some(&offered)) }
        };
        assert!(matches!(of(&[vulkan], true), EyeGaze::Missing));
        assert!(matches!(of(&[vulkan], false), EyeGaze::Added(_)));
        assert!(matches!(of(&[vulkan, EYE_GAZE], true), EyeGaze::Added(_)));
        assert!(matches!(of(&[c"XR_KHR_vulkan_enable"], true), EyeGaze::Added(_)));
    }
}
