//! What was decided of this process's devices and passes.

use std::fmt::Display;
use std::sync::{Mutex, PoisonError};

/// More than the log lists of the passes of one device.
const MOST_LINES: usize = 200;

static DECISIONS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Logs a decision, and notes it for whoever looks; it is called only for news.
pub fn decided(line: &dyn Display) {
    let line = line.to_string();
    tracing::info!("{line}");
    let mut decisions = DECISIONS.lock().unwrap_or_else(PoisonError::into_inner);
    if decisions.len() < MOST_LINES && !decisions.contains(&line) {
        decisions.push(line);
    }
}

/// All of them, each once, in the order of the log.
pub fn all() -> Vec<String> {
    DECISIONS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_decision_is_told_once() {
        for line in ["of a test: a", "of a test: b", "of a test: a"] {
            decided(&line);
        }
        let of_test: Vec<_> = all().into_iter().filter(|line| line.starts_with("of a test")).collect();
        assert_eq!(of_test, ["of a test: a", "of a test: b"]);
    }
}
