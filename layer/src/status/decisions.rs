//! Decisions on this process's devices and passes.

use std::fmt::Display;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// More than the log lists of the passes of one device.
const MOST_DECISIONS: usize = 200;

static DECISIONS: Mutex<Vec<Decision>> = Mutex::new(Vec::new());

/// Decisions so far, for readers that must not wait.
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// A decision, as the log has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Its subject.
    pub topic: Topic,
    /// One line, as in the log.
    pub line: String,
}

/// The subject of a decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Special treatment of a driver or a device.
    Quirk,
    /// A device has no rate attachments, or no masks.
    NoBackend,
    /// A pass that was recognised as the scene.
    Scene,
    /// A pass that was recognised as something else.
    OtherPass,
    /// A pass of the scene got a mask.
    Mask,
    /// A pass of the scene got none, for this reason.
    NoMask(String),
    /// Nothing of the layer's work is visible.
    Unseen,
}

/// Logs a decision and keeps it for `parafovea status`, unless it was made before: the images of a swapchain each get the same one.
pub fn decided(topic: Topic, line: &dyn Display) {
    let decision = Decision { topic, line: line.to_string() };
    {
        let mut decisions = lock();
        if decisions.contains(&decision) {
            return;
        }
        if decisions.len() < MOST_DECISIONS {
            decisions.push(decision.clone());
            COUNT.store(decisions.len(), Ordering::Release);
        }
    }
    tracing::info!("{}", decision.line);
}

/// Copies of all decisions, in the order of the log.
pub fn all() -> Vec<Decision> {
    lock().clone()
}

/// Number of decisions so far.
pub fn count() -> usize {
    COUNT.load(Ordering::Acquire)
}

fn lock() -> MutexGuard<'static, Vec<Decision>> {
    DECISIONS.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_decision_is_told_once() {
        let before = count();
        for line in ["of a test: a", "of a test: b", "of a test: a"] {
            decided(Topic::Quirk, &line);
        }
        let lines: Vec<_> = all().into_iter().map(|decision| decision.line).collect();
        let of_test: Vec<_> = lines.into_iter().filter(|line| line.starts_with("of a test")).collect();
        assert_eq!(of_test, ["of a test: a", "of a test: b"]);
        // Other tests of this process may decide too.
        assert!(count() >= before + 2);
    }
}
