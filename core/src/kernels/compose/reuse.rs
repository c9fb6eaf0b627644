//! The part of the kernel that completes a picture from earlier ones, before colour is attenuated.

use super::{ComposeParams, PixelFormat};
use crate::geometry::Fov;
use crate::layout::uniform;
use crate::reuse::{MAX_AGES, Reuse};
use glam::{Mat3, UVec2, Vec2, Vec4};

uniform! {
    /// Parameters of what is taken from one earlier picture, the shader's uniform of the same name.
    ///
    /// Points are in pixels from the corner of a picture's rectangle. Stale tiles are bits of words in a buffer, see
    /// [`crate::reuse::StaleTiles::words`], by the place of the first of them.
    pub struct ReuseParams {
        /// From points of the newest picture to that one, by columns.
        pub matrix: [[f32; 4]; 3],
        /// First pixel of the rectangle of that picture in its image.
        pub earlier_offset: [u32; 2],
        /// Size of that rectangle, pixels.
        pub earlier_extent: [f32; 2],
        /// Size of a tile of the newest picture, pixels.
        pub tile_size: [f32; 2],
        /// Columns and rows of tiles of the newest picture.
        pub tiles: [u32; 2],
        /// How many tiles of that picture a pixel is wide and high.
        pub earlier_tiles: [f32; 2],
        /// Columns and rows of tiles of that picture.
        pub earlier_grid: [u32; 2],
        /// Where the stale tiles of the newest picture are in the buffer.
        pub first_word: u32,
        /// Where those of that picture are.
        pub earlier_word: u32,
        /// Which picture this is about: 1 for the one before the newest.
        pub age: u32,
        /// Width over which fresh pixels beside stale tiles are blended, pixels.
        pub border: f32,
        /// The matrices of all earlier pictures, three columns each.
        pub matrices: [[f32; 4]; 3 * MAX_AGES],
        /// Of each: tiles per pixel, and size in pixels.
        pub extents: [[f32; 4]; MAX_AGES],
        /// Of each: columns and rows of tiles, where its stale tiles are in the buffer, 0.
        pub grids: [[u32; 4]; MAX_AGES],
    }
}

impl ReuseParams {
    /// For what is taken from the picture of `age`, 1..=[`Reuse::ages`], whose rectangle begins at `earlier_offset` of its
    /// image; of age 0 for what is taken from none. The buffer has [`set_words`] from place `first_word` on.
    pub fn new(reuse: &Reuse, age: usize, earlier_offset: [u32; 2], border: f32, first_word: u32) -> Self {
        let now = reuse.now();
        let mut params = Self {
            earlier_offset,
            tile_size: (1.0 / now.tiles_per_pixel()).into(),
            tiles: now.stale.tiles(),
            first_word,
            age: age as u32,
            border,
            ..bytemuck::Zeroable::zeroed()
        };
        let mut word = first_word + now.stale.words().len() as u32;
        for (index, earlier) in reuse.earlier().enumerate() {
            let picture = &earlier.picture;
            let matrix = columns(&earlier.matrix);
            params.matrices[index * 3..][..3].copy_from_slice(&matrix);
            let (tiles, size) = (picture.tiles_per_pixel(), picture.size());
            params.extents[index] = [tiles.x, tiles.y, size.x, size.y];
            let [columns, rows] = picture.stale.tiles();
            params.grids[index] = [columns, rows, word, 0];
            if index + 1 == age {
                params.matrix = matrix;
                params.earlier_extent = size.into();
                params.earlier_tiles = tiles.into();
                params.earlier_grid = [columns, rows];
                params.earlier_word = word;
            }
            word += picture.stale.words().len() as u32;
        }
        params
    }

    /// Whether nothing has moved between that picture and the newest.
    pub fn is_still(&self) -> bool {
        self.matrix == columns(&Mat3::IDENTITY)
    }
}

fn columns(matrix: &Mat3) -> [[f32; 4]; 3] {
    matrix.to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0])
}

/// The stale tiles of all pictures as [`ReuseParams`] expects them in the buffer: the newest picture's first.
pub fn set_words<'a>(reuse: &'a Reuse<'a>) -> impl Iterator<Item = &'a [u32]> {
    let now = std::iter::once(reuse.now().stale.words());
    now.chain(reuse.earlier().map(|earlier| earlier.picture.stale.words()))
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
}

/// Completes and processes one region of an image in place, as [`super::compose_image`] does without earlier pictures.
/// `earlier` has one image for each of [`Reuse::ages`].
pub fn reuse_image(
    pixels: &mut [u8],
    width: u32,
    format: PixelFormat,
    params: &ComposeParams,
    reuse: &Reuse,
    earlier: &[EarlierPixels],
    border: f32,
) {
    let [columns, rows] = params.rect_extent;
    for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
        let point = Vec2::new(x as f32, y as f32) + 0.5;
        let at = UVec2::from(params.rect_offset) + UVec2::new(x, y);
        let index = (at.y as usize * width as usize + at.x as usize) * 4;
        let Some(texel) = pixels.get_mut(index..index + 4) else { continue };
        let is_stale = !reuse.now().is_fresh_at(point);
        let share = if is_stale { 1.0 } else { reuse.border_share(point, border) };
        let found = if share > 0.0 { sample(format, reuse, earlier, point) } else { None };
        let here = format.decode(texel).extend(f32::from(texel[3]) / 255.0);
        let Some(found) = found else {
            if let Some(rgb) = params.pixel(x, y, here.truncate()) {
                format.encode(rgb, &mut texel[..3]);
            }
            continue;
        };
        let attenuate = |rgba: Vec4| params.pixel(x, y, rgba.truncate()).unwrap_or(rgba.truncate());
        format.encode(attenuate(here).lerp(attenuate(found), share), &mut texel[..3]);
        if is_stale {
            texel[3] = (found.w * 255.0).round() as u8;
        }
    }
}

/// The colour in linear light, and alpha, that a pixel had when it was last rendered.
fn sample(format: PixelFormat, reuse: &Reuse, earlier: &[EarlierPixels], point: Vec2) -> Option<Vec4> {
    let source = reuse.source(point)?;
    let image = earlier.get(source.age - 1)?;
    let texel = |[x, y]: [u32; 2]| {
        let (x, y) = (image.offset[0] + x, image.offset[1] + y);
        let texel = &image.pixels[(y as usize * image.width as usize + x as usize) * 4..][..4];
        format.decode(texel).extend(f32::from(texel[3]) / 255.0)
    };
    let footprint = reuse.footprint(source)?.into_iter().filter(|(_, weight)| *weight > 0.0);
    Some(footprint.map(|(at, weight)| texel(at) * weight).sum())
}
