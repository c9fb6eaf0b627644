//! A plan that a thread of the OpenXR half makes while the application records.

use crate::link::AwaitedPlan;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// The plan of the current frame, until a thread needed it.
#[derive(Default)]
pub struct Awaited {
    plan: Mutex<Record>,
    /// Whether there is one, to be looked at without the lock.
    is_set: AtomicBool,
}

struct Record(AwaitedPlan);

// SAFETY: the other half takes the call of `finish` with its context from any thread (link/records.rs).
unsafe impl Send for Record {}

impl Awaited {
    /// Takes the plan of a frame, or, without a function, withdraws the last one: after that no thread is in a call of it.
    pub fn set(&self, plan: &AwaitedPlan) {
        let mut kept = self.plan.lock().unwrap_or_else(PoisonError::into_inner);
        *kept = Record(*plan);
        self.is_set.store(plan.finish.is_some(), Ordering::Release);
    }

    /// Returns when the plan of the frame is ready. The caller holds no lock of a frame: the plan arrives within the call.
    pub fn finish(&self) {
        if !self.is_set.load(Ordering::Acquire) {
            return;
        }
        // Held within the call: a plan that is withdrawn waits for it.
        let kept = self.plan.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some(finish), true) = (kept.0.finish, self.is_set.load(Ordering::Acquire)) {
            // SAFETY: the other half keeps the context until it has withdrawn the function.
            unsafe { finish(kept.0.context) };
            self.is_set.store(false, Ordering::Release);
        }
    }
}

impl Default for Record {
    fn default() -> Self {
        Self(AwaitedPlan { finish: None, context: ptr::null() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::c_void;
    use std::sync::atomic::AtomicU32;

    /// # Safety
    ///
    /// The context is a live counter.
    unsafe extern "C" fn count(calls: *const c_void) {
        // SAFETY: the test's own counter.
        let calls = unsafe { &*calls.cast::<AtomicU32>() };
        calls.fetch_add(1, Ordering::Relaxed);
    }

    #[test]
    fn a_plan_is_awaited_once_and_not_after_it_was_withdrawn() {
        let calls = AtomicU32::new(0);
        let plan = AwaitedPlan { finish: Some(count), context: (&raw const calls).cast() };
        let awaited = Awaited::default();
        let called = || {
            awaited.finish();
            awaited.finish();
            calls.load(Ordering::Relaxed)
        };
        assert_eq!(called(), 0, "without a plan");
        awaited.set(&plan);
        assert_eq!(called(), 1);
        awaited.set(&plan);
        assert_eq!(called(), 2, "the next frame's");
        awaited.set(&plan);
        awaited.set(&AwaitedPlan { finish: None, context: ptr::null() });
        assert_eq!(called(), 2, "withdrawn");
    }
}
