//! The rate of a tile, from the definitions: its point nearest to either gaze, the map there, and the loss of visible contrast there.

use super::perception::csf;
use glam::{DQuat, DVec2, DVec3};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::geometry::Fov;
use parafovea_core::perception::TileContrast;
use parafovea_core::rate::ShadingRate;

/// One view with its tiles.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// First pixel in its image.
    pub offset: [u32; 2],
    /// Pixels.
    pub extent: [u32; 2],
    /// Edges.
    pub fov: Fov,
    /// Into the space of the gaze.
    pub orientation: DQuat,
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
}

impl View {
    /// Corners of a tile's part within the view, pixels.
    fn corners(&self, tile: [u32; 2]) -> [DVec2; 2] {
        let at = |tile: [u32; 2]| {
            let line = |axis: usize| {
                let first = self.offset[axis] / self.texel[axis];
                let pixel = f64::from((first + tile[axis]) * self.texel[axis]) - f64::from(self.offset[axis]);
                pixel.clamp(0.0, f64::from(self.extent[axis]))
            };
            DVec2::new(line(0), line(1))
        };
        [at(tile), at([tile[0] + 1, tile[1] + 1])]
    }

    /// Position of a pixel on the plane one unit ahead.
    fn on_plane(&self, pixel: DVec2) -> DVec2 {
        let edge = |angle: f32| f64::from(angle).tan();
        let part = pixel / DVec2::new(f64::from(self.extent[0]), f64::from(self.extent[1]));
        let (left, right) = (edge(self.fov.left), edge(self.fov.right));
        let (up, down) = (edge(self.fov.up), edge(self.fov.down));
        DVec2::new(left + (right - left) * part.x, up + (down - up) * part.y)
    }

    /// Angle from the nearer of two gazes to the nearest point of a tile, degrees.
    pub fn least_eccentricity_deg(&self, tile: [u32; 2], gazes: [DVec3; 2]) -> f64 {
        let [min, max] = self.corners(tile).map(|pixel| self.on_plane(pixel));
        let radians = gazes.map(|gaze| nearest(self.orientation.inverse() * gaze, min, max));
        radians[0].min(radians[1]).to_degrees()
    }

    /// Pixels per degree in the middle of a tile along the axis that has fewer, by difference.
    pub fn pixels_per_degree(&self, tile: [u32; 2]) -> f64 {
        let [min, max] = self.corners(tile);
        let direction = |pixel: DVec2| self.on_plane(pixel).extend(-1.0);
        let middle = (min + max) * 0.5;
        let step = 1e-3;
        let along = |axis: DVec2| {
            step / angle(direction(middle - axis * step * 0.5), direction(middle + axis * step * 0.5))
        };
        along(DVec2::X).min(along(DVec2::Y)).to_radians()
    }
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Angle from a direction to the nearest point of a rectangle on the plane z = -1.
fn nearest(gaze: DVec3, a: DVec2, b: DVec2) -> f64 {
    let (min, max) = (a.min(b), a.max(b));
    if gaze.z < 0.0 {
        let at = gaze.truncate() / -gaze.z;
        if at.cmpge(min).all() && at.cmple(max).all() {
            return 0.0;
        }
    }
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)].map(|at| at.extend(-1.0));
    (0..4).map(|i| to_segment(gaze, corners[i], corners[(i + 1) % 4])).fold(f64::INFINITY, f64::min)
}

/// Angle to the nearest point of a + t (b - a), 0 <= t <= 1: where the derivative of the cosine by t is 0, or an end.
fn to_segment(gaze: DVec3, a: DVec3, b: DVec3) -> f64 {
    let d = b - a;
    let t =
        (gaze.dot(d) * a.dot(a) - gaze.dot(a) * a.dot(d)) / (gaze.dot(a) * d.dot(d) - gaze.dot(d) * a.dot(d));
    let inside = if t > 0.0 && t < 1.0 { a + d * t } else { a };
    [a, b, inside].map(|point| angle(gaze, point)).into_iter().fold(f64::INFINITY, f64::min)
}

/// The coarsest of `rates` that is at least as fine as the map at an eccentricity: 1 up to E_f, the peripheral rate from
/// E_t on, linear between.
pub fn fixed_rate(map: &FixedFoveation, eccentricity_deg: f64, rates: &[ShadingRate]) -> ShadingRate {
    let (inner, outer) = (f64::from(map.foveal_deg), f64::from(map.transitional_deg));
    let peripheral = f64::from(map.peripheral.fraction());
    let wanted = if eccentricity_deg <= inner {
        1.0
    } else if eccentricity_deg >= outer {
        peripheral
    } else {
        1.0 - (eccentricity_deg - inner) / (outer - inner) * (1.0 - peripheral)
    };
    coarsest(rates, |rate| f64::from(rate.fraction()) >= wanted)
}

/// Model of the contrast sensitivity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensitivity {
    /// castleCSF at the frequencies where the bands respond, the greater of both visual fields.
    Castle,
    /// Tursun's at the upper ends of the bands, with the gain of the pyramid that it was fitted to.
    Tursun,
}

/// The coarsest of `rates` that loses at most `budget` of a tile's visible contrast: sum over the bands of contrast times sensitivity, as
/// far as the rate removes the band.
pub fn contrast_rate(
    tile: &TileContrast,
    pixels_per_degree: f64,
    eccentricity_deg: f64,
    sensitivity: Sensitivity,
    budget: f64,
    rates: &[ShadingRate],
) -> ShadingRate {
    let visible: Vec<f64> = (0..tile.bands.len())
        .map(|band| {
            let l = f64::from(tile.adaptation_cd_m2);
            let octave = 0.5f64.powi(band as i32);
            let s = match sensitivity {
                Sensitivity::Castle => {
                    let (temporal, nasal) = csf::achromatic(&csf::Stimulus {
                        rho: pixels_per_degree / 4.0 * octave,
                        omega: 0.0,
                        eccentricity: eccentricity_deg,
                        luminance: l,
                        area: 1.0,
                    });
                    temporal.max(nasal)
                }
                // The pyramid that was fitted doubles its coefficients from band to band.
                Sensitivity::Tursun => {
                    csf::tursun(
                        [5.28964, 6.22567, 3.40410, 4.01061],
                        0.0398141,
                        pixels_per_degree / 2.0 * octave,
                        eccentricity_deg,
                        l,
                    ) / octave
                }
            };
            f64::from(tile.bands[band]) * s
        })
        .collect();
    coarsest(rates, |rate| {
        let octaves = -f64::from(rate.fraction()).sqrt().log2();
        let loss: f64 =
            visible.iter().enumerate().map(|(i, c)| c * (octaves - i as f64).clamp(0.0, 1.0)).sum();
        loss <= budget
    })
}

fn coarsest(rates: &[ShadingRate], permitted: impl Fn(ShadingRate) -> bool) -> ShadingRate {
    rates
        .iter()
        .copied()
        .filter(|rate| permitted(*rate))
        .fold(ShadingRate::R1X1, |best, next| if next.fraction() < best.fraction() { next } else { best })
}
