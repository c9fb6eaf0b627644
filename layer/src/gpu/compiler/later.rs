//! Something that a thread makes.

use super::{Compilation, Compiler};
use crate::gpu::GpuError;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};

/// Makes something, with the compilation that its pipelines belong to.
type Make<T> = Box<dyn FnOnce(&Arc<Compilation>) -> Result<T, GpuError> + Send>;

/// A requested object, available once it is made. If this is dropped earlier, the object is not made; if it is being made, the drop waits
/// for it.
pub(crate) struct Later<T> {
    slot: Arc<Slot<T>>,
    made: OnceLock<Arc<T>>,
    /// Keeps the thread.
    _compiler: Arc<Compiler>,
}

/// State shared by the thread and its client.
pub(super) struct Slot<T> {
    state: Mutex<State<T>>,
    is_done: Condvar,
    /// The loss if it cannot be made, for the log.
    otherwise: &'static str,
}

enum State<T> {
    Asked(Make<T>),
    Making,
    Made(Arc<T>),
    /// It could not be made, or is not wanted any more.
    Never,
}

/// A task of the thread.
pub(super) trait Task: Send + Sync {
    fn run(&self, compilation: &Arc<Compilation>);
}

impl<T> Slot<T> {
    pub(super) fn new(otherwise: &'static str, make: Make<T>) -> Self {
        Self { state: Mutex::new(State::Asked(make)), is_done: Condvar::new(), otherwise }
    }

    fn state(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Send + Sync> Task for Slot<T> {
    fn run(&self, compilation: &Arc<Compilation>) {
        let make = {
            let mut state = self.state();
            match std::mem::replace(&mut *state, State::Making) {
                State::Asked(make) => make,
                other => return *state = other,
            }
        };
        // Unwind safety: half-made objects are dropped.
        let result = catch_unwind(AssertUnwindSafe(|| make(compilation)));
        let new = match result {
            Ok(Ok(made)) => State::Made(Arc::new(made)),
            Ok(Err(error)) => {
                if !compilation.has_ended() {
                    error.log(self.otherwise);
                }
                State::Never
            }
            Err(_) => {
                tracing::error!("{}: internal error while pipelines were compiled", self.otherwise);
                State::Never
            }
        };
        *self.state() = new;
        self.is_done.notify_all();
    }
}

impl<T> Later<T> {
    pub(super) fn new(slot: Arc<Slot<T>>, compiler: Arc<Compiler>) -> Self {
        Self { slot, made: OnceLock::new(), _compiler: compiler }
    }

    /// It, once it was made; `None` until then, and for good if that failed. Waits for nothing.
    pub(crate) fn get(&self) -> Option<&Arc<T>> {
        if self.made.get().is_none()
            && let State::Made(made) = &*self.slot.state()
        {
            let _ = self.made.set(Arc::clone(made));
        }
        self.made.get()
    }

    /// Whether it will never be there.
    pub(crate) fn has_failed(&self) -> bool {
        matches!(*self.slot.state(), State::Never)
    }
}

impl<T> Drop for Later<T> {
    fn drop(&mut self) {
        let mut state = self.slot.state();
        while matches!(*state, State::Making) {
            state = self.slot.is_done.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let unwanted = std::mem::replace(&mut *state, State::Never);
        drop(state);
        drop(unwanted);
    }
}
