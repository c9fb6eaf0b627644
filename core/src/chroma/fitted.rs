//! The curves as polynomials, as the GPU evaluates them: powers cost it more than all the rest of a pixel.
//!
//! Each is fitted in what makes it smooth, where both ends of it are exact: Eq. 1 of paper C is about a power of the root of
//! what is left to its end, Eq. 2 one of the root of what lies behind. Distances are chords of the unit sphere, which
//! take no arc cosine: 2 sin(a / 2) for an angle a.

use super::curves::{AT_ONCE, Curves, Gains, cb_gain, cr_gain};
use super::floor;
use std::f32::consts::PI;

/// Terms of a polynomial, from the constant on.
pub const TERMS: usize = 6;

/// Terms of that of the floor of Cb, which hardly falls.
pub const FLAT_TERMS: usize = 4;

/// Beyond this chord, of 130 degrees, floors fall no further: no view shows as much. The shader has the same number.
const FARTHEST: f32 = 1.812_616;

/// Shortest range that anything is fitted over.
const SHORTEST: f32 = 1e-3;

/// [`Curves`] around what counts as looked at, over the chord between a direction and the middle of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedCurves {
    /// Chord at which the plateau ends.
    pub start: f32,
    /// How much longer it is where the curves end.
    pub end: f32,
    /// Of each power: Eq. 1 over the root of what is left to `end`; Eq. 2 over the root of what lies behind `start`; the rim
    /// fade and the floor of Cr over what lies behind `start`.
    pub terms: [[f32; 4]; TERMS],
    /// The floor of Cb over what lies behind `start`.
    pub cb_floor: [f32; FLAT_TERMS],
}

impl FittedCurves {
    /// The curves around directions that reach `radius` (radians, 0..=pi) around their middle.
    pub fn new(curves: &Curves, radius: f32) -> Self {
        let start = chord(curves.plateau + radius);
        let end = (chord(curves.plateau + 1.0 / curves.range_scale + radius) - start).max(SHORTEST);
        let farthest = (FARTHEST - start).max(end);
        // What counts as eccentricity at so much more than `start`, and that as the curves have it.
        let angle = |more: f32| 2.0 * ((start + more) / 2.0).min(1.0).asin() - radius;
        let normalised = |more: f32| (angle(more) - curves.plateau) * curves.range_scale;
        let fades = curves.rim_scale < AT_ONCE;
        let rim = |more: f32| if fades { 1.0 - normalised(more).max(0.0) * curves.rim_scale } else { 0.0 };
        let floor = |fall_off: f32| {
            move |more: f32| if fall_off < AT_ONCE { floor::relative(fall_off, angle(more)) } else { 0.0 }
        };
        let polynomials: [[f32; TERMS]; 4] = [
            fitted(end.sqrt(), |root| cb_gain(normalised(end - root * root), curves.cb_bound)),
            fitted(end.sqrt(), |root| cr_gain(normalised(root * root), curves.cr_bound)),
            fitted(farthest, rim),
            fitted(farthest, floor(curves.cr_fall_off)),
        ];
        Self {
            start,
            end,
            terms: std::array::from_fn(|term| polynomials.map(|terms| terms[term])),
            cb_floor: fitted(farthest, floor(curves.cb_fall_off)),
        }
    }

    /// Gains at a chord beyond `start`, within .002 of [`Curves::gains`] for the default settings, and .02 for any.
    pub fn gains(&self, chord: f32) -> Gains {
        let more = (chord - self.start).min((FARTHEST - self.start).max(self.end));
        let roots = [self.end - more, more.min(self.end)].map(|of| of.max(0.0).sqrt());
        let over = [roots[0], roots[1], more, more];
        let [cb, cr, rim, cr_floor] = [0, 1, 2, 3]
            .map(|curve| self.terms.iter().rev().fold(0.0, |sum, term| sum * over[curve] + term[curve]));
        let cb_floor = self.cb_floor.iter().rev().fold(0.0, |sum, term| sum * more + term);
        Gains { cb: cb.max(cb_floor), cr: cr.max(rim).max(cr_floor) }
    }
}

/// The chord of an angle, radians.
fn chord(angle: f32) -> f32 {
    2.0 * (angle.min(PI) / 2.0).sin()
}

/// The polynomial that has the values of a function at 0, at `end`, and where the extrema of a Chebyshev polynomial are between.
fn fitted<const N: usize>(end: f32, function: impl Fn(f32) -> f32) -> [f32; N] {
    let end = f64::from(end);
    let nodes: [f64; N] = std::array::from_fn(|node| {
        end * (0.5 - 0.5 * (std::f64::consts::PI * node as f64 / (N - 1) as f64).cos())
    });
    // Newton's divided differences, then the powers that they stand for.
    let mut differences = nodes.map(|at| f64::from(function(at as f32)));
    for order in 1..N {
        for node in (order..N).rev() {
            differences[node] =
                (differences[node] - differences[node - 1]) / (nodes[node] - nodes[node - order]);
        }
    }
    let mut terms = [0.0; N];
    for (node, difference) in nodes.into_iter().zip(differences).rev() {
        for term in (1..N).rev() {
            terms[term] = terms[term - 1] - node * terms[term];
        }
        terms[0] = difference - node * terms[0];
    }
    terms.map(|term| term as f32)
}

#[cfg(test)]
mod tests {
    use super::super::{ChromaSettings, Mode};
    use super::*;
    use proptest::prelude::*;

    /// The greatest error of both channels from the plateau to the farthest angle.
    fn errors(settings: &ChromaSettings, radius: f32) -> [f32; 2] {
        let curves = Curves::new(settings);
        let found = FittedCurves::new(&curves, radius);
        let mut errors = [0.0f32; 2];
        for step in 0..=2000 {
            let farthest = 130f32.to_radians() - radius;
            let angle = curves.plateau + (farthest - curves.plateau) * step as f32 / 2000.0;
            if angle <= curves.plateau {
                continue;
            }
            let (exact, gains) = (curves.gains(angle), found.gains(chord(angle + radius)));
            errors = [errors[0].max((exact.cb - gains.cb).abs()), errors[1].max((exact.cr - gains.cr).abs())];
        }
        errors
    }

    #[test]
    fn the_default_is_closer_than_a_code_value() {
        for radius in [0.0, 0.1, 0.3] {
            let [cb, cr] = errors(&ChromaSettings::default(), radius);
            assert!(cb < 0.002 && cr < 0.002, "{cb}, {cr} at {radius}");
        }
    }

    #[test]
    fn both_ends_are_exact() {
        for mode in [Mode::Default, Mode::Paper] {
            let found =
                FittedCurves::new(&Curves::new(&ChromaSettings { mode, ..ChromaSettings::default() }), 0.2);
            let start = found.gains(found.start);
            assert!((start.cb - 1.0).abs() < 1e-5 && (start.cr - 1.0).abs() < 1e-5, "{start:?}");
        }
        let paper = ChromaSettings { mode: Mode::Paper, ..ChromaSettings::default() };
        let found = FittedCurves::new(&Curves::new(&paper), 0.0);
        for beyond in [0.0, 0.1, 0.5] {
            let end = found.gains(found.start + found.end + beyond);
            assert!(end.cb.abs() < 1e-4 && end.cr.abs() < 1e-4, "{end:?}");
        }
    }

    proptest! {
        #[test]
        fn any_settings_are_close(
            is_paper in any::<bool>(), cb_bound in 0.70f32..=0.85, cr_bound in 0.35f32..=0.55, plateau_deg in 1.1f32..30.0,
            max_eccentricity_deg in 20.0f32..110.0, rim_fade in 0.25f32..=1.0, radius in 0.0f32..1.0,
        ) {
            let mode = if is_paper { Mode::Paper } else { Mode::Default };
            let settings = ChromaSettings {
                mode, cb_bound, cr_bound, plateau_deg, max_eccentricity_deg, rim_fade, ..ChromaSettings::default()
            };
            let [cb, cr] = errors(&settings, radius);
            prop_assert!(cb < 0.01 && cr < 0.02, "{}, {}", cb, cr);
        }

        /// Also where next to everything is looked at.
        #[test]
        fn gains_are_numbers(radius in 0.0f32..3.2, more in 0.0f32..2.0, plateau_deg in 1.1f32..30.0) {
            let settings = ChromaSettings { plateau_deg, ..ChromaSettings::default() };
            let found = FittedCurves::new(&Curves::new(&settings), radius);
            let gains = found.gains((found.start + more).min(2.0));
            prop_assert!((-0.05..=1.05).contains(&gains.cb) && (-0.05..=1.05).contains(&gains.cr), "{:?}", gains);
        }
    }
}
