//! Pictures that no event makes: compute writes the images of the swapchains, as an upscaler or tone mapping with storage images does.

use super::memory::Memory;
use super::projected::Swapchains;
use crate::pass_detection::{Event, ImageKey, Shown, SwapchainKey, Target};
use smallvec::SmallVec;

/// So many consecutive frames with new images, and no event that makes them, are made by compute. An application that shows its last images again
/// for a while, and draws something else, is none of these.
const LEAST: u32 = 30;

/// Evidence of the last frames.
#[derive(Debug, Default)]
pub(super) struct ComputedPictures {
    /// Frames without an event that makes the picture.
    frames: u32,
    /// The images of the last frame.
    last: SmallVec<[(SwapchainKey, ImageKey); 4]>,
}

impl ComputedPictures {
    /// Takes a frame and its submission.
    pub(super) fn take(
        &mut self,
        events: &[Event],
        shown: &Shown,
        (swapchains, memory): (&Swapchains, &Memory),
    ) {
        let shows_eyes = |target: &Target| {
            let key = swapchains.shown_of(memory.description(target.image));
            key.is_some_and(|key| swapchains.shows_eyes(key, target))
        };
        let is_made = events.iter().any(|event| match event {
            Event::Pass(pass) => pass.colors.iter().chain(&pass.resolves).any(shows_eyes),
            Event::Transfer(transfer) => shows_eyes(&transfer.to),
        });
        if is_made {
            self.frames = 0;
        }
        let views = shown.views.iter().filter(|view| view.eye.is_some());
        let images: Option<SmallVec<[_; 4]>> =
            views.map(|view| Some((view.swapchain, view.image?))).collect();
        let Some(images) = images.filter(|images| !images.is_empty()) else { return };
        let is_new = |(key, image): &(SwapchainKey, ImageKey)| {
            let mut last = self.last.iter();
            last.any(|(known, before)| known == key && before != image)
        };
        if !is_made && images.iter().all(is_new) {
            self.frames = self.frames.saturating_add(1);
        }
        self.last = images;
    }

    /// Whether compute makes the pictures.
    pub(super) fn are_found(&self) -> bool {
        self.frames >= LEAST
    }
}
