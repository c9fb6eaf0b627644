//! The extensions that an instance is created with.

use openxr_sys as xr;
use std::ffi::{CStr, c_char};

/// Eye gaze as an input action: the only gaze source of this layer so far.
const EYE_GAZE: &CStr = c"XR_EXT_eye_gaze_interaction";

/// How an application's list of extensions stands to eye gaze.
pub enum EyeGaze {
    /// The application asks for it.
    AskedFor,
    /// It does not: its extensions, with eye gaze added.
    Added(Vec<*const c_char>),
    /// The list is malformed; the runtime will say so.
    Unreadable,
}

impl EyeGaze {
    /// Reads the list.
    ///
    /// # Safety
    ///
    /// `info` is valid, and stays so while the names are used.
    pub unsafe fn of(info: &xr::InstanceCreateInfo) -> Self {
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
        if asked.iter().any(|&name| unsafe { CStr::from_ptr(name) } == EYE_GAZE) {
            return Self::AskedFor;
        }
        let mut names = asked.to_vec();
        names.push(EYE_GAZE.as_ptr());
        Self::Added(names)
    }
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

    #[test]
    fn is_added_once_and_last() {
        let vulkan = c"XR_KHR_vulkan_enable2".as_ptr();
        let of = |names: &[*const c_char]| {
            // SAFETY: the names are literals.
            unsafe { EyeGaze::of(&info(names)) }
        };
        assert!(matches!(of(&[vulkan]), EyeGaze::Added(names) if names == [vulkan, EYE_GAZE.as_ptr()]));
        assert!(matches!(of(&[]), EyeGaze::Added(names) if names.len() == 1));
        assert!(matches!(of(&[vulkan, EYE_GAZE.as_ptr()]), EyeGaze::AskedFor));
        assert!(matches!(of(&[std::ptr::null()]), EyeGaze::Unreadable));
    }
}
