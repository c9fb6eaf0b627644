//! The allowed loss of a frame as a function of sound, in silence too, in the units of the sensitivity function in use.

use super::{Coefficients, GAMMA_LD, PAPER, PAPER_THRESHOLD, says_something};
use crate::audio::LEAST_KILOMEL;

/// Scale of the sensitivity that a budget is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SensitivityUnit {
    /// Tursun's, with which the paper's coefficients were fitted.
    Tursun,
    /// castleCSF's, which are physical.
    #[default]
    CastleCsf,
}

impl SensitivityUnit {
    /// kappa: units of Tursun's sensitivity for one of castleCSF's, 4.7e4 to 5.6e4.
    ///
    /// Both were evaluated on the pictures that come with AwareFoveation, in the geometry of paper A's headset: `C_v`
    /// of the full picture is 1.7e4 to 2.8e4 by Tursun's (with its
    /// [`BAND_GAIN`](crate::perception::csf::tursun::BAND_GAIN)) and 0.36 to 0.49 by castleCSF. In the middle of the range the
    /// divisor 10 000 of Eq. 12 becomes 0.2. One number cannot make two functions of different shape equal.
    pub const TURSUN_PER_CASTLE: f32 = 5.0e4;

    /// Units of Tursun's sensitivity for one of this one's.
    pub fn kappa(self) -> f32 {
        match self {
            Self::Tursun => 1.0,
            Self::CastleCsf => Self::TURSUN_PER_CASTLE,
        }
    }
}

/// The allowed loss of a frame in silence, where Eq. 3 divides 0 by 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SilenceRule {
    /// No budget: the map of [`crate::fixed_foveation`] instead, the baseline that sound is meant to improve on.
    #[default]
    FixedFoveation,
    /// alpha = 0, which Eq. 17 gives when both features of sound vanish: 1x1 wherever there is contrast. Costs more than
    /// fixed foveation does; the paper's ablation has 2.2 times.
    Strict,
    /// `silence_alpha`: a budget of one's own, in units of the sensitivity function in use. NaN and infinite count as 0.
    Alpha(f32),
}

/// The allowed loss of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Loss of sensitivity that each block may have, in units of the sensitivity function in use: alpha of
    /// [`crate::frco::coarsest`]. Finite; negative permits nothing.
    Alpha(f32),
    /// Sound gives no budget: rates by eccentricity alone.
    FixedFoveation,
}

/// Settings of the conversion from sound to a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BudgetSettings {
    /// Of Eq. 12.
    pub coefficients: Coefficients,
    /// E_0 of Eq. 15, a score. For coefficients of another study, their d.
    pub threshold: f32,
    /// While nothing is heard.
    pub silence: SilenceRule,
    /// Of the sensitivity that the budget is compared with.
    pub unit: SensitivityUnit,
}

impl Default for BudgetSettings {
    /// The paper's coefficients for castleCSF, and fixed foveation in silence.
    fn default() -> Self {
        Self {
            coefficients: PAPER,
            threshold: PAPER_THRESHOLD,
            silence: SilenceRule::default(),
            unit: SensitivityUnit::default(),
        }
    }
}

impl BudgetSettings {
    /// To the letter of the paper: its sensitivity function, and nothing free in silence.
    pub const PAPER: Self = Self {
        coefficients: PAPER,
        threshold: PAPER_THRESHOLD,
        silence: SilenceRule::Strict,
        unit: SensitivityUnit::Tursun,
    };

    /// The budget of the loudest sound of the lowest pitch, which no other exceeds; in units of the sensitivity function in use.
    pub fn greatest(&self) -> f32 {
        let alpha = self.coefficients.alpha_above(self.threshold, GAMMA_LD[1], LEAST_KILOMEL);
        alpha / self.unit.kappa()
    }

    /// The budget of a frame, Eq. 17 divided by [`SensitivityUnit::kappa`].
    ///
    /// `gamma_ld` in loudness units and `gamma_fq_kilomel` are the features of the sound, limited to their ranges. If
    /// `silent`, or if a feature is unusable (NaN, infinite, or gamma_fq of 0, which no sound has), the [`SilenceRule`]
    /// holds.
    pub fn budget(&self, gamma_ld: f32, gamma_fq_kilomel: f32, silent: bool) -> Budget {
        match self.silence {
            _ if !silent && says_something(gamma_ld, gamma_fq_kilomel) => {
                let alpha = self.coefficients.alpha_above(self.threshold, gamma_ld, gamma_fq_kilomel);
                Budget::Alpha(alpha / self.unit.kappa())
            }
            SilenceRule::FixedFoveation => Budget::FixedFoveation,
            SilenceRule::Strict => Budget::Alpha(0.0),
            SilenceRule::Alpha(alpha) => Budget::Alpha(if alpha.is_finite() { alpha } else { 0.0 }),
        }
    }
}
