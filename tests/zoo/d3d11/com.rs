//! COM objects, called by the slots of their method tables.

use anyhow::{Result, bail};
use std::ffi::c_void;
use std::ptr::{self, NonNull};

/// Result of a call; negative values are errors.
pub type HResult = i32;

/// An interface's identifier, in the order of bytes in memory.
#[repr(transparent)]
pub struct Guid([u8; 16]);

impl Guid {
    /// Of the usual notation, without its dashes.
    pub const fn new(notation: u128) -> Self {
        let b = notation.to_be_bytes();
        // The first three parts are numbers, in the machine's order of bytes.
        Self([
            b[3], b[2], b[1], b[0], b[5], b[4], b[7], b[6], b[8], b[9], b[10], b[11], b[12], b[13], b[14],
            b[15],
        ])
    }
}

/// A counted reference to an object.
pub struct Object(NonNull<c_void>);

impl Object {
    /// Takes a reference over that a call has returned.
    ///
    /// # Safety
    /// `raw` is null, or an object whose reference nobody else releases.
    pub unsafe fn from_raw(raw: *mut c_void, call: &str) -> Result<Self> {
        match NonNull::new(raw) {
            Some(object) => Ok(Self(object)),
            None => bail!("{call} returned no object"),
        }
    }

    /// The object as arguments name it.
    pub fn raw(&self) -> *mut c_void {
        self.0.as_ptr()
    }

    /// The method in a slot of its table.
    ///
    /// # Safety
    /// The interface has such a slot, with a method of type `F`, a function pointer.
    pub unsafe fn method<F: Copy>(&self, slot: usize) -> F {
        const { assert!(size_of::<F>() == size_of::<*const c_void>()) };
        // SAFETY: an object begins with the address of its table, whose slots are function pointers; type and slot as `# Safety` demands.
        unsafe {
            let table = *self.raw().cast::<*const *const c_void>();
            table.add(slot).cast::<F>().read()
        }
    }

    /// Another interface of the same object.
    pub fn query(&self, id: &Guid, name: &str) -> Result<Self> {
        let mut found = ptr::null_mut();
        let result = call!(self, 0, id => *const Guid, &mut found => *mut *mut c_void; HResult);
        check(result, name)?;
        // SAFETY: a reference that the call has added.
        unsafe { Self::from_raw(found, name) }
    }
}

impl Drop for Object {
    fn drop(&mut self) {
        call!(self, 2; u32);
    }
}

/// Refuses a call's failure.
pub fn check(result: HResult, call: &str) -> Result<()> {
    if result < 0 {
        bail!("{call} returned {:#010x}", result.cast_unsigned());
    }
    Ok(())
}

/// Calls the method in a slot of an object's table: `call!(object, slot, argument => type, ...; result)`. Slots and types are those of the
/// interface's C declaration, with the calling convention of DXVK's Linux build.
macro_rules! call {
    ($object:expr, $slot:expr $(, $argument:expr => $type:ty)* ; $result:ty) => {{
        let object: &$crate::com::Object = $object;
        // SAFETY: slot and types are those of the declaration; arguments are live for the call, as they are borrowed.
        unsafe {
            let method: unsafe extern "C" fn(*mut ::std::ffi::c_void $(, $type)*) -> $result = object.method($slot);
            method(object.raw() $(, $argument)*)
        }
    }};
}
pub(crate) use call;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_have_their_bytes_in_memory_order() {
        let Guid(bytes) = Guid::new(0x00112233_4455_6677_8899_aabbccddeeff);
        let expected =
            [0x33, 0x22, 0x11, 0, 0x55, 0x44, 0x77, 0x66, 0x88, 0x99, 0xaa, 0xbb, 0xcc, 0xdd, 0xee, 0xff];
        assert_eq!(bytes, expected);
    }
}
