//! An application that does the work of a style of rendering by hand.

use crate::pass_detection::*;
use ash::vk;
use smallvec::{SmallVec, smallvec};
use std::collections::HashMap;

/// Pixels of an eye buffer.
pub const EYE: [u32; 2] = [200, 240];

pub const LDR: vk::Format = vk::Format::R8G8B8A8_SRGB;
pub const HDR: vk::Format = vk::Format::R16G16B16A16_SFLOAT;

/// From this frame on everything is to be recognised.
pub const SETTLED: u64 = 5;

pub type Outcome = Result<Match, Unmatched>;

/// An XR swapchain of three images.
#[derive(Clone, Copy)]
pub struct Chain {
    pub key: SwapchainKey,
    pub images: [ImageKey; 3],
    pub extent: [u32; 2],
}

#[derive(Default)]
pub struct Application {
    pub recognition: Recognition,
    images: HashMap<ImageKey, ImageDescription>,
    log: Vec<Event>,
    made: u64,
    /// Whether a pass has the same depth image in every frame.
    keeps_depth: bool,
    /// Number of the frame, from 1.
    pub frame: u64,
    /// Verdicts on passes when they were submitted, with their names.
    pub seen: Vec<(u64, &'static str, Outcome)>,
}

impl Application {
    /// An application whose passes have the same depth images in every frame.
    pub fn with_kept_depth() -> Self {
        Self { keeps_depth: true, ..Self::default() }
    }

    /// Runs some frames.
    pub fn run(&mut self, frames: u64, mut frame: impl FnMut(&mut Self)) {
        for _ in 0..frames {
            self.frame += 1;
            frame(self);
        }
    }

    pub fn image(&mut self, extent: [u32; 2], format: vk::Format) -> ImageKey {
        self.described(|key| description(key, extent, format))
    }

    /// The image of that key, the same in every frame.
    pub fn kept(&mut self, key: u64, extent: [u32; 2], format: vk::Format) -> ImageKey {
        let key = ImageKey(key);
        self.images.entry(key).or_insert_with(|| description(key, extent, format));
        key
    }

    pub fn described(&mut self, describe: impl FnOnce(ImageKey) -> ImageDescription) -> ImageKey {
        self.made += 1;
        let key = ImageKey(self.made);
        self.images.insert(key, describe(key));
        key
    }

    pub fn chain(&mut self, extent: [u32; 2], layers: u32) -> Chain {
        let swapchain = SwapchainKey(1000 + self.made);
        let images = [(); 3].map(|()| {
            self.described(|key| ImageDescription {
                layers,
                swapchain: Some(swapchain),
                ..description(key, extent, LDR)
            })
        });
        Chain { key: swapchain, images, extent }
    }

    /// One swapchain for each eye.
    pub fn eyes(&mut self) -> [Chain; 2] {
        [self.chain(EYE, 1), self.chain(EYE, 1)]
    }

    pub fn describe(&self, image: ImageKey) -> Option<ImageDescription> {
        self.images.get(&image).copied()
    }

    pub fn extent(&self, image: ImageKey) -> [u32; 2] {
        self.images[&image].extent
    }

    /// The image of a swapchain that this frame draws.
    pub fn current(&self, chain: &Chain) -> ImageKey {
        chain.images[self.frame as usize % 3]
    }

    /// A pass over the whole of an image, with depth that it clears.
    pub fn scene(&mut self, name: &'static str, image: ImageKey) {
        let mut pass = whole(self.extent(image), &[image]);
        self.add_depth(&mut pass);
        self.pass(name, pass);
    }

    /// A pass over the whole of an image, without depth.
    pub fn full_screen(&mut self, name: &'static str, image: ImageKey) {
        let pass = whole(self.extent(image), &[image]);
        self.pass(name, pass);
    }

    pub fn add_depth(&mut self, pass: &mut Pass) {
        let extent = [pass.area[2], pass.area[3]];
        let depth = match pass.colors.first().filter(|_| self.keeps_depth) {
            Some(color) => self.kept(2_000_000 + color.image.0, extent, vk::Format::D32_SFLOAT),
            None => self.image(extent, vk::Format::D32_SFLOAT),
        };
        pass.depth = Some(target(depth));
        pass.facts.clears_depth = true;
    }

    pub fn pass(&mut self, name: &'static str, pass: Pass) {
        let outcome = self.recognition.of(&pass, &self.log, |image| self.describe(image));
        self.seen.push((self.frame, name, outcome));
        self.log.push(Event::Pass(pass));
    }

    pub fn copy(&mut self, from: ImageKey, to: ImageKey) {
        let rect = |image| rect_of(self.extent(image));
        self.transfer(TransferKind::Copy, (from, rect(from)), (to, rect(from)));
    }

    pub fn blit(&mut self, from: (ImageKey, [i32; 4]), to: (ImageKey, [i32; 4])) {
        self.transfer(TransferKind::Blit, from, to);
    }

    pub fn transfer(
        &mut self,
        kind: TransferKind,
        (from, from_rect): (ImageKey, [i32; 4]),
        (to, to_rect): (ImageKey, [i32; 4]),
    ) {
        let (from, to) = (target(from), target(to));
        self.log.push(Event::Transfer(Transfer { kind, from, from_rect, to, to_rect }));
    }

    /// xrEndFrame.
    pub fn show(&mut self, shown: &Shown) {
        let images = &self.images;
        self.recognition.frame(&self.log, |image| images.get(&image).copied(), shown);
        self.log.clear();
    }

    /// A submission of the whole of one swapchain for each eye.
    pub fn both(&self, eyes: &[Chain; 2]) -> Shown {
        let view = |chain: &Chain, eye| ShownView { image: Some(self.current(chain)), ..view_of(chain, eye) };
        let [left, right] = eyes;
        Shown { views: smallvec![view(left, Eye::Left), view(right, Eye::Right)], ..Shown::default() }
    }

    /// The verdicts on a pass, frame by frame.
    pub fn outcomes(&self, name: &str) -> Vec<(u64, Outcome)> {
        let named = self.seen.iter().filter(|(_, other, _)| *other == name);
        named.map(|(frame, _, outcome)| (*frame, outcome.clone())).collect()
    }

    /// From frame 4 on the pass is this, in every frame in which it occurs.
    #[track_caller]
    pub fn expect(&self, name: &str, expected: &Outcome) {
        let outcomes = self.outcomes(name);
        let settled: Vec<_> = outcomes.iter().filter(|(frame, _)| *frame >= SETTLED).collect();
        assert!(!settled.is_empty(), "no pass {name}");
        for (frame, outcome) in settled {
            assert_eq!(outcome, expected, "{name}, frame {frame}");
        }
        // Before that frame, no match, or a finer one because it has more parts.
        let Ok(expected) = expected else { return };
        for (frame, outcome) in outcomes {
            let is_finer = |found: &Match| expected.parts.iter().all(|part| found.parts.contains(part));
            assert!(
                outcome.as_ref().is_ok_and(is_finer) || outcome.is_err(),
                "{name}, frame {frame}: {outcome:?}"
            );
        }
    }
}

pub fn description(key: ImageKey, extent: [u32; 2], format: vk::Format) -> ImageDescription {
    ImageDescription { key, extent, layers: 1, format, samples: 1, is_cube: false, swapchain: None }
}

pub fn target(image: ImageKey) -> Target {
    Target { image, level: 0, base_layer: 0, layers: 1 }
}

pub fn whole(extent: [u32; 2], colors: &[ImageKey]) -> Pass {
    Pass {
        colors: colors.iter().map(|image| target(*image)).collect(),
        resolves: SmallVec::new(),
        depth: None,
        area: [0, 0, extent[0], extent[1]],
        region: [0, 0, extent[0], extent[1]],
        view_mask: 0,
        facts: PassFacts::default(),
        unmasked: None,
        draws: None,
    }
}

/// Multiview of two.
pub fn multiview(mut pass: Pass) -> Pass {
    pass.view_mask = 0b11;
    for target in pass.colors.iter_mut().chain(&mut pass.resolves).chain(&mut pass.depth) {
        target.layers = 2;
    }
    pass
}

pub fn rect_of([width, height]: [u32; 2]) -> [i32; 4] {
    [0, 0, width as i32, height as i32]
}

pub fn view_of(chain: &Chain, eye: Eye) -> ShownView {
    ShownView {
        eye: Some(eye),
        swapchain: chain.key,
        image: None,
        layer: 0,
        rect: [0, 0, chain.extent[0], chain.extent[1]],
        is_upside_down: false,
    }
}

pub const WHOLE: [f32; 4] = [0.0, 0.0, 1.0, 1.0];
pub const LEFT_HALF: [f32; 4] = [0.0, 0.0, 0.5, 1.0];
pub const RIGHT_HALF: [f32; 4] = [0.5, 0.0, 0.5, 1.0];

/// Parts as (eyes, layer, rectangle), all one way up.
pub fn matched(how: How, orientation: Orientation, parts: &[(Eyes, u32, [f32; 4])]) -> Outcome {
    let part = |(eyes, layer, rect): &(Eyes, u32, [f32; 4])| Part {
        eyes: *eyes,
        layer: *layer,
        rect: *rect,
        orientation,
    };
    Ok(Match { parts: parts.iter().map(part).collect(), how })
}

/// The whole of it is one eye's.
pub fn one(how: How, orientation: Orientation, eyes: Eyes) -> Outcome {
    matched(how, orientation, &[(eyes, 0, WHOLE)])
}

/// The whole of it goes straight to the swapchain.
pub fn straight(eyes: Eyes) -> Outcome {
    one(How::Swapchain, Orientation::Upright, eyes)
}

/// The whole of it is transferred into the swapchain, upright.
pub fn transferred(eyes: Eyes) -> Outcome {
    one(How::Transferred, Orientation::Upright, eyes)
}

/// It looks like the scene.
pub fn looks(eyes: Eyes) -> Outcome {
    one(How::Shape, Orientation::Unknown, eyes)
}
