//! castleCSF: contrast sensitivity by colour, area, spatial and temporal frequency, luminance and eccentricity.
//!
//! Ashraf, Mantiuk, Chapiro and Wuerger, "castleCSF - A contrast sensitivity function of color, area, spatiotemporal
//! frequency, luminance and eccentricity", Journal of Vision 24(4):5, 2024. Formulas and constants as in gfxdisp/castleCSF
//! (MIT licence), revision f4b0b72, v0.2.4. Written with `exp2` and `log2` only, as a shader would.

mod table;

pub use table::FovealTable;

use super::{SensitivityFall, Stimulus, VisualField};
use std::f32::consts::{LOG2_10, LOG2_E, LOG10_2};

/// Sensitivity to luminance contrast, the sum of [`sustained`] and [`transient`]; > 0 up to where f32 ends.
///
/// Out of domain or NaN: as in [`Stimulus::clamped`].
pub fn achromatic(stimulus: &Stimulus, field: VisualField) -> f32 {
    achromatic_fall(stimulus).at(stimulus.clamped().eccentricity_deg, field)
}

/// The part of [`achromatic`] that answers to static stimuli.
pub fn sustained(stimulus: &Stimulus, field: VisualField) -> f32 {
    let stimulus = stimulus.clamped();
    let foveal = sustained_foveal(&stimulus);
    ACHROMATIC_FALL.of(log2(foveal), stimulus.frequency_cpd).at(stimulus.eccentricity_deg, field)
}

/// The part of [`achromatic`] that answers to flicker and motion.
pub fn transient(stimulus: &Stimulus, field: VisualField) -> f32 {
    let stimulus = stimulus.clamped();
    let foveal = transient_foveal(&stimulus);
    ACHROMATIC_FALL.of(log2(foveal), stimulus.frequency_cpd).at(stimulus.eccentricity_deg, field)
}

/// Sensitivity of the red-green mechanism to contrast between L and M cones, > 0.
///
/// Out of domain or NaN: as in [`Stimulus::clamped`].
pub fn red_green(stimulus: &Stimulus, field: VisualField) -> f32 {
    red_green_fall(stimulus).at(stimulus.clamped().eccentricity_deg, field)
}

/// Sensitivity of the yellow-violet mechanism to contrast between S cones and both others, > 0.
///
/// Out of domain or NaN: as in [`Stimulus::clamped`].
pub fn yellow_violet(stimulus: &Stimulus, field: VisualField) -> f32 {
    yellow_violet_fall(stimulus).at(stimulus.clamped().eccentricity_deg, field)
}

/// [`achromatic`] as a function of eccentricity; that of `stimulus` is not used.
pub fn achromatic_fall(stimulus: &Stimulus) -> SensitivityFall {
    let stimulus = stimulus.clamped();
    ACHROMATIC_FALL.of(log2(achromatic_foveal(&stimulus)), stimulus.frequency_cpd)
}

/// [`red_green`] as a function of eccentricity; that of `stimulus` is not used.
pub fn red_green_fall(stimulus: &Stimulus) -> SensitivityFall {
    let stimulus = stimulus.clamped();
    RED_GREEN.fall.of(log2(chromatic_foveal(&stimulus, &RED_GREEN)), stimulus.frequency_cpd)
}

/// [`yellow_violet`] as a function of eccentricity; that of `stimulus` is not used.
pub fn yellow_violet_fall(stimulus: &Stimulus) -> SensitivityFall {
    let stimulus = stimulus.clamped();
    YELLOW_VIOLET.fall.of(log2(chromatic_foveal(&stimulus, &YELLOW_VIOLET)), stimulus.frequency_cpd)
}

/// `ecc_drop` + rho * `ecc_drop_f`: decades that are lost with each degree.
struct Fall {
    temporal: [f32; 2],
    nasal: [f32; 2],
}

const ACHROMATIC_FALL: Fall =
    Fall { temporal: [0.023_985_3, 0.018_903_8], nasal: [0.040_066_2, 0.008_136_19] };

impl Fall {
    fn of(&self, log2_foveal: f32, frequency_cpd: f32) -> SensitivityFall {
        let octaves_per_deg =
            |[constant, by_frequency]: [f32; 2]| LOG2_10 * (constant + by_frequency * frequency_cpd);
        SensitivityFall {
            log2_foveal,
            log2_per_deg_temporal: octaves_per_deg(self.temporal),
            log2_per_deg_nasal: octaves_per_deg(self.nasal),
        }
    }
}

/// log2 of a sensitivity, finite for one that f32 cannot hold: invisible contrast stays invisible.
fn log2(foveal: f32) -> f32 {
    foveal.max(f32::MIN_POSITIVE).log2()
}

fn achromatic_foveal(stimulus: &Stimulus) -> f32 {
    sustained_foveal(stimulus) + transient_foveal(stimulus)
}

/// One mechanism's dependence on spatial frequency and area.
struct Spatial {
    /// 2^`bw`: the width of the parabola.
    width: f32,
    /// The least value of the parabola below its peak, 1 - `a`.
    floor: f32,
    /// `A_0`, square degrees.
    area_deg2: f32,
    /// `f_0`, cycles per degree.
    frequency_cpd: f32,
}

impl Spatial {
    /// The log-parabola around `peak_cpd`, times the summation over area of Rovamo, Luntinen and Nasanen 1993.
    fn sensitivity(&self, stimulus: &Stimulus, peak_cpd: f32) -> f32 {
        let frequency = stimulus.frequency_cpd;
        let octaves = (frequency / peak_cpd).log2();
        // 10^(-log10(x)^2 / w) = 2^(-log2(x)^2 * log10(2) / w)
        let parabola = (-octaves * octaves * LOG10_2 / self.width).exp2();
        let parabola = if frequency < peak_cpd { parabola.max(self.floor) } else { parabola };
        let ratio = frequency / self.frequency_cpd;
        let critical_deg2 = self.area_deg2 / (1.0 + ratio * ratio);
        parabola * frequency * (critical_deg2 / (1.0 + critical_deg2 / stimulus.area_deg2)).sqrt()
    }
}

/// x^y for x >= 0, as a shader computes it.
fn power(base: f32, exponent: f32) -> f32 {
    if base > 0.0 { (base.log2() * exponent).exp2() } else { 0.0 }
}

fn exp(x: f32) -> f32 {
    (x * LOG2_E).exp2()
}

/// a * (1 + b / L)^-c: how peaks depend on luminance.
fn hyperbola([a, b, c]: [f32; 3], luminance_cd_m2: f32) -> f32 {
    a * power(1.0 + b / luminance_cd_m2, -c)
}

const SUSTAINED: Spatial =
    Spatial { width: 1.000_147_7, floor: 1.0 - 0.100_207, area_deg2: 157.103, frequency_cpd: 0.702_338 };
const SUSTAINED_PEAK: [f32; 3] = [56.4947, 7.547_26, 0.144_532];
const SUSTAINED_PEAK_CPD: [f32; 3] = [1.781_19, 91.5718, 0.256_682];

/// 5.58341e-7 * 9.66862e9 cd/m^2, see [`glare`].
const GLARE_CD_M2: f32 = 5398.387;

/// Decline of sensitivity in bright light, 1 - (1 + 5.58341e-7 / L)^-9.66862e9.
///
/// In f32 that is 0 at L = 100. (1 + x)^-n = exp(-n ln(1 + x)), and ln(1 + x) is x to within x / 2: where the
/// exponent matters (below 20) x is below 2e-9. So the bracket is 1 - exp(-5398 / L), which needs neither `expm1`
/// nor `ln_1p`, as the exponent is at least 0.54 within the domain.
fn glare(luminance_cd_m2: f32) -> f32 {
    1.0 - exp(-GLARE_CD_M2 / luminance_cd_m2)
}

fn sustained_foveal(stimulus: &Stimulus) -> f32 {
    let luminance = stimulus.luminance_cd_m2;
    let response = exp(-power(stimulus.temporal_hz, 1.3314) / 10.5795);
    let peak = hyperbola(SUSTAINED_PEAK, luminance) * glare(luminance);
    response * peak * SUSTAINED.sensitivity(stimulus, hyperbola(SUSTAINED_PEAK_CPD, luminance))
}

const TRANSIENT: Spatial =
    Spatial { width: 6.391_258, floor: 1.0 - 0.000_241_177, area_deg2: 3.816_11, frequency_cpd: 3.013_89 };
const TRANSIENT_PEAK_CPD: f32 = 3.166_96e-4;

fn transient_foveal(stimulus: &Stimulus) -> f32 {
    let luminance = stimulus.luminance_cd_m2;
    // Below 0.0113 cd/m^2 the frequency of the greatest response would be negative.
    let peak_hz = (4.7036 + 2.414_82 * LOG10_2 * luminance.log2()).max(0.0);
    let distance = power(stimulus.temporal_hz, 0.1898) - power(peak_hz, 0.1898);
    let response = exp(-distance * distance / 0.084_483_6);
    let peak = 2748.09 * power(luminance, 0.193_434);
    response * peak * TRANSIENT.sensitivity(stimulus, TRANSIENT_PEAK_CPD)
}

/// A mechanism of colour: sustained only.
struct Chromatic {
    /// `S_max`.
    peak: [f32; 3],
    /// `f_max`, cycles per degree; below the domain, so that the parabola's other side never shows.
    peak_cpd: f32,
    spatial: Spatial,
    /// `sigma_sust` and `beta_sust`.
    temporal: [f32; 2],
    fall: Fall,
}

const RED_GREEN: Chromatic = Chromatic {
    peak: [681.434, 38.0038, 0.480_386],
    peak_cpd: 0.017_836_4,
    spatial: Spatial { width: 5.355_57, floor: 0.0, area_deg2: 2816.44, frequency_cpd: 0.071_105_8 },
    temporal: [16.4325, 1.155_91],
    // `ecc_drop_f` is 2.04986e-69: none.
    fall: Fall { temporal: [0.059_140_2, 0.0], nasal: [2.896_15e-5, 0.181_08] },
};

const YELLOW_VIOLET: Chromatic = Chromatic {
    peak: [166.683, 62.8974, 0.411_93],
    peak_cpd: 0.004_257_53,
    spatial: Spatial { width: 6.417_316, floor: 0.0, area_deg2: 2.827_89e7, frequency_cpd: 6.350_93e-4 },
    temporal: [7.150_12, 0.969_123],
    // `ecc_drop_nasal` is 5.85804e-141: none.
    fall: Fall { temporal: [0.003_568_65, 0.008_066_31], nasal: [0.0, 0.011_066_2] },
};

fn chromatic_foveal(stimulus: &Stimulus, mechanism: &Chromatic) -> f32 {
    let [sigma, beta] = mechanism.temporal;
    let response = exp(-power(stimulus.temporal_hz, beta) / sigma);
    let peak = hyperbola(mechanism.peak, stimulus.luminance_cd_m2);
    response * peak * mechanism.spatial.sensitivity(stimulus, mechanism.peak_cpd)
}

#[cfg(test)]
mod tests;
