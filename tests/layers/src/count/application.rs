//! Whether this thread is in a call of the application's that begins a render pass. Both counting layers are in one
//! library, so the lower one sees the note of the upper one.

use std::cell::Cell;

thread_local! {
    static BEGINS_PASS: Cell<bool> = const { Cell::new(false) };
}

/// Passes a call of the application's on.
pub(super) fn begins_pass(call: impl FnOnce()) {
    BEGINS_PASS.set(true);
    call();
    BEGINS_PASS.set(false);
}

/// Whether such a call is being passed on.
pub(super) fn is_beginning_pass() -> bool {
    BEGINS_PASS.get()
}
