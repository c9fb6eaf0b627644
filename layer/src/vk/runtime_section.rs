//! Whether this thread is inside a call to the OpenXR runtime, or in our own work.
//!
//! A runtime may submit to the application's queue on the application's device (for compositing, or to hand
//! images over). Such submits come through the Vulkan layers like the application's own.

use std::cell::Cell;

thread_local! {
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// Enters (`true`) or leaves a section of this thread. Sections nest; leaving without having entered is
/// ignored.
pub fn set(enter: bool) {
    // A thread that is being torn down has no depth any more; its submits need no classification.
    let _ = DEPTH.try_with(|depth| {
        depth.set(if enter { depth.get().saturating_add(1) } else { depth.get().saturating_sub(1) });
    });
}

/// Whether submits of this thread are now the runtime's or ours, not the application's.
pub fn in_runtime_section() -> bool {
    DEPTH.try_with(|depth| depth.get() > 0).unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_nest_and_belong_to_one_thread() {
        assert!(!in_runtime_section());
        set(true);
        set(true);
        set(false);
        assert!(in_runtime_section(), "left one of two");
        assert!(!std::thread::spawn(in_runtime_section).join().unwrap(), "another thread");
        set(false);
        assert!(!in_runtime_section());
        set(false);
        set(true);
        assert!(in_runtime_section(), "a stray leave does not cancel a later enter");
        set(false);
    }
}
