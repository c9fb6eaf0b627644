//! Images, beyond the events of a frame.

use super::super::Parts;
use super::super::candidate;
use super::super::memory::Memory;
use super::super::projected::Swapchains;
use super::area;
use crate::pass_detection::{ImageKey, Pass, Unmatched};

/// Knowledge of images besides a frame's events.
pub(in super::super) struct Known<'a> {
    pub(in super::super) frame: u64,
    pub(in super::super) memory: &'a Memory,
    pub(in super::super) swapchains: &'a Swapchains,
    /// Whether no event makes the shown pictures: compute does.
    pub(in super::super) are_pictures_computed: bool,
}

/// Least side of a picture that is passed on, in sides of the render area that it is passed on to.
const LEAST_SIDE: f32 = 0.25;

impl Known<'_> {
    pub(super) fn extent(&self, image: ImageKey) -> Option<[u32; 2]> {
        self.memory.description(image).map(|image| image.extent)
    }

    /// Whether an image may be the picture that a pass passes on, or have a number for each of its pixels.
    pub(super) fn is_picture(&self, image: ImageKey, pass: &Pass) -> bool {
        self.memory.description(image).is_none_or(|image| {
            let is_large = |axis: usize| image.extent[axis] as f32 >= LEAST_SIDE * area(pass)[axis] as f32;
            let holds_colours = candidate::holds_colours(image.format);
            image.extent == area(pass) || (holds_colours && is_large(0) && is_large(1))
        })
    }

    /// The verdict on a pass by its looks: see [`candidate::looks`].
    pub(super) fn looks(&self, pass: &Pass, least: f32) -> Result<Parts, Unmatched> {
        candidate::looks(pass, |image| self.memory.description(image), self.swapchains, least)
    }

    pub(super) fn writes_picture(&self, pass: &Pass) -> bool {
        pass.colors.iter().chain(&pass.resolves).any(|target| {
            match self.swapchains.shown_of(self.memory.description(target.image)) {
                Some(swapchain) => self.swapchains.shows_eyes(swapchain, target),
                None => self.memory.is_placed(self.frame, target.image),
            }
        })
    }

    /// Whether a full-screen pass that reads these images of the scene shades it: a G-buffer has at least two that hold colours, and a
    /// visibility buffer has none.
    pub(super) fn is_shading(&self, images: impl Iterator<Item = ImageKey>) -> bool {
        let described = images.filter_map(|image| self.memory.description(image));
        described.filter(|image| candidate::holds_colours(image.format)).count() != 1
    }
}
