//! The chains of structures that the application passes.

use ash::vk;
use std::ffi::c_void;

/// The structure of a type in a chain.
///
/// # Safety
///
/// `at` is a valid chain, which lives for `'a`.
pub(super) unsafe fn find<'a, T: vk::TaggedStructure>(at: *const c_void) -> Option<&'a T> {
    let mut at: *const vk::BaseInStructure<'_> = at.cast();
    while !at.is_null() {
        // SAFETY: the caller vouches for the chain; the type identifies the structure.
        unsafe {
            if (*at).s_type == T::STRUCTURE_TYPE {
                return Some(&*at.cast());
            }
            at = (*at).p_next;
        }
    }
    None
}

/// Number of structures of a type in a chain.
///
/// # Safety
///
/// `at` is a valid chain.
pub(super) unsafe fn count(at: *const c_void, s_type: vk::StructureType) -> usize {
    let mut at: *const vk::BaseInStructure<'_> = at.cast();
    let mut found = 0;
    while !at.is_null() {
        // SAFETY: the caller vouches for the chain.
        unsafe {
            found += usize::from((*at).s_type == s_type);
            at = (*at).p_next;
        }
    }
    found
}

/// Structures that are left out of chains until this is dropped.
///
/// Chains are the application's memory, which is written for the time of one call. It could be in a constant;
/// the programs that this layer is for keep none there.
pub(super) struct LeftOut(Vec<(*mut vk::BaseOutStructure<'static>, *mut vk::BaseOutStructure<'static>)>);

impl LeftOut {
    pub fn new() -> Self {
        Self(Vec::new())
    }

    /// Leaves out all structures of a type behind `first`.
    ///
    /// # Safety
    ///
    /// `first` is a valid structure with a chain, no other code uses them, and they live longer than this.
    pub unsafe fn leave_out<T>(&mut self, first: *mut T, s_type: vk::StructureType) {
        let mut at: *mut vk::BaseOutStructure<'static> = first.cast();
        // SAFETY: the caller vouches for the chain, and that it lives until it is put back.
        unsafe {
            while !(*at).p_next.is_null() {
                let next = (*at).p_next;
                if (*next).s_type == s_type {
                    self.0.push((at, next));
                    (*at).p_next = (*next).p_next;
                } else {
                    at = next;
                }
            }
        }
    }
}

impl Drop for LeftOut {
    fn drop(&mut self) {
        for (before, structure) in self.0.drain(..).rev() {
            // SAFETY: `leave_out` was promised that both still live.
            unsafe { (*before).p_next = structure };
        }
    }
}

/// # Safety
///
/// `first` points to that many valid structures, or there are none.
pub(super) unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    if count == 0 || first.is_null() {
        return &[];
    }
    // SAFETY: the caller vouches for it.
    unsafe { std::slice::from_raw_parts(first, count as usize) }
}
