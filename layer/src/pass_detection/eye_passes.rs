//! The set of passes that show an eye, by which the benefit gate distinguishes scenes, and their resolution.

use super::{ImageDescription, Pass};
use ash::vk;
use smallvec::SmallVec;
use std::hash::{DefaultHasher, Hash, Hasher};

/// More kinds of passes than a frame's eyes have: further ones are ignored.
const MOST: usize = 16;

/// The kinds of passes that show an eye in one frame, and the pixels of the largest one.
///
/// Kinds depend only on properties that stay from frame to frame: images change in many applications, sizes with dynamic resolution, and
/// the number of passes wherever one is interrupted by a copy. Passes of one kind are one element of the set, regardless of their number.
#[derive(Clone, Debug, Default)]
pub struct EyePasses {
    /// In their order, each once.
    kinds: SmallVec<[u32; MOST]>,
    pixels: u32,
}

/// The common properties of the passes of one kind.
#[derive(Hash)]
struct Kind {
    format: vk::Format,
    samples: u32,
    view_mask: u32,
    colors: usize,
    has_depth: bool,
    /// Whether it draws to an image of an XR swapchain.
    is_shown: bool,
}

impl EyePasses {
    /// Adds a pass that shows an eye; `first` is the image that it draws to first.
    pub fn add(&mut self, pass: &Pass, first: &ImageDescription) {
        let [_, _, width, height] = pass.picture_area();
        self.pixels = self.pixels.max(width.saturating_mul(height));
        let kind = hash(&Kind {
            format: first.format,
            samples: first.samples,
            view_mask: pass.view_mask,
            colors: pass.colors.len(),
            has_depth: pass.depth.is_some(),
            is_shown: first.swapchain.is_some(),
        });
        if let (Err(place), true) = (self.kinds.binary_search(&kind), self.kinds.len() < MOST) {
            self.kinds.insert(place, kind);
        }
    }

    /// Hash of this set; 0: it is empty.
    pub fn number(&self) -> u32 {
        if self.kinds.is_empty() { 0 } else { hash(&self.kinds).max(1) }
    }

    /// Pixels of the largest picture among the passes; 0: there is none. The largest one, because the number of passes changes from frame to
    /// frame in many applications, and all views of one have the same scale.
    pub fn pixels(&self) -> u32 {
        self.pixels
    }

    /// Begins another frame.
    pub fn clear(&mut self) {
        self.kinds.clear();
        self.pixels = 0;
    }
}

fn hash(value: &impl Hash) -> u32 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    (hasher.finish() >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::{ImageKey, PassFacts, Target};

    fn image(number: u64, format: vk::Format, width: u32) -> ImageDescription {
        ImageDescription {
            key: ImageKey(number),
            extent: [width, width],
            layers: 1,
            format,
            samples: 1,
            is_cube: false,
            swapchain: None,
        }
    }

    fn pass(colors: usize) -> Pass {
        let target = Target { image: ImageKey(1), level: 0, base_layer: 0, layers: 1 };
        Pass {
            colors: std::iter::repeat_n(target, colors).collect(),
            resolves: SmallVec::new(),
            depth: None,
            area: [0, 0, 8, 8],
            region: [0, 0, 8, 8],
            view_mask: 0,
            facts: PassFacts::default(),
            unmasked: None,
            draws: None,
        }
    }

    fn number(passes: &[(usize, ImageDescription)]) -> u32 {
        let mut eyes = EyePasses::default();
        passes.iter().for_each(|(colors, first)| eyes.add(&pass(*colors), first));
        eyes.number()
    }

    /// Both eyes, an inset, and a pass that ends early: one resolution. In a target of a fixed size it is that of the viewport.
    #[test]
    fn the_largest_picture_is_the_resolution() {
        let first = image(1, vk::Format::R8G8B8A8_SRGB, 2000);
        let mut eyes = EyePasses::default();
        assert_eq!(eyes.pixels(), 0);
        let mut draw = |sides: &[[u32; 2]], target: [u32; 2]| {
            eyes.clear();
            for [width, height] in sides {
                let region = [0, 0, *width, *height];
                eyes.add(&Pass { area: [0, 0, target[0], target[1]], region, ..pass(1) }, &first);
            }
            eyes.pixels()
        };
        assert_eq!(draw(&[[600, 600], [1000, 1100], [1000, 1100]], [1000, 1100]), 1_100_000);
        assert_eq!(draw(&[[800, 880], [800, 880]], [1000, 1100]), 800 * 880);
        assert_eq!(draw(&[[0, 0]], [0, 0]), 0);
        assert_eq!(draw(&[[u32::MAX, u32::MAX]], [u32::MAX, u32::MAX]), u32::MAX);
    }

    #[test]
    fn images_sizes_and_numbers_of_passes_tell_nothing_apart() {
        let [forward, other] = [vk::Format::R16G16B16A16_SFLOAT, vk::Format::R8G8B8A8_SRGB];
        let both = number(&[(1, image(1, forward, 2000)), (4, image(2, other, 2000))]);
        assert_eq!(number(&[(4, image(7, other, 1500)), (1, image(9, forward, 1500))]), both);
        let split = [(1, image(1, forward, 2000)), (4, image(2, other, 2000)), (1, image(1, forward, 2000))];
        assert_eq!(number(&split), both);
        let sets =
            [number(&[]), number(&[(1, image(1, forward, 8))]), number(&[(4, image(1, other, 8))]), both];
        assert_eq!(sets[0], 0);
        for (index, set) in sets.iter().enumerate() {
            assert!(!sets[..index].contains(set), "{sets:?}");
        }
    }
}
