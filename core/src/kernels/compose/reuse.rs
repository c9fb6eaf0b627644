//! The part of the kernel that completes a picture from earlier ones, before colour is attenuated.

use super::{ComposeParams, PixelFormat};
use crate::geometry::{Fov, Nearness, PixelRect};
use crate::layout::uniform;
use crate::reuse::{Edge, Parallax, Reuse, TileLists, TileRect, TileRects};
use glam::{Mat3, UVec2, Vec2, Vec4};

uniform! {
    /// Parameters of re-use from one earlier picture, the shader's uniform of the same name.
    ///
    /// Points are in pixels from the corner of a picture's rectangle.
    pub struct ReuseParams {
        /// From points of the newest picture to that one, by columns.
        pub matrix: [[f32; 4]; 3],
        /// The same to the texture that has that one, of which 0 is the left and upper end and 1 the other one.
        pub to_texture: [[f32; 4]; 3],
        /// First pixel of the rectangle of that picture in its image.
        pub earlier_offset: [u32; 2],
        /// Size of that rectangle, pixels.
        pub earlier_extent: [f32; 2],
        /// Size of a tile of the newest picture, pixels.
        pub tile_size: [f32; 2],
        /// Number of tiles per pixel of that picture, along x and y.
        pub earlier_tiles: [f32; 2],
        /// Columns and rows of tiles of that picture.
        pub earlier_grid: [u32; 2],
        /// Index of the first word of that picture's stale tiles in the buffer, as [`crate::reuse::StaleTiles::words`].
        pub earlier_word: u32,
        /// Width over which fresh pixels beside stale tiles are blended, pixels.
        pub border: f32,
        /// Parallax, if the head has moved: offset of homogeneous points of that picture, in pixels, for each 1/m of nearness.
        pub parallax: [f32; 4],
        /// Meaning of depth in the newest picture: [`Nearness::at_zero`], [`Nearness::slope`] and [`Nearness::bounds`].
        pub nearness: [f32; 4],
        /// The same in that picture.
        pub earlier_nearness: [f32; 4],
        /// First pixel of the newest picture's depth in its image.
        pub depth_offset: [u32; 2],
        /// The same of that picture.
        pub earlier_depth_offset: [u32; 2],
        /// Number of pixels of depth per pixel of the newest picture, along x and y.
        pub depth_scale: [f32; 2],
        /// The same of that picture.
        pub earlier_depth_scale: [f32; 2],
        /// Index of the first rectangle of whole tiles in the buffer, in rectangles; in the parameters of no picture, of fresh tiles.
        pub whole_first: u32,
        /// The same of partial tiles.
        pub mixed_first: u32,
        /// The same of blended edges.
        pub border_first: u32,
        /// Ends the struct at a multiple of 16 bytes.
        pub unused: u32,
    }
}

/// The rectangle of an image in which the depth of a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthRect {
    /// Its first pixel.
    pub offset: [u32; 2],
    /// Its size, pixels: that of the picture, or another one.
    pub extent: [u32; 2],
}

impl DepthRect {
    /// Number of its pixels per pixel of a picture of `size` pixels, along x and y.
    pub(in crate::kernels) fn scale(&self, size: Vec2) -> Vec2 {
        UVec2::from(self.extent).as_vec2() / size
    }
}

pub(in crate::kernels) fn nearness_words(nearness: &Nearness) -> [f32; 4] {
    let Nearness { at_zero, slope, bounds: [least, greatest] } = *nearness;
    [at_zero, slope, least, greatest]
}

impl ReuseParams {
    /// For re-use from no picture.
    pub fn new(reuse: &Reuse, border: f32) -> Self {
        let tile_size = (1.0 / reuse.now().tiles_per_pixel()).into();
        Self { tile_size, border, ..bytemuck::Zeroable::zeroed() }
    }

    /// For re-use from the picture of `age`, 1..=[`Reuse::ages`], whose rectangle begins at `offset` of its image, which
    /// is of `extent` pixels, and whose stale tiles are in the buffer from place `word` on.
    pub fn at_age(self, reuse: &Reuse, age: usize, offset: [u32; 2], extent: [u32; 2], word: u32) -> Self {
        let Some(earlier) = reuse.at_age(age) else { return self };
        let [offset_in, extent_in] = [offset, extent].map(|of| UVec2::from(of).as_vec2());
        let to_texture = Mat3::from_scale(1.0 / extent_in) * Mat3::from_translation(offset_in);
        Self {
            matrix: columns(&earlier.matrix),
            to_texture: columns(&(to_texture * earlier.matrix)),
            earlier_offset: offset,
            earlier_extent: earlier.picture.size().into(),
            earlier_tiles: earlier.picture.tiles_per_pixel().into(),
            earlier_grid: earlier.picture.stale.tiles(),
            earlier_word: word,
            ..self
        }
    }

    /// With the depth of the newest picture, and of that of `age`, where [`Reuse::has_moved_since`].
    pub fn with_depth(self, reuse: &Reuse, age: usize, depth: DepthRect, earlier_depth: DepthRect) -> Self {
        let found = reuse.at_age(age).and_then(|earlier| Some((earlier.picture, earlier.parallax?)));
        let Some((picture, Parallax { shift, now, then })) = found else { return self };
        Self {
            parallax: shift.extend(0.0).into(),
            nearness: nearness_words(&now),
            earlier_nearness: nearness_words(&then),
            depth_offset: depth.offset,
            earlier_depth_offset: earlier_depth.offset,
            depth_scale: depth.scale(reuse.now().size()).into(),
            earlier_depth_scale: earlier_depth.scale(picture.size()).into(),
            ..self
        }
    }
}

fn columns(matrix: &Mat3) -> [[f32; 4]; 3] {
    matrix.to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0])
}

impl ComposeParams {
    /// For a rectangle in which colour stays as it is.
    pub fn neutral(rect_offset: [u32; 2], rect_extent: [u32; 2]) -> Self {
        let no_fov = Fov { left: 0.0, right: 0.0, up: 0.0, down: 0.0 };
        let gaze = glam::Vec3::ZERO;
        Self::new(rect_offset, rect_extent, no_fov, gaze, &crate::chroma::ChromaSettings::default(), true)
    }
}

/// An earlier picture in its image.
#[derive(Clone, Copy, Debug)]
pub struct EarlierPixels<'a> {
    /// Rows of `width` texels of four bytes.
    pub pixels: &'a [u8],
    /// Width of the image, pixels.
    pub width: u32,
    /// First pixel of the picture's rectangle.
    pub offset: [u32; 2],
    /// Its depth, where that is known.
    pub depth: Option<DepthPixels<'a>>,
}

/// The depth of a picture.
#[derive(Clone, Copy, Debug)]
pub struct DepthPixels<'a> {
    /// Rows of `width` values.
    pub values: &'a [f32],
    /// Width of the image, pixels.
    pub width: u32,
    /// The picture's rectangle.
    pub rect: DepthRect,
}

impl DepthPixels<'_> {
    /// The value at a point of a picture of `size` pixels; 0 beyond the image.
    fn at(&self, point: Vec2, size: Vec2) -> f32 {
        let at = UVec2::from(self.rect.offset) + (point * self.rect.scale(size)).as_uvec2();
        self.values.get(at.y as usize * self.width as usize + at.x as usize).copied().unwrap_or_default()
    }
}

/// Completes and processes one region of an image in place, as [`super::compose_image`] does without earlier pictures, with
/// the lists that `reuse` makes. `earlier` has one image for each of [`Reuse::ages`]; `depth` is that of the newest one.
pub fn reuse_image(
    pixels: &mut [u8],
    width: u32,
    format: PixelFormat,
    params: &ComposeParams,
    (reuse, lists, border): (&Reuse, &TileLists, f32),
    (depth, earlier): (Option<DepthPixels>, &[EarlierPixels]),
) {
    let sample = |point: Vec2, age: usize| sample(format, reuse, (depth, earlier), point, age);
    let mut edit = |x: u32, y: u32, change: &dyn Fn(Vec4) -> Option<(Vec4, f32)>| {
        let at = UVec2::from(params.rect_offset) + UVec2::new(x, y);
        let index = (at.y as usize * width as usize + at.x as usize) * 4;
        let Some(texel) = pixels.get_mut(index..index + 4) else { return };
        let here = format.decode(texel).extend(f32::from(texel[3]) / 255.0);
        let Some((found, share)) = change(here) else { return };
        let rgb = params.pixel(x, y, found.truncate()).unwrap_or(found.truncate());
        format.encode(here.truncate().lerp(rgb, share), &mut texel[..3]);
        if share == 1.0 {
            texel[3] = (found.w * 255.0).round() as u8;
        }
    };
    let mut fill = |tiles: &TileRects, age: usize| {
        for rect in tiles.iter() {
            for (x, y) in pixels_in(reuse, &reuse.tiles(rect.first(), rect.size())) {
                edit(x, y, &|here| match age {
                    0 => Some((here, 1.0)),
                    _ => Some((sample(centre(x, y), age)?, 1.0)),
                });
            }
        }
    };
    fill(&lists.fresh, 0);
    for age in 1..=reuse.ages() {
        fill(&lists.full[age - 1], age);
    }
    for age in (1..=reuse.ages()).rev() {
        fill(&lists.partial[age - 1], age);
    }
    for (age, borders) in (1..=reuse.ages()).zip(&lists.seam) {
        for (edge, tiles) in Edge::ALL.into_iter().zip(borders) {
            for tile in tiles.iter().flat_map(TileRect::tiles) {
                let rect = reuse.edge(tile, edge, border);
                for (x, y) in pixels_in(reuse, &rect) {
                    let share = edge.share(&rect, centre(x, y));
                    edit(x, y, &|_| Some((sample(centre(x, y), age)?, share)));
                }
            }
        }
    }
}

fn centre(x: u32, y: u32) -> Vec2 {
    Vec2::new(x as f32, y as f32) + 0.5
}

/// The pixels whose centres lie in a rectangle.
fn pixels_in(reuse: &Reuse, rect: &PixelRect) -> impl Iterator<Item = (u32, u32)> + use<> {
    let [first, end] = reuse.pixels(rect);
    (first[1]..end[1]).flat_map(move |y| (first[0]..end[0]).map(move |x| (x, y)))
}

/// The colour in linear light, and alpha, that a pixel had in the picture of an age, if that picture has it.
fn sample(
    format: PixelFormat,
    reuse: &Reuse,
    (depth, earlier): (Option<DepthPixels>, &[EarlierPixels]),
    point: Vec2,
    age: usize,
) -> Option<Vec4> {
    let image = earlier.get(age - 1)?;
    let texel = |[x, y]: [u32; 2]| {
        let (x, y) = (image.offset[0] + x, image.offset[1] + y);
        let texel = &image.pixels[(y as usize * image.width as usize + x as usize) * 4..][..4];
        format.decode(texel).extend(f32::from(texel[3]) / 255.0)
    };
    let footprint = if reuse.has_moved_since(age) {
        let moved = reuse.moved_source(point, age, depth?.at(point, reuse.now().size()))?;
        let (then, size) = (image.depth?, reuse.pictures().nth(age - 1)?.size());
        reuse.moved_footprint(&moved, |texel| then.at(UVec2::from(texel).as_vec2() + 0.5, size))
    } else {
        reuse.footprint(reuse.source(point, age)?)
    };
    let footprint = footprint?.into_iter().filter(|(_, weight)| *weight > 0.0);
    Some(footprint.map(|(at, weight)| texel(at) * weight).sum())
}
