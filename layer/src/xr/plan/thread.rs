//! The thread that plans a session's frames while the application records them. A task that the thread has not begun is done by the first
//! thread that needs the plan, so that a busy machine loses nothing: the plan is that of the frame in every case.

use super::work::{FrameTask, PlanWork};
use crate::abi::cores::{Cores, current_core};
use crate::abi::threads::spawn;
use crate::abi::{guard, time_slice};
use crate::link::{AwaitedPlan, FrameStart};
use std::ffi::c_void;
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::JoinHandle;

/// The thread of one session, from the first task on until the session ends.
pub struct PlanThread {
    shared: Arc<SharedPlan>,
    thread: Mutex<Thread>,
}

enum Thread {
    NotBegun,
    Runs(JoinHandle<()>),
    Ended,
}

/// The newest task, and the state of its session.
pub struct SharedPlan {
    stage: Mutex<Stage>,
    changed: Condvar,
    /// The core of the thread that handed over the newest task, which draws meanwhile; [`NO_CORE`] where it is not known.
    drawing_core: AtomicU32,
    /// The core on which the session's thread ran last; [`NO_CORE`] while there is none, or it is not known.
    planning_core: AtomicU32,
    /// Cores of the session's thread.
    cores: OnceLock<Cores>,
    work: PlanWork,
}

/// A number that no core has.
const NO_CORE: u32 = u32::MAX;

/// Progress of the newest task.
#[derive(Default)]
enum Stage {
    /// No task, or a finished one.
    #[default]
    Idle,
    /// The first thread that needs its plan makes it.
    Due(FrameTask),
    /// A thread makes its plan.
    UnderWay,
    /// A thread of the application made its plan; its tiles may still be sorted.
    Planned(FrameTask),
    /// Its plan is made, and the session's thread sorts its tiles.
    Sorting,
    /// The session ends.
    Ended,
}

impl PlanThread {
    /// Without a task.
    pub fn new(work: PlanWork) -> Self {
        let shared = SharedPlan {
            stage: Mutex::default(),
            changed: Condvar::new(),
            drawing_core: AtomicU32::new(NO_CORE),
            planning_core: AtomicU32::new(NO_CORE),
            cores: OnceLock::new(),
            work,
        };
        Self { shared: Arc::new(shared), thread: Mutex::new(Thread::NotBegun) }
    }

    /// The state of plans, after the plan that is due or in progress was made.
    pub fn work(&self) -> &PlanWork {
        self.shared.finish();
        &self.shared.work
    }

    /// The same, while a plan may be due or in progress.
    pub fn work_in_progress(&self) -> &PlanWork {
        &self.shared.work
    }

    /// Hands a task to the thread, after the last plan was made. Without a thread, plans the frame at once.
    pub fn begin(&self, task: FrameTask) {
        self.shared.finish();
        if !self.runs() {
            self.shared.work.plan(&task);
            return;
        }
        self.shared.draws_on(current_core().unwrap_or(NO_CORE));
        let is_planned = task.inputs.is_none();
        *self.shared.lock() = if is_planned { Stage::Planned(task) } else { Stage::Due(task) };
        if !is_planned {
            let awaited = AwaitedPlan { finish: Some(finish), context: Arc::as_ptr(&self.shared).cast() };
            self.announce(&awaited);
        }
        self.shared.changed.notify_all();
    }

    /// Waits until the tiles of the newest task are sorted; leaves them where that has not begun.
    pub fn finish_sorting(&self) {
        self.shared.finish();
        let mut stage = self.shared.lock();
        while matches!(*stage, Stage::Sorting) {
            stage = self.shared.wait(stage);
        }
        if matches!(*stage, Stage::Planned(_)) {
            *stage = Stage::Idle;
        }
    }

    /// Ends the thread. The Vulkan half makes no calls into it afterwards, and further tasks are done at once.
    pub fn end(&self) {
        let mut thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        if let Thread::Runs(handle) = std::mem::replace(&mut *thread, Thread::Ended) {
            self.announce(&AwaitedPlan { finish: None, context: ptr::null() });
            self.shared.finish();
            *self.shared.lock() = Stage::Ended;
            self.shared.changed.notify_all();
            // The panic is already logged.
            _ = handle.join();
        }
    }

    fn announce(&self, awaited: &AwaitedPlan) {
        let start = FrameStart { settings: ptr::null(), plan: ptr::null(), awaited };
        // SAFETY: the record is valid. Its context lives until `end` has withdrawn it: the session's end and `drop` both call that.
        unsafe { self.shared.work.device().begin_frame(&start) };
    }

    fn runs(&self) -> bool {
        let mut thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(*thread, Thread::NotBegun) {
            let shared = Arc::clone(&self.shared);
            let begun = spawn("parafovea-plan", move || shared.run());
            *thread = begun.map_or(Thread::Ended, Thread::Runs);
        }
        matches!(*thread, Thread::Runs(_))
    }
}

impl Drop for PlanThread {
    fn drop(&mut self) {
        self.end();
    }
}

/// Finishes the plan of a session: [`AwaitedPlan::finish`].
///
/// # Safety
///
/// The context is that of the announced [`AwaitedPlan`], which is not withdrawn yet.
unsafe extern "C" fn finish(context: *const c_void) {
    guard(
        "the plan that a submit awaits",
        || (),
        |_| {
            // SAFETY: `PlanThread::begin` announced the context, which lives until it is withdrawn; the Vulkan half makes no callbacks after that.
            if let Some(shared) = unsafe { context.cast::<SharedPlan>().as_ref() } {
                shared.finish();
            }
        },
    );
}

impl SharedPlan {
    fn lock(&self) -> MutexGuard<'_, Stage> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns when no plan is due or in progress: makes the one that is due, or waits for the one that is in progress.
    fn finish(&self) {
        let mut stage = self.lock();
        loop {
            match std::mem::replace(&mut *stage, Stage::UnderWay) {
                Stage::Due(task) => {
                    drop(stage);
                    self.work.plan(&task);
                    *self.lock() = if task.expected.is_empty() { Stage::Idle } else { Stage::Planned(task) };
                    self.changed.notify_all();
                    return;
                }
                Stage::UnderWay => stage = self.wait(stage),
                other => {
                    *stage = other;
                    return;
                }
            }
        }
    }

    fn wait<'a>(&self, stage: MutexGuard<'a, Stage>) -> MutexGuard<'a, Stage> {
        self.changed.wait(stage).unwrap_or_else(PoisonError::into_inner)
    }

    /// The application's thread draws on that core until the next task. If the system has moved it to the core of the session's thread, that
    /// thread moves before it wakes up: it may have no other core, and would wait until the application's thread pauses.
    fn draws_on(&self, core: u32) {
        self.drawing_core.store(core, Ordering::Relaxed);
        if core != NO_CORE
            && core == self.planning_core.load(Ordering::Relaxed)
            && let Some(cores) = self.cores.get()
        {
            cores.keep_off(core);
        }
    }

    /// Does tasks until the end, on another core than the application's thread.
    fn run(&self) {
        let cores = self.cores.get_or_init(Cores::of_this_thread);
        let _ended = Ended(&self.planning_core);
        // The application needs the plan soon, and works meanwhile on what may be all cores. Without success the thread waits as any other.
        _ = time_slice::shorten();
        let mut stage = self.lock();
        loop {
            let task = match std::mem::replace(&mut *stage, Stage::UnderWay) {
                Stage::Due(task) => {
                    drop(stage);
                    self.work.plan(&task);
                    stage = self.lock();
                    task
                }
                Stage::Planned(task) => task,
                Stage::Ended => {
                    *stage = Stage::Ended;
                    return;
                }
                other => {
                    *stage = other;
                    self.planning_core.store(current_core().unwrap_or(NO_CORE), Ordering::Relaxed);
                    drop(self.wait(stage));
                    // Before it takes the task, so that the application's thread need not wait for the move.
                    cores.leave(self.drawing_core.load(Ordering::Relaxed));
                    stage = self.lock();
                    continue;
                }
            };
            *stage = if task.expected.is_empty() { Stage::Idle } else { Stage::Sorting };
            drop(stage);
            self.changed.notify_all();
            self.work.sort(&task);
            stage = self.lock();
            if matches!(*stage, Stage::Sorting) {
                *stage = Stage::Idle;
                self.changed.notify_all();
            }
        }
    }
}

/// The end of a session's thread, by a panic, too. The system may give its number to another thread.
struct Ended<'a>(&'a AtomicU32);

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.0.store(NO_CORE, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests;
