//! The uses of XR swapchains in submissions.

use super::memory::Memory;
use super::placement::{self, Areas, Placement, Placements};
use super::{HOLD, Parts};
use crate::pass_detection::{
    Eye, Eyes, ImageDescription, Orientation, Shown, ShownView, SwapchainKey, Target, Unmatched,
};

/// So many frames after it was last shown, a swapchain is forgotten.
const FORGOTTEN_AFTER: u64 = 600;

/// All swapchains that were shown.
#[derive(Debug, Default)]
pub(super) struct Swapchains {
    known: Vec<Swapchain>,
}

#[derive(Debug)]
struct Swapchain {
    key: SwapchainKey,
    /// Frame in which it was last shown, in any way.
    at: u64,
    /// The eye buffers in its images.
    placements: Placements,
    /// Render areas of the passes that drew the image which was shown.
    areas: Areas,
    /// Size of its images, pixels; 0 before one of them occurred.
    extent: [u32; 2],
    has_inset: bool,
    flat_at: Option<u64>,
    unsteady_at: Option<u64>,
}

/// So many frames after a picture changed its rectangle without the render area, it is not steady.
pub(super) const UNSTEADY: u64 = 10;

impl Swapchains {
    /// Takes the submission of a frame.
    pub(super) fn show(&mut self, frame: u64, shown: &Shown, memory: &mut Memory) {
        for key in &shown.flat {
            let swapchain = self.entry(*key);
            (swapchain.at, swapchain.flat_at) = (frame, Some(frame));
        }
        for (index, view) in shown.views.iter().enumerate() {
            let is_first = shown.views[..index].iter().all(|other| other.swapchain != view.swapchain);
            if is_first {
                let views = shown.views.iter().filter(|other| other.swapchain == view.swapchain);
                self.entry(view.swapchain).project(frame, views, memory);
            }
        }
    }

    fn entry(&mut self, key: SwapchainKey) -> &mut Swapchain {
        let index = self.known.iter().position(|known| known.key == key).unwrap_or_else(|| {
            self.known.push(Swapchain {
                key,
                at: 0,
                placements: Placements::new(),
                areas: Areas::new(),
                extent: [0; 2],
                has_inset: false,
                flat_at: None,
                unsteady_at: None,
            });
            self.known.len() - 1
        });
        &mut self.known[index]
    }

    /// The swapchain of an image, if it was shown lately. An API layer between the application and the runtime may draw the application's
    /// swapchains into its own, and show only these: the images of the others are like any off-screen one.
    pub(super) fn shown_of(&self, image: Option<ImageDescription>) -> Option<SwapchainKey> {
        image?.swapchain.filter(|key| self.get(*key).is_some())
    }

    fn get(&self, key: SwapchainKey) -> Option<&Swapchain> {
        self.known.iter().find(|known| known.key == key)
    }

    /// The parts of `target`, an image of the swapchain, that a pass with the render area `area` draws.
    pub(super) fn parts(
        &self,
        frame: u64,
        key: SwapchainKey,
        target: &Target,
        area: [u32; 4],
    ) -> Result<Parts, Unmatched> {
        let swapchain = self.get(key).ok_or(Unmatched::NotShown)?;
        if self.is_flat(frame, key) {
            return Err(Unmatched::Flat);
        }
        let parts = placement::parts(&swapchain.placements, &swapchain.areas, target, area);
        if parts.is_empty() {
            return Err(if swapchain.has_inset { Unmatched::Inset } else { Unmatched::NotShown });
        }
        let unsteady = swapchain.unsteady_at.is_some_and(|at| frame < at + UNSTEADY);
        if unsteady { Err(Unmatched::Unsteady) } else { Ok(parts) }
    }

    /// Placements of eye buffers in its images.
    pub(super) fn placements(&self, key: SwapchainKey) -> &[Placement] {
        self.get(key).map_or(&[], |swapchain| &swapchain.placements)
    }

    /// Whether it was lately shown in a quad or the like.
    pub(super) fn is_flat(&self, frame: u64, key: SwapchainKey) -> bool {
        self.get(key).and_then(|swapchain| swapchain.flat_at).is_some_and(|at| frame < at + HOLD)
    }

    /// Whether an eye buffer lies in these layers.
    pub(super) fn shows_eyes(&self, key: SwapchainKey, target: &Target) -> bool {
        let within = |layer: u32| layer.checked_sub(target.base_layer).is_some_and(|at| at < target.layers);
        target.level == 0 && self.placements(key).iter().any(|placement| within(placement.layer))
    }

    /// All eye buffers, and whether they fill the render area: if the viewport is smaller, it may be so in the passes before, at an
    /// unknown place.
    pub(super) fn pictures(&self) -> impl Iterator<Item = (&Placement, bool)> {
        self.known.iter().flat_map(|swapchain| {
            let is_filled = swapchain.is_filled();
            swapchain.placements.iter().map(move |placement| (placement, is_filled))
        })
    }

    /// Size of an eye's smallest image, pixels; 0 without any.
    pub(super) fn least_picture(&self) -> [f32; 2] {
        let sizes = self.pictures().map(|(picture, _)| [picture.rect[2], picture.rect[3]]);
        sizes.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]).unwrap_or_default()
    }

    /// Number of eye buffers in all swapchains.
    pub(super) fn count_pictures(&self) -> usize {
        self.known.iter().map(|swapchain| swapchain.placements.len()).sum()
    }

    /// Whether both eyes lie beside each other in one image, the left one on the left.
    pub(super) fn are_beside(&self) -> bool {
        let are_beside = |a: &Placement, b: &Placement| {
            (a.eyes, b.eyes, a.layer) == (Eyes::Left, Eyes::Right, b.layer)
                && a.rect[0] + a.rect[2] <= b.rect[0]
        };
        self.known
            .iter()
            .map(|swapchain| &swapchain.placements)
            .any(|placements| placements.iter().any(|a| placements.iter().any(|b| are_beside(a, b))))
    }

    /// Forgets a swapchain that is gone.
    pub(super) fn forget_one(&mut self, key: SwapchainKey) {
        self.known.retain(|swapchain| swapchain.key != key);
    }

    /// Forgets swapchains that were not shown for long.
    pub(super) fn forget(&mut self, frame: u64) {
        self.known.retain(|swapchain| frame < swapchain.at + FORGOTTEN_AFTER);
    }
}

impl Swapchain {
    /// Whether a pass that draws it, or else its images, are as large as a picture or all of them.
    fn is_filled(&self) -> bool {
        let [width, height] = self.extent;
        let images: &[[u32; 4]] = &[[0, 0, width, height]];
        let areas = if self.areas.is_empty() { images } else { &self.areas };
        areas.iter().any(|area| placement::is_picture(&self.placements, *area))
    }

    fn project<'a>(
        &mut self,
        frame: u64,
        views: impl Iterator<Item = &'a ShownView> + Clone,
        memory: &mut Memory,
    ) {
        let placements: Placements = views.clone().filter_map(placement_of).collect();
        let mut areas = Areas::new();
        for image in views.clone().filter_map(|view| view.image) {
            memory.shown(image, &mut areas);
        }
        if areas.is_empty() {
            memory.shown_of(frame, self.key, &mut areas);
        }
        let same_areas = !areas.is_empty() && areas == self.areas;
        if same_areas && self.at > 0 && placements != self.placements {
            self.unsteady_at = Some(frame);
        }
        if !areas.is_empty() {
            self.areas = areas;
        }
        self.extent = memory.extent_of(self.key).unwrap_or(self.extent);
        self.at = frame;
        self.placements = placements;
        self.has_inset = views.clone().any(|view| view.eye.is_none());
    }
}

fn placement_of(view: &ShownView) -> Option<Placement> {
    let eyes = match view.eye? {
        Eye::Left => Eyes::Left,
        Eye::Right => Eyes::Right,
    };
    let orientation = if view.is_upside_down { Orientation::UpsideDown } else { Orientation::Upright };
    let has_size = view.rect[2] > 0 && view.rect[3] > 0;
    has_size.then(|| Placement {
        eyes,
        layer: view.layer,
        rect: view.rect.map(|pixels| pixels as f32),
        orientation,
    })
}
