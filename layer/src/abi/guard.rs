//! No panic of ours may reach the application: unwinding out of an `extern "system"` function aborts it.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

#[cfg(debug_assertions)]
mod injected;

/// The answer of the layer below to the call of a hook.
///
/// A hook records it, so that a panic after that neither repeats the call nor changes its result.
pub struct Answer<R> {
    result: Cell<Option<R>>,
    #[cfg(debug_assertions)]
    call: &'static str,
}

impl<R: Copy> Answer<R> {
    /// To the exported function `call`.
    fn to(call: &'static str) -> Self {
        #[cfg(not(debug_assertions))]
        let _ = call;
        Self {
            result: Cell::new(None),
            #[cfg(debug_assertions)]
            call,
        }
    }

    /// Records the answer, and returns it.
    pub fn record(&self, result: R) -> R {
        self.result.set(Some(result));
        #[cfg(debug_assertions)]
        injected::after(self.call);
        result
    }
}

impl Answer<()> {
    /// Records that the call was made.
    pub fn made(&self) {
        self.record(());
    }
}

/// Runs `hook`, the body of the exported function `call`. If it panics, its recorded answer stands; without
/// one, `pass_through` makes the call as if the hook were not there.
pub fn guard<R: Copy>(
    call: &'static str,
    pass_through: impl FnOnce() -> R,
    hook: impl FnOnce(&Answer<R>) -> R,
) -> R {
    let answer = Answer::to(call);
    let hook = |answer: &_| {
        #[cfg(debug_assertions)]
        injected::before(call);
        hook(answer)
    };
    // Unwind safety: all state that a hook may leave half done is behind a mutex or an atomic of ours. It is only state about the application's
    // objects, never memory that others own.
    match catch_unwind(AssertUnwindSafe(|| hook(&answer))) {
        Ok(result) => result,
        Err(panic) => {
            report(call, panic);
            answer.result.get().unwrap_or_else(pass_through)
        }
    }
}

/// Runs a step of the exported function `call` that has to be tried even after a panic of its hook, and whose own panic does not skip the
/// steps after it.
pub fn attempt(call: &'static str, step: impl FnOnce()) {
    // Unwind safety: as in `guard`.
    if let Err(panic) = catch_unwind(AssertUnwindSafe(step)) {
        report(call, panic);
    }
}

/// The calls that panicked: each is reported once.
static REPORTED: Mutex<Vec<&'static str>> = Mutex::new(Vec::new());

/// Logs a panic. Dropping the payload, and logging, may panic again: neither gets out.
fn report(call: &'static str, panic: Box<dyn Any + Send>) {
    let logged = catch_unwind(AssertUnwindSafe(|| {
        let mut reported = REPORTED.lock().unwrap_or_else(PoisonError::into_inner);
        if reported.contains(&call) {
            return drop(panic);
        }
        reported.push(call);
        drop(reported);
        let text = panic
            .downcast_ref::<&str>()
            .copied()
            .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("no message");
        tracing::error!(
            "internal error in {call}: {text}; the application continues without this feature; please report this with the log"
        );
        drop(panic);
    }));
    if let Err(again) = logged {
        std::mem::forget(again);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_before_the_call_down_passes_the_call_through() {
        assert_eq!(guard("test", || 7, |_| panic!("{}", 1)), 7);
    }

    #[test]
    fn a_panic_after_the_call_down_keeps_its_answer() {
        let result = guard(
            "test",
            || unreachable!("the call must not be made twice"),
            |answer| {
                answer.record(3);
                panic!("late");
            },
        );
        assert_eq!(result, 3);
    }

    #[test]
    fn a_step_that_panics_keeps_nothing_from_being_done() {
        attempt("test", || panic!("{}", 1));
        let hook = |_: &Answer<u8>| panic!("{}", 2);
        assert_eq!(guard("test", || (attempt("test", || panic!("{}", 3)), 7).1, hook), 7);
    }

    #[test]
    fn a_payload_that_panics_when_dropped_stays_inside() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("again");
            }
        }
        assert_eq!(guard("test", || 1, |_| std::panic::panic_any(Bomb)), 1);
    }
}
