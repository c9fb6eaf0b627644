//! Text across the C surface.

use super::pointers::{In, Out};
use crate::fault::{Fault, section};
use std::ffi::{CStr, c_char};

impl In<c_char> {
    /// A NUL-terminated UTF-8 parameter.
    pub fn text(&self, name: &str) -> Result<&str, Fault> {
        utf8(name, member(name, self.raw())?)
    }
}

/// A string that a member of a valid structure, or a parameter, points to.
pub(super) fn member<'a>(name: &str, text: *const c_char) -> Result<&'a CStr, Fault> {
    if text.is_null() {
        return Err(Fault::validation(section::VALID_USAGE, format!("{name} is NULL")));
    }
    // SAFETY: the specification ("Valid Usage") obliges the application to pass NUL-terminated strings.
    Ok(unsafe { CStr::from_ptr(text) })
}

fn utf8<'a>(name: &str, text: &'a CStr) -> Result<&'a str, Fault> {
    text.to_str()
        .map_err(|_| Fault::validation(section::VALID_USAGE, format!("{name} is not UTF-8: {text:?}")))
}

/// A string that a structure holds in an array of its own.
pub(crate) fn array<'a, const N: usize>(name: &str, text: &'a [c_char; N]) -> Result<&'a str, Fault> {
    // SAFETY: `c_char` and `u8` have the same layout.
    let bytes = unsafe { &*std::ptr::from_ref(text).cast::<[u8; N]>() };
    let text = CStr::from_bytes_until_nul(bytes)
        .map_err(|_| Fault::validation(section::VALID_USAGE, format!("{name} is not NUL-terminated")))?;
    utf8(name, text)
}

/// Fills an array with text, cut at the end where it does not fit, and a NUL.
pub(crate) fn fill<const N: usize>(array: &mut [c_char; N], text: &str) {
    array.fill(0);
    let end = text.floor_char_boundary(N - 1);
    for (target, byte) in array.iter_mut().zip(&text.as_bytes()[..end]) {
        *target = *byte as c_char;
    }
}

/// Text as the array of a two-call idiom, with its NUL.
pub(crate) fn terminated(text: &str) -> Vec<c_char> {
    text.bytes().chain([0]).map(|byte| byte as c_char).collect()
}

impl<const N: usize> Out<[c_char; N]> {
    /// Stores text in an array parameter.
    pub fn set_text(&mut self, name: &str, text: &str) -> Result<(), Fault> {
        let mut array = [0; N];
        fill(&mut array, text);
        self.set(name, array)
    }
}
