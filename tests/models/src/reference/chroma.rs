//! Paper C's curves with the bounds of our default mode, and attenuated colours, as formulas.

use super::perception::csf::{self, Stimulus};

/// Gain of Cb at normalised eccentricity, Eq. 1; 0 from 1 on.
pub fn cb_gain(e: f64, z: f64) -> f64 {
    if e >= 1.0 { 0.0 } else { (1.0 - e * e).powf(z) }
}

/// Gain of Cr at normalised eccentricity, Eq. 2; 0 from 1 on.
pub fn cr_gain(e: f64, z: f64) -> f64 {
    if e >= 1.0 { 0.0 } else { (1.0 + (std::f64::consts::PI * e.powf(z)).cos()) / 2.0 }
}

/// Sensitivity to fields of 1/16 cycle per degree, relative to that at the gaze, (yellow-violet, red-green).
pub fn floor(eccentricity_deg: f64) -> (f64, f64) {
    let field =
        |eccentricity| Stimulus { rho: 0.0625, omega: 0.0, eccentricity, luminance: 100.0, area: 64.0 };
    let relative = |sensitivity: fn(&Stimulus) -> (f64, f64)| {
        let ((temporal, nasal), (foveal, _)) =
            (sensitivity(&field(eccentricity_deg)), sensitivity(&field(0.0)));
        temporal.max(nasal) / foveal
    };
    (relative(csf::yellow_violet), relative(csf::red_green))
}

/// Both gains of the default mode, (Cb, Cr), with a rim fade of half the range.
pub fn default_gains(
    eccentricity_deg: f64,
    plateau_deg: f64,
    end_deg: f64,
    cb_z: f64,
    cr_z: f64,
) -> (f64, f64) {
    let e = ((eccentricity_deg - plateau_deg) / (end_deg - plateau_deg).max(15.0)).max(0.0);
    let (cb_floor, cr_floor) = floor(eccentricity_deg);
    (cb_gain(e, cb_z).max(cb_floor), cr_gain(e, cr_z).max(1.0 - 2.0 * e).max(cr_floor))
}

/// A colour with its chroma scaled, by way of Y, Cb and Cr: Cb = (B - Y) / (2 - 2 Kb), Cr = (R - Y) / (2 - 2 Kr).
pub fn scaled([r, g, b]: [f64; 3], (cb_gain, cr_gain): (f64, f64), [kr, kg, kb]: [f64; 3]) -> [f64; 3] {
    let y = kr * r + kg * g + kb * b;
    let cb = (b - y) / (2.0 - 2.0 * kb) * cb_gain;
    let cr = (r - y) / (2.0 - 2.0 * kr) * cr_gain;
    let (red, blue) = (y + (2.0 - 2.0 * kr) * cr, y + (2.0 - 2.0 * kb) * cb);
    [red, (y - kr * red - kb * blue) / kg, blue]
}

/// Contrast that the red-green mechanism of castleCSF sees between a colour (BT.709, linear) and the grey of its
/// luminance: |L - 2.3112 M| over L + M, with the cone responses of CIE 2006 (2 degrees).
pub fn red_green_contrast([r, g, b]: [f64; 3]) -> f64 {
    let xyz = |[r, g, b]: [f64; 3]| {
        [
            0.4124 * r + 0.3576 * g + 0.1805 * b,
            0.2126 * r + 0.7152 * g + 0.0722 * b,
            0.0193 * r + 0.1192 * g + 0.9505 * b,
        ]
    };
    let cones = |[x, y, z]: [f64; 3]| {
        [
            0.187_596_27 * x + 0.585_168_65 * y - 0.026_384_26 * z,
            -0.133_397_43 * x + 0.405_505_78 * y + 0.034_502_13 * z,
        ]
    };
    let luminance = xyz([r, g, b])[1];
    let [l, m] = cones(xyz([r, g, b]));
    let [grey_l, grey_m] = cones(xyz([luminance; 3]));
    ((l - 2.3112 * m) - (grey_l - 2.3112 * grey_m)).abs() / (grey_l + grey_m)
}
