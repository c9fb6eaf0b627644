//! Frames of engines, from the captures and the sources that each names.

pub(crate) mod compatibility;
pub(crate) mod native;
pub(crate) mod open;
pub(crate) mod unity;
pub(crate) mod unreal;

use crate::frame_graphs::frame::{Frame, Image, plain};
use crate::frame_graphs::textures::Texture;
use ash::vk;
use parafovea::pass_detection::ImageDescription;

/// Draws one frame, of which the scene samples these textures.
pub(crate) type Engine = fn(&mut Frame<'_>, &[Texture]);

/// An image of several samples.
fn multisampled(
    frame: &mut Frame<'_>,
    name: &'static str,
    number: usize,
    extent: [u32; 2],
    layers: u32,
    format: vk::Format,
) -> Image {
    frame.described(name, number, |key| ImageDescription { samples: 4, layers, ..plain(key, extent, format) })
}
