//! Semantic paths.

use crate::abi::pointers::{In, List, Out};
use crate::abi::text;
use crate::fault::{Fault, section};
use crate::runtime::call;
use openxr_sys as xr;
use std::ffi::c_char;

/// The paths of an instance; an `XrPath` is a place in the list, from 1.
#[derive(Debug, Default)]
pub(crate) struct Paths(Vec<String>);

impl Paths {
    /// The path with this text, which must be well-formed.
    pub fn intern(&mut self, text: &str) -> xr::Path {
        let index = self.0.iter().position(|known| known == text).unwrap_or_else(|| {
            self.0.push(text.to_owned());
            self.0.len() - 1
        });
        xr::Path::from_raw(index as u64 + 1)
    }

    /// Text of a path.
    pub fn text(&self, path: xr::Path) -> Result<&str, Fault> {
        let found = path.into_raw().checked_sub(1).and_then(|index| self.0.get(usize::try_from(index).ok()?));
        found.map(String::as_str).ok_or_else(|| {
            let message = format!("{:#x} is no XrPath of this instance", path.into_raw());
            Fault::new(xr::Result::ERROR_PATH_INVALID, section::PATHS, message)
        })
    }
}

/// Whether a name may stand between two slashes.
pub(crate) fn is_component(name: &str) -> bool {
    !name.is_empty()
        && name.bytes().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_' | b'.'))
}

fn is_well_formed(path: &str) -> bool {
    path.len() < xr::MAX_PATH_LENGTH
        && path.strip_prefix('/').is_some_and(|rest| {
            rest.split('/').all(|name| is_component(name) && name.bytes().any(|byte| byte != b'.'))
        })
}

/// `xrStringToPath`.
pub(crate) extern "system" fn string_to_path(
    instance: xr::Instance,
    string: In<c_char>,
    path: Out<xr::Path>,
) -> xr::Result {
    call("xrStringToPath", |runtime| {
        let instance = runtime.instances.get_mut(instance)?;
        let string = string.text("pathString")?;
        if !is_well_formed(string) {
            let message = format!("{string:?} is no well-formed path");
            return Err(Fault::new(xr::Result::ERROR_PATH_FORMAT_INVALID, section::PATHS, message));
        }
        path.set("path", instance.paths.intern(string))?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrPathToString`.
pub(crate) extern "system" fn path_to_string(
    instance: xr::Instance,
    path: xr::Path,
    capacity: u32,
    count: Out<u32>,
    items: Out<c_char>,
) -> xr::Result {
    call("xrPathToString", |runtime| {
        let text = text::terminated(runtime.instances.get(instance)?.paths.text(path)?);
        List { capacity, count, items }.fill("buffer", &text)?;
        Ok(xr::Result::SUCCESS)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_lower_case_names_between_slashes() {
        for good in ["/user", "/user/hand/left", "/interaction_profiles/khr/simple_controller", "/a/b.c-d_e0"]
        {
            assert!(is_well_formed(good), "{good}");
        }
        for bad in ["", "/", "user", "/user/", "/user//hand", "/User", "/user/..", "/user hand"] {
            assert!(!is_well_formed(bad), "{bad}");
        }
    }
}
