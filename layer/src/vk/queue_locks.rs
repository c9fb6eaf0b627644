//! One submit at a time on each queue.
//!
//! Vulkan demands this order of applications. OpenXR calls submit to the session's queue, too, with this layer more often, and some applications
//! submit on other threads meanwhile: uploads of StereoKit, and transfers of Godot on devices with one queue.

use super::table::Table;
use ash::vk;
use std::cell::Cell;
use std::sync::{Arc, Mutex, PoisonError};

thread_local! {
    /// Whether this thread holds the lock of a queue.
    static HOLDS: Cell<bool> = const { Cell::new(false) };
}

/// The locks of a device's queues. Nothing else is locked under one, and nothing is waited for.
#[derive(Default)]
pub struct QueueLocks(Table<vk::Queue, Arc<Mutex<()>>>);

impl QueueLocks {
    /// Makes a call down that submits to a queue, under its lock; allocates for the first one alone. A call within another one, by a layer
    /// below that begins at the top, is made under the lock of the outer one.
    pub fn with<T>(&self, queue: vk::Queue, call: impl FnOnce() -> T) -> T {
        let Some(_held) = Held::begin() else { return call() };
        let lock = self.0.get(queue).unwrap_or_else(|| self.0.get_or_insert(queue, Arc::default()));
        let _lock = lock.lock().unwrap_or_else(PoisonError::into_inner);
        call()
    }
}

/// The time in which this thread holds the lock of a queue.
struct Held;

impl Held {
    /// `None` if it holds one already.
    fn begin() -> Option<Self> {
        // A thread that is being torn down has no such state, and makes its call without the lock.
        let held = HOLDS.try_with(|holds| holds.replace(true)).unwrap_or(true);
        (!held).then_some(Self)
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let _ = HOLDS.try_with(|holds| holds.set(false));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    fn queue(handle: u64) -> vk::Queue {
        vk::Queue::from_raw(handle)
    }

    #[test]
    fn calls_within_a_call_are_made_at_once() {
        let locks = QueueLocks::default();
        let within = |inner| locks.with(queue(1), || locks.with(queue(inner), || inner));
        assert_eq!([within(1), within(2)], [1, 2]);
        assert_eq!(locks.0.all().len(), 1, "the lock of the outer call");
    }

    #[test]
    fn queues_do_not_wait_for_each_other() {
        let locks = Arc::new(QueueLocks::default());
        let (sender, receiver) = channel();
        locks.with(queue(1), || {
            let others = Arc::clone(&locks);
            std::thread::spawn(move || others.with(queue(2), || sender.send(())));
            receiver.recv_timeout(Duration::from_secs(30)).expect("a queue waits for another queue");
        });
    }
}
