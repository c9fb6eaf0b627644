//! Sorting the tiles of eye images ahead of xrEndFrame. A planned frame has known stale tiles, and views that applications rarely change. The
//! session's plan thread sorts the tiles while the application draws; xrEndFrame takes its lists if stale tiles, views and earlier images are
//! as expected, and sorts the tiles itself if not: the result is the same.

use super::lists::EyeLists;
use super::{CompletionSettings, Kept};
use crate::planner;
use crate::planner::Watched;
use glam::{Quat, Vec2};
use parafovea_core::geometry::{ImagePlane, View};
use parafovea_core::reuse::{Picture, StaleTiles, Viewpoint};

/// The expected next eye buffer of an eye.
pub struct Expected<'a> {
    /// Settings of its completion.
    pub settings: CompletionSettings,
    /// The directions to compare with earlier pictures.
    pub watched: Option<Watched>,
    /// Pose and field of view; the image has the size of the last one.
    pub view: planner::View,
    /// Writes its stale tiles.
    pub stale: &'a dyn Fn(&mut StaleTiles),
}

/// The tiles of a frame's expected pictures.
#[derive(Debug, Default)]
pub struct SortedTiles {
    eyes: [EyeTiles; 2],
}

/// The tiles of the expected eye buffer of an eye, and their input.
#[derive(Debug, Default)]
struct EyeTiles {
    /// `None` without an expected picture.
    settings: Option<CompletionSettings>,
    watched: Option<Watched>,
    /// The newest first; entries from `len` on are spare memory.
    pictures: Vec<Input>,
    len: usize,
    lists: EyeLists,
}

/// The properties of a picture that tiles are sorted by.
#[derive(Clone, Debug)]
struct Input {
    /// [`Kept::number`]; 0 of the expected one.
    number: u64,
    view: View,
    extent: [u32; 2],
    stale: StaleTiles,
    viewpoint: Option<Viewpoint>,
}

impl SortedTiles {
    /// Sorts the tiles of the pictures that `expect` sets.
    pub fn update(&mut self, expect: impl FnOnce(&mut Self)) {
        self.eyes.iter_mut().for_each(|eye| eye.settings = None);
        expect(self);
        for eye in &mut self.eyes {
            if let Some(settings) = eye.settings {
                let pictures = eye.pictures[..eye.len].iter().map(Input::picture);
                eye.lists.update(pictures, settings, eye.watched.as_ref());
            }
        }
    }

    /// Expects another eye buffer of an eye after `pictures`. With it, `lost` pictures will be dropped, as with the last one.
    pub(super) fn expect(&mut self, eye: usize, pictures: &[Kept], lost: usize, expected: Expected) {
        let Some(last) = pictures.first() else { return };
        let eye = &mut self.eyes[eye];
        let Expected { settings, watched, view: planner::View { orientation, position, fov }, stale } =
            expected;
        let earlier = &pictures[..pictures.len().saturating_sub(lost)];
        (eye.settings, eye.watched, eye.len) = (Some(settings), watched, 1 + earlier.len());
        // The picture that was the newest is second now, and all others follow it. Pictures that are already in place need no copy.
        eye.pictures.resize_with(eye.pictures.len().max(eye.len), Input::default);
        eye.pictures.rotate_right(1);
        for (input, kept) in eye.pictures[1..eye.len].iter_mut().zip(earlier) {
            input.viewpoint = kept.viewpoint();
            if input.number != kept.number {
                (input.number, input.view, input.extent) = (kept.number, kept.view, kept.extent);
                input.stale.clone_from(&kept.stale);
            }
        }
        let newest = &mut eye.pictures[0];
        stale(&mut newest.stale);
        (newest.number, newest.extent) = (0, last.extent);
        newest.view = View { orientation, plane: fov.tangents().plane(last.extent) };
        newest.viewpoint = last.viewpoint().map(|last| Viewpoint { position_m: position, ..last });
    }

    /// Moves the lists worked out for an eye into `lists` if they belong to `pictures`, and returns whether they do. Each can be taken once.
    pub(super) fn take(
        &mut self,
        eye: usize,
        pictures: &[Kept],
        settings: CompletionSettings,
        watched: Option<&Watched>,
        lists: &mut EyeLists,
    ) -> bool {
        let eye = &mut self.eyes[eye];
        let inputs = &eye.pictures[..eye.len];
        let is_same = |(index, (input, kept)): (usize, (&Input, &Kept))| {
            input.viewpoint == kept.viewpoint()
                && match index {
                    0 => (input.view, input.extent) == (kept.view, kept.extent) && input.stale == kept.stale,
                    _ => input.number == kept.number,
                }
        };
        let is_known = eye.settings == Some(settings)
            && eye.watched.as_ref() == watched
            && inputs.len() == pictures.len()
            && inputs.iter().zip(pictures).enumerate().all(is_same);
        if is_known {
            eye.settings = None;
            std::mem::swap(lists, &mut eye.lists);
        }
        is_known
    }
}

impl Input {
    fn picture(&self) -> Picture<'_> {
        Picture { view: self.view, extent: self.extent, stale: &self.stale, viewpoint: self.viewpoint }
    }
}

impl Default for Input {
    fn default() -> Self {
        let plane = ImagePlane { origin: Vec2::ZERO, step: Vec2::ONE };
        Self {
            number: 0,
            view: View { orientation: Quat::IDENTITY, plane },
            extent: [0; 2],
            stale: StaleTiles::default(),
            viewpoint: None,
        }
    }
}

#[cfg(test)]
mod tests;
