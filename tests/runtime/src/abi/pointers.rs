//! Pointer parameters of OpenXR functions as types that can only be used checked.
//!
//! [`In`] and [`Out`] have the layout of a pointer and stand in the signatures of the exported functions. Nothing in
//! this crate makes one: they come from the application, which the specification ("Valid Usage") obliges to pass
//! NULL or a pointer to a valid object that outlives the call. NULL, misalignment and wrong `type` members are
//! checked here; a pointer to nowhere cannot be, in any runtime.

use super::structures::Structure;
use crate::fault::{Fault, section, structure_name};
use ash::vk;
use ash::vk::Handle;
use openxr_sys as xr;
use std::ops::Deref;

/// A `const T*` parameter.
#[repr(transparent)]
pub(crate) struct In<T>(*const T);

/// A `T*` parameter.
#[repr(transparent)]
pub(crate) struct Out<T>(*mut T);

/// A structure of the application that was checked: `type` is right, the chain ends and repeats nothing.
pub(crate) struct Valid<'a, T>(&'a T);

impl<T> Deref for Valid<'_, T> {
    type Target = T;
    fn deref(&self) -> &T {
        self.0
    }
}

/// More links than any chain has; a longer one is taken to have a cycle.
const MAX_LINKS: usize = 64;

impl<T: Structure> In<T> {
    /// The structure.
    pub fn get(&self) -> Result<Valid<'_, T>, Fault> {
        // SAFETY: the type's contract: NULL or valid for the call, which `self` does not outlive.
        unsafe { valid(self.0) }
    }
}

impl<T> In<T> {
    pub fn is_null(&self) -> bool {
        self.0.is_null()
    }

    /// The pointer itself, to pass on.
    pub fn raw(&self) -> *const T {
        self.0
    }

    /// Target of a pointer that is not a structure with a type.
    pub fn copied(&self, name: &str) -> Result<T, Fault>
    where
        T: Copy,
    {
        check_pointer(self.0, name)?;
        // SAFETY: the type's contract.
        Ok(unsafe { *self.0 })
    }
}

impl<'a, T: Structure> Valid<'a, T> {
    /// The structure of type `U` that extends this one.
    pub fn extension<U: Structure>(&self) -> Option<Valid<'a, U>> {
        // SAFETY: `valid` walked this chain; a structure with this `type` has the layout that belongs to it.
        unsafe { links(self.0) }
            .find(|&link| unsafe { (*link).ty } == U::TYPE)
            .map(|link| Valid(unsafe { &*link.cast() }))
    }

    /// Types of the chain that do not extend this structure: the specification has runtimes skip them.
    pub fn unexpected(&self) -> Vec<xr::StructureType> {
        // SAFETY: as above.
        let types = unsafe { links(self.0) }.map(|link| unsafe { (*link).ty });
        types.filter(|ty| !T::EXTENDED_BY.contains(ty)).collect()
    }

    /// An array that a member of this structure points to.
    pub(super) fn array<U>(&self, name: &str, count: u32, first: *const U) -> Result<&'a [U], Fault> {
        if count == 0 {
            return Ok(&[]);
        }
        check_pointer(first, name)?;
        // SAFETY: a member of a valid structure that has a count points to so many valid elements.
        Ok(unsafe { std::slice::from_raw_parts(first, count as usize) })
    }

    /// An element of an array of this structure, checked like a parameter.
    pub(super) fn element<U: Structure>(&self, element: &'a U) -> Result<Valid<'a, U>, Fault> {
        // SAFETY: a reference is valid; its chain is, as that of any structure of the application.
        unsafe { valid(element) }
    }

    /// The structures that an array of pointers of this structure points to, each known by its `type`.
    pub(super) fn base<U: Structure>(
        &self,
        base: *const xr::BaseInStructure,
    ) -> Option<Result<Valid<'a, U>, Fault>> {
        // SAFETY: a non-NULL pointer in a valid structure points to a valid structure, which begins with its type.
        (unsafe { (*base).ty } == U::TYPE).then(|| unsafe { valid(base.cast()) })
    }
}

/// # Safety
/// `first` is NULL or points to a structure that is valid for `'a`.
unsafe fn valid<'a, T: Structure>(first: *const T) -> Result<Valid<'a, T>, Fault> {
    let name = std::any::type_name::<T>().rsplit("::").next().unwrap_or_default();
    check_pointer(first, name)?;
    // SAFETY: not NULL, hence valid; every structure begins with `type` and `next`.
    let ty = unsafe { (*first.cast::<xr::BaseInStructure>()).ty };
    check_type::<T>(name, ty)?;
    // SAFETY: valid, and its type is right.
    unsafe { check_chain(name, first) }?;
    // SAFETY: as above.
    Ok(Valid(unsafe { &*first }))
}

/// The structures of a chain after the first one. Each is read only to find the next one.
///
/// # Safety
/// `first` points to a structure that is valid for as long as the iterator is used.
unsafe fn links<T: Structure>(first: *const T) -> impl Iterator<Item = *const xr::BaseInStructure> {
    let mut last = first.cast::<xr::BaseInStructure>();
    std::iter::from_fn(move || {
        // SAFETY: every structure begins with `type` and `next`; `next` is NULL or leads to another one.
        let link = unsafe { (*last).next };
        last = link;
        (!link.is_null()).then_some(link)
    })
    .fuse()
    .take(MAX_LINKS + 1)
}

fn check_pointer<T>(pointer: *const T, name: &str) -> Result<(), Fault> {
    if pointer.is_null() {
        return Err(Fault::validation(section::VALID_USAGE, format!("{name} is NULL")));
    }
    if !pointer.is_aligned() {
        return Err(Fault::validation(section::VALID_USAGE, format!("{name} is misaligned: {pointer:p}")));
    }
    Ok(())
}

fn check_type<T: Structure>(name: &str, ty: xr::StructureType) -> Result<(), Fault> {
    if ty == T::TYPE {
        return Ok(());
    }
    let (found, wanted) = (structure_name(ty), structure_name(T::TYPE));
    Err(Fault::validation(section::STRUCTURES, format!("{name}: type is {found}, not {wanted}")))
}

/// # Safety
/// As for [`links`], but a link may be misaligned.
unsafe fn check_chain<T: Structure>(name: &str, first: *const T) -> Result<(), Fault> {
    let mut seen = Vec::new();
    // SAFETY: no link after a misaligned one is asked for.
    for link in unsafe { links(first) } {
        if !link.is_aligned() {
            return Err(Fault::validation(section::CHAINS, format!("{name}: next is misaligned: {link:p}")));
        }
        // SAFETY: aligned and not NULL, hence valid.
        let ty = unsafe { (*link).ty };
        if seen.contains(&ty) {
            let ty = structure_name(ty);
            return Err(Fault::validation(section::CHAINS, format!("{name}: {ty} is in the chain twice")));
        }
        seen.push(ty);
    }
    if seen.len() > MAX_LINKS {
        return Err(Fault::validation(section::CHAINS, format!("{name}: the chain has no end")));
    }
    Ok(())
}

impl<T> Out<T> {
    /// Stores a value.
    pub fn set(&self, name: &str, value: T) -> Result<(), Fault>
    where
        T: Copy,
    {
        check_pointer(self.0, name)?;
        // SAFETY: the type's contract.
        unsafe { self.0.write(value) };
        Ok(())
    }

    /// Stores the first elements of the array behind the pointer.
    fn set_all(&self, name: &str, values: &[T]) -> Result<(), Fault>
    where
        T: Copy,
    {
        if values.is_empty() {
            return Ok(());
        }
        check_pointer(self.0, name)?;
        // SAFETY: the type's contract; callers compared the length with the capacity that came along.
        unsafe { self.0.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
        Ok(())
    }
}

impl<T: Structure> Out<T> {
    /// The structure to fill.
    pub fn get(&mut self) -> Result<&mut T, Fault> {
        // SAFETY: the type's contract: valid for the call, and the application passes it for writing.
        unsafe {
            valid(self.0.cast_const())?;
            Ok(&mut *self.0)
        }
    }

    /// The structure of type `U` that extends the one to fill.
    pub fn extension<U: Structure>(&mut self) -> Option<&mut U> {
        if self.0.is_null() {
            return None;
        }
        // SAFETY: the type's contract; the links of a chain are distinct objects.
        unsafe { links(self.0.cast_const()) }
            .find(|&link| unsafe { (*link).ty } == U::TYPE)
            .map(|link| unsafe { &mut *link.cast_mut().cast() })
    }

    /// The first `count` structures of an array to fill.
    fn get_all(&mut self, name: &str, count: usize) -> Result<&mut [T], Fault> {
        if count == 0 {
            return Ok(&mut []);
        }
        check_pointer(self.0, name)?;
        for index in 0..count {
            // SAFETY: the type's contract; the application passed the capacity, which the caller compared.
            unsafe { valid(self.0.add(index).cast_const())? };
        }
        // SAFETY: as above.
        Ok(unsafe { std::slice::from_raw_parts_mut(self.0, count) })
    }
}

impl Out<xr::EventDataBuffer> {
    /// Stores an event, which begins like the buffer.
    pub fn set_event<E: Structure>(&mut self, event: E) -> Result<(), Fault> {
        const { assert!(size_of::<E>() <= size_of::<xr::EventDataBuffer>()) };
        self.get()?;
        // SAFETY: the buffer is valid for writing, at least as large, and at least as aligned (both hold pointers).
        unsafe { self.0.cast::<E>().write(event) };
        Ok(())
    }
}

impl Out<xr::SpaceLocations> {
    /// The array of locations to fill.
    pub fn get_locations(&mut self) -> Result<&mut [xr::SpaceLocationData], Fault> {
        let filled = self.get()?;
        inner_array("locations", filled.location_count, filled.locations)
    }

    /// The array of velocities to fill, where one is asked for.
    pub fn get_velocities(&mut self) -> Result<&mut [xr::SpaceVelocityData], Fault> {
        match self.extension::<xr::SpaceVelocities>() {
            Some(filled) => inner_array("velocities", filled.velocity_count, filled.velocities),
            None => Ok(&mut []),
        }
    }
}

fn inner_array<'a, T>(name: &str, count: u32, first: *mut T) -> Result<&'a mut [T], Fault> {
    if count == 0 {
        return Ok(&mut []);
    }
    check_pointer(first, name)?;
    // SAFETY: a member of a valid structure that has a count points to so many valid elements, for writing.
    Ok(unsafe { std::slice::from_raw_parts_mut(first, count as usize) })
}

/// An array parameter of the two-call idiom: capacity, returned count, and the array.
pub(crate) struct List<T> {
    pub capacity: u32,
    pub count: Out<u32>,
    pub items: Out<T>,
}

impl<T: Copy> List<T> {
    /// Stores the count and, if a capacity is given, the items.
    pub fn fill(self, name: &str, items: &[T]) -> Result<(), Fault> {
        if self.announce(name, items.len())? { self.items.set_all(name, items) } else { Ok(()) }
    }
}

impl<T> List<T> {
    /// Whether items are to be stored.
    fn announce(&self, name: &str, count: usize) -> Result<bool, Fault> {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        self.count.set("the count", count)?;
        if self.capacity == 0 {
            return Ok(false);
        }
        if self.capacity < count {
            let message = format!("{name}: capacity {} is less than the count {count}", self.capacity);
            return Err(Fault::new(xr::Result::ERROR_SIZE_INSUFFICIENT, section::BUFFER_SIZES, message));
        }
        Ok(true)
    }
}

impl<T: Structure> List<T> {
    /// As [`List::fill`], for structures, of which `type` and `next` belong to the application.
    pub fn fill_structures<U>(
        mut self,
        name: &str,
        items: &[U],
        mut fill: impl FnMut(&mut T, &U),
    ) -> Result<(), Fault> {
        if !self.announce(name, items.len())? {
            return Ok(());
        }
        let structures = self.items.get_all(name, items.len())?;
        structures.iter_mut().zip(items).for_each(|(structure, item)| fill(structure, item));
        Ok(())
    }
}

impl List<xr::SwapchainImageVulkanKHR> {
    /// As [`List::fill_structures`], without a look at `type` and `next`.
    pub fn fill_unread(self, name: &str, images: &[vk::Image]) -> Result<(), Fault> {
        if !self.announce(name, images.len())? {
            return Ok(());
        }
        check_pointer(self.items.0, name)?;
        for (at, image) in images.iter().enumerate() {
            // SAFETY: the type's contract: room for `capacity` structures, at least as many as images.
            unsafe { (&raw mut (*self.items.0.add(at)).image).write(image.as_raw()) };
        }
        Ok(())
    }
}

/// The vertices and the indices that a visibility mask asks for.
pub(crate) fn mask_lists(mask: &mut xr::VisibilityMaskKHR) -> (List<xr::Vector2f>, List<u32>) {
    let vertices = List {
        capacity: mask.vertex_capacity_input,
        count: Out(&mut mask.vertex_count_output),
        items: Out(mask.vertices),
    };
    let indices = List {
        capacity: mask.index_capacity_input,
        count: Out(&mut mask.index_count_output),
        items: Out(mask.indices),
    };
    (vertices, indices)
}
