//! The answer of recognition.

use super::Pass;
use ash::vk;
use smallvec::SmallVec;
use std::fmt;

/// A pass that makes the eye buffer of an eye, or of both.
#[derive(Clone, Debug, PartialEq)]
pub struct Match {
    /// Parts of its target, and the eye that each shows. They may lie over each other: then each pixel is both, and the finer rate holds.
    /// A pixel in none of them belongs to no eye.
    pub parts: SmallVec<[Part; 4]>,
    /// Evidence of the match.
    pub how: How,
}

impl Match {
    /// Whether every layer that the pass draws shows an eye: one layer of rates for all of them then makes no other content coarse, such as the
    /// insets of quad views.
    pub fn shows_all_layers(&self, pass: &Pass) -> bool {
        let layers = pass.colors.first().map_or(0, |target| target.layers);
        let is_drawn = |layer: &u32| pass.view_mask == 0 || pass.view_mask & (1 << layer) != 0;
        let all = if pass.view_mask == 0 { 0..layers } else { 0..u32::BITS };
        all.filter(is_drawn).all(|layer| self.parts.iter().any(|part| part.layer == layer))
    }
}

/// A rectangle of a target that shows a whole eye buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Eye that it shows.
    pub eyes: Eyes,
    /// Array layer, counted from the first one of the target (with multiview: the view).
    pub layer: u32,
    /// x, y, width, height as fractions of the render area, so that it follows where that is resized. It may reach
    /// beyond 0..1, where the pass draws a part of the picture only.
    pub rect: [f32; 4],
    /// Vertical orientation of the picture.
    pub orientation: Orientation,
}

/// Eye or eyes of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Eyes {
    /// The left eye's.
    Left,
    /// The right eye's.
    Right,
    /// One's or the other's, or both eyes': the finer rate of both plans holds.
    Finer,
}

/// Vertical orientation of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Orientation {
    /// The first row is the top, as in the plan.
    Upright,
    /// The first row is the bottom.
    UpsideDown,
    /// Not proven: the finer rate of both holds.
    Unknown,
}

/// The evidence of a match, surest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum How {
    /// A colour attachment, or its resolve target in the pass, is an image of an XR swapchain.
    Swapchain,
    /// It is copied, blitted or resolved into one afterwards.
    Transferred,
    /// Its content becomes an eye buffer by full-screen passes, as far as these can be followed, and it looks like one.
    Shape,
    /// A rule of the profile.
    Profile,
}

impl fmt::Display for How {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Swapchain => "draws into the swapchain",
            Self::Transferred => "is copied, blitted or resolved into the swapchain",
            Self::Shape => "is read by the passes that draw the eye buffer",
            Self::Profile => "named by rates.passes",
        })
    }
}

/// Reason why a pass is not the scene. `Display` completes "not the scene: ...".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unmatched {
    /// No colour attachment: shadow maps, depth pre-passes.
    NoColour,
    /// The image can be a cube map.
    Cube,
    /// Into a mip level other than 0.
    Level(u32),
    /// Its picture turns up in a quad, a cylinder or the like.
    Flat,
    /// Into a swapchain, or a part of one, that no projection view shows.
    NotShown,
    /// Into a swapchain that is shown for neither eye's whole picture: insets of quad views.
    Inset,
    /// Nothing is known of the image.
    UnknownImage,
    /// Smaller than half of the eye buffer; or than a third, where its content is known to become the eye buffer.
    Small,
    /// Larger than twice the eye buffer.
    Large,
    /// Another aspect than the eye buffer.
    Aspect,
    /// Number of array layers: more than eyes, or with two eyes side by side in each.
    Layers(u32),
    /// Its format does not hold colours.
    Format(vk::Format),
    /// The shown image fills only a part of the render area, and so may earlier passes.
    Viewport,
    /// No later pass draws an image that is shown.
    After,
    /// The scene is drawn straight into the swapchain.
    DrawnDirectly,
    /// Images of the same shape have different uses in one frame.
    Ambiguous,
    /// Draws of the scene sample it, or nothing else: a mirror, a shadow map, a scope, a user interface.
    Texture,
    /// It passes an eye buffer on, and shades nothing: coarse rates would only lose detail.
    FullScreen,
    /// The picture's rectangle changes while the render area does not.
    Unsteady,
    /// The profile excludes it.
    Excluded,
    /// Seen for the first time: earlier frames are the evidence.
    New,
}

impl fmt::Display for Unmatched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoColour => "no colour: a shadow map or a depth pre-pass",
            Self::Cube => "a cube map",
            Self::Level(level) => return write!(f, "draws into mip level {level}"),
            Self::Flat => "shown in a composition layer other than a projection layer",
            Self::NotShown => "draws into a part of a swapchain that no projection layer shows",
            Self::Inset => "an inset of quad views",
            Self::UnknownImage => "its image is unknown",
            Self::Small => "less than half the size of the eye buffer",
            Self::Large => "more than twice the size of the eye buffer",
            Self::Aspect => "its aspect ratio differs from that of the eye buffer",
            Self::Layers(layers) => return write!(f, "{layers} array layers"),
            Self::Format(format) => return write!(f, "{format:?} is not a colour format"),
            Self::Viewport => "the displayed image fills only part of the render area",
            Self::After => "no visible pass follows it",
            Self::DrawnDirectly => "the scene is drawn directly into the swapchain",
            Self::Ambiguous => "images of this size and format serve different purposes",
            Self::Texture => "a texture that the scene samples",
            Self::FullScreen => "a full-screen pass after the scene, kept at 1x1",
            Self::Unsteady => "the displayed rectangle changes, but the render area does not",
            Self::Excluded => "excluded by rates.passes",
            Self::New => "absent from earlier frames",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::{ImageKey, PassFacts, Target};

    /// Four views of one multiview pass: two eyes, and two insets.
    #[test]
    fn insets_are_no_layers_of_eyes() {
        let part = |layer| Part {
            eyes: Eyes::Left,
            layer,
            rect: [0.0, 0.0, 1.0, 1.0],
            orientation: Orientation::Upright,
        };
        let eyes = Match { parts: SmallVec::from_iter([part(0), part(1)]), how: How::Swapchain };
        let pass = |layers, view_mask| Pass {
            colors: SmallVec::from_iter([Target { image: ImageKey(1), level: 0, base_layer: 0, layers }]),
            resolves: SmallVec::new(),
            depth: None,
            area: [0, 0, 64, 64],
            region: [0, 0, 64, 64],
            view_mask,
            facts: PassFacts::default(),
            unmasked: None,
            draws: None,
        };
        for (layers, view_mask, all) in
            [(4, 0b1111, false), (4, 0b11, true), (2, 0b11, true), (2, 0, true), (1, 0, true), (4, 0, false)]
        {
            assert_eq!(eyes.shows_all_layers(&pass(layers, view_mask)), all, "{layers} {view_mask:b}");
        }
    }
}
