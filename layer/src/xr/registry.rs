//! Live OpenXR objects of one kind, found by their handles.

use openxr_sys as xr;
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

/// A registry. No lock is held after a method returns, so that calls down are never made under one.
#[derive(Debug)]
pub struct Registry<T> {
    live: RwLock<BTreeMap<u64, Arc<T>>>,
}

impl<T> Registry<T> {
    /// An empty registry.
    pub const fn new() -> Self {
        Self { live: RwLock::new(BTreeMap::new()) }
    }

    /// Begins to track an object.
    pub fn insert<H: xr::Handle>(&self, handle: H, object: Arc<T>) {
        self.write().insert(handle.into_raw(), object);
    }

    /// The object of that handle.
    pub fn get<H: xr::Handle>(&self, handle: H) -> Option<Arc<T>> {
        self.read().get(&handle.into_raw()).cloned()
    }

    /// What `choose` makes of the first live object of which it makes anything.
    pub fn find_map<R>(&self, choose: impl Fn(&Arc<T>) -> Option<R>) -> Option<R> {
        self.read().values().find_map(choose)
    }

    /// The live objects that `belongs` holds for.
    pub fn filter<const N: usize>(&self, belongs: impl Fn(&T) -> bool) -> SmallVec<[Arc<T>; N]>
    where
        [Arc<T>; N]: smallvec::Array<Item = Arc<T>>,
    {
        self.read().values().filter(|object| belongs(object)).cloned().collect()
    }

    /// Forgets an object. Call it before the object is destroyed: its handle may be in use again after.
    pub fn remove<H: xr::Handle>(&self, handle: H) -> Option<Arc<T>> {
        self.write().remove(&handle.into_raw())
    }

    /// Forgets all objects that `belongs` holds for, such as the children of an object.
    pub fn remove_where(&self, belongs: impl Fn(&T) -> bool) -> Vec<Arc<T>> {
        let mut removed = Vec::new();
        self.write().retain(|_, object| {
            let remove = belongs(object);
            if remove {
                removed.push(Arc::clone(object));
            }
            !remove
        });
        removed
    }

    fn read(&self) -> RwLockReadGuard<'_, BTreeMap<u64, Arc<T>>> {
        self.live.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, BTreeMap<u64, Arc<T>>> {
        self.live.write().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use openxr_sys::Handle;

    #[test]
    fn children_leave_with_their_parent() {
        let registry = Registry::new();
        for (handle, parent) in [(1, 'a'), (2, 'b'), (3, 'a')] {
            registry.insert(xr::Swapchain::from_raw(handle), Arc::new(parent));
        }
        assert_eq!(registry.remove_where(|&parent| parent == 'a').len(), 2);
        assert!(registry.get(xr::Swapchain::from_raw(1)).is_none());
        assert_eq!(registry.filter::<4>(|_| true).into_vec(), [Arc::new('b')]);
    }
}
