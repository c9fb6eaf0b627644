//! A plan as an image: rates as colours, re-used tiles darker, radii as lines, the gaze as a dot.

use super::frame::{EyePlan, FramePlan};
use crate::geometry::eccentricity;
use crate::image::Plane;
use crate::rate::ShadingRate;
use glam::{Vec2, Vec3};

/// sRGB.
type Colour = [u8; 3];

/// Colours of 1, 1/2, 1/4, 1/8 and 1/16 invocations per pixel: light to dark, distinct for the colour-blind too.
const RATES: [Colour; 5] = [[250, 231, 85], [122, 209, 81], [34, 168, 132], [42, 120, 142], [65, 68, 135]];

/// Brightness of re-used tiles, as part of their colour.
const REUSED: f32 = 0.45;

const GAZE: Colour = [255, 255, 255];
const RING: Colour = [20, 20, 20];
const REGION: Colour = [255, 140, 105];
const GAP: Colour = [255, 255, 255];

/// Radius of the dot, degrees.
const DOT_DEG: f32 = 0.8;

impl FramePlan {
    /// Both eyes beside each other, each `width` pixels wide (1..=4096), as sRGB. Dark lines are the borders of rates,
    /// red lines the borders of the regions of the update schedule.
    pub fn picture(&self, width: u32) -> Plane<[u8; 3]> {
        let width = width.clamp(1, 4096);
        let height = self.eyes.iter().map(|eye| height(eye, width)).max().unwrap_or(1);
        let gap = width / 64;
        Plane::from_fn(width * 2 + gap, height, |x, y| {
            let (eye, x) = if x < width { (0, Some(x)) } else { (1, x.checked_sub(width + gap)) };
            x.and_then(|x| self.colour(&self.eyes[eye], [x, y], width)).unwrap_or(GAP)
        })
    }

    /// Colour of a pixel of the picture of one eye; nothing below it.
    fn colour(&self, eye: &EyePlan, at: [u32; 2], width: u32) -> Option<Colour> {
        if eye.extent.contains(&0) || at[1] >= height(eye, width) {
            return None;
        }
        let scale = eye.extent[0] as f32 / width as f32;
        let pixel =
            |dx: u32, dy: u32| Vec2::new((at[0] + dx) as f32 + 0.5, (at[1] + dy) as f32 + 0.5) * scale;
        let here = self.bands(eye, pixel(0, 0));
        let beside = [self.bands(eye, pixel(1, 0)), self.bands(eye, pixel(0, 1))];
        if here.gaze {
            return Some(GAZE);
        }
        if beside.iter().any(|next| next.ring != here.ring) {
            return Some(RING);
        }
        if beside.iter().any(|next| next.region != here.region) {
            return Some(REGION);
        }
        let middle = pixel(0, 0);
        let [x, y] = eye.tile_of([middle.x as u32, middle.y as u32]);
        let colour = of_rate(eye.rate(x, y));
        let kept = if eye.is_due(x, y) { 1.0 } else { REUSED };
        Some(colour.map(|channel| (f32::from(channel) * kept) as u8))
    }

    /// Between which lines a pixel of the view lies.
    fn bands(&self, eye: &EyePlan, pixel: Vec2) -> Bands {
        let direction = eye.plane().direction(pixel);
        let angle = eye.centres.map(|gaze| eccentricity(gaze, direction).to_degrees());
        let nearer = angle[0].min(angle[1]);
        let inside = |radii: &[f32]| radii.iter().filter(|radius| nearer >= **radius).count();
        Bands {
            gaze: eye.gaze != Vec3::ZERO && eccentricity(eye.gaze, direction).to_degrees() < DOT_DEG,
            ring: inside(&eye.rings.from_deg()),
            region: inside(&self.regions_deg),
        }
    }
}

/// Position of a pixel among the lines of the picture.
struct Bands {
    gaze: bool,
    ring: usize,
    region: usize,
}

/// Height of the picture of an eye that is `width` wide, 1..=4 times that.
fn height(eye: &EyePlan, width: u32) -> u32 {
    let ratio = f64::from(eye.extent[1]) / f64::from(eye.extent[0].max(1));
    (f64::from(width) * ratio.min(4.0)).round().max(1.0) as u32
}

fn of_rate(rate: ShadingRate) -> Colour {
    RATES[((rate.octaves() * 2.0) as usize).min(RATES.len() - 1)]
}
