//! Change of contrast in just-noticeable differences: castleCSF's sensitivity to the change in each band.
//!
//! A band's value over the luminance (or colour) that the eye is adapted to is a contrast; times the sensitivity at the
//! band's frequency, the spot's eccentricity and its luminance it is in JND. A spot's error is the largest of its
//! bands' errors. Masking by the image is not modelled: in busy parts errors are less visible than these figures.

use crate::errors::bands::{BAND_CYCLES_PER_PIXEL, BAND_GAIN, BANDS, Bands};
use crate::errors::field::{CELL_PX, Field};
use parafovea_core::image::Plane;
use parafovea_core::perception::csf::{Stimulus, VisualField, castle};
use std::f32::consts::PI;

/// A mechanism of castleCSF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mechanism {
    /// Luminance, after [`crate::errors::temporal`]'s sustained filter.
    Sustained,
    /// Luminance, after the transient filter, which peaks at this frequency, Hz.
    Transient(f32),
    /// Red-green, at 0 Hz: each frame for itself.
    RedGreen,
    /// Yellow-violet, at 0 Hz.
    YellowViolet,
}

/// JND for a unit of band value, by band and cell: sensitivity over the adaptation luminance.
pub(crate) type Weights = [Vec<f32>; BANDS];

impl Mechanism {
    /// Weights for a picture whose cells have the adaptation luminance `adaptation_cd_m2`.
    pub fn weights(self, field: &Field, adaptation_cd_m2: &[f32]) -> Weights {
        std::array::from_fn(|band| {
            let cells = field.cells.iter().zip(adaptation_cd_m2);
            cells
                .map(|(cell, &luminance_cd_m2)| {
                    let frequency_cpd = BAND_CYCLES_PER_PIXEL[band] * cell.pixels_per_degree;
                    let stimulus = Stimulus {
                        frequency_cpd,
                        temporal_hz: if let Self::Transient(peak_hz) = self { peak_hz } else { 0.0 },
                        eccentricity_deg: cell.eccentricity_deg,
                        luminance_cd_m2,
                        area_deg2: area_deg2(frequency_cpd),
                    };
                    BAND_GAIN[band] * self.sensitivity(&stimulus) / luminance_cd_m2
                })
                .collect()
        })
    }

    fn sensitivity(self, stimulus: &Stimulus) -> f32 {
        let field = VisualField::Worst;
        match self {
            Self::Sustained => castle::sustained(stimulus, field),
            Self::Transient(_) => castle::transient(stimulus, field),
            Self::RedGreen => castle::red_green(stimulus, field),
            Self::YellowViolet => castle::yellow_violet(stimulus, field),
        }
    }
}

/// Area of a change, square degrees: a disc with a radius of one cycle, at least one square degree, since whole
/// rings are degraded.
fn area_deg2(frequency_cpd: f32) -> f32 {
    (PI / (frequency_cpd * frequency_cpd)).max(1.0)
}

/// JND at each pixel for a picture of changes.
pub(crate) fn map(change: &Plane, field: &Field, weights: &Weights, bands: &mut Bands) -> Plane {
    let [width, height] = field.extent;
    let mut map = Plane::filled(width, height, 0.0_f32);
    bands.split(change, |band, values| {
        let rows = map.texels_mut().chunks_exact_mut(width as usize);
        for (y, (to, from)) in rows.zip(values.texels().chunks_exact(width as usize)).enumerate() {
            let cells = &weights[band][y / CELL_PX as usize * field.cells_across as usize..];
            let parts = to.chunks_mut(CELL_PX as usize).zip(from.chunks(CELL_PX as usize));
            for ((to, from), weight) in parts.zip(cells) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = to.max(from.abs() * weight);
                }
            }
        }
    });
    map
}

/// The luminance that the eye is adapted to at each cell, cd/m^2: the reference's mean over some 20 pixels.
pub(crate) fn adaptation(luminance: &Plane, field: &Field, bands: &mut Bands) -> Vec<f32> {
    let mean = bands.mean(luminance);
    let [width, height] = field.extent;
    let centre = |cell: u32, side: u32| (cell * CELL_PX + CELL_PX / 2).min(side - 1);
    let cells = 0..field.cells.len() as u32;
    cells
        .map(|cell| {
            mean.at(centre(cell % field.cells_across, width), centre(cell / field.cells_across, height))
        })
        .collect()
}

#[cfg(test)]
mod tests;
