//! Messages for people, a line each, for the log of the library's user.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Most lines that wait: without a reader the log does not grow.
const MOST: usize = 16;

/// Lines in their order.
#[derive(Debug, Default)]
pub struct PendingMessages(Mutex<Lines>);

#[derive(Debug, Default)]
struct Lines {
    waiting: VecDeque<String>,
    last: String,
}

impl PendingMessages {
    /// Adds a line, unless it repeats the last one.
    pub fn say(&self, line: String) {
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if lines.last != line && lines.waiting.len() < MOST {
            lines.last.clone_from(&line);
            lines.waiting.push_back(line);
        }
    }

    /// The oldest line that was not taken yet.
    pub fn next(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).waiting.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_logged_once() {
        let messages = PendingMessages::default();
        for line in ["deaf", "deaf", "listens", "deaf"] {
            messages.say(line.to_owned());
        }
        let lines: Vec<String> = std::iter::from_fn(|| messages.next()).collect();
        assert_eq!(lines, ["deaf", "listens", "deaf"]);
        (0..100).for_each(|number| messages.say(number.to_string()));
        assert_eq!(std::iter::from_fn(|| messages.next()).count(), MOST);
    }
}
