use super::*;
use crate::checks::checks;
use crate::errors::clip::{Eye, Picture};
use glam::{Quat, Vec3};
use parafovea_core::geometry::Fov;
use std::f32::consts::TAU;

const SIDE: u32 = 128;
const CYCLES_PER_PIXEL: f32 = BAND_CYCLES_PER_PIXEL[1];

/// A view of so small an angle that gratings along it have the frequency `frequency_cpd`, with the gaze this far above.
fn field(frequency_cpd: f32, eccentricity_deg: f32) -> Field {
    let pixels_per_degree = frequency_cpd / CYCLES_PER_PIXEL;
    let half = (SIDE as f32 / 2.0 * (1.0 / pixels_per_degree).to_radians().tan()).atan();
    let fov = Fov { left: -half, right: half, up: half, down: -half };
    let gaze = Quat::from_rotation_x(eccentricity_deg.to_radians()) * Vec3::NEG_Z;
    let picture = Picture::from_linear(SIDE, SIDE, |_, _| [0.5; 3]);
    Field::new(&Eye { picture, fov, gaze, age: None })
}

/// JND of a change of luminance by a grating with this contrast, at the peak nearest to the middle.
fn seen(mechanism: Mechanism, field: &Field, contrast: f32, luminance_cd_m2: f32) -> f32 {
    let grating = |x: u32| (TAU * CYCLES_PER_PIXEL * (x as f32 - SIDE as f32 / 2.0)).cos();
    let change = Plane::from_fn(SIDE, SIDE, |x, _| luminance_cd_m2 * contrast * grating(x));
    let adaptation = vec![luminance_cd_m2; field.cells.len()];
    let weights = mechanism.weights(field, &adaptation);
    map(&change, field, &weights, &mut Bands::default()).at(SIDE / 2, SIDE / 2)
}

/// castleCSF's sensitivity, computed by others, is the inverse of the contrast that reads 1 JND.
#[test]
fn a_grating_at_threshold_is_one_jnd() {
    let usable = |check: &&crate::checks::Sensitivity| {
        check.omega == 0.0 && check.area == 1.0 && check.rho >= 2.0 && check.ecc <= 20.0
    };
    let checks = checks();
    let pairs: Vec<_> = checks.castle_ach_vis0.iter().zip(&checks.castle_ach_vis180).collect();
    let mut count = 0;
    for (temporal, nasal) in pairs.into_iter().filter(|(temporal, _)| usable(temporal)) {
        let sensitivity = temporal.sensitivity.max(nasal.sensitivity) as f32;
        let field = field(temporal.rho as f32, temporal.ecc as f32);
        let jnd = seen(Mechanism::Sustained, &field, 1.0 / sensitivity, temporal.luminance as f32);
        // Half a cell between the middle and the cell's centre, where sensitivity is computed, is up to 0.6 degrees.
        assert!((jnd - 1.0).abs() < 0.06, "{temporal:?}: {jnd}");
        count += 1;
    }
    assert!(count >= 5, "{count} checks");
}

#[test]
fn colour_uses_its_own_sensitivity() {
    let field = field(2.0, 0.0);
    let stimulus = Stimulus { frequency_cpd: 2.0, ..Stimulus::default() };
    for (mechanism, sensitivity) in [
        (Mechanism::RedGreen, castle::red_green(&stimulus, VisualField::Worst)),
        (Mechanism::YellowViolet, castle::yellow_violet(&stimulus, VisualField::Worst)),
        (Mechanism::Transient(0.0), castle::transient(&stimulus, VisualField::Worst)),
    ] {
        let jnd = seen(mechanism, &field, 0.1, 100.0);
        // Its lower bands may show colour better than the band of the grating itself.
        assert!(
            jnd >= 0.1 * sensitivity * 0.93 && jnd < 0.1 * sensitivity * 2.0,
            "{mechanism:?} {jnd} {sensitivity}"
        );
    }
}

#[test]
fn adaptation_is_the_local_mean() {
    let field = field(2.0, 0.0);
    let luminance = Plane::from_fn(SIDE, SIDE, |x, _| if x < SIDE / 2 { 10.0 } else { 50.0 });
    let adaptation = adaptation(&luminance, &field, &mut Bands::default());
    assert!((adaptation[0] - 10.0).abs() < 1e-4 && (adaptation[15] - 50.0).abs() < 1e-4);
    assert!(adaptation[7] > 15.0 && adaptation[7] < 30.0, "{}", adaptation[7]);
}
