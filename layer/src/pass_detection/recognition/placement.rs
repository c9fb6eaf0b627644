//! Placements of eye buffers in images, and their sources.

use super::Parts;
use crate::pass_detection::{Eyes, Orientation, Part, Target, Transfer};
use smallvec::SmallVec;

/// Placement of a whole eye buffer in an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub(super) eyes: Eyes,
    /// Array layer of the image.
    pub(super) layer: u32,
    /// x, y, width, height in pixels; it may reach beyond the image that holds a part of it only.
    pub(super) rect: [f32; 4],
    pub(super) orientation: Orientation,
}

pub(super) type Placements = SmallVec<[Placement; 4]>;

/// Render areas of passes: x, y, width, height in pixels.
pub(super) type Areas = SmallVec<[[u32; 4]; 4]>;

/// A transfer that writes a smaller share of the picture than this is not evidence of the picture's source.
const LEAST_SHARE: f32 = 0.25;

/// Placements of one image that are kept.
const MOST: usize = 8;

impl Placement {
    /// Placement of the picture in the source of `transfer`; `None` if it does not come from there.
    pub(super) fn before(&self, transfer: &Transfer) -> Option<Self> {
        let Transfer { from, from_rect, to, to_rect, .. } = transfer;
        if from.level != 0 || to.level != 0 {
            return None;
        }
        let layer = self.layer.checked_sub(to.base_layer)?;
        if layer >= to.layers.min(from.layers) {
            return None;
        }
        let [(x, width, is_mirrored), (y, height, is_flipped)] =
            [self.along(0, from_rect, to_rect)?, self.along(1, from_rect, to_rect)?];
        let share = self.share(0, to_rect) * self.share(1, to_rect);
        if is_mirrored || share < LEAST_SHARE {
            return None;
        }
        Some(Self {
            layer: from.base_layer.checked_add(layer)?,
            rect: [x, y, width, height],
            orientation: if is_flipped { flipped(self.orientation) } else { self.orientation },
            ..*self
        })
    }

    /// First pixel and size on an axis of the source, and whether it is mirrored.
    fn along(&self, axis: usize, from: &[i32; 4], to: &[i32; 4]) -> Option<(f32, f32, bool)> {
        let scale = from[axis + 2] as f32 / to[axis + 2] as f32;
        let at = |pixel: f32| from[axis] as f32 + (pixel - to[axis] as f32) * scale;
        let (first, end) = (at(self.rect[axis]), at(self.rect[axis] + self.rect[axis + 2]));
        let fits = scale.is_finite() && first.is_finite() && end.is_finite() && first != end;
        fits.then(|| (first.min(end), (end - first).abs(), end < first))
    }

    /// Share of the placement's side that lies in `rect`, 0..=1.
    fn share(&self, axis: usize, rect: &[i32; 4]) -> f32 {
        let (first, size) = (rect[axis] as f32, rect[axis + 2] as f32);
        let (first, end) = (first.min(first + size), first.max(first + size));
        let (own, own_end) = (self.rect[axis], self.rect[axis] + self.rect[axis + 2]);
        let both = end.min(own_end) - first.max(own);
        if self.rect[axis + 2] > 0.0 { (both / self.rect[axis + 2]).max(0.0) } else { 0.0 }
    }

    /// As a part of the picture that a pass draws into `target` with the render area `area`; `None` where it draws none of it.
    fn part(&self, target: &Target, area: [u32; 4]) -> Option<Part> {
        let layer = self.layer.checked_sub(target.base_layer).filter(|layer| *layer < target.layers)?;
        let [x, y, width, height] = area.map(|pixels| pixels as f32);
        let [own_x, own_y, own_width, own_height] = self.rect;
        let rect = [(own_x - x) / width, (own_y - y) / height, own_width / width, own_height / height];
        let meets = |axis: usize| rect[axis] < 1.0 && rect[axis] + rect[axis + 2] > 0.0;
        let is_met = rect.iter().all(|side| side.is_finite()) && meets(0) && meets(1);
        is_met.then_some(Part { eyes: self.eyes, layer, rect, orientation: self.orientation })
    }
}

/// Adds a placement that is not there yet. Beyond some, none is added.
pub(super) fn add(placements: &mut Placements, new: Placement) {
    let is_same = |old: &Placement| {
        (old.eyes, old.layer, old.orientation) == (new.eyes, new.layer, new.orientation)
            && old.rect.iter().zip(new.rect).all(|(old, new)| (old - new).abs() < 0.5)
    };
    if placements.len() < MOST && !placements.iter().any(is_same) {
        placements.push(new);
    }
}

/// The placements that a pass draws into `target`, in its render area. `areas` are the render areas of the passes that drew the shown
/// images of the placements: the picture follows the render area if that is resized.
pub(super) fn parts(placements: &[Placement], areas: &[[u32; 4]], target: &Target, area: [u32; 4]) -> Parts {
    let reference = if areas.contains(&area) { None } else { resized_from(placements, areas, area) };
    let area = reference.unwrap_or(area);
    placements.iter().filter_map(|placement| placement.part(target, area)).collect()
}

/// The render area that was the size of a picture, or of them all, and now is `area`.
fn resized_from(placements: &[Placement], areas: &[[u32; 4]], area: [u32; 4]) -> Option<[u32; 4]> {
    let pictures = areas.iter().filter(|old| is_picture(placements, **old));
    pictures.copied().find(|old| is_resized(old, area))
}

/// Whether a render area is a picture, or all of them.
pub(super) fn is_picture(placements: &[Placement], area: [u32; 4]) -> bool {
    let area = area.map(|pixels| pixels as f32);
    placements.iter().any(|placement| is_near(placement.rect, area)) || is_near(bounds(placements), area)
}

/// Whether `new` may be `old` resized: the same aspect, and the origin the same or moved along.
fn is_resized(old: &[u32; 4], new: [u32; 4]) -> bool {
    let [old_x, old_y, old_width, old_height] = old.map(|pixels| pixels as f32);
    let [x, y, width, height] = new.map(|pixels| pixels as f32);
    let scale = [width / old_width, height / old_height];
    let moved = |old: f32, new: f32, scale: f32| (new - old).abs() <= 1.0 || (new - old * scale).abs() <= 1.0;
    // Sizes are often rounded to a multiple of 8.
    let same_aspect = (scale[0] / scale[1] - 1.0).abs() * old_width.min(old_height) <= 16.0;
    same_aspect && moved(old_x, x, scale[0]) && moved(old_y, y, scale[1])
}

/// The smallest rectangle with all placements in it.
fn bounds(placements: &[Placement]) -> [f32; 4] {
    let mut ends = [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY];
    for placement in placements {
        for axis in 0..2 {
            ends[axis] = ends[axis].min(placement.rect[axis]);
            ends[axis + 2] = ends[axis + 2].max(placement.rect[axis] + placement.rect[axis + 2]);
        }
    }
    [ends[0], ends[1], ends[2] - ends[0], ends[3] - ends[1]]
}

fn is_near(a: [f32; 4], b: [f32; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1.0)
}

fn flipped(orientation: Orientation) -> Orientation {
    match orientation {
        Orientation::Upright => Orientation::UpsideDown,
        Orientation::UpsideDown => Orientation::Upright,
        Orientation::Unknown => Orientation::Unknown,
    }
}
