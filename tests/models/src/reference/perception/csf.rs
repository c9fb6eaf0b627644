//! Contrast sensitivity as published: constants and formulas of gfxdisp/castleCSF f4b0b72 (v0.2.4) and of
//! AwareFoveation, without regard to rounding.

/// A stimulus.
#[derive(Clone, Copy, Debug)]
pub struct Stimulus {
    /// Spatial frequency, cycles per degree.
    pub rho: f64,
    /// Temporal frequency, Hz.
    pub omega: f64,
    /// Degrees.
    pub eccentricity: f64,
    /// cd/m^2.
    pub luminance: f64,
    /// Square degrees.
    pub area: f64,
}

/// castleCSF of luminance contrast, (temporal, nasal).
pub fn achromatic(s: &Stimulus) -> (f64, f64) {
    with_fall(sustained(s) + transient(s), s, [0.0239853, 0.0189038], [0.0400662, 0.00813619])
}

/// The sustained part at the gaze.
pub fn sustained(s: &Stimulus) -> f64 {
    let l = s.luminance;
    let response = (-s.omega.powf(1.3314) / 10.5795).exp();
    let bright = -(-9.66862e9 * (5.58341e-7 / l).ln_1p()).exp_m1();
    let s_max = 56.4947 * (1.0 + 7.54726 / l).powf(-0.144532) * bright;
    let f_max = 1.78119 * (1.0 + 91.5718 / l).powf(-0.256682);
    response * s_max * spatial(s, f_max, 2.13047e-4, 1.0 - 0.100207, 157.103, 0.702338)
}

/// The transient part at the gaze.
pub fn transient(s: &Stimulus) -> f64 {
    let omega_0 = (4.7036 + 2.41482 * s.luminance.log10()).max(0.0);
    let response = (-(s.omega.powf(0.1898) - omega_0.powf(0.1898)).powi(2) / 0.0844836).exp();
    let s_max = 2748.09 * s.luminance.powf(0.193434);
    response * s_max * spatial(s, 3.16696e-4, 2.6761, 1.0 - 2.41177e-4, 3.81611, 3.01389)
}

/// castleCSF of red-green contrast, (temporal, nasal).
pub fn red_green(s: &Stimulus) -> (f64, f64) {
    let response = (-s.omega.powf(1.15591) / 16.4325).exp();
    let s_max = 681.434 * (1.0 + 38.0038 / s.luminance).powf(-0.480386);
    let foveal = response * s_max * spatial(s, 0.0178364, 2.42104, 0.0, 2816.44, 0.0711058);
    with_fall(foveal, s, [0.0591402, 2.04986e-69], [2.89615e-05, 0.18108])
}

/// castleCSF of yellow-violet contrast, (temporal, nasal).
pub fn yellow_violet(s: &Stimulus) -> (f64, f64) {
    let response = (-s.omega.powf(0.969123) / 7.15012).exp();
    let s_max = 166.683 * (1.0 + 62.8974 / s.luminance).powf(-0.41193);
    let foveal = response * s_max * spatial(s, 0.00425753, 2.68197, 0.0, 2.82789e7, 0.000635093);
    with_fall(foveal, s, [0.00356865, 0.00806631], [5.85804e-141, 0.0110662])
}

fn spatial(s: &Stimulus, f_max: f64, bw: f64, floor: f64, a_0: f64, f_0: f64) -> f64 {
    let parabola = 10f64.powf(-(s.rho.log10() - f_max.log10()).powi(2) / 2f64.powf(bw));
    let parabola = if s.rho < f_max { parabola.max(floor) } else { parabola };
    let a_c = a_0 / (1.0 + (s.rho / f_0).powi(2));
    parabola * (a_c / (1.0 + a_c / s.area)).sqrt() * s.rho
}

fn with_fall(foveal: f64, s: &Stimulus, temporal: [f64; 2], nasal: [f64; 2]) -> (f64, f64) {
    let at = |[k_e, k_f]: [f64; 2]| foveal * 10f64.powf(-(k_e + k_f * s.rho) * s.eccentricity);
    (at(temporal), at(nasal))
}

/// Tursun 2019 with x1 to x4 and `fec`: PCHIP over ln f with the general, unequally spaced formulas.
pub fn tursun(x: [f64; 4], fec: f64, f: f64, theta: f64, l_a: f64) -> f64 {
    let knots = [1e-32, 4.0, 8.0, 16.0, 32.0, 64.0].map(f64::ln);
    let values = [x[0], x[0], x[1], x[2], x[3], -32.0].map(|x: f64| x * std::f64::consts::LN_10);
    let s_0 = pchip(&knots, &values, f.ln()).exp();
    s_0 * (-fec * theta * f).exp() * (1.0 + 0.7 / l_a).powf(-0.2)
}

/// Piecewise cubic Hermite interpolation, Fritsch and Carlson's slopes with Moler's end formula.
fn pchip(x: &[f64; 6], y: &[f64; 6], at: f64) -> f64 {
    let h: Vec<f64> = x.windows(2).map(|x| x[1] - x[0]).collect();
    let delta: Vec<f64> = y.windows(2).zip(&h).map(|(y, h)| (y[1] - y[0]) / h).collect();
    let mut slope = [0.0; 6];
    for k in 1..5 {
        if delta[k - 1] * delta[k] > 0.0 {
            let (w1, w2) = (2.0 * h[k] + h[k - 1], h[k] + 2.0 * h[k - 1]);
            slope[k] = (w1 + w2) / (w1 / delta[k - 1] + w2 / delta[k]);
        }
    }
    let end = ((2.0 * h[4] + h[3]) * delta[4] - h[4] * delta[3]) / (h[3] + h[4]);
    slope[5] = if end.signum() != delta[4].signum() {
        0.0
    } else if delta[3].signum() != delta[4].signum() && end.abs() > 3.0 * delta[4].abs() {
        3.0 * delta[4]
    } else {
        end
    };
    let k = (1..5).rev().find(|&k| at >= x[k]).unwrap_or(0);
    let s = at - x[k];
    let c = (3.0 * delta[k] - 2.0 * slope[k] - slope[k + 1]) / h[k];
    let b = (slope[k] - 2.0 * delta[k] + slope[k + 1]) / (h[k] * h[k]);
    y[k] + s * (slope[k] + s * (c + s * b))
}
