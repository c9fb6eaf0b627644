//! One colour swapchain an eye, as most cases have them.

use crate::failure::Failure;
use crate::session::{Session, SubImage};
use crate::swapchain::{Shape, Swapchain};
use parafovea_zoo::cases::pattern::Figure;

/// The swapchains of the left and the right eye.
pub struct Stereo<'s> {
    pub eyes: [Swapchain<'s>; 2],
}

impl<'s> Stereo<'s> {
    /// Of the recommended sizes.
    pub fn create(session: &'s Session<'s>) -> Result<Self, Failure> {
        let [left, right] = session.app.view_sizes;
        Self::with_shapes(session, [&Shape::srgb(left), &Shape::srgb(right)])
    }

    pub fn with_shapes(session: &'s Session<'s>, shapes: [&Shape; 2]) -> Result<Self, Failure> {
        Ok(Self { eyes: [Swapchain::create(session, shapes[0])?, Swapchain::create(session, shapes[1])?] })
    }

    /// Draws and releases an image of both; `number` makes the pictures of a frame its own.
    pub fn paint(&self, number: u32) -> Result<(), Failure> {
        for (eye, swapchain) in (0..).zip(&self.eyes) {
            swapchain.paint(&[Figure::new(number, eye, swapchain.whole())])?;
        }
        Ok(())
    }

    /// The whole of both images released last.
    pub fn images(&self) -> [SubImage; 2] {
        self.eyes.each_ref().map(|eye| eye.sub_image(eye.whole()))
    }
}
