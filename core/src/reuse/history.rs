//! Where the pixels of a picture lie in earlier ones.

use super::{MAX_AGES, StaleTiles};
use crate::geometry::{Reprojection, View};
use glam::{Mat3, Vec2};

/// A turn that moves no pixel farther than this, pixels, counts as none: it would only blur.
const STILL_PIXELS: f32 = 1.0 / 64.0;

/// What is known of a picture of an eye.
///
/// Points are in pixels from the upper left corner of the rectangle of the image that shows the eye's view; the centre of a
/// pixel is at + 0.5.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// How it was looked at, and its pixels.
    pub view: View,
    /// Size, pixels.
    pub extent: [u32; 2],
    /// Its tiles that were not rendered.
    pub stale: &'a StaleTiles,
}

impl Picture<'_> {
    /// How many tiles a pixel is wide and high.
    pub(crate) fn tiles_per_pixel(&self) -> Vec2 {
        self.stale.tiles_across() / self.size()
    }

    pub(crate) fn size(&self) -> Vec2 {
        Vec2::new(self.extent[0].max(1) as f32, self.extent[1].max(1) as f32)
    }

    /// The tile at a point; for points beyond the picture, the nearest.
    pub(crate) fn tile_at(&self, point: Vec2) -> [u32; 2] {
        self.stale.tile_at(point / self.size())
    }

    /// Whether the tile at a point was rendered.
    pub fn is_fresh_at(&self, point: Vec2) -> bool {
        !self.stale.is_stale(self.tile_at(point))
    }
}

/// An earlier picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Earlier<'a> {
    pub(crate) picture: Picture<'a>,
    /// From points of the newest picture, as (x, y, 1), to homogeneous points of this one.
    pub(crate) matrix: Mat3,
}

impl Earlier<'_> {
    /// Where a point of the newest picture lies in this one; nothing where it does not show it.
    pub(crate) fn point(&self, point: Vec2) -> Option<Vec2> {
        let found = self.matrix * point.extend(1.0);
        let at = found.truncate() / found.z;
        let is_inside = found.z > 0.0 && at.cmpge(Vec2::ZERO).all() && at.cmple(self.picture.size()).all();
        is_inside.then_some(at)
    }
}

/// Where a pixel is re-used from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// How many pictures ago it was rendered, 1..=[`MAX_AGES`].
    pub age: usize,
    /// The point there.
    pub point: Vec2,
}

/// The texels that make a re-used pixel: pixels of an earlier picture, from its upper left corner, and their weights,
/// which sum up to 1. A texel of a tile that was not rendered has none.
pub type Footprint = [([u32; 2], f32); 4];

/// A picture with those before it that can be re-used.
#[derive(Clone, Copy, Debug)]
pub struct Reuse<'a> {
    now: Picture<'a>,
    earlier: [Option<Earlier<'a>>; MAX_AGES],
}

impl<'a> Reuse<'a> {
    /// `earlier` pictures, the newest first; what is more than [`MAX_AGES`] is left out, and all from the first on that
    /// cannot be related to `now`.
    ///
    /// With `turns` pixels are looked for in the direction that they show, without it (paper B) at the same place of
    /// the picture.
    pub fn new(now: Picture<'a>, earlier: impl IntoIterator<Item = Picture<'a>>, turns: bool) -> Self {
        let mut found = [None; MAX_AGES];
        for (slot, picture) in found.iter_mut().zip(earlier) {
            let matrix = if turns { turn(&now, &picture) } else { Some(resize(&now, &picture)) };
            let Some(matrix) = matrix else { break };
            *slot = Some(Earlier { picture, matrix });
        }
        Self { now, earlier: found }
    }

    /// The picture that is to be completed.
    pub fn now(&self) -> Picture<'a> {
        self.now
    }

    /// Whether nothing has moved since any of the earlier ones.
    pub fn is_still(&self) -> bool {
        self.earlier().all(|earlier| earlier.matrix == Mat3::IDENTITY)
    }

    /// The earlier ones, the newest first.
    pub(crate) fn earlier(&self) -> impl Iterator<Item = &Earlier<'a>> {
        self.earlier.iter().map_while(Option::as_ref)
    }

    /// The earlier pictures, the newest first.
    pub fn pictures(&self) -> impl Iterator<Item = &Picture<'a>> {
        self.earlier().map(|earlier| &earlier.picture)
    }

    /// How many earlier ones there are.
    pub fn ages(&self) -> usize {
        self.earlier().count()
    }

    /// Where the newest rendering of what a point shows lies in the earlier pictures.
    pub fn source(&self, point: Vec2) -> Option<Source> {
        self.earlier().enumerate().find_map(|(index, earlier)| {
            let at = earlier.point(point).filter(|at| earlier.picture.is_fresh_at(*at))?;
            Some(Source { age: index + 1, point: at })
        })
    }

    /// What a source is made of: bilinear, without the texels of tiles that were not rendered.
    pub fn footprint(&self, source: Source) -> Option<Footprint> {
        let earlier = self.earlier.get(source.age.checked_sub(1)?)?.as_ref()?;
        let picture = &earlier.picture;
        let base = (source.point - 0.5).floor();
        let share = source.point - 0.5 - base;
        let mut footprint = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(right, down)| {
            let step = Vec2::new(right, down);
            let texel = (base + step).clamp(Vec2::ZERO, picture.size() - 1.0);
            let weights = (Vec2::ONE - step - share).abs();
            let is_fresh = picture.is_fresh_at(texel + 0.5);
            (texel.as_uvec2().into(), if is_fresh { weights.x * weights.y } else { 0.0 })
        });
        let sum: f32 = footprint.iter().map(|(_, weight)| weight).sum();
        footprint.iter_mut().for_each(|(_, weight)| *weight /= sum);
        (sum > 0.0).then_some(footprint)
    }

    /// How much of a fresh pixel is taken from its [`Self::source`], 0..=1: next to a stale tile nearly all, and less from there,
    /// to nothing at a distance of `width` pixels.
    pub fn border_share(&self, point: Vec2, width: f32) -> f32 {
        let tile = self.now.tile_at(point);
        let size = 1.0 / self.now.tiles_per_pixel();
        let mut nearest = f32::INFINITY;
        for (right, down) in AROUND {
            let beside = [tile[0].wrapping_add_signed(right), tile[1].wrapping_add_signed(down)];
            if self.now.stale.is_stale(beside) {
                let low = Vec2::new(beside[0] as f32, beside[1] as f32) * size;
                let away = (low - point).max(point - low - size).max(Vec2::ZERO);
                nearest = nearest.min(away.length());
            }
        }
        if width > 0.0 { (1.0 - nearest / width).max(0.0) } else { 0.0 }
    }
}

/// The tiles around one.
pub(super) const AROUND: [(i32, i32); 8] =
    [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

/// From points of one picture to the same place of another.
fn resize(from: &Picture, to: &Picture) -> Mat3 {
    Mat3::from_scale(to.size() / from.size())
}

/// From points of one picture to those that show the same direction in another.
fn turn(from: &Picture, to: &Picture) -> Option<Mat3> {
    let found = Reprojection::between(&from.view, &to.view)?;
    let matrix = found.matrix();
    let same = resize(from, to);
    let size = from.size();
    let is_still = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].into_iter().all(|corner| {
        let corner = corner * size;
        let moved = found.pixel(corner).map(|to| to.distance(same.transform_point2(corner)));
        moved.is_some_and(|moved| moved < STILL_PIXELS)
    });
    Some(if is_still { same } else { matrix })
}
