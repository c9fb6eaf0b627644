//! Reference of the kernel `compose`: the work on the pixels of one region, a rectangle of an image that
//! shows one eye's view, after the whole image was copied.
//!
//! The region is divided into tiles of [`TILE_SIZE`] pixels; tiles without work are not drawn, and pixels
//! inside the plateau of full colour around the gaze are not written.
//!
//! Where parts of the picture were not rendered, these are taken from earlier pictures first ([`reuse_image`]).

mod image;
mod reuse;

pub use image::{PixelFormat, compose_image};
pub(in crate::kernels) use reuse::nearness_words;
pub use reuse::{DepthPixels, DepthRect, EarlierPixels, ReuseParams, reuse_image};

use crate::chroma::{ChromaSettings, Curves, Focus, Gamut, Mode, Polynomials, attenuate};
use crate::geometry::{Fov, ImagePlane, PixelRect, eccentricity, tile_eccentricity, unit_direction};
use crate::layout::uniform;
use glam::{UVec2, Vec2, Vec3};

/// Side of a tile in pixels. The shader has the same constant.
pub const TILE_SIZE: u32 = 64;

uniform! {
    /// Parameters of one region, the shader's uniform of the same name.
    pub struct ComposeParams {
        /// First pixel of the region.
        pub rect_offset: [u32; 2],
        /// Size of the region, pixels.
        pub rect_extent: [u32; 2],
        /// [`ImagePlane::origin`] of the region.
        pub plane_origin: [f32; 2],
        /// [`ImagePlane::step`] of the region.
        pub plane_step: [f32; 2],
        /// Centre of the gaze region, in view space, of unit length; all 0 when there are
        /// none, and then no work.
        pub gaze: [f32; 3],
        /// [`Curves::plateau`], radians.
        pub plateau: f32,
        /// Kr, see [`crate::color::Matrix::weights`].
        pub red_weight: f32,
        /// Kb; Kg is the rest to 1.
        pub blue_weight: f32,
        /// [`Curves::range_scale`], per radian.
        pub range_scale: f32,
        /// [`Curves::rim_scale`].
        pub rim_scale: f32,
        /// [`Polynomials::cb_loss`].
        pub cb_loss: [f32; 4],
        /// The first four of [`Polynomials::cr_loss`].
        pub cr_loss: [f32; 4],
        /// The last one.
        pub cr_loss_last: f32,
        /// [`Curves::cb_fall_off`], octaves per radian.
        pub cb_fall_off: f32,
        /// [`Curves::cr_fall_off`], octaves per radian.
        pub cr_fall_off: f32,
        /// [`Focus::radius`], radians.
        pub radius: f32,
        /// [`Focus::strength`].
        pub strength: f32,
        /// [`Gamut::floor`].
        pub gamut_floor: f32,
        /// [`Gamut::ceiling`].
        pub gamut_ceiling: f32,
        /// Fills the last slot.
        pub unused: u32,
    }
}

impl ComposeParams {
    /// Parameters of the rectangle of `rect_extent` pixels at `rect_offset`, which shows `fov` as seen with
    /// `gaze`: a direction in that eye's view space, +x right, +y up, -z forward. Without a usable gaze
    /// (zero, not finite) there is no work. `clamp_to_unit`: the image stores 0..=1 only.
    ///
    /// Attenuation follows that gaze alone; for a focus, see [`Self::following`].
    pub fn new(
        rect_offset: [u32; 2],
        rect_extent: [u32; 2],
        fov: Fov,
        gaze: Vec3,
        settings: &ChromaSettings,
        clamp_to_unit: bool,
    ) -> Self {
        let plane = fov.tangents().plane(rect_extent);
        let polynomials = Polynomials::new(&Curves::new(settings));
        let [first, second, third, fourth, cr_loss_last] = polynomials.cr_loss;
        let gamut = match (settings.mode, clamp_to_unit) {
            (Mode::Paper, _) => Gamut::UNBOUNDED,
            (Mode::Default, true) => Gamut::UNIT,
            (Mode::Default, false) => Gamut::POSITIVE,
        };
        let weights = settings.matrix.weights();
        Self {
            rect_offset,
            rect_extent,
            plane_origin: plane.origin.into(),
            plane_step: plane.step.into(),
            gaze: unit_direction(gaze).unwrap_or(Vec3::ZERO).into(),
            plateau: polynomials.plateau,
            red_weight: weights.x,
            blue_weight: weights.z,
            range_scale: polynomials.range_scale,
            rim_scale: polynomials.rim_scale,
            cb_loss: polynomials.cb_loss,
            cr_loss: [first, second, third, fourth],
            cr_loss_last,
            cb_fall_off: polynomials.cb_fall_off,
            cr_fall_off: polynomials.cr_fall_off,
            radius: 0.0,
            strength: 1.0,
            gamut_floor: gamut.floor,
            gamut_ceiling: gamut.ceiling,
            unused: 0,
        }
    }

    /// With a focus in place of the gaze; its direction is in that eye's view space too.
    pub fn following(mut self, focus: Focus) -> Self {
        self.gaze = unit_direction(focus.direction).unwrap_or(Vec3::ZERO).into();
        self.radius = focus.radius;
        self.strength = focus.strength;
        self
    }

    /// The part of the region inside an image of `extent` pixels, if any. The content of its pixels is unchanged.
    pub fn clipped(mut self, extent: [u32; 2]) -> Option<Self> {
        let room = UVec2::from(extent).saturating_sub(self.rect_offset.into());
        self.rect_extent = room.min(self.rect_extent.into()).into();
        (self.rect_extent[0] > 0 && self.rect_extent[1] > 0).then_some(self)
    }

    /// Columns and rows of tiles.
    pub fn tile_grid(&self) -> [u32; 2] {
        self.rect_extent.map(|side| side.div_ceil(TILE_SIZE))
    }

    /// Whether any pixel of a tile lies outside of the plateau.
    pub fn tile_has_work(&self, tile: [u32; 2]) -> bool {
        let min = UVec2::from(tile) * TILE_SIZE;
        let max = (min + TILE_SIZE).min(self.rect_extent.into());
        self.rect_has_work(min.as_vec2(), max.as_vec2())
    }

    /// Whether any pixel of the region lies outside of the plateau.
    pub fn has_work(&self) -> bool {
        self.rect_has_work(Vec2::ZERO, UVec2::from(self.rect_extent).as_vec2())
    }

    fn rect_has_work(&self, min: Vec2, max: Vec2) -> bool {
        let (plane, gaze) = (self.plane(), self.gaze.into());
        let reaches = |angle: f32| angle - self.radius > self.plateau;
        // One corner settles it for nearly every region, at a twelfth of the arc tangents.
        self.strength > 0.0
            && (reaches(eccentricity(plane.direction(min), gaze))
                || reaches(tile_eccentricity(&plane, PixelRect { min, max }, gaze).max))
    }

    /// The new colour of the pixel at (`x`, `y`) of the region, given its colour in linear light; nothing inside
    /// the plateau.
    pub fn pixel(&self, x: u32, y: u32, rgb: Vec3) -> Option<Vec3> {
        let direction = self.plane().direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let angle = eccentricity(direction, self.gaze.into()) - self.radius;
        if angle <= self.plateau || self.strength <= 0.0 {
            return None;
        }
        let gains = self.polynomials().gains(angle).at_strength(self.strength);
        Some(attenuate(rgb, gains, self.weights(), self.gamut()))
    }

    fn plane(&self) -> ImagePlane {
        ImagePlane { origin: self.plane_origin.into(), step: self.plane_step.into() }
    }

    fn polynomials(&self) -> Polynomials {
        let [first, second, third, fourth] = self.cr_loss;
        Polynomials {
            plateau: self.plateau,
            range_scale: self.range_scale,
            rim_scale: self.rim_scale,
            cb_loss: self.cb_loss,
            cr_loss: [first, second, third, fourth, self.cr_loss_last],
            cb_fall_off: self.cb_fall_off,
            cr_fall_off: self.cr_fall_off,
        }
    }

    fn weights(&self) -> Vec3 {
        Vec3::new(self.red_weight, 1.0 - self.red_weight - self.blue_weight, self.blue_weight)
    }

    fn gamut(&self) -> Gamut {
        Gamut { floor: self.gamut_floor, ceiling: self.gamut_ceiling }
    }
}

#[cfg(test)]
mod tests;
