//! HLSL to the byte code of Direct3D, by vkd3d's compiler.

use anyhow::{Context, Result, bail};
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr;

/// vkd3d declares its functions and methods with the calling convention of Windows, on Linux too.
type D3DCompile = unsafe extern "win64" fn(
    *const c_void,
    usize,
    *const c_char,
    *const Macro,
    *mut c_void,
    *const c_char,
    *const c_char,
    u32,
    u32,
    *mut *mut Blob,
    *mut *mut Blob,
) -> i32;

#[repr(C)]
struct Macro {
    name: *const c_char,
    value: *const c_char,
}

/// `ID3DBlob`: bytes.
#[repr(C)]
struct Blob {
    table: *const BlobTable,
}

#[repr(C)]
struct BlobTable {
    query: *const c_void,
    add: *const c_void,
    release: unsafe extern "win64" fn(*mut Blob) -> u32,
    pointer: unsafe extern "win64" fn(*mut Blob) -> *const u8,
    size: unsafe extern "win64" fn(*mut Blob) -> usize,
}

/// The compiler.
pub struct Compiler {
    compile: D3DCompile,
    _library: libloading::Library,
}

impl Compiler {
    /// Loads vkd3d.
    pub fn load() -> Result<Self> {
        // SAFETY: the library of this name is taken to be vkd3d's, whose function is of this type.
        unsafe {
            let library = libloading::Library::new("libvkd3d-utils.so.1").context("vkd3d's compiler")?;
            let compile = *library.get::<D3DCompile>(b"D3DCompile\0")?;
            Ok(Self { compile, _library: library })
        }
    }

    /// Compiles a function of a shader to byte code, with macros defined as 1.
    pub fn compile(&self, source: &str, entry: &CStr, profile: &CStr, defined: &[&CStr]) -> Result<Vec<u8>> {
        let mut macros: Vec<Macro> =
            defined.iter().map(|name| Macro { name: name.as_ptr(), value: c"1".as_ptr() }).collect();
        macros.push(Macro { name: ptr::null(), value: ptr::null() });
        let name = CString::from(c"scene.hlsl");
        let (mut code, mut messages) = (ptr::null_mut(), ptr::null_mut());
        // SAFETY: all pointers are live for the call; the macros end with an empty one.
        let result = unsafe {
            (self.compile)(
                source.as_ptr().cast(),
                source.len(),
                name.as_ptr(),
                macros.as_ptr(),
                ptr::null_mut(),
                entry.as_ptr(),
                profile.as_ptr(),
                0,
                0,
                &mut code,
                &mut messages,
            )
        };
        // SAFETY: each is null or a blob that the call has returned, taken once.
        let (code, messages) = unsafe { (take(code), take(messages)) };
        match code {
            Some(code) if result >= 0 => Ok(code),
            _ => {
                let messages = messages.unwrap_or_default();
                bail!("{}: {}", entry.to_string_lossy(), String::from_utf8_lossy(&messages))
            }
        }
    }
}

/// The bytes of a blob, which ends.
///
/// # Safety
/// `blob` is null or a live one.
unsafe fn take(blob: *mut Blob) -> Option<Vec<u8>> {
    // SAFETY: a live blob, as `# Safety` demands, begins with its table.
    let table = unsafe { blob.as_ref()?.table.as_ref()? };
    // SAFETY: pointer and size are those of the same live blob.
    let bytes = unsafe { std::slice::from_raw_parts((table.pointer)(blob), (table.size)(blob)).to_vec() };
    // SAFETY: its only reference.
    unsafe { (table.release)(blob) };
    Some(bytes)
}
