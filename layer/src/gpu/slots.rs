//! Slots of submits under way, by the purpose of the submit.

use super::SUBMITS_IN_FLIGHT;
use std::ops::Range;

/// The purpose of a submit. Each has slots of its own, so that no submit of a frame waits for another one of the same frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// The pictures of a frame.
    Pictures,
    /// Copies of depth, of both eyes.
    Depth,
    /// Debug views over finished pictures.
    DebugView,
    /// New images of a swapchain. Applications create several swapchains in one frame.
    NewImages,
}

impl Purpose {
    /// Its slots.
    const fn slots(self) -> Range<usize> {
        match self {
            Self::Pictures => 0..SUBMITS_IN_FLIGHT,
            Self::DebugView => SUBMITS_IN_FLIGHT..2 * SUBMITS_IN_FLIGHT,
            Self::Depth => 2 * SUBMITS_IN_FLIGHT..4 * SUBMITS_IN_FLIGHT,
            Self::NewImages => 4 * SUBMITS_IN_FLIGHT..SLOTS,
        }
    }
}

/// Number of purposes.
pub(super) const PURPOSES: usize = 4;

/// Number of swapchains whose new images are prepared without a wait.
const NEW_SWAPCHAINS: usize = 8;

/// Number of slots of all purposes: a frame has two copies of depth.
pub(super) const SLOTS: usize = 4 * SUBMITS_IN_FLIGHT + NEW_SWAPCHAINS;

/// A slot of the ring: memory that is kept per slot may be written until its submit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SlotIndex {
    purpose: Purpose,
    /// Among the slots of its purpose.
    index: usize,
}

impl SlotIndex {
    /// The slot of a purpose's next submit, after `count` others.
    pub(super) fn after(purpose: Purpose, count: usize) -> Self {
        Self { purpose, index: count % purpose.slots().len() }
    }

    /// Its purpose.
    pub(super) fn purpose(self) -> Purpose {
        self.purpose
    }

    /// Below [`SUBMITS_IN_FLIGHT`], but for [`Purpose::Depth`] and [`Purpose::NewImages`].
    pub(crate) fn get(self) -> usize {
        self.index
    }

    /// Among all slots.
    pub(super) fn of_all(self) -> usize {
        self.purpose.slots().start + self.index
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn purposes_share_no_slot() {
        let mut seen = Vec::new();
        let purposes = [Purpose::Pictures, Purpose::Depth, Purpose::DebugView, Purpose::NewImages];
        assert!(purposes.map(|purpose| purpose as usize).into_iter().eq(0..PURPOSES));
        for purpose in purposes {
            let slots = |count| SlotIndex::after(purpose, count).of_all();
            let each = purpose.slots().len();
            seen.extend((0..each).map(slots));
            assert!((0..each).all(|count| slots(count) == slots(count + each)));
        }
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..SLOTS));
    }
}
