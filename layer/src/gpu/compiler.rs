//! Compiles the layer's pipelines on a thread: no frame of the application waits for a compiler. Until its pipelines are ready, a
//! technique does nothing.
//!
//! A device has one thread for both halves, as long as there is something to make, and one pipeline cache, whose data is kept on
//! disk from one launch to the next.

mod compilation;
mod file;
mod later;

pub(crate) use compilation::Compilation;
pub(crate) use later::Later;

use super::GpuError;
use crate::abi::threads::spawn;
use crate::link::DeviceRecord;
use ash::vk;
use later::{Slot, Task};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use std::thread::{JoinHandle, current, sleep};
use std::time::{Duration, Instant};

/// The compiler of one device.
pub(crate) struct Compiler {
    work: Arc<Work>,
    /// Whether each thing is made by the thread that asks for it.
    is_at_once: bool,
}

/// The work of the thread.
struct Work {
    record: DeviceRecord,
    compilation: Arc<Compilation>,
    queue: Mutex<Queue>,
}

#[derive(Default)]
struct Queue {
    asked: VecDeque<Arc<dyn Task>>,
    /// The last thread that was begun.
    thread: Option<JoinHandle<()>>,
    /// Whether it will look into `asked` again.
    is_working: bool,
}

/// The compilers of live devices.
static COMPILERS: Mutex<Vec<(vk::Device, Weak<Compiler>)>> = Mutex::new(Vec::new());

impl Compiler {
    /// The compiler of a device.
    ///
    /// # Safety
    /// The record is of a live device. Before it is destroyed, [`Self::end`] is called, or all that was asked for is dropped and
    /// the result is, too.
    pub(crate) unsafe fn of(record: &DeviceRecord) -> Arc<Self> {
        let mut compilers = compilers();
        compilers.retain(|(_, compiler)| compiler.strong_count() > 0);
        let known = compilers.iter().find(|(device, _)| *device == record.device);
        if let Some(known) = known.and_then(|(_, compiler)| compiler.upgrade()) {
            return known;
        }
        let new = Arc::new(Self::new(record, at_once_is_asked()));
        compilers.push((record.device, Arc::downgrade(&new)));
        new
    }

    /// A compiler that makes each thing on the thread that asks for it, without a cache.
    ///
    /// # Safety
    /// As for [`Self::of`].
    pub(crate) unsafe fn at_once(record: &DeviceRecord) -> Arc<Self> {
        Arc::new(Self::new(record, true))
    }

    fn new(record: &DeviceRecord, is_at_once: bool) -> Self {
        let (compilation, queue) = (Arc::default(), Mutex::default());
        Self { work: Arc::new(Work { record: *record, compilation, queue }), is_at_once }
    }

    /// Requests an object. If it cannot be made, the log states `otherwise`.
    ///
    /// Objects that `make` owns live until the requested one is made or not wanted any more, at the latest until the result is dropped.
    pub(crate) fn ask<T: Send + Sync + 'static>(
        self: &Arc<Self>,
        otherwise: &'static str,
        make: impl FnOnce(&Arc<Compilation>) -> Result<T, GpuError> + Send + 'static,
    ) -> Later<T> {
        let slot = Arc::new(Slot::new(otherwise, Box::new(make)));
        if self.is_at_once {
            slot.run(&self.work.compilation);
        } else {
            self.add(Arc::clone(&slot) as Arc<dyn Task>);
        }
        Later::new(slot, Arc::clone(self))
    }

    fn add(&self, task: Arc<dyn Task>) {
        let mut queue = self.work.queue();
        if self.work.compilation.has_ended() {
            return;
        }
        queue.asked.push_back(task);
        if !queue.is_working {
            at_exit();
            let work = Arc::clone(&self.work);
            match spawn("parafovea-compile", move || work.run()) {
                Ok(thread) => (queue.thread, queue.is_working) = (Some(thread), true),
                Err(error) => tracing::warn!(
                    "all techniques that need pipelines of the layer are off: cannot start a thread: {error}"
                ),
            }
        }
    }

    /// Notes that the device is about to be destroyed: nothing more is made, and the thread has ended after this.
    pub(crate) fn end(&self) {
        // The object that the thread made may have had the last reference to the compiler.
        if let Some(thread) = self.stop().filter(|thread| thread.thread().id() != current().id()) {
            // Panics were caught.
            let _ = thread.join();
        }
        self.work.compilation.close();
        compilers().retain(|(_, compiler)| !std::ptr::eq(compiler.as_ptr(), self));
    }

    /// Has nothing more made, and returns the thread, which ends after at most one pipeline.
    fn stop(&self) -> Option<JoinHandle<()>> {
        let (asked, thread) = {
            let mut queue = self.work.queue();
            self.work.compilation.end();
            (std::mem::take(&mut queue.asked), queue.thread.take())
        };
        drop(asked);
        thread
    }

    /// Ends the compiler of a device that is about to be destroyed, if it has one.
    pub(crate) fn end_on(device: vk::Device) {
        let known = compilers().iter().find(|(of, _)| *of == device).and_then(|(_, known)| known.upgrade());
        if let Some(known) = known {
            known.end();
        }
    }
}

impl Drop for Compiler {
    fn drop(&mut self) {
        self.end();
    }
}

impl Work {
    /// Makes the requested objects until none is left.
    fn run(&self) {
        // SAFETY: `of`'s caller vouched for the record until `end`, which waits for this thread and closes the cache.
        unsafe { self.compilation.open(&self.record) };
        loop {
            while let Some(task) = self.next() {
                task.run(&self.compilation);
            }
            self.compilation.save();
            let mut queue = self.queue();
            if queue.asked.is_empty() {
                queue.is_working = false;
                return;
            }
        }
    }

    fn next(&self) -> Option<Arc<dyn Task>> {
        self.queue().asked.pop_front()
    }

    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn compilers() -> MutexGuard<'static, Vec<(vk::Device, Weak<Compiler>)>> {
    COMPILERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Longest wait of a process's exit for a pipeline that is being compiled.
const LONGEST_EXIT: Duration = Duration::from_secs(2);

/// Has the threads end when the process exits, before the drivers' own objects go, which were made earlier.
fn at_exit() {
    static PROCESS: OnceLock<u32> = OnceLock::new();
    extern "C" fn end() {
        // A forked process has no threads of ours.
        if PROCESS.get() != Some(&std::process::id()) {
            return;
        }
        let all: Vec<_> = compilers().iter().filter_map(|(_, compiler)| compiler.upgrade()).collect();
        let threads: Vec<_> = all.iter().filter_map(|compiler| compiler.stop()).collect();
        // The device is the application's: nothing is destroyed.
        std::mem::forget(all);
        let begun = Instant::now();
        while !threads.iter().all(JoinHandle::is_finished) && begun.elapsed() < LONGEST_EXIT {
            sleep(Duration::from_millis(1));
        }
    }
    PROCESS.get_or_init(|| {
        // SAFETY: the function does not unwind, and is never unloaded (`-z nodelete`).
        unsafe { libc::atexit(end) };
        std::process::id()
    });
}

/// Whether a test wants each effect from the first frame on. For tests, in builds with debug assertions alone.
fn at_once_is_asked() -> bool {
    cfg!(debug_assertions) && std::env::var_os("PARAFOVEA_COMPILE_AT_ONCE").is_some()
}

#[cfg(test)]
mod tests;
