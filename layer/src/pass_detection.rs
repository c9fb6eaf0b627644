//! Which of the application's passes make the picture of an eye.
//!
//! The Vulkan half writes down what submitted command buffers do as [`Event`]s; at xrEndFrame the OpenXR half says what
//! the application [`Shown`]. From both, recognition works out which targets are the scene, and of which eye.

mod event;
mod eye_passes;
mod matched;
mod recognition;
mod shown;
mod unmasked;

pub use event::{
    Draws, Event, ImageDescription, ImageKey, Pass, PassFacts, Reads, Target, Transfer, TransferKind,
};
pub use eye_passes::EyePasses;
pub use matched::{Eyes, How, Match, Orientation, Part, Unmatched};
pub use recognition::{Feedback, Recognition};
pub use shown::{Eye, Shown, ShownView, SwapchainKey};
pub use unmasked::Unmasked;
