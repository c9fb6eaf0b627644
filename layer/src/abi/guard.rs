//! No panic of ours may reach the application: unwinding out of an `extern "system"` function aborts it.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What the layer below answered to the call that a hook stands in.
///
/// A hook records it, so that a panic after that neither repeats the call nor changes its result.
pub struct Answer<R>(Cell<Option<R>>);

impl<R: Copy> Answer<R> {
    /// Records the answer, and returns it.
    pub fn record(&self, result: R) -> R {
        self.0.set(Some(result));
        result
    }
}

/// Runs `hook`, the body of the exported function `call`. If it panics, its recorded answer stands; without
/// one, `pass_through` makes the call as if the hook were not there.
pub fn guard<R: Copy>(
    call: &'static str,
    pass_through: impl FnOnce() -> R,
    hook: impl FnOnce(&Answer<R>) -> R,
) -> R {
    let answer = Answer(Cell::new(None));
    // Unwind safety: whatever a hook may leave half done is behind a mutex or an atomic of ours, and is only
    // state about the application's objects, never memory that others own.
    match catch_unwind(AssertUnwindSafe(|| hook(&answer))) {
        Ok(result) => result,
        Err(panic) => {
            report(call, panic);
            answer.0.get().unwrap_or_else(pass_through)
        }
    }
}

/// Logs a panic. Dropping the payload, and logging, may panic again: neither gets out.
fn report(call: &'static str, panic: Box<dyn Any + Send>) {
    let logged = catch_unwind(AssertUnwindSafe(|| {
        let text = panic
            .downcast_ref::<&str>()
            .copied()
            .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("no message");
        tracing::error!("internal error in {call}: {text}");
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
