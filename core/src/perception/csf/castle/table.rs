//! [`achromatic`](super::achromatic) sensitivity at the gaze as a table, for as many tiles as a picture has.

use super::{ACHROMATIC_FALL, achromatic_foveal, log2};
use crate::perception::BANDS;
use crate::perception::csf::{SensitivityFall, Stimulus, VisualField};
use crate::range::within;

/// Steps of the table for each octave of frequency and of luminance.
const STEPS: f32 = 4.0;
/// log2 of the frequencies of the first and last column, cycles per degree: the model's domain.
const FREQUENCY: [f32; 2] = [-4.0, 6.0];
/// log2 of the luminances of the first and last row, cd/m^2: around the model's domain.
const LUMINANCE: [f32; 2] = [-10.0, 13.5];
const COLUMNS: usize = ((FREQUENCY[1] - FREQUENCY[0]) * STEPS) as usize + 1;
const ROWS: usize = ((LUMINANCE[1] - LUMINANCE[0]) * STEPS) as usize + 1;

/// Sensitivity at the gaze for one temporal frequency and area, tabulated over spatial frequency and luminance.
///
/// Within 2 % of the formula (0.2 dB; the formula is within 3.6 dB of human sensitivity) but for 0.009 to 0.032 cd/m^2:
/// there the transient response has a step at 0.0113, which the table spreads over its cells. 15 kB.
#[derive(Clone, Debug, PartialEq)]
pub struct FovealTable {
    /// log2 of sensitivity.
    texels: Vec<f32>,
}

impl FovealTable {
    /// The table for a temporal frequency in Hz and an area in square degrees, clamped by [`Stimulus::clamped`].
    pub fn new(temporal_hz: f32, area_deg2: f32) -> Self {
        let usual = Stimulus { temporal_hz, area_deg2, ..Stimulus::default() }.clamped();
        let texels =
            (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column))).map(|(row, column)| {
                let stimulus = Stimulus {
                    frequency_cpd: (FREQUENCY[0] + column as f32 / STEPS).exp2(),
                    luminance_cd_m2: (LUMINANCE[0] + row as f32 / STEPS).exp2(),
                    ..usual
                };
                log2(achromatic_foveal(&stimulus))
            });
        Self { texels: texels.collect() }
    }

    /// log2 of sensitivity: 41 spatial frequencies from 1/16 cycle per degree on, four to an octave, in each of 95 rows of
    /// luminance from 2^-10 cd/m^2 on, as many.
    pub fn texels(&self) -> &[f32] {
        &self.texels
    }

    /// [`achromatic`](super::achromatic) sensitivity in each band of a tile, finest first, each an octave below the one
    /// before ([`BandFrequencies`](crate::perception::BandFrequencies)), where the finest is at `finest_cpd` cycles per
    /// degree, and the tile has `luminance_cd_m2` and lies at `eccentricity_deg`.
    ///
    /// Out of domain or NaN: as in [`Stimulus::clamped`]. At least 2^-126.
    pub fn sensitivities(
        &self,
        finest_cpd: f32,
        luminance_cd_m2: f32,
        eccentricity_deg: f32,
        field: VisualField,
    ) -> [f32; BANDS] {
        let falls = self.falls(finest_cpd, luminance_cd_m2);
        falls.map(|fall| fall.at(eccentricity_deg, field))
    }

    /// [`achromatic_fall`](super::achromatic_fall) of each band of a tile, as [`Self::sensitivities`].
    pub fn falls(&self, finest_cpd: f32, luminance_cd_m2: f32) -> [SensitivityFall; BANDS] {
        let usual = Stimulus::default();
        let luminance = within(luminance_cd_m2, Stimulus::LUMINANCE_CD_M2, usual.luminance_cd_m2);
        let (row, down) = cell(luminance.log2(), LUMINANCE, ROWS);
        let rows = &self.texels[row * COLUMNS..][..2 * COLUMNS];
        let finest_cpd = within(finest_cpd, Stimulus::FREQUENCY_CPD, usual.frequency_cpd);
        let (column, along) = cell(finest_cpd.log2(), FREQUENCY, COLUMNS);
        std::array::from_fn(|band| {
            // An octave is a whole number of columns, so that each band is as far along its cell as the first.
            let (column, along) = match column.checked_sub(band * STEPS as usize) {
                Some(column) => (column, along),
                None => (0, 0.0),
            };
            let [above, below] = [&rows[column..], &rows[COLUMNS + column..]]
                .map(|texels| texels[0] + (texels[1] - texels[0]) * along);
            let frequency_cpd = (finest_cpd / (1 << band) as f32).max(Stimulus::FREQUENCY_CPD[0]);
            ACHROMATIC_FALL.of(above + (below - above) * down, frequency_cpd)
        })
    }
}

/// The cell of `value`, and its position in the cell, 0..=1.
fn cell(value: f32, [first, last]: [f32; 2], nodes: usize) -> (usize, f32) {
    let position = (value.clamp(first, last) - first) * STEPS;
    let cell = (position as usize).min(nodes - 2);
    (cell, position - cell as f32)
}

#[cfg(test)]
mod tests;
