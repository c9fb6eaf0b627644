//! The update schedule against paper B's table.

use glam::Vec3;
use parafovea_core::geometry::Fov;
use parafovea_core::schedule::{Regions, UpdateConfiguration, pixel_rate};
use parafovea_models::checks::checks;
use parafovea_models::reference::schedule as reference;

/// The display that the paper's table fits best, as the paper does not state its field of view: 1440 x 1600 pixels,
/// 110.5 degrees high.
const EXTENT: [u32; 2] = [1440, 1600];
const HALF_FOV_DEG: f64 = 55.25;

/// Pixels of each region there, with the gaze at the centre.
fn counts() -> [u64; 5] {
    let up = HALF_FOV_DEG.to_radians() as f32;
    let right = (up.tan() * 0.9).atan();
    let plane = Fov { left: -right, right, up, down: -up }.tangents().plane(EXTENT);
    Regions::default().pixel_counts(&plane, EXTENT, Vec3::NEG_Z)
}

#[test]
fn regions_have_the_stated_pixels() {
    assert_eq!(counts(), [11796, 13024, 78540, 248780, 1951860]);
    let radii_deg = Regions::default().radii_deg;
    // The radii have one decimal, which f32 does not hold exactly.
    let exact = radii_deg.map(|radius| (f64::from(radius) * 10.0).round() / 10.0);
    assert_eq!(counts(), reference::region_counts(EXTENT[0], EXTENT[1], HALF_FOV_DEG, exact));
    for (radius, stated) in exact.into_iter().zip(checks().frame_rate.radii_deg) {
        assert!((radius - stated).abs() < 1e-12);
    }
}

#[test]
fn regions_have_the_stated_shares() {
    let total = f64::from(EXTENT[0] * EXTENT[1]);
    for (count, share) in counts().into_iter().zip(checks().frame_rate.area_frac) {
        // The shares are of circles, and a circle's edge in pixels is up to 38 pixels of 2,304,000 off.
        assert!((count as f64 / total - share).abs() < 2e-5, "{count}: {share}");
    }
}

#[test]
fn pixel_rates_equal_the_table() {
    let checks = checks().frame_rate;
    assert_eq!(checks.table.len(), UpdateConfiguration::PAPER.len());
    let areas = counts().map(|count| count as f32);
    for configuration in UpdateConfiguration::PAPER {
        let row = &checks.table[&configuration.to_string()];
        let points = 100.0 * f64::from(pixel_rate(areas, configuration));
        assert!(
            (points - row.paper).abs() <= checks.tol_points,
            "{configuration}: {points} for {}",
            row.paper
        );
        assert!((points - row.model).abs() < 1e-3, "{configuration}: {points} for {}", row.model);
        let exact = reference::pixel_rate(counts().map(|count| count as f64), configuration.factors());
        assert!((points - 100.0 * exact).abs() < 1e-5, "{configuration}");
        let given = pixel_rate(checks.area_frac.map(|share| share as f32), configuration);
        assert!((100.0 * f64::from(given) - row.model).abs() < 1e-5, "{configuration}: {given}");
    }
}
