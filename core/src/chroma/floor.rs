//! The chroma gain that remains at any eccentricity: as much as the eye's sensitivity to large fields is kept there.
//!
//! castleCSF lets sensitivity to gratings of a frequency fall with eccentricity by a fixed ratio per degree, in the
//! temporal and in the nasal visual field. The one in which more is seen counts, as both eyes see most of a view.

use super::Gains;
use crate::perception::csf::{SensitivityFall, Stimulus, VisualField, castle};

/// Frequency of a large field, cycles per degree: the lowest of castleCSF, a half-wave of 8 degrees.
///
/// At this one the red-green contrast of a field of 8 degrees in pure red, green or blue (BT.709, 100 cd/m^2 white)
/// that is scaled by the floor stays above threshold out to 55 degrees, the default end of the curves. An octave
/// higher, green and blue fields would fall below it.
pub const FLOOR_FREQUENCY_CPD: f32 = Stimulus::FREQUENCY_CPD[0];

/// Fall-off of both channels per radian, in octaves (for exp2), >= 0: of Cb as yellow-violet, of Cr as red-green.
pub(super) fn fall_off() -> Gains {
    let field = Stimulus { frequency_cpd: FLOOR_FREQUENCY_CPD, ..Stimulus::default() };
    let per_radian = |fall: SensitivityFall| fall.log2_per_deg(VisualField::Worst) * 1f32.to_degrees();
    Gains {
        cb: per_radian(castle::yellow_violet_fall(&field)),
        cr: per_radian(castle::red_green_fall(&field)),
    }
}

/// Sensitivity to large fields at an eccentricity (radians), relative to that at 0, of both channels: 1 at 0, falling
/// towards 0. Negative counts as 0, and so does NaN.
pub fn floor(eccentricity: f32) -> Gains {
    let Gains { cb, cr } = fall_off();
    Gains { cb: relative(cb, eccentricity), cr: relative(cr, eccentricity) }
}

/// [`floor`] of a channel that falls by `fall_off` octaves per radian.
pub(super) fn relative(fall_off: f32, eccentricity: f32) -> f32 {
    (-fall_off * eccentricity.max(0.0)).exp2()
}
