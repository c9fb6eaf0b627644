//! Nine-point calibration: the user looks at nine dots one after the other, and a polynomial is fitted that moves the measured gaze
//! onto them.

use super::fixation::{DotLook, DotTiming, Fixation, NoFixation, distance};
use super::polynomial::{GazePolynomial, PolynomialOrder, least_squares};
use super::recentre::MAX_OFFSET_DEG;
use std::fmt;

/// Angles of the outer dots from the middle: within the 15 degrees that most natural saccades stay below (Bahill, Adler and Stark
/// 1975), beyond which the head turns as well, and within the pictures of all headsets; less upwards and downwards, as lids and lashes
/// cover the pupils there, and eyes turn less.
const WIDE_DEG: f32 = 12.0;
const HIGH_DEG: f32 = 9.0;

/// Positions of the dots, degrees to the left and upwards of the head's forward direction, in the order of their appearance: the
/// middle, then around it, each near the one before.
pub const DOTS_DEG: [[f32; 2]; 9] = [
    [0.0, 0.0],
    [0.0, HIGH_DEG],
    [-WIDE_DEG, HIGH_DEG],
    [-WIDE_DEG, 0.0],
    [-WIDE_DEG, -HIGH_DEG],
    [0.0, -HIGH_DEG],
    [WIDE_DEG, -HIGH_DEG],
    [WIDE_DEG, 0.0],
    [WIDE_DEG, HIGH_DEG],
];

const NAMES: [&str; 9] = [
    "the middle",
    "the top",
    "the top right",
    "the right",
    "the bottom right",
    "the bottom",
    "the bottom left",
    "the left",
    "the top left",
];

/// A dot lasts 1.5 s: a saccade follows it after 200 to 250 ms (Carpenter 1988), and lands within 100 ms. A fixation of half a second is
/// longer than fixations in a scene (200 to 400 ms).
const TIMING: DotTiming =
    DotTiming { settle_ns: 700_000_000, measured_ns: 800_000_000, fixation_ns: 500_000_000 };

/// The first dot appears anywhere.
const FIRST: DotTiming = DotTiming { settle_ns: 1_500_000_000, ..TIMING };

/// A dot stays after a blink, or without a fixation.
const AGAIN: DotTiming = DotTiming { settle_ns: 0, ..TIMING };

/// Largest number of measurements of a dot.
const MOST_TRIES: u8 = 4;

/// The largest distance from a dot that a fit may leave, degrees: 2 degrees are the mean error of headsets without a calibration of ours. More
/// is a look at something else.
const MAX_RESIDUAL_DEG: f32 = 2.0;

/// A higher order is worth its terms if it leaves less than this share of the error.
const LESS_ERROR: f32 = 0.9;

/// The least gain over the present correction, degrees: less is below the noise of trackers.
const LEAST_GAIN_DEG: f32 = 0.05;

/// Some of the nine dots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dots(u16);

impl Dots {
    fn of(is_one: impl Fn(usize) -> bool) -> Self {
        Self((0..DOTS_DEG.len()).filter(|dot| is_one(*dot)).map(|dot| 1 << dot).sum())
    }

    fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl fmt::Display for Dots {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = NAMES
            .iter()
            .enumerate()
            .filter(|(dot, _)| self.0 >> dot & 1 == 1)
            .map(|(_, name)| *name)
            .collect();
        match names.as_slice() {
            [all @ .., last] if !all.is_empty() => write!(f, "the dots at {} and {last}", all.join(", ")),
            names => write!(f, "the dot at {}", names.join("")),
        }
    }
}

/// Reason why a calibration gave no correction.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationFailure {
    /// It has not come to its end.
    #[error("not all dots were shown")]
    Unfinished,
    /// Too few samples.
    #[error("the eye tracker did not see the eyes long enough at {0}")]
    NoGaze(Dots),
    /// No steady fixation, or several of them.
    #[error("the gaze did not rest on one point for half a second at {0}")]
    Unsteady(Dots),
    /// Implausible corrections.
    #[error("the gaze was more than 10 degrees from {0}")]
    TooFar(Dots),
    /// The fit leaves more than 2 degrees.
    #[error("the gaze at {0} does not fit the other dots: the fit is off by {1:.1} degrees")]
    Inconsistent(Dots, f32),
    /// The fit folds the view, or is not determined.
    #[error("the gaze hardly followed the dots")]
    Implausible,
    /// The error of the fit, and of the correction that holds.
    #[error("a new correction would be off by {0:.1} degrees; the present one is off by {1:.1} degrees")]
    NotBetter(f32, f32),
}

/// A dot and the corrected gaze.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FittedDot {
    /// Its accuracy: distance of the corrected gaze from the dot, degrees.
    pub accuracy_deg: f32,
    /// Its precision: root mean square of the distances of the samples from their median, degrees (Holmqvist, Nyström and Mulvey 2012).
    pub precision_deg: f32,
}

/// A correction, and how well it fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationFit {
    /// The correction.
    pub polynomial: GazePolynomial,
    /// Its order, chosen by cross-validation.
    pub order: PolynomialOrder,
    /// The dots, in the order of [`DOTS_DEG`].
    pub dots: [FittedDot; 9],
    /// Root mean square of the distances from each dot, of a fit to the other eight, degrees: the error to expect elsewhere.
    pub error_deg: f32,
    /// The same of the correction that held, or of no correction, which knew none of the dots.
    pub error_before_deg: f32,
}

/// A calibration that is under way. Allocates at the end of a dot.
#[derive(Clone, Debug)]
pub struct Calibration {
    look: DotLook,
    tries: u8,
    dots: [Result<Fixation, NoFixation>; 9],
    dot: usize,
}

impl Default for Calibration {
    fn default() -> Self {
        Self { look: DotLook::new(FIRST), tries: 0, dots: [Err(NoFixation::Unseen); 9], dot: 0 }
    }
}

impl Calibration {
    /// Takes the gaze of a frame that is shown at `now_ns`, which the first one begins: degrees to the left and upwards of straight
    /// ahead, without any correction, and when the eyes looked there, on the same clock; `None` where they are not seen.
    pub fn push(&mut self, look: Option<([f32; 2], i64)>, now_ns: i64) {
        if self.is_over() {
            return;
        }
        self.look.push(look, now_ns);
        if !self.look.is_over() {
            return;
        }
        let found = self.look.fixation();
        self.dots[self.dot] = found;
        self.tries += 1;
        let timing = if found.is_err() && self.tries < MOST_TRIES {
            AGAIN
        } else {
            (self.dot, self.tries) = (self.dot + 1, 0);
            TIMING
        };
        self.look = DotLook::new(timing);
        self.look.push(look, now_ns);
    }

    /// The number of the dot to show, in [`DOTS_DEG`]; `None` when it is over.
    pub fn dot(&self) -> Option<usize> {
        (!self.is_over()).then_some(self.dot)
    }

    /// Whether no more samples are needed.
    pub fn is_over(&self) -> bool {
        self.dot == DOTS_DEG.len()
    }

    /// The correction; `before` is the one that holds, from angles without a correction.
    ///
    /// # Errors
    /// The eyes were not seen or did not rest, or the correction is implausible, or no better than before.
    pub fn fit(&self, before: impl Fn([f32; 2]) -> [f32; 2]) -> Result<CalibrationFit, CalibrationFailure> {
        if !self.is_over() {
            return Err(CalibrationFailure::Unfinished);
        }
        for (reason, failure) in [
            (NoFixation::Unseen, CalibrationFailure::NoGaze as fn(Dots) -> _),
            (NoFixation::Unsteady, CalibrationFailure::Unsteady),
        ] {
            let failed = Dots::of(|dot| self.dots[dot] == Err(reason));
            if !failed.is_empty() {
                return Err(failure(failed));
            }
        }
        let fixations = self.dots.map(Result::unwrap_or_default);
        let measured = fixations.map(|fixation| fixation.centre_deg);
        let far = Dots::of(|dot| distance(measured[dot], DOTS_DEG[dot]) > MAX_OFFSET_DEG);
        if !far.is_empty() {
            return Err(CalibrationFailure::TooFar(far));
        }
        let (order, error_deg) = best_order(&measured).ok_or(CalibrationFailure::Implausible)?;
        let polynomial = fitted(order, &measured, None).ok_or(CalibrationFailure::Implausible)?;
        let mut dots = [FittedDot::default(); 9];
        for (dot, fitted) in dots.iter_mut().enumerate() {
            let accuracy_deg = distance(polynomial.corrected(measured[dot]), DOTS_DEG[dot]);
            *fitted = FittedDot { accuracy_deg, precision_deg: fixations[dot].spread_deg };
        }
        let worst = dots.iter().map(|dot| dot.accuracy_deg).fold(0.0, f32::max);
        if worst > MAX_RESIDUAL_DEG {
            return Err(CalibrationFailure::Inconsistent(
                Dots::of(|dot| dots[dot].accuracy_deg == worst),
                worst,
            ));
        }
        let error_before_deg = root_mean_square(|dot| distance(before(measured[dot]), DOTS_DEG[dot]));
        if error_deg > error_before_deg - LEAST_GAIN_DEG {
            return Err(CalibrationFailure::NotBetter(error_deg, error_before_deg));
        }
        Ok(CalibrationFit { polynomial, order, dots, error_deg, error_before_deg })
    }
}

/// The order with the least error at dots that it was not fitted to, degrees; the simpler one of about equal ones.
fn best_order(measured: &[[f32; 2]; 9]) -> Option<(PolynomialOrder, f32)> {
    let mut best: Option<(PolynomialOrder, f32)> = None;
    for order in PolynomialOrder::ALL {
        let error_deg = root_mean_square(|dot| {
            fitted(order, measured, Some(dot))
                .map_or(f32::INFINITY, |fit| distance(fit.corrected(measured[dot]), DOTS_DEG[dot]))
        });
        if error_deg.is_finite() && best.is_none_or(|(_, least)| error_deg < LESS_ERROR * least) {
            best = Some((order, error_deg));
        }
    }
    best
}

/// The fit to all dots but one, for the area of all.
fn fitted(
    order: PolynomialOrder,
    measured: &[[f32; 2]; 9],
    left_out: Option<usize>,
) -> Option<GazePolynomial> {
    let pairs = (0..9).filter(|dot| Some(*dot) != left_out).map(|dot| (measured[dot], DOTS_DEG[dot]));
    let edge = |of: fn(f32, f32) -> f32| {
        [0, 1].map(|axis| measured.iter().map(|dot| dot[axis]).fold(measured[0][axis], of))
    };
    GazePolynomial::new(least_squares(order, pairs)?, [edge(f32::min), edge(f32::max)])
}

fn root_mean_square(of_dot: impl Fn(usize) -> f32) -> f32 {
    ((0..9).map(|dot| of_dot(dot).powi(2)).sum::<f32>() / 9.0).sqrt()
}

#[cfg(test)]
mod tests;
