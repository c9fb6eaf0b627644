//! Differences between both eyes: age and displacement of the image.
//!
//! Both eyes look at the same thing, so points at the same angle from each eye's gaze show it (corresponding points
//! of the retinas). A point of the left view is turned with the gaze, from the left eye's to the right eye's, to find
//! its partner. That is exact for things at the distance of the fixated one.
//!
//! The displacement of a tile is the horizontal shift of the reference that explains the test best: the best of whole
//! pixels up to [`REACH_PX`] by squared difference, then refined by Gauss-Newton steps on an interpolated reference. It
//! counts as displacement only if it explains at least half of the squared change: blur, noise or loss of colour do not
//! displace. Tiles without horizontal texture have none.

use crate::errors::clip::Eye;
use crate::errors::field::{Field, TILE_PX};
use glam::{Quat, Vec2, Vec3};
use parafovea_core::geometry::resolution;
use parafovea_core::image::Plane;

/// Largest displacement that is looked for, pixels.
pub const REACH_PX: i32 = 8;

/// Least share of the squared change that a displacement must explain.
const EXPLAINED: f32 = 0.5;

/// Refinement ends at steps below this, pixels, or after [`MAX_STEPS`].
const PRECISION_PX: f32 = 1e-3;
const MAX_STEPS: usize = 8;

/// Difference of age, in frames, between each tile of the left view and its partner in the right view. `None` where the
/// partner is not in view or no ages are given.
pub(crate) fn age(eyes: [&Eye; 2], fields: [&Field; 2]) -> Vec<Option<f32>> {
    between(fields, |side, pixel| Some(sample(eyes[side].age.as_ref()?, fields[side], pixel)))
}

/// Difference of displacement, arc minutes, given each view's displacements by tile.
pub(crate) fn disparity(displacements: [&[Option<f32>]; 2], fields: [&Field; 2]) -> Vec<Option<f32>> {
    between(fields, |side, pixel| {
        let [x, y] = (pixel / TILE_PX as f32).to_array().map(|tile| tile as usize);
        displacements[side][y * fields[side].tiles[0] as usize + x]
    })
}

/// |left - right| at each tile of the left view.
fn between(fields: [&Field; 2], value: impl Fn(usize, Vec2) -> Option<f32>) -> Vec<Option<f32>> {
    let turn = turn(fields[0].gaze, fields[1].gaze);
    let difference = |tile: usize| {
        let left = fields[0].tile_centre(tile);
        let right = pixel(fields[1], turn * fields[0].plane.direction(left))?;
        Some((value(0, left)? - value(1, right)?).abs())
    };
    (0..fields[0].tile_pixels.len()).map(difference).collect()
}

/// The rotation from one direction to another.
fn turn(from: Vec3, to: Vec3) -> Quat {
    Quat::from_rotation_arc(from.normalize_or(Vec3::NEG_Z), to.normalize_or(Vec3::NEG_Z))
}

/// Pixel position of a direction in a picture; None outside the picture.
fn pixel(field: &Field, direction: Vec3) -> Option<Vec2> {
    let pixel = (direction.truncate() / -direction.z - field.plane.origin) / field.plane.step;
    let extent = Vec2::new(field.extent[0] as f32, field.extent[1] as f32);
    let inside = direction.z < 0.0 && pixel.cmpge(Vec2::ZERO).all() && pixel.cmplt(extent).all();
    inside.then_some(pixel)
}

/// The texel of a map that is spread over a picture.
fn sample(map: &Plane, field: &Field, pixel: Vec2) -> f32 {
    let at =
        |pixel: f32, side: u32, texels: u32| ((pixel / side as f32 * texels as f32) as u32).min(texels - 1);
    map.at(at(pixel.x, field.extent[0], map.width()), at(pixel.y, field.extent[1], map.height()))
}

/// Displacement of each tile of `test` to the right of `reference`, arc minutes. `None` for tiles without
/// texture to match.
pub(crate) fn displacements(reference: &Plane, test: &Plane, field: &Field) -> Vec<Option<f32>> {
    let displacement = |tile: usize| {
        let window = Window { reference, test, origin: field.tile_origin(tile) };
        let shift = window.shift()?;
        let arc_minutes = 60.0 / resolution(&field.plane, field.tile_centre(tile)).horizontal;
        Some(shift * arc_minutes)
    };
    (0..field.tile_pixels.len()).map(displacement).collect()
}

/// A tile of both pictures.
struct Window<'a> {
    reference: &'a Plane,
    test: &'a Plane,
    origin: [u32; 2],
}

impl Window<'_> {
    /// Pixels to the right.
    fn shift(&self) -> Option<f32> {
        let unmoved = self.cost(0);
        if unmoved == 0.0 {
            return self.is_textured().then_some(0.0);
        }
        if !self.is_textured() {
            return None;
        }
        let nearest_first = (1..=REACH_PX).flat_map(|by| [by, -by]);
        let best = nearest_first.map(|by| (by, self.cost(by)));
        let (whole, _) = best.fold((0, unmoved), |best, next| if next.1 < best.1 { next } else { best });
        let mut shift = whole as f32;
        for _ in 0..MAX_STEPS {
            let (step, _) = self.step(shift);
            shift = (shift + step.clamp(-1.0, 1.0)).clamp(whole as f32 - 1.0, whole as f32 + 1.0);
            if step.abs() < PRECISION_PX {
                break;
            }
        }
        let (_, left) = self.step(shift);
        Some(if left <= (1.0 - EXPLAINED) * unmoved { shift } else { 0.0 })
    }

    fn rows(&self) -> impl Iterator<Item = (&[f32], &[f32])> + '_ {
        let rows = self.origin[1]..(self.origin[1] + TILE_PX).min(self.test.height());
        rows.map(|y| (self.reference.row(y), self.test.row(y)))
    }

    fn columns(&self) -> std::ops::Range<usize> {
        self.origin[0] as usize..(self.origin[0] + TILE_PX).min(self.test.width()) as usize
    }

    /// Whether the reference varies horizontally by more than a code would: RMS step above 0.1 % of its mean.
    fn is_textured(&self) -> bool {
        let (mut steps, mut squares) = (0.0, 0.0);
        for (reference, _) in self.rows() {
            for pair in reference[self.columns()].windows(2) {
                steps += (pair[1] - pair[0]).powi(2);
                squares += pair[0].powi(2);
            }
        }
        steps > 1e-6 * squares
    }

    /// Squared difference between test and the reference moved right by whole pixels.
    fn cost(&self, by: i32) -> f32 {
        let mut sum = 0.0;
        for (reference, test) in self.rows() {
            for x in self.columns() {
                let from = (x as i32 - by).clamp(0, reference.len() as i32 - 1) as usize;
                sum += (test[x] - reference[from]).powi(2);
            }
        }
        sum
    }

    /// The Gauss-Newton step from a shift, and the squared difference at it.
    fn step(&self, shift: f32) -> (f32, f32) {
        let (mut slope_error, mut slopes, mut errors) = (0.0, 0.0, 0.0);
        for (reference, test) in self.rows() {
            for x in self.columns() {
                let (value, slope) = interpolate(reference, x as f32 - shift);
                let error = test[x] - value;
                slope_error += slope * error;
                slopes += slope * slope;
                errors += error * error;
            }
        }
        // d value / d shift = -slope
        (if slopes > 0.0 { -slope_error / slopes } else { 0.0 }, errors)
    }
}

/// Value and slope of the Catmull-Rom spline through a row; the outermost pixels go on.
fn interpolate(row: &[f32], at: f32) -> (f32, f32) {
    let whole = at.floor();
    let t = at - whole;
    let [a, b, c, d] =
        [-1, 0, 1, 2].map(|next| row[(whole as i32 + next).clamp(0, row.len() as i32 - 1) as usize]);
    let (linear, quadratic, cubic) =
        (0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d, 1.5 * (b - c) + 0.5 * (d - a));
    (b + t * (linear + t * (quadratic + t * cubic)), linear + t * (2.0 * quadratic + 3.0 * t * cubic))
}

#[cfg(test)]
mod tests;
