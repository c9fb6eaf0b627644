//! What is kept of chroma at any eccentricity: as much as the eye's sensitivity to large fields is kept there.
//!
//! castleCSF (Ashraf et al. 2024, J. Vision 24(4):5) lets the sensitivity to red-green and yellow-violet gratings of
//! frequency rho fall with eccentricity e as 10^(-(k_e + k_f rho) e), with constants of their own for the temporal and
//! the nasal visual field; constants as in its revision f4b0b72, `CSF_castleCSF.m`, get_default_par. The field in which
//! more is seen counts, since both eyes see most of the view and its fields overlap.

use super::Gains;

/// Frequency of a large field, cycles per degree: the lowest of castleCSF, a half-wave of 8 degrees.
///
/// At this one the red-green contrast of a field of 8 degrees in pure red, green or blue (BT.709, 100 cd/m^2 white)
/// that is scaled by the floor stays above threshold out to 55 degrees, the default end of the curves. An octave
/// higher, green and blue fields would fall below it.
pub const FLOOR_FREQUENCY_CPD: f32 = 0.0625;

/// k_e and k_f of a visual field: decades per degree, and per degree and cycle per degree.
type FallOff = (f32, f32);

const RED_GREEN_TEMPORAL: FallOff = (0.059_140_2, 2.049_86e-69_f64 as f32);
const RED_GREEN_NASAL: FallOff = (2.896_15e-5, 0.181_08);
const YELLOW_VIOLET_TEMPORAL: FallOff = (0.003_568_65, 0.008_066_31);
const YELLOW_VIOLET_NASAL: FallOff = (5.858_04e-141_f64 as f32, 0.011_066_2);

/// Fall-off of both channels per radian, in octaves (for exp2): of Cb as yellow-violet, of Cr as red-green.
pub(super) const FALL_OFF: Gains = Gains {
    cb: octaves_per_radian(YELLOW_VIOLET_TEMPORAL, YELLOW_VIOLET_NASAL),
    cr: octaves_per_radian(RED_GREEN_TEMPORAL, RED_GREEN_NASAL),
};

/// Of the visual field in which sensitivity falls less. As each is one exponential, it is the same at every angle.
const fn octaves_per_radian(temporal: FallOff, nasal: FallOff) -> f32 {
    let temporal = temporal.0 + temporal.1 * FLOOR_FREQUENCY_CPD;
    let nasal = nasal.0 + nasal.1 * FLOOR_FREQUENCY_CPD;
    let decades_per_degree = if temporal < nasal { temporal } else { nasal };
    decades_per_degree * std::f32::consts::LOG2_10 * (180.0 / std::f32::consts::PI)
}

/// Sensitivity to large fields at an eccentricity (radians), relative to that at 0, of both channels: 1 at 0, falling
/// to 0. Negative counts as 0, and so does NaN.
pub fn floor(eccentricity: f32) -> Gains {
    let relative = |fall_off: f32| (-fall_off * eccentricity.max(0.0)).exp2();
    Gains { cb: relative(FALL_OFF.cb), cr: relative(FALL_OFF.cr) }
}
