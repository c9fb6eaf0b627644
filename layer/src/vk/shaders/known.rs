//! Effects of fragment shaders, by the identifiers of their modules (VK_EXT_shader_module_identifier), kept from one launch to the next.
//!
//! From its second launch on, a game of DXVK or vkd3d-proton makes pipelines by identifiers, without code. Identifiers
//! are hashes of the code, so two drivers give the same one only to the same code.

mod file;

use crate::abi::threads::spawn;
use crate::cache_file;
use crate::vk::shaders::effects::FragmentShaders;
use smallvec::SmallVec;
use std::collections::{HashMap, VecDeque};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::sleep;
use std::time::Duration;

/// An identifier, of up to 32 bytes (`VK_MAX_SHADER_MODULE_IDENTIFIER_SIZE_EXT`).
pub type Identifier = SmallVec<[u8; 32]>;

/// Most modules that are kept, the newest: the largest games have some ten thousand, with some hundred bytes each.
const MOST_MODULES: usize = 16_384;

/// Time for which new facts are collected before they are written.
const WRITTEN_AFTER: Duration = Duration::from_secs(2);

/// The facts of a process.
pub struct KnownShaders {
    /// File that they are written to; `None`: they are not written.
    file: Option<PathBuf>,
    state: Mutex<State>,
    /// Whether a later launch gets new facts, as far as is known.
    are_kept: AtomicBool,
}

#[derive(Default)]
struct State {
    facts: Facts,
    /// Whether a thread is going to write.
    is_to_be_written: bool,
}

/// Facts by identifier, the oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
struct Facts {
    by_identifier: HashMap<Identifier, Arc<FragmentShaders>>,
    order: VecDeque<Identifier>,
}

impl Facts {
    /// Adds or replaces a module's facts, and returns whether they changed. Beyond the limit, the oldest are removed.
    fn insert(&mut self, identifier: Identifier, shaders: Arc<FragmentShaders>) -> bool {
        match self.by_identifier.insert(identifier.clone(), shaders.clone()) {
            Some(before) => before != shaders,
            None => {
                self.order.push_back(identifier);
                if self.order.len() > MOST_MODULES
                    && let Some(oldest) = self.order.pop_front()
                {
                    self.by_identifier.remove(&oldest);
                }
                true
            }
        }
    }

    /// In their order.
    fn iter(&self) -> impl Iterator<Item = (&Identifier, &Arc<FragmentShaders>)> {
        self.order.iter().filter_map(|identifier| self.by_identifier.get_key_value(identifier))
    }
}

impl KnownShaders {
    /// The facts of this process, with the file's in `$XDG_CACHE_HOME/parafovea`.
    pub fn of_process() -> &'static Arc<Self> {
        static KNOWN: OnceLock<Arc<KnownShaders>> = OnceLock::new();
        KNOWN.get_or_init(|| {
            let known = Self::at(cache_file::folder().map(|folder| folder.join("shaders")));
            // Unit tests have no folder.
            known.are_kept.fetch_or(cfg!(test), Ordering::Relaxed);
            Arc::new(known)
        })
    }

    /// The facts of a file; none of a damaged or unreadable one.
    fn at(file: Option<PathBuf>) -> Self {
        let facts = file.as_deref().and_then(file::read).unwrap_or_default();
        let state = Mutex::new(State { facts, is_to_be_written: false });
        Self { are_kept: AtomicBool::new(file.is_some()), file, state }
    }

    /// Whether the code of a module is worth a request: no launch has seen it, and the next launch will know it. Else each launch would request
    /// it.
    pub fn is_worth_a_request(&self, identifier: &[u8]) -> bool {
        let are_kept = self.are_kept.load(Ordering::Relaxed);
        let facts = &self.state().facts;
        are_kept && facts.order.len() < MOST_MODULES && !facts.by_identifier.contains_key(identifier)
    }

    /// The facts of a module's shaders; `None` if no launch has seen it.
    pub fn get(&self, identifier: &[u8]) -> Option<Arc<FragmentShaders>> {
        self.state().facts.by_identifier.get(identifier).cloned()
    }

    /// Keeps the facts of a module's shaders. A thread writes them a little later.
    pub fn note(self: &Arc<Self>, identifier: &[u8], shaders: &Arc<FragmentShaders>) {
        if identifier.is_empty() || shaders.is_empty() {
            return;
        }
        let mut state = self.state();
        let is_news = state.facts.insert(identifier.into(), Arc::clone(shaders));
        if !is_news || state.is_to_be_written || self.file.is_none() {
            return;
        }
        state.is_to_be_written = true;
        drop(state);
        let known = Arc::clone(self);
        let write = move || {
            sleep(WRITTEN_AFTER);
            known.write();
        };
        if let Err(error) = spawn("parafovea-facts", write) {
            tracing::debug!("results of shader analysis could not be stored: cannot start a thread: {error}");
        }
    }

    /// Writes the known facts, merged with newer facts of other processes.
    fn write(&self) {
        let Some(path) = &self.file else { return };
        let mut facts = file::read(path).unwrap_or_default();
        let mut state = self.state();
        state.is_to_be_written = false;
        for (identifier, shaders) in state.facts.iter() {
            facts.insert(identifier.clone(), Arc::clone(shaders));
        }
        drop(state);
        if let Err(error) = file::write(path, &facts) {
            self.are_kept.store(false, Ordering::Relaxed);
            tracing::debug!("results of shader analysis could not be stored: {error}");
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests;
