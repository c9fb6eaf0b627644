//! The audio-visual perception model: the quality of foveated rendering as a function of sound, and the loss of contrast
//! that sound therefore allows (paper A, "Audio-visual aware Foveated Rendering", Eq. 12-17).
//!
//! [`Coefficients::alpha`] is the budget that [`crate::frco`] spends tile by tile; [`SilenceRule`] covers silence.

mod budget;

use crate::audio::{GREATEST_KILOMEL, LEAST_KILOMEL};
pub use budget::{Budget, BudgetSettings, SensitivityUnit, SilenceRule};

/// Range of gamma_ld in which the paper's study was done (supplement, section 1.3: -35 to -10 LUFS), loudness units.
pub const GAMMA_LD: [f32; 2] = [0.0, 25.0];

/// Divisor of gamma_vis before its weight (Eq. 12), to bring all features to one scale.
pub const VISUAL_LOSS_SCALE: f32 = 10_000.0;

/// a, b, c and d of Eq. 12: the contribution of each feature to the score. All are >= 0 (Eq. 13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Score for each loudness unit of gamma_ld.
    pub a: f32,
    /// Score times kilo-mel: divided by gamma_fq.
    pub b: f32,
    /// Score that 10 000 units of gamma_vis cost, in the scale of Tursun's sensitivity ([`SensitivityUnit::Tursun`]).
    pub c: f32,
    /// Score of full rendering without sound.
    pub d: f32,
}

/// Eq. 14.
pub const PAPER: Coefficients = Coefficients { a: 0.05, b: 0.45, c: 0.19, d: 3.63 };

/// E_0 of the paper, the score from which on rendering is as good as its baseline's (section 4.2): d of [`PAPER`].
pub const PAPER_THRESHOLD: f32 = PAPER.d;

impl Default for Coefficients {
    /// [`PAPER`].
    fn default() -> Self {
        PAPER
    }
}

impl Coefficients {
    /// Eq. 12: the predicted mean score, 1 to 5 in the paper's study, though nothing bounds the sum.
    ///
    /// `gamma_ld` in loudness units, 0..=25; `gamma_fq_kilomel` in 1..=2.5457; `gamma_vis` >= 0 in Tursun's units. The
    /// features are taken as they are, without limits, as a fit needs it; gamma_fq of 0 gives infinity, NaN NaN.
    pub fn score(&self, gamma_ld: f32, gamma_fq_kilomel: f32, gamma_vis: f32) -> f32 {
        self.a * gamma_ld + self.b / gamma_fq_kilomel - self.c * gamma_vis / VISUAL_LOSS_SCALE + self.d
    }

    /// alpha of Eq. 17 with E_0 = d, as the paper has it: the visual loss that sound allows, in Tursun's units.
    ///
    /// Features beyond what the paper studied, [`GAMMA_LD`] and [`LEAST_KILOMEL`]`..=`[`GREATEST_KILOMEL`], count as its
    /// end. 0 if gamma_fq is not above 0, which no sound has, or if a feature or coefficient is NaN or infinite. 0 too if
    /// c is not above 0: a study in which visual loss cost nothing gives no limit for it.
    pub fn alpha(&self, gamma_ld: f32, gamma_fq_kilomel: f32) -> f32 {
        self.alpha_above(self.d, gamma_ld, gamma_fq_kilomel)
    }

    /// alpha of Eq. 17 for a threshold E_0 (a score) of one's own: 10000/c (a gamma_ld + b/gamma_fq + d - E_0).
    ///
    /// Negative where even full rendering stays below E_0. Otherwise as [`Self::alpha`].
    pub fn alpha_above(&self, threshold: f32, gamma_ld: f32, gamma_fq_kilomel: f32) -> f32 {
        if !says_something(gamma_ld, gamma_fq_kilomel) || self.c.is_nan() || self.c <= 0.0 {
            return 0.0;
        }
        let loudness = gamma_ld.clamp(GAMMA_LD[0], GAMMA_LD[1]);
        // d - E_0 first: it is exactly 0 in the usual case, and then costs the others no digits.
        let score = self.a * loudness
            + self.b / gamma_fq_kilomel.clamp(LEAST_KILOMEL, GREATEST_KILOMEL)
            + (self.d - threshold);
        let alpha = VISUAL_LOSS_SCALE / self.c * score;
        if alpha.is_finite() { alpha } else { 0.0 }
    }
}

/// Whether both features can be of a sound: finite, and gamma_fq above 0.
fn says_something(gamma_ld: f32, gamma_fq_kilomel: f32) -> bool {
    gamma_ld.is_finite() && gamma_fq_kilomel.is_finite() && gamma_fq_kilomel > 0.0
}

#[cfg(test)]
mod tests;
