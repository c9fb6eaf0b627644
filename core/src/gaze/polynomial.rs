//! Polynomials that correct the direction of the gaze.
//!
//! Video eye trackers map pupils to angles by polynomials of the first or second order in both axes (Sheena and Borah 1981; Stampe 1993);
//! more terms than nine points support add error between and beyond the points (Cerrolaza, Villanueva and Cabeza 2012).

use super::recentre::MAX_OFFSET_DEG;

/// Number of terms of the second order: 1, left, up, left * left, left * up, up * up.
const TERMS: usize = 6;

/// Unit of the angles in the terms, degrees: all terms have about the same size then.
const UNIT_DEG: f32 = 10.0;

/// The widest angle of an area, degrees: more than headsets show of a turn of the eyes.
const WIDEST_DEG: f32 = 60.0;

/// Least area in the view, as a share of the area in the eye tracker's angles, that a correction makes of any small part: a fold is below 0.
const LEAST_SCALE: f32 = 0.25;

/// Number of the terms in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PolynomialOrder {
    /// A constant angle.
    Offset,
    /// Besides, scale, rotation and shear.
    Affine,
    /// Besides, curvature.
    SecondOrder,
}

impl PolynomialOrder {
    /// All of them, the simplest first.
    pub const ALL: [Self; 3] = [Self::Offset, Self::Affine, Self::SecondOrder];

    /// Number of terms for each axis.
    pub const fn terms(self) -> usize {
        match self {
            Self::Offset => 1,
            Self::Affine => 3,
            Self::SecondOrder => TERMS,
        }
    }
}

/// A correction that depends on the direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazePolynomial {
    coefficients_deg: [[f32; TERMS]; 2],
    area_deg: [[f32; 2]; 2],
}

impl GazePolynomial {
    /// A polynomial of the angles that are added to the gaze to the left and upwards, degrees, for the terms 1, left, up, left * left,
    /// left * up and up * up, with angles in units of 10 degrees; measured between two corners of an area, right and down, then left and up,
    /// degrees. `None` if it is implausible: it moves a gaze in the area by more than [`MAX_OFFSET_DEG`], or folds the area.
    pub fn new(coefficients_deg: [[f32; TERMS]; 2], area_deg: [[f32; 2]; 2]) -> Option<Self> {
        let [low, high] = area_deg;
        let is_area =
            (0..2).all(|axis| -WIDEST_DEG <= low[axis] && low[axis] < high[axis] && high[axis] <= WIDEST_DEG);
        let polynomial = Self { coefficients_deg, area_deg };
        let is_plausible = || polynomial.grid().all(|angles| polynomial.is_plausible_at(angles));
        (is_area && is_plausible()).then_some(polynomial)
    }

    /// The coefficients, as in [`Self::new`].
    pub fn coefficients_deg(&self) -> [[f32; TERMS]; 2] {
        self.coefficients_deg
    }

    /// The area, as in [`Self::new`].
    pub fn area_deg(&self) -> [[f32; 2]; 2] {
        self.area_deg
    }

    /// A gaze of so many degrees to the left and upwards, corrected. Beyond the area it gets the correction of the area's edge, so that no
    /// correction is larger than measured ones.
    pub fn corrected(&self, left_up_deg: [f32; 2]) -> [f32; 2] {
        let [low, high] = self.area_deg;
        let within = [0, 1].map(|axis| left_up_deg[axis].max(low[axis]).min(high[axis]));
        let terms = terms(within);
        [0, 1].map(|axis| {
            let row = &self.coefficients_deg[axis];
            left_up_deg[axis] + row.iter().zip(terms).map(|(factor, term)| factor * term).sum::<f32>()
        })
    }

    /// Points over the area.
    fn grid(&self) -> impl Iterator<Item = [f32; 2]> {
        let [low, high] = self.area_deg;
        let at = move |axis: usize, step: u8| low[axis] + (high[axis] - low[axis]) * f32::from(step) / 4.0;
        (0..25u8).map(move |index| [at(0, index % 5), at(1, index / 5)])
    }

    fn is_plausible_at(&self, angles: [f32; 2]) -> bool {
        let moved = self.corrected(angles);
        let far = (moved[0] - angles[0]).hypot(moved[1] - angles[1]);
        let [left, up] = angles.map(|angle| angle / UNIT_DEG);
        let [[by_left, up_by_left], [left_by_up, by_up]] =
            [[0.0, 1.0, 0.0, 2.0 * left, up, 0.0], [0.0, 0.0, 1.0, 0.0, left, 2.0 * up]].map(|slopes| {
                self.coefficients_deg.map(|row| {
                    row.iter().zip(slopes).map(|(factor, slope)| factor * slope).sum::<f32>() / UNIT_DEG
                })
            });
        let scale = (1.0 + by_left) * (1.0 + by_up) - up_by_left * left_by_up;
        // Not finite is implausible, too.
        far <= MAX_OFFSET_DEG + 0.1 && scale >= LEAST_SCALE
    }
}

fn terms(left_up_deg: [f32; 2]) -> [f32; TERMS] {
    let [left, up] = left_up_deg.map(|angle| angle / UNIT_DEG);
    [1.0, left, up, left * left, left * up, up * up]
}

/// The coefficients that move measured angles nearest to the wanted ones, by least squares; `None` if the points do not determine them.
pub(super) fn least_squares(
    order: PolynomialOrder,
    pairs: impl Iterator<Item = ([f32; 2], [f32; 2])>,
) -> Option<[[f32; TERMS]; 2]> {
    let count = order.terms();
    // Normal equations, and the right sides of both axes.
    let mut rows = [[0.0f64; TERMS + 2]; TERMS];
    for (measured, wanted) in pairs {
        let terms = terms(measured).map(f64::from);
        for (row, term) in rows.iter_mut().zip(terms).take(count) {
            for (sum, other) in row.iter_mut().zip(terms).take(count) {
                *sum += term * other;
            }
            for axis in 0..2 {
                row[TERMS + axis] += term * f64::from(wanted[axis] - measured[axis]);
            }
        }
    }
    for column in 0..count {
        let pivot = (column..count)
            .max_by(|one, other| rows[*one][column].abs().total_cmp(&rows[*other][column].abs()))?;
        rows.swap(column, pivot);
        if rows[column][column].abs() < 1e-6 {
            return None;
        }
        let pivot_row = rows[column];
        for (index, row) in rows.iter_mut().enumerate().take(count) {
            if index != column {
                let factor = row[column] / pivot_row[column];
                row.iter_mut().zip(pivot_row).for_each(|(value, other)| *value -= factor * other);
            }
        }
    }
    let mut coefficients = [[0.0; TERMS]; 2];
    for (axis, solved) in coefficients.iter_mut().enumerate() {
        for (term, value) in solved.iter_mut().enumerate().take(count) {
            *value = (rows[term][TERMS + axis] / rows[term][term]) as f32;
        }
    }
    Some(coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const AREA: [[f32; 2]; 2] = [[-12.0, -9.0], [12.0, 9.0]];

    fn points() -> Vec<[f32; 2]> {
        [-9.0f32, 0.0, 9.0].iter().flat_map(|up| [-12.0f32, 0.0, 12.0].map(|left| [left, *up])).collect()
    }

    proptest! {
        #[test]
        fn coefficients_are_found_again(all in proptest::array::uniform2(proptest::array::uniform6(-1f32..1.0))) {
            let Some(planted) = GazePolynomial::new(all, AREA) else { return Ok(()) };
            let pairs = points().into_iter().map(|measured| (measured, planted.corrected(measured)));
            let found = least_squares(PolynomialOrder::SecondOrder, pairs).unwrap();
            for (found, planted) in found.iter().flatten().zip(all.iter().flatten()) {
                prop_assert!((found - planted).abs() < 1e-3, "{found} {planted}");
            }
        }

        #[test]
        fn a_plausible_polynomial_moves_no_gaze_far(
            all in proptest::array::uniform2(proptest::array::uniform6(
                prop_oneof![proptest::num::f32::ANY, -8f32..8.0])),
            gaze in proptest::array::uniform2(-180f32..180.0),
        ) {
            if let Some(polynomial) = GazePolynomial::new(all, AREA) {
                let [left, up] = polynomial.corrected(gaze);
                // Between the points that are checked, a little more.
                prop_assert!((left - gaze[0]).hypot(up - gaze[1]) <= MAX_OFFSET_DEG * 1.5);
            }
        }
    }

    #[test]
    fn folds_and_large_corrections_are_implausible() {
        let with = |axis: usize, term: usize, value: f32| {
            let mut all = [[0.0; TERMS]; 2];
            all[axis][term] = value;
            GazePolynomial::new(all, AREA)
        };
        assert!(with(0, 0, 9.9).is_some() && with(0, 0, 10.2).is_none());
        assert!(with(0, 1, -7.0).is_some() && with(0, 1, -8.0).is_none(), "narrowed to a fifth");
        assert!(with(1, 5, -3.0).is_some() && with(1, 5, -6.0).is_none(), "folded at the edge");
        assert!(with(0, 3, f32::NAN).is_none() && with(1, 0, f32::INFINITY).is_none());
        for area in [[[0.0; 2]; 2], [[12.0, 9.0], [-12.0, -9.0]], [[f32::NAN; 2]; 2], [[-99.0; 2], [99.0; 2]]]
        {
            assert!(GazePolynomial::new([[0.0; TERMS]; 2], area).is_none(), "{area:?}");
        }
    }

    #[test]
    fn beyond_the_area_the_correction_is_that_of_the_edge() {
        let mut all = [[0.0; TERMS]; 2];
        all[0][1] = 1.0;
        let polynomial = GazePolynomial::new(all, AREA).unwrap();
        assert_eq!(polynomial.corrected([12.0, 0.0]), [13.2, 0.0]);
        assert_eq!(polynomial.corrected([30.0, 40.0]), [31.2, 40.0]);
    }

    #[test]
    fn points_on_a_line_determine_no_curvature() {
        let pairs = || (0..9).map(|step| ([step as f32, 0.0], [step as f32 + 1.0, 0.0]));
        assert!(least_squares(PolynomialOrder::Affine, pairs()).is_none());
        assert_eq!(least_squares(PolynomialOrder::Offset, pairs()).unwrap()[0][0], 1.0);
    }
}
