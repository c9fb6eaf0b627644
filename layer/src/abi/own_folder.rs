//! The folder of this library: its companions lie beside it.

use std::ffi::{CStr, OsStr, c_void};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

/// An address within this library.
static HERE: u8 = 0;

/// The folder that this library was loaded from.
pub fn own_folder() -> Option<PathBuf> {
    let here: *const c_void = (&raw const HERE).cast();
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::uninit();
    // SAFETY: an address within this library, and a place for the answer, which is written on success; its
    // name is a C string that lives as long as the library.
    let file = unsafe {
        if libc::dladdr(here, info.as_mut_ptr()) == 0 {
            return None;
        }
        let name = info.assume_init().dli_fname;
        if name.is_null() {
            return None;
        }
        PathBuf::from(OsStr::from_bytes(CStr::from_ptr(name).to_bytes()))
    };
    file.canonicalize().ok()?.parent().map(Path::to_owned)
}
