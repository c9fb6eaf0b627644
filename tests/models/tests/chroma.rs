//! Chroma attenuation: paper C's numbers, the floor against castleCSF, gamut and luminance against formulas.

use glam::Vec3;
use parafovea_core::chroma::{
    ChromaSettings, Curves, FLOOR_FREQUENCY_CPD, Gains, Gamut, Matrix, Mode, attenuate, cb_gain, cr_gain,
    floor,
};
use parafovea_core::perception::csf::{Stimulus, VisualField, castle};
use parafovea_models::checks::checks;
use parafovea_models::chroma_report::Report;
use parafovea_models::reference::chroma as reference;
use proptest::prelude::*;

const MATRICES: [Matrix; 3] = [Matrix::Bt709, Matrix::Bt601, Matrix::Bt2020];

/// The bounds of the paper, Z of Cb and of Cr.
const BOUNDS: [(f32, f32); 4] = [(0.70, 0.35), (0.70, 0.55), (0.85, 0.35), (0.85, 0.55)];

fn corners() -> impl Iterator<Item = Vec3> {
    (0..8).map(|bits| Vec3::new((bits & 1) as f32, (bits >> 1 & 1) as f32, (bits >> 2) as f32))
}

#[test]
fn the_curves_are_those_of_the_paper() {
    for row in checks().chroma.curve {
        let e = row["E"] as f32;
        for (name, expected) in row.iter().filter(|(name, _)| *name != "E") {
            let z: f32 = name[2..].parse().unwrap();
            let gain = f64::from(if name.starts_with("cb") { cb_gain(e, z) } else { cr_gain(e, z) });
            // 1e-4 of the gain: at E = .99 the rounding of E itself to f32 is 5e-6 of 1 - E.
            assert!(
                (gain - expected).abs() <= 1e-4 * expected + 1e-9,
                "{name} at {e}: {gain}, not {expected}"
            );
        }
    }
}

#[test]
fn the_disc_means_are_those_of_the_paper() {
    for (name, expected) in checks().chroma.disc_mean {
        let z: f32 = name[2..].parse().unwrap();
        let disc = Report::of(|e| Gains { cb: cb_gain(e, z), cr: cr_gain(e, z) }).disc;
        let mean = f64::from(if name.starts_with("cb") { disc.cb } else { disc.cr });
        assert!((mean - expected).abs() < 1e-5, "{name}: {mean}, not {expected}");
    }
}

#[test]
fn the_floor_is_castle_csf_s_ratio_for_large_fields() {
    for degrees in 0..=110 {
        let eccentricity_deg = degrees as f32;
        let kept = floor(eccentricity_deg.to_radians());
        let field = Stimulus { frequency_cpd: FLOOR_FREQUENCY_CPD, area_deg2: 64.0, ..Stimulus::default() };
        let ratio = |sensitivity: fn(&Stimulus, VisualField) -> f32| {
            let far = Stimulus { eccentricity_deg, ..field };
            sensitivity(&far, VisualField::Worst) / sensitivity(&field, VisualField::Worst)
        };
        let (cb, cr) = reference::floor(f64::from(eccentricity_deg));
        for (kept, ratio, reference) in
            [(kept.cb, ratio(castle::yellow_violet), cb), (kept.cr, ratio(castle::red_green), cr)]
        {
            assert!((kept / ratio - 1.0).abs() < 1e-5, "{degrees}: {kept}, not {ratio}");
            assert!((f64::from(kept) / reference - 1.0).abs() < 1e-5, "{degrees}: {kept}, not {reference}");
        }
        assert!(kept.cb >= kept.cr, "the order that the gamut guard relies on");
    }
}

/// Contrast of a pure colour's field of 8 degrees in thresholds of the red-green mechanism at 55 degrees, scaled by the relative
/// sensitivity to `frequency_cpd`.
fn seen_at_55_deg(colour: Vec3, frequency_cpd: f32) -> f32 {
    let field = Stimulus {
        frequency_cpd: FLOOR_FREQUENCY_CPD,
        temporal_hz: 0.0,
        eccentricity_deg: 55.0,
        luminance_cd_m2: 100.0 * Matrix::Bt709.weights().dot(colour),
        area_deg2: 64.0,
    };
    let at = |eccentricity_deg| Stimulus { frequency_cpd, eccentricity_deg, ..field };
    let sensitivity = |stimulus| castle::red_green(&stimulus, VisualField::Worst);
    let contrast = reference::red_green_contrast(colour.to_array().map(f64::from)) as f32;
    contrast * sensitivity(at(55.0)) / sensitivity(at(0.0)) * sensitivity(field)
}

#[test]
fn large_saturated_fields_stay_visible_far_out_and_would_not_an_octave_higher() {
    for colour in [Vec3::X, Vec3::Y, Vec3::Z] {
        let kept = floor(55f32.to_radians()).cr;
        let seen = seen_at_55_deg(colour, FLOOR_FREQUENCY_CPD);
        assert!(seen > 1.5, "{colour} at {kept} of its colour: {seen} thresholds");
    }
    for colour in [Vec3::Y, Vec3::Z] {
        let seen = seen_at_55_deg(colour, 2.0 * FLOOR_FREQUENCY_CPD);
        assert!(seen < 1.0, "{colour}: {seen} thresholds");
    }
}

/// Largest excursions of green below 0 and above 1, without the guard.
fn overshoot(matrix: Matrix, gains: impl Iterator<Item = Gains> + Clone) -> (f32, f32) {
    let green = gains.flat_map(|gains| {
        corners().map(move |rgb| attenuate(rgb, gains, matrix.weights(), Gamut::UNBOUNDED).y)
    });
    green.fold((0.0, 0.0), |(below, above), green| (below.min(green), above.max(green - 1.0)))
}

#[test]
fn without_the_guard_green_leaves_the_gamut_as_far_as_computed() {
    let steps = || (0..=1000).map(|step| step as f32 / 1000.0);
    for (matrix, on_curves, at_most) in
        [(Matrix::Bt709, 0.0105, 0.0215), (Matrix::Bt601, 0.032, 0.058), (Matrix::Bt2020, 0.012, 0.023)]
    {
        let curves = BOUNDS
            .into_iter()
            .flat_map(|(cb, cr)| steps().map(move |e| Gains { cb: cb_gain(e, cb), cr: cr_gain(e, cr) }));
        for ((below, above), expected) in [
            (overshoot(matrix, curves), on_curves),
            (overshoot(matrix, [Gains { cb: 1.0, cr: 0.0 }].into_iter()), at_most),
        ] {
            assert!(
                (below + expected).abs() < 6e-4 && (above - expected).abs() < 6e-4,
                "{matrix:?}: {below} {above}"
            );
        }
    }
}

fn any_settings() -> impl Strategy<Value = ChromaSettings> {
    let modes = prop_oneof![Just(Mode::Default), Just(Mode::Paper)];
    (modes, 0.70f32..=0.85, 0.35f32..=0.55, 1.1f32..30.0, 20.0f32..110.0, 0..3usize).prop_map(
        |(mode, cb_bound, cr_bound, plateau_deg, max_eccentricity_deg, matrix)| ChromaSettings {
            mode,
            cb_bound,
            cr_bound,
            plateau_deg,
            max_eccentricity_deg,
            matrix: MATRICES[matrix],
            ..ChromaSettings::default()
        },
    )
}

fn any_colour() -> impl Strategy<Value = Vec3> {
    let component = || prop_oneof![4 => 0.0f32..=1.0, 1 => Just(0.0f32), 1 => Just(1.0f32)];
    (component(), component(), component()).prop_map(|(r, g, b)| Vec3::new(r, g, b))
}

proptest! {
    #[test]
    fn default_gains_are_those_of_the_formulas(
        cb in 0.70f32..=0.85, cr in 0.35f32..=0.55, plateau in 1.1f32..30.0, end in 20.0f32..110.0,
        eccentricity in 0.0f32..120.0,
    ) {
        let settings = ChromaSettings {
            cb_bound: cb,
            cr_bound: cr,
            plateau_deg: plateau,
            max_eccentricity_deg: end,
            ..ChromaSettings::default()
        };
        let found = Curves::new(&settings).gains(eccentricity.to_radians());
        let [e, p, m, b, r] = [eccentricity, plateau, end, cb, cr].map(f64::from);
        let (cb, cr) = reference::default_gains(e, p, m, b, r);
        prop_assert!((f64::from(found.cb) - cb).abs() < 1e-5, "{found:?}, not {cb}");
        prop_assert!((f64::from(found.cr) - cr).abs() < 1e-5, "{found:?}, not {cr}");
    }

    #[test]
    fn a_colour_is_scaled_as_by_way_of_cb_and_cr(
        rgb in any_colour(), cb in 0.0f32..=1.0, cr in 0.0f32..=1.0, matrix in 0..3usize,
    ) {
        let gains = Gains { cb: cb.max(cr), cr: cb.min(cr) };
        let weights = MATRICES[matrix].weights();
        let found = attenuate(rgb, gains, weights, Gamut::UNBOUNDED);
        let wide = |v: Vec3| v.to_array().map(f64::from);
        let expected = reference::scaled(wide(rgb), (gains.cb.into(), gains.cr.into()), wide(weights));
        for (found, expected) in wide(found).into_iter().zip(expected) {
            prop_assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
        }
    }

    /// The guard in the form of an inequality for Cb: with BT.709, at most (Y - .4681 Cr) / .1873 for Cb > 0.
    #[test]
    fn the_guard_caps_cb_where_green_would_be_negative(rgb in any_colour(), cb in 0.0f32..=1.0, cr in 0.0f32..=1.0) {
        let gains = Gains { cb: cb.max(cr), cr: cb.min(cr) };
        let weights = Matrix::Bt709.weights();
        let y = weights.dot(rgb);
        let (blue, red) = ((rgb.z - y) / 1.8556, (rgb.x - y) / 1.5748 * gains.cr);
        let found = attenuate(rgb, gains, weights, Gamut::UNIT);
        let kept = (found.z - y) / 1.8556;
        let room = if blue > 0.0 { (y - 0.4681 * red) / 0.1873 } else { (1.0 - y + 0.4681 * red) / 0.1873 };
        let expected = (gains.cb * blue.abs()).min(room.max(gains.cr * blue.abs()));
        prop_assert!((kept.abs() - expected).abs() < 1e-4, "{kept}, not {expected}");
    }

    #[test]
    fn y_is_kept_and_the_guard_keeps_the_gamut(
        settings in any_settings(), rgb in any_colour(), angle in 0.0f32..3.1, strength in 0.0f32..=1.0,
    ) {
        let weights = settings.matrix.weights();
        let gains = Curves::new(&settings).gains(angle).at_strength(strength);
        for gamut in [Gamut::UNIT, Gamut::UNBOUNDED] {
            let out = attenuate(rgb, gains, weights, gamut);
            prop_assert!((weights.dot(out) - weights.dot(rgb)).abs() <= 5e-7, "{rgb} became {out}");
            if gamut == Gamut::UNIT {
                prop_assert!(out.min_element() >= -1e-6 && out.max_element() <= 1.0 + 1e-6, "{rgb} became {out}");
            }
        }
    }
}
