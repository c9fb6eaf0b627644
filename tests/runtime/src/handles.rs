//! Handles are numbers of a table, never pointers: a stale or foreign one is an error, not a crash.

use crate::fault::{Fault, section};
use openxr_sys as xr;
use std::collections::BTreeMap;
use std::marker::PhantomData;

/// Gives every object of the process a number of its own, so that a handle of one kind is never a valid handle of
/// another kind, and a destroyed one never becomes valid again.
#[derive(Debug, Default)]
pub(crate) struct Serial(u64);

impl Serial {
    fn next(&mut self) -> u64 {
        self.0 += 1;
        self.0
    }
}

/// The living objects of one kind.
#[derive(Debug)]
pub(crate) struct Table<H, T> {
    /// The handle's type in the headers.
    kind: &'static str,
    objects: BTreeMap<u64, T>,
    handle: PhantomData<H>,
}

impl<H: xr::Handle, T> Table<H, T> {
    pub const fn new(kind: &'static str) -> Self {
        Self { kind, objects: BTreeMap::new(), handle: PhantomData }
    }

    pub fn insert(&mut self, serial: &mut Serial, object: T) -> H {
        let raw = serial.next();
        self.objects.insert(raw, object);
        H::from_raw(raw)
    }

    pub fn get(&self, handle: H) -> Result<&T, Fault> {
        self.objects.get(&handle.into_raw()).ok_or_else(|| invalid(self.kind, handle))
    }

    pub fn get_mut(&mut self, handle: H) -> Result<&mut T, Fault> {
        self.objects.get_mut(&handle.into_raw()).ok_or_else(|| invalid(self.kind, handle))
    }

    pub fn remove(&mut self, handle: H) -> Result<T, Fault> {
        self.objects.remove(&handle.into_raw()).ok_or_else(|| invalid(self.kind, handle))
    }

    pub fn retain(&mut self, keep: impl Fn(&T) -> bool) {
        self.objects.retain(|_, object| keep(object));
    }

    pub fn iter(&self) -> impl Iterator<Item = (H, &T)> {
        self.objects.iter().map(|(raw, object)| (H::from_raw(*raw), object))
    }
}

fn invalid(kind: &str, handle: impl xr::Handle) -> Fault {
    let message = match handle.into_raw() {
        0 => format!("{kind} is XR_NULL_HANDLE"),
        raw => format!("{raw:#x} is no living {kind}"),
    };
    Fault::new(xr::Result::ERROR_HANDLE_INVALID, section::HANDLES, message)
}
