//! Decisions on this process's devices and passes.
//!
//! Each copy of this library has a list. The Vulkan half decides; the OpenXR half, which may be another copy, takes its decisions over
//! through the link ([`crate::link::DecisionRecord`]).

use parafovea_manifest::status;
use std::fmt::Display;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// More than the log lists of the passes of one device.
const MOST_DECISIONS: usize = 200;

static DECISIONS: Decisions = Decisions::new();

/// A decision, as the log has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Its subject.
    pub topic: Topic,
    /// One line, as in the log.
    pub line: String,
}

impl Decision {
    /// The same for `parafovea status`, and for programs that read its output.
    pub fn status(&self) -> status::Decision {
        let topic = match self.topic {
            Topic::Quirk => status::Topic::Quirk,
            Topic::NoBackend => status::Topic::NoBackend,
            Topic::Scene => status::Topic::Scene,
            Topic::OtherPass => status::Topic::OtherPass,
            Topic::Mask => status::Topic::Mask,
            Topic::NoMask(_) => status::Topic::NoMask,
            Topic::Unseen => status::Topic::Unseen,
            Topic::FullRate(_) => status::Topic::FullRate,
            Topic::Feedback => status::Topic::Feedback,
        };
        status::Decision { topic, reason: self.topic.reason().to_owned(), line: self.line.clone() }
    }
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
    /// Draws in passes of the scene that stay at 1x1, for this reason.
    FullRate(String),
    /// Images of earlier frames that passes read.
    Feedback,
}

impl Topic {
    /// Its number in [`crate::link::DecisionRecord::topic`].
    pub fn number(&self) -> u32 {
        match self {
            Self::Quirk => 0,
            Self::NoBackend => 1,
            Self::Scene => 2,
            Self::OtherPass => 3,
            Self::Mask => 4,
            Self::NoMask(_) => 5,
            Self::Unseen => 6,
            Self::FullRate(_) => 7,
            Self::Feedback => 8,
        }
    }

    /// The reason that it carries; empty for topics without one.
    pub fn reason(&self) -> &str {
        match self {
            Self::NoMask(reason) | Self::FullRate(reason) => reason,
            Self::Quirk
            | Self::NoBackend
            | Self::Scene
            | Self::OtherPass
            | Self::Mask
            | Self::Unseen
            | Self::Feedback => "",
        }
    }

    /// The topic of that number, with its reason; `None` if no topic has that number.
    pub fn from_number(number: u32, reason: &str) -> Option<Self> {
        Some(match number {
            0 => Self::Quirk,
            1 => Self::NoBackend,
            2 => Self::Scene,
            3 => Self::OtherPass,
            4 => Self::Mask,
            5 => Self::NoMask(reason.to_owned()),
            6 => Self::Unseen,
            7 => Self::FullRate(reason.to_owned()),
            8 => Self::Feedback,
            _ => return None,
        })
    }
}

/// A list that only grows. Readers take no lock.
struct Decisions {
    list: [OnceLock<Decision>; MOST_DECISIONS],
    len: AtomicUsize,
    appending: Mutex<()>,
}

impl Decisions {
    const fn new() -> Self {
        Self {
            list: [const { OnceLock::new() }; MOST_DECISIONS],
            len: AtomicUsize::new(0),
            appending: Mutex::new(()),
        }
    }

    fn get(&self, index: usize) -> Option<&Decision> {
        self.list.get(index)?.get()
    }

    fn iter(&self) -> impl Iterator<Item = &Decision> {
        self.list.iter().map_while(OnceLock::get)
    }

    /// Appends a decision, as long as there is room; false if it is in the list already.
    fn append(&self, decision: &Decision) -> bool {
        let _appending = self.appending.lock().unwrap_or_else(PoisonError::into_inner);
        if self.iter().any(|known| known == decision) {
            return false;
        }
        let len = self.len.load(Ordering::Relaxed);
        if let Some(free) = self.list.get(len) {
            // No other thread appends: the entry is free.
            _ = free.set(decision.clone());
            self.len.store(len + 1, Ordering::Release);
        }
        true
    }
}

/// Logs a decision and keeps it for `parafovea status`, unless it was made before: the images of a swapchain each get the same one.
pub fn decided(topic: Topic, line: &dyn Display) {
    let decision = Decision { topic, line: line.to_string() };
    if DECISIONS.append(&decision) {
        tracing::info!("{}", decision.line);
    }
}

/// Keeps a decision of the Vulkan half, which has logged it. Nothing changes if both halves are one copy of this library.
pub fn take_over(decision: &Decision) {
    DECISIONS.append(decision);
}

/// The decision of that index, from 0; `None` if there are fewer. Takes no lock.
pub fn decision(index: usize) -> Option<&'static Decision> {
    DECISIONS.get(index)
}

/// Copies of all decisions, in the order of the log.
pub fn all() -> Vec<Decision> {
    DECISIONS.iter().cloned().collect()
}

/// Number of decisions so far.
pub fn count() -> usize {
    DECISIONS.len.load(Ordering::Acquire)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str) -> Decision {
        Decision { topic: Topic::Quirk, line: text.to_owned() }
    }

    #[test]
    fn each_decision_is_kept_once_and_a_full_list_stays_as_it_is() {
        let decisions = Decisions::new();
        let appended = ["a", "b", "a"].map(|text| decisions.append(&line(text)));
        assert_eq!(appended, [true, true, false]);
        (0..2 * MOST_DECISIONS).for_each(|number| _ = decisions.append(&line(&number.to_string())));
        assert_eq!((decisions.iter().count(), decisions.get(MOST_DECISIONS)), (MOST_DECISIONS, None));
        assert_eq!([0, 1, 2].map(|index| &*decisions.get(index).unwrap().line), ["a", "b", "0"]);
    }

    #[test]
    fn decisions_of_this_process_are_counted() {
        let before = count();
        ["of a test: a", "of a test: b", "of a test: a"].iter().for_each(|text| decided(Topic::Quirk, text));
        let of_test = all().into_iter().filter(|decision| decision.line.starts_with("of a test"));
        assert!(of_test.eq(["of a test: a", "of a test: b"].map(line)));
        // Other tests of this process may decide too.
        assert!(count() >= before + 2);
    }

    #[test]
    fn topics_survive_the_link() {
        let no_mask = Topic::NoMask("it blends".to_owned());
        let topics = [
            Topic::Quirk,
            Topic::NoBackend,
            Topic::Scene,
            Topic::OtherPass,
            Topic::Mask,
            no_mask,
            Topic::Unseen,
            Topic::FullRate("it discards".to_owned()),
            Topic::Feedback,
        ];
        for topic in topics {
            assert_eq!(Topic::from_number(topic.number(), topic.reason()), Some(topic));
        }
        assert_eq!(Topic::from_number(9, ""), None);
    }
}
