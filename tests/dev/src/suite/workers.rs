//! Threads that share the work of a queue.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Does all the work, so many pieces at a time, beginning with the first; returns the results in the order in which they came.
pub fn run<Work: Send, Outcome: Send>(
    workers: usize,
    work: Vec<Work>,
    do_one: impl Fn(Work) -> Outcome + Sync,
) -> Vec<Outcome> {
    let (queue, done) = (Mutex::new(work.into_iter()), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    // A statement of its own: in the head of `while let` the queue would be locked as long as the work lasts.
                    let Some(next) = lock(&queue).next() else { return };
                    let outcome = do_one(next);
                    lock(&done).push(outcome);
                }
            });
        }
    });
    std::mem::take(&mut *lock(&done))
}

/// A worker that panics ends the scope with a panic: its locks are of no interest any more.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    /// Each piece waits for the other one to begin.
    #[test]
    fn two_workers_work_at_the_same_time() {
        let ((to_first, first), (to_second, second)) = (channel(), channel());
        let met = run(2, vec![(to_second, first), (to_first, second)], |(other, own)| {
            // The receiver is gone if the other piece has timed out.
            _ = other.send(());
            own.recv_timeout(Duration::from_secs(20)).is_ok()
        });
        assert_eq!(met, [true, true]);
    }

    #[test]
    fn all_work_is_done_once() {
        let mut done = run(3, (0..100).collect(), |number: u32| number);
        done.sort_unstable();
        assert_eq!(done, (0..100).collect::<Vec<_>>());
        assert_eq!(run(4, Vec::<u32>::new(), |number| number), []);
    }
}
