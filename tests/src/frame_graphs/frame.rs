//! The material of frame graphs: images that last, passes, transfers, and an XR swapchain.

use crate::frame_graphs::step::{Step, Truth};
use ash::vk;
use parafovea::pass_detection::{
    Event, Eye, Feedback, ImageDescription, ImageKey, Match, Recognition, Shown, ShownView, SwapchainKey,
    Target, Transfer, TransferKind, Unmatched,
};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Arrangement of the eyes in XR swapchains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// A swapchain for each eye.
    Separate,
    /// Two layers of one.
    Array,
    /// Beside each other in one.
    DoubleWide,
}

/// An image of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// Key of the image.
    pub key: ImageKey,
    /// Size, pixels.
    pub extent: [u32; 2],
    /// Array layers.
    pub layers: u32,
}

impl Image {
    /// Level 0, all layers.
    pub(crate) fn target(&self) -> Target {
        Target { image: self.key, level: 0, base_layer: 0, layers: self.layers }
    }
}

/// A pass, and the verdict of recognition at its submit.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Number of the frame, from 0.
    pub frame: u64,
    /// The pass.
    pub name: &'static str,
    /// Its truth.
    pub truth: Truth,
    /// The verdict.
    pub outcome: Result<Match, Unmatched>,
}

/// An application: its images, and the recognition of its passes.
#[derive(Default)]
pub struct World {
    recognition: Recognition,
    images: HashMap<ImageKey, ImageDescription>,
    named: HashMap<(&'static str, usize, [u32; 2]), Image>,
    log: Vec<Event>,
    frame: u64,
    /// All passes so far.
    pub seen: Vec<Seen>,
    /// Time of recognition at the end of each frame.
    pub spent: Vec<Duration>,
    /// Time of the verdicts within each frame.
    pub verdicts_took: Vec<Duration>,
    /// The same of the current frame.
    verdicts: Duration,
}

/// A frame that is being drawn.
pub struct Frame<'a> {
    world: &'a mut World,
    /// Its number, from 0.
    pub number: u64,
    /// Size of an eye buffer of the swapchain, pixels.
    pub eye: [u32; 2],
    /// Arrangement of the eyes in it.
    pub arrangement: Arrangement,
    /// Side of the scene's targets, in sides of the eye buffer: dynamic resolution.
    pub scale: f32,
    /// Whether no descriptors are known.
    pub is_bindless: bool,
}

impl World {
    /// Draws a frame, and shows both eyes.
    pub fn frame(
        &mut self,
        eye: [u32; 2],
        arrangement: Arrangement,
        scale: f32,
        is_bindless: bool,
        draw: impl FnOnce(&mut Frame<'_>),
    ) {
        let number = self.frame;
        self.frame += 1;
        let mut frame = Frame { world: self, number, eye, arrangement, scale, is_bindless };
        draw(&mut frame);
        let shown = frame.shown();
        let images = &self.images;
        let begin = Instant::now();
        self.recognition.frame(&self.log, |image| images.get(&image).copied(), &shown);
        self.spent.push(begin.elapsed());
        self.verdicts_took.push(std::mem::take(&mut self.verdicts));
        self.log.clear();
    }

    /// Whether the image is made from images of earlier frames, by recognition.
    pub fn feedback(&self) -> Feedback {
        self.recognition.feedback()
    }

    fn made(&mut self, describe: impl FnOnce(ImageKey) -> ImageDescription) -> Image {
        let key = ImageKey(self.images.len() as u64 + 1);
        let description = describe(key);
        self.images.insert(key, description);
        Image { key, extent: description.extent, layers: description.layers }
    }
}

/// High dynamic range.
pub const HDR: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
/// Packed high dynamic range.
pub const PACKED: vk::Format = vk::Format::B10G11R11_UFLOAT_PACK32;
/// Low dynamic range.
pub const LDR: vk::Format = vk::Format::R8G8B8A8_SRGB;
/// Linear bytes.
pub const BYTES: vk::Format = vk::Format::R8G8B8A8_UNORM;
/// Normals.
pub const NORMALS: vk::Format = vk::Format::A2B10G10R10_UNORM_PACK32;
/// Two numbers: velocities.
pub const VELOCITY: vk::Format = vk::Format::R16G16_SFLOAT;
/// One byte.
pub const MASK: vk::Format = vk::Format::R8_UNORM;
/// Numbers of triangles.
pub const IDENTITY: vk::Format = vk::Format::R32G32_UINT;
/// Depth.
pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// A size times a scale, rounded up to a multiple of 8.
pub fn scaled(size: [u32; 2], scale: f32) -> [u32; 2] {
    size.map(|side| ((side as f32 * scale) as u32).next_multiple_of(8))
}

impl Frame<'_> {
    /// Size of the scene's targets for one eye, pixels.
    pub fn size(&self) -> [u32; 2] {
        if self.scale == 1.0 { self.eye } else { scaled(self.eye, self.scale) }
    }

    /// The same of both eyes beside each other.
    pub fn wide(&self) -> [u32; 2] {
        let [width, height] = self.size();
        [2 * width, height]
    }

    /// The image of that name, number and size; the same in every frame.
    pub fn image(
        &mut self,
        name: &'static str,
        number: usize,
        extent: [u32; 2],
        format: vk::Format,
    ) -> Image {
        self.described(name, number, |key| plain(key, extent, format))
    }

    /// The same, with two layers.
    pub fn array(&mut self, name: &'static str, extent: [u32; 2], format: vk::Format) -> Image {
        self.described(name, 0, |key| ImageDescription { layers: 2, ..plain(key, extent, format) })
    }

    /// The same, of any kind.
    pub fn described(
        &mut self,
        name: &'static str,
        number: usize,
        describe: impl FnOnce(ImageKey) -> ImageDescription,
    ) -> Image {
        let next = ImageKey(self.world.images.len() as u64 + 1);
        let description = describe(next);
        let named = (name, number, description.extent);
        if let Some(known) = self.world.named.get(&named) {
            return *known;
        }
        let image = self.world.made(|_| description);
        self.world.named.insert(named, image);
        image
    }

    /// An image that only this frame has.
    pub fn fresh(&mut self, extent: [u32; 2], format: vk::Format) -> Image {
        self.world.made(|key| plain(key, extent, format))
    }

    /// The image of the XR swapchain that this frame draws: of an eye, where each has its own.
    pub fn swapchain(&mut self, eye: usize) -> Image {
        let index = (self.number % 3) as usize;
        let [width, height] = self.eye;
        let (name, extent, layers) = match (self.arrangement, eye) {
            (Arrangement::Separate, 0) => ("left swapchain", [width, height], 1),
            (Arrangement::Separate, _) => ("right swapchain", [width, height], 1),
            (Arrangement::Array, _) => ("swapchain", [width, height], 2),
            (Arrangement::DoubleWide, _) => ("wide swapchain", [2 * width, height], 1),
        };
        let swapchain = Some(self.key(eye));
        self.described(name, index, |key| ImageDescription { layers, swapchain, ..plain(key, extent, LDR) })
    }

    fn key(&self, eye: usize) -> SwapchainKey {
        SwapchainKey(match self.arrangement {
            Arrangement::Separate => eye as u64 + 1,
            Arrangement::Array => 3,
            Arrangement::DoubleWide => 4,
        })
    }

    fn shown(&mut self) -> Shown {
        let views = [(0, Eye::Left), (1, Eye::Right)].map(|(index, eye)| {
            let image = self.swapchain(index).key;
            let is_wide = self.arrangement == Arrangement::DoubleWide;
            ShownView {
                eye: Some(eye),
                swapchain: self.key(index),
                image: Some(image),
                layer: if self.arrangement == Arrangement::Array { index as u32 } else { 0 },
                rect: [if is_wide { self.eye[0] * index as u32 } else { 0 }, 0, self.eye[0], self.eye[1]],
                is_upside_down: false,
            }
        });
        Shown { views: views.into_iter().collect(), ..Shown::default() }
    }

    /// Submits a pass.
    pub fn add(&mut self, step: Step) {
        let images = &self.world.images;
        // As in the layer, which follows descriptors of images that may hold a picture.
        let is_followed =
            |image: ImageKey| images.get(&image).is_some_and(|image| image.format != DEPTH && !image.is_cube);
        let step = if self.is_bindless { step.bindless() } else { step.reading(is_followed) };
        let Step { name, truth, pass } = step;
        let World { recognition, images, log, seen, verdicts, .. } = &mut *self.world;
        let begin = Instant::now();
        let outcome = recognition.of(&pass, log, |image| images.get(&image).copied());
        *verdicts += begin.elapsed();
        seen.push(Seen { frame: self.number, name, truth, outcome });
        log.push(Event::Pass(pass));
    }

    /// Copies as much of one image as the other has.
    pub fn copy(&mut self, from: Image, to: Image) {
        let rect = rect_of([0, 1].map(|axis: usize| from.extent[axis].min(to.extent[axis])));
        self.transfer(TransferKind::Copy, (from, rect), (to, rect));
    }

    /// Blits the whole of one image to the whole of another.
    pub fn blit(&mut self, from: Image, to: Image) {
        self.transfer(TransferKind::Blit, (from, rect_of(from.extent)), (to, rect_of(to.extent)));
    }

    /// Copies, blits or resolves.
    pub fn transfer(
        &mut self,
        kind: TransferKind,
        (from, from_rect): (Image, [i32; 4]),
        (to, to_rect): (Image, [i32; 4]),
    ) {
        let (from, to) = (from.target(), to.target());
        self.world.log.push(Event::Transfer(Transfer { kind, from, from_rect, to, to_rect }));
    }
}

/// The whole of a size.
pub fn rect_of([width, height]: [u32; 2]) -> [i32; 4] {
    [0, 0, width as i32, height as i32]
}

/// An image of one layer and one sample.
pub fn plain(key: ImageKey, extent: [u32; 2], format: vk::Format) -> ImageDescription {
    ImageDescription { key, extent, layers: 1, format, samples: 1, is_cube: false, swapchain: None }
}

/// Eye of view 0 or 1.
pub fn eye_of(view: usize) -> Option<Eye> {
    Some(if view == 0 { Eye::Left } else { Eye::Right })
}
