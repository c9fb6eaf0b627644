//! Live objects of the application, of one kind, found by their handle.

use dashmap::DashMap;
use rustc_hash::FxBuildHasher;
use std::hash::Hash;

/// A map that many threads use at once: it is split into parts that are locked apart, and no lock is held after a method
/// returns, so that calls down are never made under one. Values are cheap to clone.
pub struct Table<K, V>(DashMap<K, V, FxBuildHasher>);

impl<K: Eq + Hash + Copy, V: Clone> Table<K, V> {
    /// Begins to keep an object, in place of one of the same handle.
    pub fn insert(&self, key: K, value: V) {
        self.0.insert(key, value);
    }

    /// The kept value of an object.
    pub fn get(&self, key: K) -> Option<V> {
        self.0.get(&key).map(|found| found.value().clone())
    }

    /// Whether an object is kept.
    pub fn has(&self, key: K) -> bool {
        self.0.contains_key(&key)
    }

    /// Whether an object is kept that `holds` is true for.
    pub fn is(&self, key: K, holds: impl FnOnce(&V) -> bool) -> bool {
        self.0.get(&key).is_some_and(|found| holds(found.value()))
    }

    /// Changes the kept value of an object, if there is one.
    pub fn change(&self, key: K, change: impl FnOnce(&mut V)) {
        if let Some(mut found) = self.0.get_mut(&key) {
            change(found.value_mut());
        }
    }

    /// The kept value of an object; `new`, from now on, if there was none.
    pub fn get_or_insert(&self, key: K, new: V) -> V {
        self.0.entry(key).or_insert_with(|| new.clone()).value().clone()
    }

    /// The kept values of all objects.
    pub fn all(&self) -> Vec<V> {
        self.0.iter().map(|found| found.value().clone()).collect()
    }

    /// Forgets an object.
    pub fn remove(&self, key: K) -> Option<V> {
        self.0.remove(&key).map(|(_, value)| value)
    }

    /// Forgets the objects that `belongs` holds for, and returns them, so that none is dropped under a lock.
    pub fn remove_where(&self, belongs: impl Fn(&K, &V) -> bool) -> Vec<(K, V)> {
        let mut removed = Vec::new();
        self.0.retain(|key, value| {
            let remove = belongs(key, value);
            if remove {
                removed.push((*key, value.clone()));
            }
            !remove
        });
        removed
    }
}

impl<K: Eq + Hash, V> Default for Table<K, V> {
    fn default() -> Self {
        Self(DashMap::with_hasher(FxBuildHasher))
    }
}
