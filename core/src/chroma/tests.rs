use super::*;
use glam::Vec3;
use proptest::prelude::*;

/// Eq. 1 and 2 of paper C in double precision: E, Cb at Z = .70 and .85, Cr at Z = .35, .45 and .55.
const VECTORS: [[f64; 6]; 8] = [
    [0.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    [0.05, 0.998_249_343, 0.997_874_601, 0.726_350_021, 0.842_572_752, 0.911_319_163],
    [0.1, 0.992_989_454, 0.991_493_600, 0.583_358_159, 0.720_232_784, 0.816_481_771],
    [0.25, 0.955_828_319, 0.946_619_802, 0.322_422_068, 0.443_748_596, 0.552_498_821],
    [0.5, 0.817_603_768, 0.783_072_683, 0.110_193_599, 0.166_943_863, 0.228_093_224],
    [0.75, 0.560_640_723, 0.495_257_828, 0.022_467_776_2, 0.035_941_922_8, 0.051_917_896_6],
    [0.9, 0.312_699_740, 0.243_747_719, 3.230_706_18e-3, 5.281_350_62e-3, 7.800_874_28e-3],
    [0.99, 0.064_446_176_1, 0.035_811_714_6, 3.042_323_23e-5, 5.024_064_84e-5, 7.497_489_94e-5],
];

#[test]
fn curves_match_the_paper() {
    for [e, cb70, cb85, cr35, cr45, cr55] in VECTORS {
        let e32 = e as f32;
        for (z, expected) in [(0.70, cb70), (0.85, cb85)] {
            let gain = f64::from(cb_gain(e32, z));
            assert!((gain / expected - 1.0).abs() < 1e-5, "Cb({e}; {z}) = {gain}, not {expected}");
        }
        for (z, expected) in [(0.35, cr35), (0.45, cr45), (0.55, cr55)] {
            let gain = f64::from(cr_gain(e32, z));
            // 1e-4: at E = .99 the rounding of E itself to f32 is 5e-6 of 1 - E.
            assert!((gain / expected - 1.0).abs() < 1e-4, "Cr({e}; {z}) = {gain}, not {expected}");
        }
    }
}

#[test]
fn no_colour_from_the_end_on() {
    for e in [1.0, 1.5, f32::INFINITY] {
        assert_eq!(cb_gain(e, 0.7), 0.0);
        assert!(cr_gain(e, 0.35) < 1e-14);
    }
}

#[test]
fn plateau_keeps_everything_and_the_paper_has_none() {
    let settings = ChromaSettings::default();
    let at = |curves: Curves, degrees: f32| curves.gains(degrees.to_radians());
    let default = Curves::new(&settings);
    assert_eq!(at(default, 6.29), Gains { cb: 1.0, cr: 1.0 });
    assert!(at(default, 7.0).cr < 1.0);
    let paper = Curves::new(&ChromaSettings { mode: Mode::Paper, ..settings });
    assert!((at(paper, 5.5).cr - 0.816_482).abs() < 1e-4, "E = .1");
    assert!((at(paper, 54.45).cb - 0.064_446).abs() < 1e-3, "E = .99, no floor");
    assert_eq!((at(paper, 55.1).cb, at(paper, 170.0).cr < 1e-14), (0.0, true));
}

#[test]
fn from_the_end_of_the_curves_on_the_floor_is_kept() {
    let curves = Curves::new(&ChromaSettings::default());
    for (degrees, cb, cr) in
        [(55.0f32, 0.916136, 0.237654), (80.0, 0.880378, 0.123675), (110.0, 0.839305, 0.056479)]
    {
        let found = curves.gains(degrees.to_radians());
        assert!((found.cb - cb).abs() < 1e-5 && (found.cr - cr).abs() < 1e-5, "{degrees}: {found:?}");
        assert_eq!(found, floor(degrees.to_radians()));
    }
}

#[test]
fn the_rim_fade_is_for_curves_that_would_begin_at_an_edge() {
    let gains = |cr_bound: f32, degrees: f32| {
        Curves::new(&ChromaSettings { cr_bound, ..ChromaSettings::default() }).gains(degrees.to_radians())
    };
    // Eq. 2 at E = .05: .726 for the least bound, .911 for the greatest.
    let e = 6.3 + 0.05 * 48.7;
    assert!((gains(0.35, e).cr - 0.9).abs() < 1e-4, "the line, 1 - .05 / .5");
    assert!((gains(0.55, e).cr - 0.911_319).abs() < 1e-4, "the curve");
}

#[test]
fn settings_out_of_range_are_limited() {
    let wild = ChromaSettings {
        cb_bound: f32::NAN,
        cr_bound: -3.0,
        plateau_deg: 1e9,
        max_eccentricity_deg: f32::NEG_INFINITY,
        rim_fade: f32::INFINITY,
        max_change_per_s: f32::NAN,
        ..ChromaSettings::default()
    };
    let curves = Curves::new(&wild);
    assert_eq!((curves.cb_bound, curves.cr_bound), (0.70, 0.35));
    assert!((curves.plateau - 30f32.to_radians()).abs() < 1e-6);
    assert!(curves.range_scale > 0.0 && curves.range_scale.is_finite());
}

/// Without the guard green leaves the gamut by up to .0105 with BT.709; with it, by rounding only.
#[test]
fn guard_is_needed_and_works() {
    let curves = Curves::new(&ChromaSettings { mode: Mode::Paper, ..ChromaSettings::default() });
    let weights = Matrix::Bt709.weights();
    let blue = Vec3::new(0.0, 0.0, 1.0);
    let lowest = |gamut| {
        (0..100)
            .map(|i| attenuate(blue, curves.gains(i as f32 / 100.0), weights, gamut).min_element())
            .fold(0.0, f32::min)
    };
    assert!(lowest(Gamut::UNBOUNDED) < -0.005, "{}", lowest(Gamut::UNBOUNDED));
    assert!(lowest(Gamut::UNIT) > -1e-6, "{}", lowest(Gamut::UNIT));
}

fn bounds() -> impl Strategy<Value = ChromaSettings> {
    let matrix = prop_oneof![Just(Matrix::Bt709), Just(Matrix::Bt601), Just(Matrix::Bt2020)];
    (0.70f32..=0.85, 0.35f32..=0.55, 1.1f32..30.0, 20.0f32..110.0, 0.25f32..=1.0, matrix).prop_map(
        |(cb_bound, cr_bound, plateau_deg, max_eccentricity_deg, rim_fade, matrix)| ChromaSettings {
            mode: Mode::Default,
            cb_bound,
            cr_bound,
            plateau_deg,
            max_eccentricity_deg,
            rim_fade,
            matrix,
            ..ChromaSettings::default()
        },
    )
}

#[test]
fn a_colour_that_is_no_number_stays_as_it_is() {
    let gains = Gains { cb: 0.5, cr: 0.25 };
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for rgb in [Vec3::new(odd, 0.5, 0.25), Vec3::new(0.5, odd, 0.25), Vec3::new(0.5, 0.25, odd)] {
            let out = attenuate(rgb, gains, Matrix::Bt709.weights(), Gamut::POSITIVE);
            assert_eq!(out.to_array().map(f32::to_bits), rgb.to_array().map(f32::to_bits));
        }
    }
}

proptest! {
    #[test]
    fn gains_stay_in_range_and_fall(settings in bounds(), a in 0.0f32..3.2, b in 0.0f32..3.2) {
        let curves = Curves::new(&settings);
        let (near, far) = (curves.gains(a.min(b)), curves.gains(a.max(b)));
        for gains in [near, far] {
            prop_assert!((0.0..=1.0).contains(&gains.cb) && (0.0..=1.0).contains(&gains.cr), "{gains:?}");
            prop_assert!(gains.cb >= gains.cr, "{gains:?}");
        }
        prop_assert!(near.cb >= floor(a.min(b)).cb && near.cr >= floor(a.min(b)).cr, "{near:?} is below the floor");
        // 1e-6: rounding of the powers.
        prop_assert!(far.cb <= near.cb + 1e-6 && far.cr <= near.cr + 1e-6, "{near:?} to {far:?}");
    }

    #[test]
    fn nothing_falls_more_steeply_than_said(settings in bounds(), from in 0.0f32..3.1, step in 1e-3f32..0.03) {
        let curves = Curves::new(&settings);
        let (near, far) = (curves.gains(from), curves.gains(from + step));
        // 2e-6: rounding.
        let allowed = curves.steepest() * step + 2e-6;
        prop_assert!(near.cb - far.cb <= allowed && near.cr - far.cr <= allowed, "{near:?} to {far:?}, {allowed}");
    }

    #[test]
    fn polynomials_are_the_curves(settings in bounds(), paper in any::<bool>(), e in 0.0f32..3.2) {
        let settings = ChromaSettings { mode: if paper { Mode::Paper } else { Mode::Default }, ..settings };
        let curves = Curves::new(&settings);
        let (exact, found) = (curves.gains(e), Polynomials::new(&curves).gains(e));
        let off = (found.cb - exact.cb).abs().max((found.cr - exact.cr).abs());
        prop_assert!(off <= Polynomials::WITHIN, "{found:?} instead of {exact:?}");
        prop_assert!(found.cb <= 1.0 && found.cr <= 1.0 && found.cb >= 0.0 && found.cr >= 0.0, "{found:?}");
        if e <= curves.plateau {
            prop_assert_eq!(found, Gains::FULL);
        }
    }

    #[test]
    fn polynomials_fall_as_the_curves_do(settings in bounds(), from in 0.0f32..3.1, step in 1e-3f32..0.03) {
        let curves = Curves::new(&settings);
        let (near, far) = [from, from + step].map(|e| Polynomials::new(&curves).gains(e)).into();
        let allowed = curves.steepest() * step + 2e-6;
        prop_assert!(near.cb - far.cb <= allowed && near.cr - far.cr <= allowed, "{near:?} to {far:?}, {allowed}");
        prop_assert!(far.cb <= near.cb + 1e-4 && far.cr <= near.cr + 1e-4, "{near:?} to {far:?}");
    }

    #[test]
    fn gains_are_finite_for_any_eccentricity(settings in bounds(), e in proptest::num::f32::ANY) {
        let gains = Curves::new(&settings).gains(e);
        prop_assert!((0.0..=1.0).contains(&gains.cb) && (0.0..=1.0).contains(&gains.cr), "{gains:?}");
    }

    #[test]
    fn luminance_is_kept_in_gamut(
        settings in bounds(), e in 0.0f32..2.0, r in 0.0f32..=1.0, g in 0.0f32..=1.0, b in 0.0f32..=1.0,
    ) {
        let (weights, rgb) = (settings.matrix.weights(), Vec3::new(r, g, b));
        let out = attenuate(rgb, Curves::new(&settings).gains(e), weights, Gamut::UNIT);
        let (before, after) = (weights.dot(rgb), weights.dot(out));
        // 5e-7: rounding, of components up to 1.
        prop_assert!((after - before).abs() <= 5e-7, "{before} became {after}");
        prop_assert!(out.min_element() >= -1e-6 && out.max_element() <= 1.0 + 1e-6, "{out}");
    }

    #[test]
    fn full_gain_changes_nothing(r in -1.0f32..4.0, g in -1.0f32..4.0, b in -1.0f32..4.0) {
        let rgb = Vec3::new(r, g, b);
        let out = attenuate(rgb, Gains { cb: 1.0, cr: 1.0 }, Matrix::Bt709.weights(), Gamut::POSITIVE);
        prop_assert_eq!(out, rgb);
    }

    #[test]
    fn any_light_stays_finite(
        settings in bounds(), e in 0.0f32..2.0,
        r in -65504.0f32..65504.0, g in -65504.0f32..65504.0, b in -65504.0f32..65504.0,
    ) {
        let gains = Curves::new(&settings).gains(e);
        for gamut in [Gamut::POSITIVE, Gamut::UNBOUNDED] {
            prop_assert!(attenuate(Vec3::new(r, g, b), gains, settings.matrix.weights(), gamut).is_finite());
        }
    }
}
