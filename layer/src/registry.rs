//! Live objects of one kind, found by their identifiers: OpenXR handles, Vulkan dispatch keys.

use smallvec::SmallVec;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

/// A registry; a list, because there are few objects of a kind at a time. No lock is held after a method returns,
/// so that calls down are never made under one.
#[derive(Debug)]
pub struct Registry<K, T> {
    live: RwLock<Vec<(K, Arc<T>)>>,
}

impl<K: PartialEq, T> Registry<K, T> {
    /// An empty registry.
    pub const fn new() -> Self {
        Self { live: RwLock::new(Vec::new()) }
    }

    /// Begins to track an object, in place of one of the same key.
    pub fn insert(&self, key: K, object: Arc<T>) {
        let mut live = self.write();
        live.retain(|(known, _)| *known != key);
        live.push((key, object));
    }

    /// The object of that key: one that is tracked already, or else `object`, which is from then on.
    pub fn get_or_insert(&self, key: K, object: Arc<T>) -> Arc<T> {
        let mut live = self.write();
        if let Some((_, known)) = live.iter().find(|(known, _)| *known == key) {
            return Arc::clone(known);
        }
        live.push((key, Arc::clone(&object)));
        object
    }

    /// The object of that key.
    pub fn get(&self, key: K) -> Option<Arc<T>> {
        self.read().iter().find(|(known, _)| *known == key).map(|(_, object)| Arc::clone(object))
    }

    /// The value of `choose` for the first live object with one.
    pub fn find_map<R>(&self, choose: impl Fn(&Arc<T>) -> Option<R>) -> Option<R> {
        self.read().iter().find_map(|(_, object)| choose(object))
    }

    /// The live objects that `belongs` holds for.
    pub fn filter<const N: usize>(&self, belongs: impl Fn(&T) -> bool) -> SmallVec<[Arc<T>; N]>
    where
        [Arc<T>; N]: smallvec::Array<Item = Arc<T>>,
    {
        self.read().iter().map(|(_, object)| object).filter(|object| belongs(object)).cloned().collect()
    }

    /// Forgets an object. Call it before the object is destroyed: its key may be in use again after.
    pub fn remove(&self, key: K) -> Option<Arc<T>> {
        let mut live = self.write();
        let index = live.iter().position(|(known, _)| *known == key)?;
        Some(live.swap_remove(index).1)
    }

    /// Forgets all objects that `belongs` holds for, such as the children of an object.
    pub fn remove_where(&self, belongs: impl Fn(&T) -> bool) -> Vec<Arc<T>> {
        let mut removed = Vec::new();
        self.write().retain(|(_, object)| {
            let remove = belongs(object);
            if remove {
                removed.push(Arc::clone(object));
            }
            !remove
        });
        removed
    }

    fn read(&self) -> RwLockReadGuard<'_, Vec<(K, Arc<T>)>> {
        self.live.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Vec<(K, Arc<T>)>> {
        self.live.write().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_in_use_again_is_the_new_object() {
        let registry = Registry::new();
        registry.insert(7, Arc::new('a'));
        registry.insert(7, Arc::new('b'));
        assert_eq!(*registry.get_or_insert(7, Arc::new('c')), 'b');
        assert_eq!(registry.remove(7), Some(Arc::new('b')));
        assert_eq!(registry.get(7), None);
    }

    #[test]
    fn children_leave_with_their_parent() {
        let registry = Registry::new();
        for (handle, parent) in [(1, 'a'), (2, 'b'), (3, 'a')] {
            registry.insert(handle, Arc::new(parent));
        }
        assert_eq!(registry.remove_where(|&parent| parent == 'a').len(), 2);
        assert!(registry.get(1).is_none());
        assert_eq!(registry.filter::<4>(|_| true).into_vec(), [Arc::new('b')]);
    }
}
