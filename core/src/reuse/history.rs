//! Positions of an image's pixels in earlier images.

use super::rects::Edge;
use super::{MAX_AGES, StaleTiles};
use crate::gaze::NEAREST_ASSUMED_M;
use crate::geometry::{Nearness, PixelRect, Reprojection, View, parallax};
use glam::{Mat3, Vec2, Vec3};

/// A turn that moves no pixel farther than this, pixels, counts as none: it would only blur.
const STILL_PIXELS: f32 = 1.0 / 64.0;

/// Head movement that moves nothing from [`NEAREST_ASSUMED_M`] on farther than this, pixels, counts as none: following it by depth would
/// make no visible difference.
const UNMOVED_PIXELS: f32 = 0.25;

/// Tolerance of the comparison by depth, pixels: a texel of an earlier image shows the same surface if its point lies within this distance
/// here. A surface seen at a slant has less from pixel to pixel.
const SAME_PIXELS: f32 = 0.25;

/// One eye buffer, with its view and stale tiles.
///
/// Points are in pixels from the upper left corner of the rectangle of the image that shows the eye's view; the centre of a
/// pixel is at + 0.5.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Orientation and image plane of the view.
    pub view: View,
    /// Size, pixels.
    pub extent: [u32; 2],
    /// Its tiles that were not rendered.
    pub stale: &'a StaleTiles,
    /// From where it was seen, where that is known with its depth.
    pub viewpoint: Option<Viewpoint>,
}

/// Viewpoint of an image, with the meaning of its depth, for reprojection by depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Position of the view, in the space that its orientation leads to, metres.
    pub position_m: Vec3,
    /// Meaning of the values of its depth image.
    pub nearness: Nearness,
}

impl Picture<'_> {
    /// Number of tiles per pixel, along x and y.
    pub fn tiles_per_pixel(&self) -> Vec2 {
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
    /// Parallax, if the viewpoint has moved since and both images have depth.
    pub(crate) parallax: Option<Parallax>,
    /// Whether nothing has moved since.
    pub(crate) is_still: bool,
    /// [`Picture::tiles_per_pixel`]; of a picture without tiles, which is fresh, as if it were one.
    pub(crate) tiles_per_pixel: Vec2,
}

/// Parallax of near content between the newest image and an earlier one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parallax {
    /// Vector to add to homogeneous points of the earlier image for each 1/m ([`parallax`]).
    pub(crate) shift: Vec3,
    /// Meaning of depth in the newest image.
    pub(crate) now: Nearness,
    /// Meaning of depth in the earlier one.
    pub(crate) then: Nearness,
}

impl Earlier<'_> {
    /// Position of a point of the newest image in this one, for content at infinity; `None` if this one does not show it.
    pub(crate) fn point(&self, point: Vec2) -> Option<Vec2> {
        self.shown(self.matrix * point.extend(1.0))
    }

    fn shown(&self, homogeneous: Vec3) -> Option<Vec2> {
        let at = homogeneous.truncate() / homogeneous.z;
        let is_inside =
            homogeneous.z > 0.0 && at.cmpge(Vec2::ZERO).all() && at.cmple(self.picture.size()).all();
        is_inside.then_some(at)
    }

    /// [`Self::matrix`] for content at [`NEAREST_ASSUMED_M`]; `None` if distance does not matter.
    pub(crate) fn near_matrix(&self) -> Option<Mat3> {
        let Mat3 { x_axis, y_axis, z_axis } = self.matrix;
        self.parallax
            .map(|Parallax { shift, .. }| Mat3::from_cols(x_axis, y_axis, z_axis + shift / NEAREST_ASSUMED_M))
    }
}

/// Source of a re-used pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Age of the source image, counted in images, 1..=[`MAX_AGES`].
    pub age: usize,
    /// The point there.
    pub point: Vec2,
}

/// Source of a re-used pixel in an image from another viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedSource {
    /// The picture, and the point there.
    pub source: Source,
    /// Nearness of the pixel's content there, 1/m.
    pub nearness: f32,
    /// Displacement here for each 1/m of nearness there, pixels.
    pub pixels_m: f32,
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
    /// `earlier` images, the newest first; at most [`MAX_AGES`], and only up to the first one that cannot be related to `now`.
    ///
    /// With `turns` pixels are looked for in the direction that they show, without it (paper B) at the same place of
    /// the picture.
    pub fn new(now: Picture<'a>, earlier: impl IntoIterator<Item = Picture<'a>>, turns: bool) -> Self {
        let mut found = [None; MAX_AGES];
        for (slot, picture) in found.iter_mut().zip(earlier) {
            let matrix = if turns { turn(&now, &picture) } else { Some(resize(&now, &picture)) };
            let Some(matrix) = matrix else { break };
            let parallax = if turns { move_between(&now, &picture, &matrix) } else { None };
            let is_still = matrix == Mat3::IDENTITY && parallax.is_none();
            let is_one = picture.stale.tiles() == [0; 2];
            let tiles_per_pixel = if is_one { 1.0 / picture.size() } else { picture.tiles_per_pixel() };
            *slot = Some(Earlier { picture, matrix, parallax, is_still, tiles_per_pixel });
        }
        Self { now, earlier: found }
    }

    /// The picture that is to be completed.
    pub fn now(&self) -> Picture<'a> {
        self.now
    }

    /// Whether nothing has moved since any of the earlier ones.
    pub fn is_still(&self) -> bool {
        self.earlier().all(|earlier| earlier.is_still)
    }

    /// Whether nothing has moved since the picture of an age, 1..=[`Self::ages`].
    pub fn is_still_since(&self, age: usize) -> bool {
        self.at_age(age).is_some_and(|earlier| earlier.is_still)
    }

    /// Whether content of the image of an age is found by its depth: the head has moved, and both have depth.
    pub fn has_moved_since(&self, age: usize) -> bool {
        self.at_age(age).is_some_and(|earlier| earlier.parallax.is_some())
    }

    pub(crate) fn at_age(&self, age: usize) -> Option<&Earlier<'a>> {
        self.earlier.get(age.checked_sub(1)?)?.as_ref()
    }

    /// The earlier ones, the newest first.
    pub(crate) fn earlier(&self) -> impl Iterator<Item = &Earlier<'a>> {
        self.earlier.iter().map_while(Option::as_ref)
    }

    /// The earlier pictures, the newest first.
    pub fn pictures(&self) -> impl Iterator<Item = &Picture<'a>> {
        self.earlier().map(|earlier| &earlier.picture)
    }

    /// Number of earlier images.
    pub fn ages(&self) -> usize {
        self.earlier().count()
    }

    /// The point's source in the image of an age; `None` if its tile there was not rendered.
    pub fn source(&self, point: Vec2, age: usize) -> Option<Source> {
        let earlier = self.at_age(age)?;
        let at = earlier.point(point).filter(|at| earlier.picture.is_fresh_at(*at))?;
        Some(Source { age, point: at })
    }

    /// As [`Self::source`], of a point with this value in the depth image, where [`Self::has_moved_since`].
    pub fn moved_source(&self, point: Vec2, age: usize, depth: f32) -> Option<MovedSource> {
        let earlier = self.at_age(age)?;
        let Parallax { shift, now, .. } = earlier.parallax?;
        let nearness = now.at(depth);
        let found = earlier.matrix * point.extend(1.0) + shift * nearness;
        let at = earlier.shown(found).filter(|at| earlier.picture.is_fresh_at(*at))?;
        Some(MovedSource {
            source: Source { age, point: at },
            nearness: nearness / found.z,
            pixels_m: (shift.truncate() - at * shift.z).length(),
        })
    }

    /// The texels of a source: bilinear, without texels of tiles that were not rendered.
    pub fn footprint(&self, source: Source) -> Option<Footprint> {
        self.footprint_of(source, |_| true)
    }

    /// As [`Self::footprint`], without texels of other surfaces: an earlier image lacks content that was occluded then. `depth` reads
    /// the earlier depth image.
    pub fn moved_footprint(&self, moved: &MovedSource, depth: impl Fn([u32; 2]) -> f32) -> Option<Footprint> {
        let then = self.at_age(moved.source.age)?.parallax?.then;
        self.footprint_of(moved.source, |texel| {
            (then.at(depth(texel)) - moved.nearness).abs() * moved.pixels_m <= SAME_PIXELS
        })
    }

    fn footprint_of(&self, source: Source, counts: impl Fn([u32; 2]) -> bool) -> Option<Footprint> {
        let earlier = self.at_age(source.age)?;
        let picture = &earlier.picture;
        let base = (source.point - 0.5).floor();
        let share = source.point - 0.5 - base;
        let mut footprint = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(right, down)| {
            let step = Vec2::new(right, down);
            let texel = (base + step).clamp(Vec2::ZERO, picture.size() - 1.0);
            let weights = (Vec2::ONE - step - share).abs();
            let at = texel.as_uvec2().into();
            let counts = picture.is_fresh_at(texel + 0.5) && counts(at);
            (at, if counts { weights.x * weights.y } else { 0.0 })
        });
        let sum: f32 = footprint.iter().map(|(_, weight)| weight).sum();
        footprint.iter_mut().for_each(|(_, weight)| *weight /= sum);
        (sum > 0.0).then_some(footprint)
    }

    /// Whether an edge or a corner of a tile is blended with earlier images: the tile is fresh, and its neighbour there is stale; of a
    /// corner, only the diagonal one.
    pub fn is_seam(&self, tile: [u32; 2], Edge { across, down }: Edge) -> bool {
        let is_stale = |across: i8, down: i8| {
            let beside =
                [tile[0].wrapping_add_signed(across.into()), tile[1].wrapping_add_signed(down.into())];
            self.now.stale.is_stale(beside)
        };
        let is_corner = across != 0 && down != 0;
        !is_stale(0, 0)
            && is_stale(across, down)
            && !(is_corner && (is_stale(across, 0) || is_stale(0, down)))
    }

    /// The pixels of some tiles, given as the first one and the number of columns and rows.
    pub fn tiles(&self, first: [u32; 2], [columns, rows]: [u32; 2]) -> PixelRect {
        let size = 1.0 / self.now.tiles_per_pixel();
        let corner =
            |column: u32, row: u32| (Vec2::new(column as f32, row as f32) * size).min(self.now.size());
        PixelRect { min: corner(first[0], first[1]), max: corner(first[0] + columns, first[1] + rows) }
    }

    /// The first pixel whose centre lies in a rectangle, and the column and row after the last one.
    pub fn pixels(&self, rect: &PixelRect) -> [[u32; 2]; 2] {
        [rect.min, rect.max].map(|corner| (corner - 0.5).ceil().min(self.now.size()).as_uvec2().into())
    }

    /// The pixels of an edge or corner of a tile, `border` of them wide, or half of the tile where that is less.
    pub fn edge(&self, tile: [u32; 2], Edge { across, down }: Edge, border: f32) -> PixelRect {
        let PixelRect { min, max } = self.tiles(tile, [1, 1]);
        let width = Vec2::splat(border).min(0.5 / self.now.tiles_per_pixel());
        let axis = |side: i8, low: f32, high: f32, width: f32| match side {
            0 => (low, high),
            1.. => (high - width, high),
            _ => (low, low + width),
        };
        let x = axis(across, min.x, max.x, width.x);
        let y = axis(down, min.y, max.y, width.y);
        PixelRect { min: Vec2::new(x.0, y.0), max: Vec2::new(x.1, y.1) }
    }
}

/// From points of one picture to the same place of another.
fn resize(from: &Picture, to: &Picture) -> Mat3 {
    Mat3::from_scale(to.size() / from.size())
}

/// From points of one picture to the points of the same direction in another.
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

/// Parallax of near content in an earlier image; `None` unless both have depth, and the head has moved.
fn move_between(now: &Picture, then: &Picture, matrix: &Mat3) -> Option<Parallax> {
    let (here, there) = now.viewpoint.zip(then.viewpoint)?;
    let shift = parallax(&then.view, here.position_m, there.position_m)?;
    let has_moved = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].into_iter().any(|corner| {
        let far = *matrix * (corner * now.size()).extend(1.0);
        let near = far + shift / NEAREST_ASSUMED_M;
        // Not `>`: points behind the view have no place.
        let is_there = near.z > 0.0 && far.z > 0.0;
        !(is_there && (near.truncate() / near.z).distance(far.truncate() / far.z) <= UNMOVED_PIXELS)
    });
    has_moved.then_some(Parallax { shift, now: here.nearness, then: there.nearness })
}
