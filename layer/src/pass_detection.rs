//! Detection of the application's passes that make an eye buffer.
//!
//! The Vulkan half records the work of submitted command buffers as [`Event`]s; at xrEndFrame the OpenXR half reports the
//! submission as [`Shown`]. From both, recognition finds the targets that are the scene, and the eye of each.

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
pub use recognition::{Feedback, Recognition, holds_colours};
pub use shown::{Eye, Shown, ShownView, SwapchainKey};
pub use unmasked::Unmasked;
