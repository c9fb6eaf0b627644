//! Keys of instances and devices.

use ash::vk::Handle;

/// The key of an instance or a device: the loader's dispatch table, whose address is the first word of every dispatchable object. A
/// physical device has its instance's key; a queue and a command buffer have their device's.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DispatchKey(usize);

impl DispatchKey {
    /// The address of the dispatch table.
    pub fn address(self) -> usize {
        self.0
    }

    /// The key with that address.
    #[cfg(test)]
    pub fn from_address(address: usize) -> Self {
        Self(address)
    }

    /// Reads an object's key; `None` for a null handle. Read it before the object is destroyed.
    ///
    /// # Safety
    ///
    /// `object` is null or a live dispatchable object.
    pub unsafe fn of<H: Handle>(object: H) -> Option<Self> {
        let object = object.as_raw() as *const usize;
        // SAFETY: a live dispatchable object is a pointer to memory whose first word is the dispatch table
        // (the loader's contract with drivers).
        (!object.is_null()).then(|| Self(unsafe { *object }))
    }
}
