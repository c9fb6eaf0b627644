//! Memory of images.

use super::feedback::{EyePicture, images_read};
use super::placement::{self, Areas, Placement, Placements};
use super::projected::UNSTEADY;
use super::provenance::Role;
use super::roles::Roles;
use super::{HOLD, Parts};
use crate::pass_detection::{
    Event, Eyes, ImageDescription, ImageKey, Shown, SwapchainKey, Target, Unmatched,
};
use rustc_hash::FxHashMap;

/// Number of frames with an image, but without new evidence, after which knowledge of the image is dropped.
const MOST_MISSES: u32 = 60;

/// Number of frames after its last use, after which an image is forgotten.
const FORGOTTEN_AFTER: u64 = 120;

/// Number of frames for which an image counts as young.
const YOUNG: u64 = 3;

/// All images that lately occurred.
#[derive(Debug, Default)]
pub(super) struct Memory {
    images: FxHashMap<ImageKey, Image>,
    /// Roles of the passes that drew the images of a swapchain, which take turns.
    of_swapchains: FxHashMap<SwapchainKey, Roles>,
}

#[derive(Debug)]
struct Image {
    description: ImageDescription,
    /// First frame with it.
    met_at: u64,
    /// Last frame with it.
    at: u64,
    /// Last frame with a pass that draws it; 0 before any.
    drawn_at: u64,
    /// Render areas of the passes that drew it since it was last read or shown.
    areas: Areas,
    is_used: bool,
    /// Eye buffers that are made of it by transfers.
    placed: Placed,
    /// Its content becomes an eye buffer.
    precedes: Evidence,
    /// Roles of the passes that drew it, in their order.
    roles: Roles,
    flat_at: Option<u64>,
    /// Last event that made it an eye buffer, or a stage of one; None if it holds something else.
    eye_picture: Option<EyePicture>,
}

#[derive(Debug, Default)]
struct Placed {
    evidence: Evidence,
    placements: Placements,
    /// Render areas of the passes that drew the transferred picture.
    areas: Areas,
    /// Both, as they were before the frame `remembered_at`.
    before: (Placements, Areas),
    remembered_at: u64,
    unsteady_at: Option<u64>,
    /// The last frame that made the other eye's picture of the same rectangle.
    alternated_at: Option<u64>,
}

/// Something that earlier frames have shown.
#[derive(Clone, Copy, Debug, Default)]
struct Evidence {
    /// Last frame that showed it; 0: none.
    at: u64,
    /// Frames since then in which it could have been shown.
    misses: u32,
}

impl Evidence {
    fn confirm(&mut self, frame: u64) {
        *self = Self { at: frame, misses: 0 };
    }

    fn miss(&mut self, frame: u64) {
        if self.at != frame {
            self.misses = self.misses.saturating_add(1);
        }
    }

    fn holds(self) -> bool {
        self.at > 0 && self.misses < MOST_MISSES
    }
}

impl Memory {
    /// Takes the images of a frame's events, first to last, and the `shown` ones, which compute may have written.
    pub(super) fn meet(
        &mut self,
        frame: u64,
        events: &[Event],
        shown: &Shown,
        describe: impl Fn(ImageKey) -> Option<ImageDescription>,
    ) {
        for image in shown.views.iter().filter_map(|view| view.image) {
            self.entry(frame, image, &describe);
        }
        for event in events {
            match event {
                Event::Pass(pass) => {
                    // Depth counts only where there is nothing else: for the listing.
                    let depth = pass.depth.iter().filter(|_| pass.colors.is_empty());
                    for target in pass.colors.iter().chain(&pass.resolves).chain(depth) {
                        if let Some(image) = self.entry(frame, target.image, &describe) {
                            image.draw(frame, target, pass.area);
                        }
                    }
                    // Compute writes images that no event names.
                    for image in images_read(pass) {
                        self.entry(frame, image, &describe);
                    }
                }
                Event::Transfer(transfer) => {
                    self.entry(frame, transfer.to.image, &describe);
                    if let Some(image) = self.entry(frame, transfer.from.image, &describe) {
                        image.read(frame);
                    }
                }
            }
        }
    }

    fn entry(
        &mut self,
        frame: u64,
        key: ImageKey,
        describe: impl Fn(ImageKey) -> Option<ImageDescription>,
    ) -> Option<&mut Image> {
        use std::collections::hash_map::Entry;
        let image = match self.images.entry(key) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(vacant) => vacant.insert(Image::new(describe(key)?, frame)),
        };
        image.at = frame;
        Some(image)
    }

    /// Forgets the roles of passes that drew a swapchain, which is gone.
    pub(super) fn forget_swapchain(&mut self, swapchain: SwapchainKey) {
        self.of_swapchains.remove(&swapchain);
    }

    pub(super) fn description(&self, image: ImageKey) -> Option<ImageDescription> {
        self.images.get(&image).map(|image| image.description)
    }

    pub(super) fn is_known(&self, image: ImageKey) -> bool {
        self.images.contains_key(&image)
    }

    /// Whether it was first met lately, or never.
    pub(super) fn is_young(&self, frame: u64, image: ImageKey) -> bool {
        self.images.get(&image).is_none_or(|image| frame < image.met_at + YOUNG)
    }

    /// Whether a pass draws it, as far as is known.
    pub(super) fn is_drawn(&self, image: ImageKey) -> bool {
        self.images.get(&image).is_some_and(|image| image.drawn_at > 0)
    }

    /// Takes note that an image is shown: adds the render areas of the passes that drew it.
    pub(super) fn shown(&mut self, image: ImageKey, areas: &mut Areas) {
        if let Some(image) = self.images.get_mut(&image) {
            image.show(areas);
        }
    }

    /// The same for those images of `swapchain` that were drawn in this frame, where it is not known which is shown.
    pub(super) fn shown_of(&mut self, frame: u64, swapchain: SwapchainKey, areas: &mut Areas) {
        let is_drawn =
            |image: &&mut Image| image.drawn_at == frame && image.description.swapchain == Some(swapchain);
        for image in self.images.values_mut().filter(is_drawn) {
            image.show(areas);
        }
    }

    /// The size of a swapchain's images, pixels, where one of them occurred.
    pub(super) fn extent_of(&self, swapchain: SwapchainKey) -> Option<[u32; 2]> {
        let mut own = self.images.values().filter(|image| image.description.swapchain == Some(swapchain));
        own.next().map(|image| image.description.extent)
    }

    /// The parts of `target` that a pass with the render area `area` draws. [`Unmatched::New`] where nothing is known.
    pub(super) fn parts(&self, frame: u64, target: &Target, area: [u32; 4]) -> Result<Parts, Unmatched> {
        let image = self.images.get(&target.image).ok_or(Unmatched::New)?;
        if image.is_flat(frame) {
            return Err(Unmatched::Flat);
        }
        let placed = &image.placed;
        if !placed.evidence.holds() {
            return Err(Unmatched::New);
        }
        let is_recent = |at: Option<u64>| at.is_some_and(|at| frame < at + UNSTEADY);
        if is_recent(placed.unsteady_at) {
            return Err(Unmatched::Unsteady);
        }
        let mut parts = placement::parts(&placed.placements, &placed.areas, target, area);
        if is_recent(placed.alternated_at) {
            parts.iter_mut().for_each(|part| part.eyes = Eyes::Finer);
        }
        if parts.is_empty() { Err(Unmatched::NotShown) } else { Ok(parts) }
    }

    /// The eye buffers that transfers make of it.
    pub(super) fn placements(&self, image: ImageKey) -> &[Placement] {
        match self.images.get(&image) {
            Some(image) if image.placed.evidence.holds() => &image.placed.placements,
            _ => &[],
        }
    }

    /// Whether transfers make an eye buffer of it, and nothing flat.
    pub(super) fn is_placed(&self, frame: u64, image: ImageKey) -> bool {
        !self.is_flat(frame, image) && !self.placements(image).is_empty()
    }

    /// Takes note of a picture that is made of an image in this frame.
    pub(super) fn place(&mut self, frame: u64, image: ImageKey, placement: Placement) {
        if let Some(image) = self.images.get_mut(&image) {
            image.placed.add(frame, placement);
        }
    }

    pub(super) fn is_flat(&self, frame: u64, image: ImageKey) -> bool {
        self.images.get(&image).is_some_and(|image| image.is_flat(frame))
    }

    pub(super) fn set_flat(&mut self, frame: u64, image: ImageKey) {
        if let Some(image) = self.images.get_mut(&image) {
            image.flat_at = Some(frame);
        }
    }

    pub(super) fn precedes(&self, image: ImageKey) -> bool {
        self.images.get(&image).is_some_and(|image| image.precedes.holds())
    }

    pub(super) fn set_precedes(&mut self, frame: u64, image: ImageKey) {
        if let Some(image) = self.images.get_mut(&image) {
            image.precedes.confirm(frame);
        }
    }

    /// Notes the role of the next pass to draw an image in this frame, with depth or without.
    pub(super) fn add_role(&mut self, frame: u64, image: ImageKey, has_depth: bool, role: Role) {
        let Some(image) = self.images.get_mut(&image) else { return };
        let roles = match image.description.swapchain {
            Some(swapchain) => self.of_swapchains.entry(swapchain).or_default(),
            None => &mut image.roles,
        };
        roles.add(frame, has_depth, role);
    }

    /// Role of pass number `ordinal`, from 0, among the passes with depth, or without, of an image in this frame, by the evidence of
    /// earlier frames.
    pub(super) fn role(
        &self,
        frame: u64,
        image: &ImageDescription,
        has_depth: bool,
        ordinal: impl FnOnce() -> usize,
    ) -> Role {
        let roles = match image.swapchain {
            Some(swapchain) => self.of_swapchains.get(&swapchain),
            None => self.images.get(&image.key).map(|image| &image.roles),
        };
        roles.map_or(Role::Unknown, |roles| roles.of(frame, has_depth, ordinal))
    }

    /// Last event that made an image an eye buffer.
    pub(super) fn eye_picture(&self, image: ImageKey) -> Option<EyePicture> {
        self.images.get(&image)?.eye_picture
    }

    /// Sets the current content of an image: an eye buffer, or `None` for anything else.
    pub(super) fn set_eye_picture(&mut self, image: ImageKey, picture: Option<EyePicture>) {
        if let Some(image) = self.images.get_mut(&image) {
            image.eye_picture = picture;
        }
    }

    /// Looks which images' pictures moved, or changed their eye, while the passes that draw them did not.
    pub(super) fn compare(&mut self, frame: u64) {
        for image in self.images.values_mut() {
            image.placed.compare(frame);
        }
    }

    /// Counts for images that occur in this frame the parts that this frame did not confirm.
    pub(super) fn count_misses(&mut self, frame: u64) {
        for image in self.images.values_mut().filter(|image| image.at == frame) {
            image.placed.evidence.miss(frame);
            image.precedes.miss(frame);
        }
    }

    /// Forgets images that did not occur for long.
    pub(super) fn forget(&mut self, frame: u64) {
        self.images.retain(|_, image| frame < image.at + FORGOTTEN_AFTER);
        self.of_swapchains.retain(|_, roles| frame < roles.at() + FORGOTTEN_AFTER);
    }
}

impl Image {
    fn new(description: ImageDescription, frame: u64) -> Self {
        Self {
            description,
            met_at: frame,
            at: frame,
            drawn_at: 0,
            areas: Areas::new(),
            is_used: false,
            placed: Placed::default(),
            precedes: Evidence::default(),
            roles: Roles::default(),
            flat_at: None,
            eye_picture: None,
        }
    }

    fn is_flat(&self, frame: u64) -> bool {
        self.flat_at.is_some_and(|at| frame < at + HOLD)
    }

    fn draw(&mut self, frame: u64, target: &Target, area: [u32; 4]) {
        self.drawn_at = frame;
        if target.level > 0 {
            return;
        }
        if self.is_used {
            self.areas.clear();
            self.is_used = false;
        }
        add_areas(&mut self.areas, &[area]);
    }

    fn show(&mut self, areas: &mut Areas) {
        add_areas(areas, &self.areas);
        self.is_used = true;
    }

    fn read(&mut self, frame: u64) {
        self.is_used = true;
        self.placed.remember(frame);
        if !self.areas.is_empty() {
            self.placed.areas.clone_from(&self.areas);
        }
    }
}

impl Placed {
    /// Keeps the former knowledge, once, before a frame's first change.
    fn remember(&mut self, frame: u64) {
        if self.remembered_at != frame {
            self.remembered_at = frame;
            self.before.0.clone_from(&self.placements);
            self.before.1.clone_from(&self.areas);
        }
    }

    fn add(&mut self, frame: u64, placement: Placement) {
        if self.evidence.at != frame {
            self.placements.clear();
            self.evidence.confirm(frame);
        }
        placement::add(&mut self.placements, placement);
    }

    fn compare(&mut self, frame: u64) {
        let (placements, areas) = &self.before;
        let is_compared = self.evidence.at == frame && !areas.is_empty();
        if !is_compared || *areas != self.areas || *placements == self.placements {
            return;
        }
        let at_any_eye = |placements: &[Placement]| -> Placements {
            placements.iter().map(|placement| Placement { eyes: Eyes::Finer, ..*placement }).collect()
        };
        if at_any_eye(placements) == at_any_eye(&self.placements) {
            self.alternated_at = Some(frame);
        } else {
            self.unsteady_at = Some(frame);
        }
    }
}

/// Adds areas that are not there yet, as far as they are few.
fn add_areas(areas: &mut Areas, more: &[[u32; 4]]) {
    for area in more {
        if areas.len() < areas.inline_size() && !areas.contains(area) {
            areas.push(*area);
        }
    }
}
