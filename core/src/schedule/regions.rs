//! The concentric regions around the gaze, and the share of an image that each has.

use super::configuration::{REGIONS, UpdateConfiguration};
use crate::geometry::ImagePlane;
use glam::{DVec3, Vec2, Vec3};

/// Boundaries of the regions of paper B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regions {
    /// Outer radii of the first four regions, degrees of eccentricity, not falling; the fifth is the rest. An
    /// eccentricity equal to a radius lies inside. NaN counts as unbounded: everything up to there is faster.
    pub radii_deg: [f32; 4],
}

impl Default for Regions {
    /// 6.3, 9.1, 18.1 and 31.1 degrees: 5.2, 8, 17 and 30, which reproduce the paper's table of pixel rates, plus
    /// the 1.1 degrees that it adds for the tracker (its section 4).
    fn default() -> Self {
        Self { radii_deg: [6.3, 9.1, 18.1, 31.1] }
    }
}

impl Regions {
    /// Region of an eccentricity in degrees, 0 (centre) ..= 4. NaN gives 0, as if looked at.
    pub fn region_at(&self, eccentricity_deg: f32) -> usize {
        let mut region = 0;
        // Each radius that is passed counts once, which has no branch and is right for radii that do not fall.
        for radius in self.radii_deg {
            region += usize::from(eccentricity_deg > radius);
        }
        region
    }

    /// The regions with every radius larger by `deg`, as when the fovea is inflated
    /// ([`crate::gaze::foveal_inflation_deg`]). Negative or NaN adds nothing.
    pub fn enlarged(&self, deg: f32) -> Self {
        Self { radii_deg: self.radii_deg.map(|radius| radius + deg.max(0.0)) }
    }

    /// Number of pixels of an image of `extent` pixels in each region: pixels are counted at their centre, `gaze` is in view
    /// space. A gaze without a meaning (zero, not finite) puts all into the first.
    pub fn pixel_counts(&self, plane: &ImagePlane, extent: [u32; 2], gaze: Vec3) -> [u64; REGIONS] {
        let mut counts = [0; REGIONS];
        let Some(gaze) = gaze.as_dvec3().try_normalize().filter(|gaze| gaze.is_finite()) else {
            counts[0] = u64::from(extent[0]) * u64::from(extent[1]);
            return counts;
        };
        // Angles beyond 180 degrees do not occur, and below 0 neither; NaN becomes 180.
        let cosines = self.radii_deg.map(|radius| {
            let radius = if radius.is_nan() { 180.0 } else { f64::from(radius) };
            if radius < 0.0 { 2.0 } else { radius.min(180.0).to_radians().cos() }
        });
        for y in 0..extent[1] {
            for x in 0..extent[0] {
                let direction = direction(plane, Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let cosine = gaze.dot(direction) / direction.length();
                counts[cosines.iter().filter(|&&limit| cosine < limit).count()] += 1;
            }
        }
        counts
    }
}

/// As [`ImagePlane::direction`], in double precision: a count of pixels is compared exactly.
fn direction(plane: &ImagePlane, pixel: Vec2) -> DVec3 {
    (plane.origin.as_dvec2() + plane.step.as_dvec2() * pixel.as_dvec2()).extend(-1.0)
}

/// Paper B's pixel rate P = (sum of a_i / f_i) / a: the share of the pixels that is rendered, averaged over many
/// frames, 0..=1. `areas` are the regions' sizes in any one unit.
///
/// Areas that are negative or not finite count as 0; without any area the answer is 1.
pub fn pixel_rate(areas: [f32; REGIONS], configuration: UpdateConfiguration) -> f32 {
    let areas = areas.map(|area| if area.is_finite() { f64::from(area.max(0.0)) } else { 0.0 });
    let total: f64 = areas.iter().sum();
    let rendered: f64 =
        areas.iter().zip(configuration.factors()).map(|(area, factor)| area / f64::from(factor)).sum();
    if total > 0.0 { (rendered / total) as f32 } else { 1.0 }
}
