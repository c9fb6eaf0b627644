//! The set of passes that show an eye, by which the benefit gate distinguishes scenes, and their resolution.

use super::{ImageDescription, Pass};
use ash::vk;
use smallvec::SmallVec;
use std::hash::{DefaultHasher, Hash, Hasher};

/// More kinds of passes than a frame's eyes have: further ones are ignored.
const MOST: usize = 16;

/// The kinds of passes that show an eye in one frame.
///
/// Kinds depend only on properties that stay from frame to frame: images change in many applications, sizes with dynamic resolution, and
/// the number of passes wherever one is interrupted by a copy. Passes of one kind are one element of the set, regardless of their number.
#[derive(Clone, Debug, Default)]
pub struct EyePasses {
    /// In the order of their numbers, each once.
    kinds: SmallVec<[KindPasses; MOST]>,
}

/// The passes of one kind.
#[derive(Clone, Copy, Debug)]
struct KindPasses {
    number: u32,
    /// Vertices of their draws; saturates.
    vertices: u32,
    /// Pixels of the largest picture among them; 0 where they draw nothing.
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
        let number = hash(&Kind {
            format: first.format,
            samples: first.samples,
            view_mask: pass.view_mask,
            colors: pass.colors.len(),
            has_depth: pass.depth.is_some(),
            is_shown: first.swapchain.is_some(),
        });
        // The region of a pass without draws is the whole target, regardless of the resolution.
        let draws = pass.draws.as_ref().is_none_or(|draws| draws.quads + draws.meshes > 0);
        let pixels = if draws { pass.region[2].saturating_mul(pass.region[3]) } else { 0 };
        let vertices = pass.draws.as_ref().map_or(0, |draws| draws.vertices);
        match self.kinds.binary_search_by_key(&number, |kind| kind.number) {
            Ok(place) => {
                let kind = &mut self.kinds[place];
                kind.vertices = kind.vertices.saturating_add(vertices);
                kind.pixels = kind.pixels.max(pixels);
            }
            Err(place) if self.kinds.len() < MOST => {
                self.kinds.insert(place, KindPasses { number, vertices, pixels });
            }
            Err(_) => {}
        }
    }

    /// Hash of this set; 0: it is empty.
    pub fn number(&self) -> u32 {
        let numbers: SmallVec<[u32; MOST]> = self.kinds.iter().map(|kind| kind.number).collect();
        if numbers.is_empty() { 0 } else { hash(&numbers).max(1) }
    }

    /// Pixels of the scene: the largest picture among the passes of the kind that draws most; 0: there is none. The largest one, because the
    /// number of passes changes from frame to frame in many applications; of one kind, as interfaces and hands may have a fixed size.
    pub fn pixels(&self) -> u32 {
        let most = self.kinds.iter().max_by_key(|kind| (kind.vertices, kind.pixels));
        most.map_or(0, |kind| kind.pixels)
    }

    /// Begins another frame.
    pub fn clear(&mut self) {
        self.kinds.clear();
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
    use crate::pass_detection::{Draws, ImageKey, PassFacts, Target};

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

    /// A pass to a target of this size with its viewports in a part of it, and so many vertices, or none drawn.
    fn drawn(target: [u32; 2], [width, height]: [u32; 2], vertices: u32) -> Pass {
        let draws = Draws { meshes: u32::from(vertices > 0), vertices, ..Draws::default() };
        let region = [0, 0, width, height];
        Pass { area: [0, 0, target[0], target[1]], region, draws: Some(draws), ..pass(1) }
    }

    /// Both eyes, an inset, and a pass that ends early: one resolution. In a target of a fixed size it is that of the viewport, at any scale
    /// and with any rounding.
    #[test]
    fn the_largest_picture_of_the_scene_is_the_resolution() {
        let first = image(1, vk::Format::R8G8B8A8_SRGB, 2000);
        let target = [1000, 1100];
        let pixels = |sides: &[[u32; 2]]| {
            let mut eyes = EyePasses::default();
            sides.iter().for_each(|side| eyes.add(&drawn(target, *side, 9), &first));
            eyes.pixels()
        };
        assert_eq!(pixels(&[]), 0);
        assert_eq!(pixels(&[[600, 600], [1000, 1100], [1000, 1100]]), 1_100_000);
        for scaled in [[800, 880], [768, 832], [450, 495]] {
            assert_eq!(pixels(&[[300, 300], scaled, scaled]), scaled[0] * scaled[1]);
        }
        assert_eq!(pixels(&[[u32::MAX, u32::MAX]]), u32::MAX);
        let mut eyes = EyePasses::default();
        eyes.add(&drawn(target, target, 0), &first);
        eyes.add(&drawn(target, [800, 880], 9), &first);
        assert_eq!(eyes.pixels(), 800 * 880, "a pass that only clears");
    }

    #[test]
    fn an_interface_of_a_fixed_size_is_not_the_resolution() {
        let [scene, shown] = [vk::Format::R16G16B16A16_SFLOAT, vk::Format::R8G8B8A8_SRGB];
        let mut eyes = EyePasses::default();
        for _ in 0..2 {
            eyes.add(&drawn([800, 880], [800, 880], 100_000), &image(1, scene, 800));
            eyes.add(&drawn([1000, 1100], [1000, 1100], 500), &image(2, shown, 1000));
        }
        assert_eq!(eyes.pixels(), 800 * 880);
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
