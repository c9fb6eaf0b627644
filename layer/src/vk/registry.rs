//! Objects that this layer tracks, found by dispatch key.

use ash::vk::Handle;
use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

/// What identifies an instance or a device: the loader's dispatch table, whose address is the first word of
/// every dispatchable object. A physical device has its instance's key; a queue and a command buffer have
/// their device's.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct DispatchKey(usize);

impl DispatchKey {
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

/// Live objects of one kind. No lock is held after a method returns, so calls down are never made under one.
pub struct Registry<T> {
    live: RwLock<BTreeMap<DispatchKey, Arc<T>>>,
}

impl<T> Registry<T> {
    /// An empty registry.
    pub const fn new() -> Self {
        Self { live: RwLock::new(BTreeMap::new()) }
    }

    /// Begins to track an object.
    pub fn insert(&self, key: DispatchKey, object: T) {
        self.live.write().unwrap_or_else(PoisonError::into_inner).insert(key, Arc::new(object));
    }

    /// The object of that key.
    pub fn get(&self, key: DispatchKey) -> Option<Arc<T>> {
        self.live.read().unwrap_or_else(PoisonError::into_inner).get(&key).cloned()
    }

    /// Forgets an object: call it before the object is destroyed, because its key may be in use again as
    /// soon as it is.
    pub fn remove(&self, key: DispatchKey) -> Option<Arc<T>> {
        self.live.write().unwrap_or_else(PoisonError::into_inner).remove(&key)
    }
}
