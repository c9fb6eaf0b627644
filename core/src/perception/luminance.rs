//! Luminance of colours.

use crate::color::Matrix;
use crate::image::Plane;
use glam::Vec3;

/// The brightest that a pixel is taken to be, cd/m^2: the end of castleCSF's domain and of SMPTE ST 2084.
pub const BRIGHTEST_CD_M2: f32 = 10_000.0;

/// Luminance of white where nothing else is known, cd/m^2: paper A's headsets, as most, show about 100.
pub const USUAL_WHITE_CD_M2: f32 = 100.0;

/// The largest half float: the limit of a component of any image, infinity aside.
const LARGEST_COMPONENT: f32 = 65_504.0;

/// Luminance of a colour in linear light whose white (1, 1, 1) is `white_cd_m2`, in cd/m^2, 0..=10,000.
///
/// `matrix` weights the components. A NaN component counts as 0, an infinite one as the largest that an image holds, and
/// a negative result as black. A white that is not finite or not above 0 is [`USUAL_WHITE_CD_M2`].
pub fn luminance(rgb: Vec3, white_cd_m2: f32, matrix: Matrix) -> f32 {
    bounded(rgb.to_array().map(component), usable_white(white_cd_m2), matrix.weights())
}

/// [`luminance`] of every pixel of `colors`, into `out`, which takes their size.
pub fn luminance_plane(colors: &Plane<Vec3>, white_cd_m2: f32, matrix: Matrix, out: &mut Plane) {
    out.resize(colors.width(), colors.height());
    let (white, weights) = (usable_white(white_cd_m2), matrix.weights());
    for (luminance, rgb) in out.texels_mut().iter_mut().zip(colors.texels()) {
        *luminance = bounded(rgb.to_array().map(component), white, weights);
    }
}

fn bounded([r, g, b]: [f32; 3], white_cd_m2: f32, weights: Vec3) -> f32 {
    let relative = weights.x * r + weights.y * g + weights.z * b;
    (relative * white_cd_m2).clamp(0.0, BRIGHTEST_CD_M2)
}

/// A luminance of white, or the usual one in place of an impossible one.
pub(crate) fn usable_white(white_cd_m2: f32) -> f32 {
    if white_cd_m2.is_finite() && white_cd_m2 > 0.0 { white_cd_m2 } else { USUAL_WHITE_CD_M2 }
}

/// Looks at the bits, as a shader must: compilers may assume that there is no NaN and fold the usual test away.
fn component(value: f32) -> f32 {
    let is_nan = value.to_bits() & 0x7fff_ffff > 0x7f80_0000;
    if is_nan { 0.0 } else { value.clamp(-LARGEST_COMPONENT, LARGEST_COMPONENT) }
}

/// A luminance that may come from anywhere, as one that [`luminance`] gives: negative values and NaN as 0.
///
/// One comparison of bits: as integers, values with a sign and NaN are above positive infinity.
pub(crate) fn as_luminance(value: f32) -> f32 {
    if value.to_bits() > 0x7f80_0000 { 0.0 } else { value.min(BRIGHTEST_CD_M2) }
}

#[cfg(test)]
mod tests;
