//! The pictures of the last frames, which still lie in the application's images: stale tiles are taken from them.
//!
//! A picture is kept from the frame that shows it first, with that frame's pose and field of view and the tiles that its passes left out,
//! until the application draws to its image again. No colour is copied, and re-used content is never re-used again. Depth, where it is
//! submitted, is the runtime's image after its frame, so it is copied.

mod ahead;
mod lists;

pub use ahead::{Expected, SortedTiles};

use crate::config::{Config, ReuseMode, longest_period};
use crate::kernels::change::ChangeRegion;
use crate::kernels::compose::{EarlierImage, PictureDepth, ReuseRegion};
use crate::planner::Watched;
use crate::xr::swapchain::NewestDepth;
use ash::vk;
use glam::Quat;
use lists::EyeLists;
use openxr_sys as xr;
use parafovea_core::geometry::View;
use parafovea_core::kernels::compose::DepthRect;
use parafovea_core::reuse::{MAX_AGES, Picture, Reuse, StaleTiles, Viewpoint};
use std::array;

/// Pictures that are further apart than this, nanoseconds, are not of one run: the application paused, or was hidden.
const LONGEST_GAP_NS: i64 = 100_000_000;

/// Parameters for completing pictures from earlier ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompletionSettings {
    /// Whether re-used tiles are turned with the head; else they stay where they were in the picture (paper B).
    pub turns: bool,
    /// Width of the border in which fresh pixels beside re-used ones are blended, pixels.
    pub border: f32,
    /// Greatest age of a tile that is taken from one picture, in pictures. Of an older tile, a part that a newer picture has is taken
    /// from that picture.
    pub oldest: usize,
}

impl CompletionSettings {
    /// As paper B does.
    pub const PAPER: Self = Self { turns: false, border: 0.0, oldest: MAX_AGES };
    /// From a configuration.
    pub fn of(config: &Config) -> Self {
        let settings = if config.reuse.mode == ReuseMode::Paper { Self::PAPER } else { Self::TURNED };
        Self { oldest: longest_period(config) as usize, ..settings }
    }

    /// Turned with the head.
    pub const TURNED: Self = Self { turns: true, border: 4.0, oldest: MAX_AGES };

    /// The same, but without a turn where the pictures are in different spaces.
    fn unless(self, has_moved: bool) -> Self {
        if has_moved { Self { oldest: self.oldest, ..Self::PAPER } } else { self }
    }

    /// Width of blended borders, pixels; 0 while the head stands still: both sides of a border are then of one picture, except for moving
    /// content.
    fn border_of(&self, reuse: &Reuse) -> f32 {
        if reuse.is_still() { 0.0 } else { self.border }
    }
}

/// The last eye buffers of both eyes.
#[derive(Debug, Default)]
pub struct History {
    eyes: [EyeHistory; 2],
}

/// The depth of a picture, as a frame submits it.
#[derive(Debug, Clone)]
pub struct ShownDepth {
    /// Its path.
    pub newest: NewestDepth,
    /// Array layer.
    pub array_layer: u32,
    /// Rectangle within the image.
    pub rect: DepthRect,
    /// The submitted view and its position.
    pub viewpoint: Viewpoint,
}

/// A picture as a frame shows it.
#[derive(Debug, Clone, Copy)]
pub struct ShownEyeBuffer {
    /// Number of its virtual swapchain.
    pub substitute: u64,
    /// The space of its pose.
    pub space: xr::Space,
    /// Whether that space rests in the world: in others, pictures cannot be turned to each other.
    pub rests: bool,
    /// Display time.
    pub time: xr::Time,
    /// Number of its release, counted from 1.
    pub release: u64,
    /// Whether it is a copy of the picture before, drawn by no pass of this frame.
    pub is_copied: bool,
    /// Index of the application's image that contains it.
    pub image_index: u32,
    /// Array layer of that image.
    pub array_layer: u32,
    /// Rectangle within the image.
    pub rect: vk::Rect2D,
    /// Orientation of its view, and its image plane.
    pub view: View,
}

impl History {
    /// Takes the eye buffer (0: left, 1: right) that a frame shows, or none. `is_intact` returns whether the picture of a release is
    /// still intact, and `stale` writes the stale tiles of this one. Its depth comes with it, if that was copied.
    ///
    /// Returns whether this is a new picture that goes on from the one before, in one swapchain and one space: then the next one probably does,
    /// too, and can be completed. After a picture that is shown again, the next one is rendered whole: the schedule counts frames, and an
    /// application that draws each eye in every other frame would never draw some of its tiles.
    pub fn show(
        &mut self,
        eye: usize,
        shown: Option<(&ShownEyeBuffer, Option<ShownDepth>)>,
        is_intact: impl Fn(u64) -> bool,
        stale: impl FnOnce(&mut StaleTiles),
    ) -> bool {
        let history = &mut self.eyes[eye];
        match shown {
            Some(shown) => history.show(shown, is_intact, stale),
            None => {
                history.keep(0);
                false
            }
        }
    }

    /// Whether an eye has pictures, of this swapchain.
    pub fn is_of(&self, eye: usize, substitute: u64) -> bool {
        let EyeHistory { len, of, .. } = &self.eyes[eye];
        *len > 0 && of.is_some_and(|(known, _)| known == substitute)
    }

    /// Whether the newest eye buffer of an eye can be followed as the head moves: it has depth, and so has the picture before it.
    pub fn has_depth(&self, eye: usize) -> bool {
        let EyeHistory { pictures, len, .. } = &self.eyes[eye];
        *len > 1 && pictures[..2].iter().all(|kept| kept.depth.is_some())
    }

    /// Whether an eye has any picture.
    pub fn has_pictures(&self, eye: usize) -> bool {
        self.eyes[eye].len > 0
    }

    /// Assigns the stale tiles of an eye's newest picture to earlier pictures, and finds its tiles to compare with them: rendered tiles with
    /// a watched middle, or none if `settings` do not turn pictures. Tiles of `sorted` are taken if they belong to this picture.
    pub fn complete(
        &mut self,
        eye: usize,
        settings: CompletionSettings,
        watched: Option<&Watched>,
        sorted: Option<&mut SortedTiles>,
    ) {
        let EyeHistory { pictures, len, lists, has_moved, .. } = &mut self.eyes[eye];
        let (pictures, settings) = (&pictures[..*len], settings.unless(*has_moved));
        if sorted.is_none_or(|sorted| !sorted.take(eye, pictures, settings, watched, lists)) {
            lists.update(pictures.iter().map(Kept::picture), settings, watched);
        }
    }

    /// Sets an eye's part of `sorted` to the input of the next [`Self::complete`], if its next picture is as `expected`.
    pub fn expect(&self, eye: usize, sorted: &mut SortedTiles, expected: Expected) {
        let EyeHistory { pictures, len, lost, .. } = &self.eyes[eye];
        sorted.expect(eye, &pictures[..*len], *lost, expected);
    }

    /// The comparisons that [`Self::complete`] found, of a view that is turned so in the world; `None` if there is nothing to compare.
    pub fn changes(
        &self,
        eye: usize,
        settings: CompletionSettings,
        orientation: Quat,
    ) -> Option<ChangeRegion<'_>> {
        let EyeHistory { pictures, len, lists: EyeLists { compared, .. }, has_moved, .. } = &self.eyes[eye];
        let settings = settings.unless(*has_moved);
        let (newest, earlier) = pictures[..*len].split_first().filter(|_| compared.count() > 0)?;
        let reuse = Reuse::new(newest.picture(), earlier.iter().map(Kept::picture), settings.turns);
        Some(ChangeRegion {
            array_layer: newest.image.array_layer,
            offset: newest.image.offset,
            tiles: compared,
            earlier: earlier_images(&pictures[..*len]),
            view: View { orientation, plane: lists::of_tiles(&reuse) },
            depth: newest.picture_depth(),
            reuse,
        })
    }

    /// The re-use that [`Self::complete`] worked out; `None` if the newest picture is complete.
    pub fn region(&self, eye: usize, settings: CompletionSettings) -> Option<ReuseRegion<'_>> {
        let EyeHistory { pictures, len, lists: EyeLists { lists, .. }, has_moved, .. } = &self.eyes[eye];
        let (pictures, settings) = (&pictures[..*len], settings.unless(*has_moved));
        let [width, height] = pictures.first()?.extent;
        let EarlierImage { array_layer, offset: [x, y], .. } = pictures[0].image;
        let reuse = lists::reuse(pictures.iter().map(Kept::picture), settings)?;
        Some(ReuseRegion {
            array_layer,
            rect: vk::Rect2D {
                offset: vk::Offset2D { x: x as i32, y: y as i32 },
                extent: vk::Extent2D { width, height },
            },
            lists,
            earlier: earlier_images(pictures),
            border: settings.border_of(&reuse),
            depth: pictures[0].picture_depth(),
            earlier_depth: array::from_fn(|index| pictures.get(index + 1).and_then(Kept::picture_depth)),
            reuse,
        })
    }
}

fn earlier_images(pictures: &[Kept]) -> [EarlierImage; MAX_AGES] {
    array::from_fn(|age| pictures.get(age + 1).map_or_else(EarlierImage::default, |kept| kept.image))
}

/// Of one eye.
#[derive(Debug, Default)]
struct EyeHistory {
    /// The newest first. Elements beyond [`Self::len`] are memory to be used again.
    pictures: Vec<Kept>,
    len: usize,
    /// The swapchain of all of them, and the space of the newest.
    of: Option<(u64, xr::Space)>,
    /// Number of pictures pushed so far.
    pushed: u64,
    /// Number of pictures dropped when the newest one was shown.
    lost: usize,
    /// Whether the newest picture is in another space than the others, or in one that moves, so that it cannot be turned to them.
    has_moved: bool,
    lists: EyeLists,
}

/// One picture.
#[derive(Debug)]
struct Kept {
    /// The number of the eye buffer, counted from 1: its content stays the same, but for its depth.
    number: u64,
    release: u64,
    image: EarlierImage,
    extent: [u32; 2],
    view: View,
    time: xr::Time,
    stale: StaleTiles,
    depth: Option<ShownDepth>,
}

impl Kept {
    fn new(number: u64, (shown, depth): (&ShownEyeBuffer, Option<ShownDepth>), stale: StaleTiles) -> Self {
        let vk::Rect2D { offset, extent } = shown.rect;
        Self {
            number,
            release: shown.release,
            image: EarlierImage {
                app_index: shown.image_index,
                array_layer: shown.array_layer,
                offset: [offset.x as u32, offset.y as u32],
            },
            extent: [extent.width, extent.height],
            view: shown.view,
            time: shown.time,
            stale,
            depth,
        }
    }

    fn picture(&self) -> Picture<'_> {
        Picture { view: self.view, extent: self.extent, stale: &self.stale, viewpoint: self.viewpoint() }
    }

    fn viewpoint(&self) -> Option<Viewpoint> {
        self.depth.as_ref().map(|depth| depth.viewpoint)
    }

    fn picture_depth(&self) -> Option<PictureDepth<'_>> {
        self.depth.as_ref().map(|depth| PictureDepth {
            kept: &depth.newest.kept,
            copy: depth.newest.copy,
            array_layer: depth.array_layer,
            rect: depth.rect,
        })
    }
}

impl EyeHistory {
    fn show(
        &mut self,
        (shown, depth): (&ShownEyeBuffer, Option<ShownDepth>),
        is_intact: impl Fn(u64) -> bool,
        stale: impl FnOnce(&mut StaleTiles),
    ) -> bool {
        if self.has_moved {
            // All but the newest are in a space that the application has left.
            self.keep(self.len.min(1));
        }
        let (was_of, was_in) = self.of.unzip();
        let last = self.pictures.first().filter(|_| was_of == Some(shown.substitute));
        // Even after a pause or a frame without pictures: its stale tiles remain, and the runtime's picture is complete.
        let is_again = last.is_some_and(|last| last.release == shown.release);
        let last = last.filter(|_| self.len > 0);
        let gap = last.map(|last| shown.time.as_nanos().saturating_sub(last.time.as_nanos()));
        let goes_on = gap.is_some_and(|gap| (0..=LONGEST_GAP_NS).contains(&gap));
        if !goes_on {
            self.len = 0;
        }
        self.has_moved = goes_on && (was_in != Some(shown.space) || !shown.rests);
        self.of = Some((shown.substitute, shown.space));
        match self.pictures.first_mut().filter(|_| is_again) {
            // The same picture again, even if it is submitted with another pose.
            Some(newest) => {
                newest.time = shown.time;
                self.len = self.len.max(1);
            }
            None => self.push((shown, depth), stale),
        }
        let earlier = self.pictures[1..self.len].iter();
        let intact = 1 + earlier.take_while(|kept| is_intact(kept.release)).count();
        self.lost = self.len - intact;
        self.keep(intact);
        goes_on && !is_again && shown.rests && !self.has_moved
    }

    /// Keeps that many pictures, with their depth if that is still available.
    fn keep(&mut self, len: usize) {
        self.len = len;
        for (index, kept) in self.pictures.iter_mut().enumerate() {
            let has_copy = |depth: &ShownDepth| depth.newest.kept.has_copy(depth.newest.copy);
            kept.depth = kept.depth.take().filter(|depth| index < len && has_copy(depth));
        }
    }

    fn push(&mut self, shown: (&ShownEyeBuffer, Option<ShownDepth>), stale: impl FnOnce(&mut StaleTiles)) {
        let mut tiles = match self.pictures.len() > MAX_AGES {
            true => self.pictures.pop().map(|kept| kept.stale).unwrap_or_default(),
            false => StaleTiles::default(),
        };
        match self.pictures.first().filter(|_| shown.0.is_copied && self.len > 0) {
            Some(before) => tiles.clone_from(&before.stale),
            None => stale(&mut tiles),
        }
        self.pushed += 1;
        self.pictures.insert(0, Kept::new(self.pushed, shown, tiles));
        self.len = (self.len + 1).min(self.pictures.len());
    }
}

#[cfg(test)]
mod tests;
