//! Chains of extending structures, which OpenXR (`next`) and Vulkan (`pNext`) lay out alike.

use std::ffi::c_void;
use std::marker::PhantomData;

/// Common header of the structures of a chain: `XrBaseInStructure`, `VkBaseInStructure`.
#[repr(C)]
#[derive(Debug)]
pub struct Header {
    /// The structure's type, as the C enumeration's number.
    pub ty: i32,
    /// The next structure, or null.
    pub next: *const Header,
}

/// A type that may stand in a chain.
///
/// # Safety
///
/// The type is `repr(C)` and starts as [`Header`] does; a structure whose type is [`Structure::number`] is one.
pub unsafe trait Structure {
    /// Number of the structure's type (`VkStructureType`, `XrStructureType`).
    fn number() -> i32;
}

/// Longest chain that is followed. The longest real ones, of Vulkan's device creation, have some dozens of
/// structures; a chain that goes on for longer is taken to have a cycle.
pub const MAX_LENGTH: usize = 256;

/// Iterates over a chain; ends after [`MAX_LENGTH`] structures.
#[derive(Debug)]
pub struct Chain<'a> {
    next: *const Header,
    left: usize,
    borrowed: PhantomData<&'a Header>,
}

/// The structures from `first` on.
///
/// # Safety
///
/// `first` is null or begins a chain of structures which start as [`Header`] does, and which stay valid and
/// unchanged for `'a`.
pub unsafe fn chain<'a>(first: *const c_void) -> Chain<'a> {
    Chain { next: first.cast(), left: MAX_LENGTH, borrowed: PhantomData }
}

impl<'a> Iterator for Chain<'a> {
    type Item = &'a Header;

    fn next(&mut self) -> Option<&'a Header> {
        if self.left == 0 {
            return None;
        }
        // SAFETY: null, or a structure of the chain that `chain`'s caller vouched for.
        let found = unsafe { self.next.as_ref() }?;
        self.next = found.next;
        self.left -= 1;
        Some(found)
    }
}

impl<'a> Chain<'a> {
    /// The first structure of type `T`.
    pub fn find<T: Structure>(mut self) -> Option<&'a T> {
        let found = Iterator::find(&mut self, |header| header.ty == T::number())?;
        // SAFETY: `Structure` guarantees that a structure of this number is a T; it is valid for 'a, as all of the chain is.
        Some(unsafe { &*std::ptr::from_ref(found).cast::<T>() })
    }
}

/// A structure that is out of its chain until this is dropped: for a call to a layer or runtime that does not know it.
#[derive(Debug)]
pub struct Unlinked<T> {
    link: *mut *mut Header,
    found: *mut T,
}

/// Takes the first structure of type `T` out of the chain that `first` points to.
///
/// # Safety
///
/// `first` points to null or to the first structure of a chain as for [`chain`], which stays valid, and is not used elsewhere while the
/// result lives.
pub unsafe fn unlink<T: Structure>(first: *mut *mut c_void) -> Option<Unlinked<T>> {
    let mut link: *mut *mut Header = first.cast();
    for _ in 0..MAX_LENGTH {
        // SAFETY: `link` points to `first` or to the pointer in a structure of the chain, which are valid, as `# Safety` demands.
        unsafe {
            let found = *link;
            let header = found.as_ref()?;
            if header.ty == T::number() {
                *link = header.next.cast_mut();
                return Some(Unlinked { link, found: found.cast() });
            }
            link = (&raw mut (*found).next).cast();
        }
    }
    None
}

impl<T> Unlinked<T> {
    /// The structure.
    pub fn get(&mut self) -> &mut T {
        // SAFETY: `unlink` found it by its number, and its caller vouched for the chain while this lives.
        unsafe { &mut *self.found }
    }
}

impl<T> Drop for Unlinked<T> {
    fn drop(&mut self) {
        // SAFETY: as above; the structure itself still points to the rest of its chain.
        unsafe { *self.link = self.found.cast() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[repr(C)]
    struct Number {
        ty: i32,
        next: *const Header,
        value: u32,
    }

    // SAFETY: repr(C), and begins with a number and a pointer.
    unsafe impl Structure for Number {
        fn number() -> i32 {
            5
        }
    }

    #[test]
    fn finds_by_type_and_ends_at_null() {
        let number = Number { ty: 5, next: std::ptr::null(), value: 9 };
        let first = Header { ty: 1, next: (&raw const number).cast() };
        let first = (&raw const first).cast();
        // SAFETY: two valid structures, alive to the end of the test.
        unsafe {
            assert_eq!(chain(first).count(), 2);
            assert_eq!(chain(first).find::<Number>().map(|found| found.value), Some(9));
            assert!(chain(std::ptr::null()).find::<Number>().is_none());
        }
    }

    #[test]
    fn a_structure_is_out_of_its_chain_for_a_while() {
        let mut last = Header { ty: 7, next: std::ptr::null() };
        let mut number = Number { ty: 5, next: &raw const last, value: 9 };
        let mut head = Header { ty: 1, next: (&raw const number).cast() };
        let mut first: *mut c_void = (&raw mut head).cast();
        // SAFETY: three valid structures, alive to the end of the test.
        unsafe {
            let mut unlinked = unlink::<Number>(&raw mut first).unwrap();
            unlinked.get().value = 4;
            assert_eq!(chain(first).map(|header| header.ty).collect::<Vec<_>>(), [1, 7]);
            drop(unlinked);
            assert_eq!(chain(first).map(|header| header.ty).collect::<Vec<_>>(), [1, 5, 7]);
            assert_eq!(chain(first).find::<Number>().unwrap().value, 4);
            first = (&raw mut number).cast();
            drop(unlink::<Number>(&raw mut first));
            assert_eq!(chain(first).count(), 2);
            first = (&raw mut last).cast();
            assert!(unlink::<Number>(&raw mut first).is_none());
        }
    }

    #[test]
    fn a_circle_ends() {
        let mut first = Header { ty: 1, next: std::ptr::null() };
        first.next = &raw const first;
        // SAFETY: one valid structure, which names itself as the next.
        assert_eq!(unsafe { chain((&raw const first).cast()) }.count(), MAX_LENGTH);
    }
}
