//! `change`: difference of tiles of an image from an earlier image in the same directions, or, if the head has moved and depth is known, at
//! the same places.
//!
//! A tile has four parts, each of which is compared by the mean luminance of a few samples: finer detail is not seen where
//! pictures are re-used, and comparing it would take a still texture that turns with the head for one that changes.

use super::compose::{DepthRect, nearness_words};
use crate::color::Matrix;
use crate::geometry::Nearness;
use crate::layout::uniform;
use crate::reuse::Reuse;
use glam::{Mat3, UVec2, Vec2, Vec3};

/// Light that is always there, as a share of white: reflections in the lenses. Keeps black from counting as changed by
/// the least that is written to it.
pub const DARK: f32 = 0.005;

/// Share of the difference between the samples of a part that interpolation may have caused, in an interpolated picture.
pub const INTERPOLATED: f32 = 0.5;

/// Limit of a component of a colour, the largest half float.
const LARGEST_COMPONENT: f32 = 65_504.0;

uniform! {
    /// Parameters of the comparison of some tiles with one earlier picture, the shader's uniform of the same name.
    ///
    /// Textures have 0 at their left and upper end, and 1 at the other one.
    pub struct ChangeParams {
        /// From points of the newest picture, in pixels from its corner, to the texture that has the earlier one, by columns.
        pub to_earlier: [[f32; 4]; 3],
        /// Weights of red, green and blue in luminance.
        pub weights: [f32; 3],
        /// [`INTERPOLATED`], or 0 where nothing has moved.
        pub noise: f32,
        /// Size of a pixel of the texture that has the newest picture.
        pub pixel: [f32; 2],
        /// First pixel of the newest picture in its image.
        pub offset: [f32; 2],
        /// Size of the newest picture, pixels.
        pub extent: [f32; 2],
        /// Size of a tile of it, pixels.
        pub tile_size: [f32; 2],
        /// Index of the first of the tiles among the words, and of their first result among the results.
        pub first: [u32; 2],
        /// Number of tiles.
        pub count: u32,
        /// [`DARK`].
        pub dark: f32,
        /// Parallax, if the head has moved: offset of a point after [`Self::to_earlier`], for each 1/m of nearness.
        pub parallax: [f32; 4],
        /// Meaning of depth in the newest picture: [`Nearness::at_zero`], [`Nearness::slope`] and [`Nearness::bounds`].
        pub nearness: [f32; 4],
        /// First pixel of the newest picture's depth in its image.
        pub depth_offset: [u32; 2],
        /// Number of pixels of depth per pixel of the newest picture, along x and y.
        pub depth_scale: [f32; 2],
    }
}

impl ChangeParams {
    /// For tiles of the newest picture of `reuse`, whose rectangle begins at `offset` of its image, compared with the picture of
    /// `age`, 1..=[`Reuse::ages`], at `earlier_offset` of its own; both images are of `extent` pixels. Nothing where there is no
    /// such picture.
    pub fn new(
        reuse: &Reuse,
        age: usize,
        offset: [u32; 2],
        earlier_offset: [u32; 2],
        extent: [u32; 2],
    ) -> Option<Self> {
        let earlier = reuse.at_age(age)?;
        let pixel = 1.0 / UVec2::from(extent).max(UVec2::ONE).as_vec2();
        let to_texture =
            Mat3::from_scale(pixel) * Mat3::from_translation(UVec2::from(earlier_offset).as_vec2());
        let to_earlier = to_texture * earlier.matrix;
        let parallax = earlier.parallax.map(|parallax| to_texture * parallax.shift).unwrap_or_default();
        let nearness = earlier.parallax.map(|parallax| nearness_words(&parallax.now)).unwrap_or_default();
        Some(Self {
            to_earlier: to_earlier.to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0]),
            weights: Matrix::Bt709.weights().into(),
            noise: if earlier.is_still { 0.0 } else { INTERPOLATED },
            pixel: pixel.into(),
            offset: UVec2::from(offset).as_vec2().into(),
            extent: reuse.now().size().into(),
            tile_size: (1.0 / reuse.now().tiles_per_pixel()).into(),
            first: [0; 2],
            count: 0,
            dark: DARK,
            parallax: parallax.extend(0.0).into(),
            nearness,
            depth_offset: [0; 2],
            depth_scale: [0.0; 2],
        })
    }

    /// With the depth of the newest picture in that rectangle of its image.
    pub fn with_depth(self, depth: DepthRect) -> Self {
        let depth_scale = depth.scale(self.extent.into()).into();
        Self { depth_offset: depth.offset, depth_scale, ..self }
    }

    /// Difference of a tile, by column and row: the greatest difference of luminance among its parts, relative to the mean of
    /// both pictures; >= 0.
    ///
    /// `newest` and `earlier` sample the textures, in linear light.
    pub fn change(
        &self,
        tile: [u32; 2],
        newest: impl Fn(Vec2) -> Vec3,
        earlier: impl Fn(Vec2) -> Vec3,
    ) -> f32 {
        self.moved_change(tile, |_| 0.0, newest, earlier)
    }

    /// As [`Self::change`], where the head has moved; `depth` gives the pixels of the newest picture's depth image.
    pub fn moved_change(
        &self,
        tile: [u32; 2],
        depth: impl Fn([u32; 2]) -> f32,
        newest: impl Fn(Vec2) -> Vec3,
        earlier: impl Fn(Vec2) -> Vec3,
    ) -> f32 {
        let mut greatest: f32 = 0.0;
        let mut light = 0.0;
        for part in QUARTERS {
            let (mut sums, mut low, mut high) = ([0.0; 2], [f32::INFINITY; 2], [0.0f32; 2]);
            for tap in QUARTERS {
                let point = self.point(tile, 2 * part + tap);
                let here = (point + Vec2::from(self.offset)) * Vec2::from(self.pixel);
                let samples =
                    [newest(here), earlier(self.earlier(point, &depth))].map(|rgb| self.luminance(rgb));
                for (index, value) in samples.into_iter().enumerate() {
                    sums[index] += value;
                    low[index] = low[index].min(value);
                    high[index] = high[index].max(value);
                }
            }
            let spread = (high[0] - low[0]).max(high[1] - low[1]);
            greatest = greatest.max((sums[0] - sums[1]).abs() / 4.0 - self.noise * spread);
            light += sums[0] + sums[1];
        }
        greatest / (light / 32.0 + self.dark)
    }

    /// The place of one of 4 x 4 samples of a tile, which is within the picture.
    fn point(&self, tile: [u32; 2], sample: UVec2) -> Vec2 {
        let at = UVec2::from(tile).as_vec2() + (sample.as_vec2() + 0.5) / 4.0;
        (at * Vec2::from(self.tile_size)).min(Vec2::from(self.extent) - 1.0).max(Vec2::ZERO)
    }

    fn earlier(&self, point: Vec2, depth: impl Fn([u32; 2]) -> f32) -> Vec2 {
        let [x, y, z, parallax] = [self.to_earlier[0], self.to_earlier[1], self.to_earlier[2], self.parallax]
            .map(|[x, y, z, _]| Vec3::new(x, y, z));
        let [at_zero, slope, least, greatest] = self.nearness;
        let nearness = Nearness { at_zero, slope, bounds: [least, greatest] };
        let pixel = UVec2::from(self.depth_offset) + (point * Vec2::from(self.depth_scale)).as_uvec2();
        let found = x * point.x + y * point.y + z + parallax * nearness.at(depth(pixel.into()));
        found.truncate() / found.z
    }

    fn luminance(&self, rgb: Vec3) -> f32 {
        let component = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, LARGEST_COMPONENT) };
        Vec3::from(self.weights).dot(Vec3::from(rgb.to_array().map(component)))
    }
}

const QUARTERS: [UVec2; 4] = [UVec2::new(0, 0), UVec2::new(1, 0), UVec2::new(0, 1), UVec2::new(1, 1)];

#[cfg(test)]
mod tests;
