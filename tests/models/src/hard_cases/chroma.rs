//! Hard cases of `chroma`.

use super::Case;
use crate::reference::chroma as reference;
use glam::Vec3;
use parafovea_core::chroma::{
    ChromaSettings, ChromaTemporalFilter, Curves, Gains, Gamut, Matrix, Mode, attenuate, cb_gain, cr_gain,
};
use parafovea_core::geometry::Fov;
use parafovea_core::kernels::compose::ComposeParams;

const MODEL: &str = "chroma";

pub(super) fn cases() -> Vec<Case> {
    [published(), default_mode(), colours(), times(), images()].concat()
}

fn case(case: impl Into<String>, expected: impl Into<String>, got: impl Into<String>, passed: bool) -> Case {
    Case { model: MODEL, case: case.into(), expected: expected.into(), got: got.into(), error: None, passed }
}

/// Both published curves around the ends of their domain, against double precision.
fn published() -> Vec<Case> {
    let at = |name: &str, e: f32| {
        let (cb, cr) = (cb_gain(e, 0.7), cr_gain(e, 0.35));
        let wide = f64::from(e).max(0.0);
        let (wide_cb, wide_cr) = (reference::cb_gain(wide, 0.7), reference::cr_gain(wide, 0.35));
        let error = (f64::from(cb) - wide_cb).abs().max((f64::from(cr) - wide_cr).abs());
        let made =
            case(name, format!("{wide_cb:.7}, {wide_cr:.7}"), format!("{cb:.7}, {cr:.7}"), error < 1e-6);
        Case { error: Some(error), ..made }
    };
    let limits = [
        ("E NaN", f32::NAN, Gains::FULL),
        ("E -infinite", f32::NEG_INFINITY, Gains::FULL),
        ("E infinite", f32::INFINITY, Gains { cb: 0.0, cr: 0.0 }),
    ]
    .map(|(name, e, expected)| {
        let found = Gains { cb: cb_gain(e, 0.7), cr: cr_gain(e, 0.35) };
        let passed = (found.cb - expected.cb).abs() < 1e-12 && (found.cr - expected.cr).abs() < 1e-12;
        case(
            name,
            format!("{}, {}", expected.cb, expected.cr),
            format!("{:e}, {:e}", found.cb, found.cr),
            passed,
        )
    });
    let known = [
        ("E = 0", 0.0),
        ("E = 1e-30", 1e-30),
        ("E = 1e-6", 1e-6),
        ("E = 1 - 6e-8", 1f32.next_down()),
        ("E = 1", 1.0),
        ("E = 1 + 1e-7", 1f32.next_up()),
        ("E = 1000", 1000.0),
    ];
    known.map(|(name, e)| at(name, e)).into_iter().chain(limits).collect()
}

/// Our mode, at any angle: full within the plateau, the floor far out.
fn default_mode() -> Vec<Case> {
    let curves = Curves::new(&ChromaSettings::default());
    let known = [0.0, 6.3, 6.300_1, 20.0, 54.999, 55.0, 55.001, 110.0, 120.0].map(|degrees: f32| {
        let found = curves.gains(degrees.to_radians());
        let (cb, cr) = reference::default_gains(
            f64::from(degrees),
            f64::from(6.3f32),
            55.0,
            f64::from(0.70f32),
            f64::from(0.55f32),
        );
        let error = (f64::from(found.cb) - cb).abs().max((f64::from(found.cr) - cr).abs());
        let made = case(
            format!("default mode at {degrees} degrees"),
            format!("{cb:.6}, {cr:.6}"),
            format!("{:.6}, {:.6}", found.cb, found.cr),
            error < 5e-6,
        );
        Case { error: Some(error), ..made }
    });
    let wrong = ChromaSettings {
        cb_bound: f32::NAN,
        cr_bound: f32::NEG_INFINITY,
        plateau_deg: f32::INFINITY,
        max_eccentricity_deg: -1.0,
        rim_fade: f32::NAN,
        max_change_per_s: f32::NAN,
        ..ChromaSettings::default()
    };
    let wild = {
        let gains = [0.0, 0.5, 3.2, f32::NAN, f32::INFINITY].map(|angle| Curves::new(&wrong).gains(angle));
        // 1e-12: at the very end Eq. 1 is 0, and Eq. 2 the square of the rounding error of a cosine.
        let in_order = |gains: &Gains| gains.cr >= 0.0 && gains.cr <= gains.cb + 1e-12 && gains.cb <= 1.0;
        let passed = gains.iter().all(in_order);
        case(
            "settings NaN and infinite",
            "0 <= Cr <= Cb <= 1",
            format!("{:.3}, {:.3} at 180 degrees", gains[2].cb, gains[2].cr),
            passed,
        )
    };
    known.into_iter().chain([wild]).collect()
}

/// Colours at the edges of the gamut and far beyond, at gains that differ much.
fn colours() -> Vec<Case> {
    let weights = Matrix::Bt709.weights();
    let gains = Gains { cb: 0.95, cr: 0.05 };
    let guarded = [
        ("black", Vec3::ZERO),
        ("white", Vec3::ONE),
        ("saturated blue", Vec3::Z),
        ("saturated yellow", Vec3::new(1.0, 1.0, 0.0)),
        ("saturated red", Vec3::X),
        ("dark blue 1e-6", Vec3::Z * 1e-6),
    ]
    .map(|(name, rgb)| {
        let out = attenuate(rgb, gains, weights, Gamut::UNIT);
        let change = f64::from((weights.dot(out) - weights.dot(rgb)).abs());
        let inside = out.min_element() >= -1e-7 && out.max_element() <= 1.0 + 1e-6;
        let made = case(
            format!("{name}, guarded"),
            "Y kept, in 0..=1",
            format!("{out:.6}"),
            inside && change < 2e-7,
        );
        Case { error: Some(change), ..made }
    });
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let bright = [
        ("10,000 cd/m2 blue (125 of 80)", Vec3::new(0.0, 0.0, 125.0)),
        ("65504 red", Vec3::new(65504.0, 0.0, 0.0)),
        ("negative green (wide gamut)", Vec3::new(0.9, -0.2, 0.1)),
        ("denormal 1e-40", Vec3::new(1e-40, 0.0, 2e-40)),
    ]
    .map(|(name, rgb)| {
        let out = attenuate(rgb, gains, weights, Gamut::UNBOUNDED);
        let expected = reference::scaled(wide(rgb), (gains.cb.into(), gains.cr.into()), wide(weights));
        let error = wide(out).into_iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = f64::from(rgb.abs().max_element()).max(1e-38);
        let made = case(name, format!("{expected:.3?}"), format!("{out:.3}"), error < 1e-6 * size);
        Case { error: Some(error), ..made }
    });
    let odd = [("NaN", f32::NAN), ("infinite", f32::INFINITY)].map(|(name, odd)| {
        let rgb = Vec3::new(0.5, odd, 0.25);
        let out = attenuate(rgb, gains, weights, Gamut::POSITIVE);
        let same = out.to_array().map(f32::to_bits) == rgb.to_array().map(f32::to_bits);
        case(format!("{name} green"), "the pixel as it is", format!("{out}"), same)
    });
    [guarded.to_vec(), bright.to_vec(), odd.to_vec()].concat()
}

/// Clocks and gazes that misbehave; the results are strength and radius.
fn times() -> Vec<Case> {
    let settings = ChromaSettings::default();
    let month_ns = 30 * 86_400 * 1_000_000_000i64;
    let after = |name: &str, from: i64, to: i64, gaze: Vec3, radius: std::ops::RangeInclusive<f32>| {
        let mut filter = ChromaTemporalFilter::default();
        filter.update(Some(Vec3::NEG_Z), from, &settings);
        let focus = filter.update(Some(gaze), to, &settings);
        let got = focus
            .map_or("no focus".to_owned(), |focus| format!("{:.4} rad, {}", focus.radius, focus.strength));
        let passed = focus.is_some_and(|focus| radius.contains(&focus.radius) && focus.strength == 1.0);
        case(name, format!("{:.4} to {:.4} rad, 1", radius.start(), radius.end()), got, passed)
    };
    let aside = Vec3::new(1.0, 0.0, -1.0);
    let half = std::f32::consts::PI / 8.0;
    let frame_ns = 11_111_111;
    let mut cases = vec![
        after("gaze jumps 45 degrees, 11 ms", 0, frame_ns, aside, half - 0.002..=half - 0.0005),
        after(
            "the same after 30 days of XrTime",
            month_ns,
            month_ns + frame_ns,
            aside,
            half - 0.002..=half - 0.0005,
        ),
        after("the same at an equal time", 5, 5, aside, half - 1e-5..=half + 1e-5),
        after("the same with a clock that went back", month_ns, 0, aside, half - 1e-5..=half + 1e-5),
        after("the whole of i64 in one step", i64::MIN, i64::MAX, aside, 0.0..=1e-6),
        after("gaze turns round, equal time", 0, 0, Vec3::Z, 4.0 * half - 1e-5..=4.0 * half + 1e-5),
        after("gaze of length 1e38", 0, 0, Vec3::NEG_Z * 1e38, 0.0..=1e-6),
        after("gaze of length 1e-38", 0, 0, Vec3::NEG_Z * 1e-38, 0.0..=1e-6),
    ];
    for (name, gaze) in [("lost", None), ("zero", Some(Vec3::ZERO)), ("NaN", Some(Vec3::NAN))] {
        let mut filter = ChromaTemporalFilter::default();
        filter.update(Some(Vec3::NEG_Z), 0, &settings);
        let lost = filter.update(gaze, frame_ns, &settings);
        let back = filter.update(Some(Vec3::NEG_Z), 2 * frame_ns, &settings);
        let strength = back.map_or(f32::NAN, |focus| focus.strength);
        let error = f64::from(strength) - 0.5 * frame_ns as f64 * 1e-9;
        let made = case(
            format!("gaze {name} for a frame"),
            "full colour, then 0.0056 strength",
            format!("{lost:?}, {strength:.6}"),
            lost.is_none() && error.abs() < 1e-8,
        );
        cases.push(Case { error: Some(error.abs()), ..made });
    }
    cases
}

/// The smallest and the largest image, and a gaze that none of it is near.
fn images() -> Vec<Case> {
    let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
    let params =
        |extent, gaze| ComposeParams::new([0, 0], extent, fov, gaze, &ChromaSettings::default(), true);
    let behind = params([1, 1], Vec3::Z).pixel(0, 0, Vec3::X);
    let paper = ChromaSettings { mode: Mode::Paper, ..ChromaSettings::default() };
    let edge = ComposeParams::new([0, 0], [8192, 8192], fov, Vec3::NEG_Z, &paper, true);
    let corner = edge.pixel(8191, 8191, Vec3::X);
    vec![
        case("1x1, gaze ahead", "untouched", "", params([1, 1], Vec3::NEG_Z).pixel(0, 0, Vec3::X).is_none()),
        case(
            "1x1, gaze behind",
            "attenuated, not gone",
            format!("{behind:?}"),
            behind.is_some_and(|rgb| rgb.is_finite() && rgb.x - rgb.z > 0.1 && rgb.x < 0.9),
        ),
        case(
            "8192x8192, corner, paper mode",
            "finite, Y kept",
            format!("{corner:?}"),
            corner.is_some_and(|rgb| (Matrix::Bt709.weights().dot(rgb) - 0.2126).abs() < 1e-6),
        ),
        case("1x1, no gaze", "untouched", "", !params([1, 1], Vec3::ZERO).has_work()),
    ]
}
