//! The contrast sensitivity functions behind one call for a tile.

use crate::avpm::SensitivityUnit;
use crate::perception::csf::castle::FovealTable;
use crate::perception::csf::tursun::{BAND_GAIN, Fit};
use crate::perception::csf::{Stimulus, VisualField};
use crate::perception::{BANDS, BandFrequencies};

/// A contrast sensitivity function, ready for many tiles.
#[derive(Clone, Debug)]
pub enum Sensitivity {
    /// castleCSF's to still pictures, 1 square degree, the greater of both visual fields, where the bands respond.
    CastleCsf(FovealTable),
    /// Tursun's, with the frequencies and the fit that paper A used, times [`BAND_GAIN`]: contrast here is physical, and
    /// that of the pyramid that was fitted is not.
    Tursun,
}

impl Sensitivity {
    /// The function of a unit. Allocates the table of castleCSF.
    pub fn new(unit: SensitivityUnit) -> Self {
        let usual = Stimulus::default();
        match unit {
            SensitivityUnit::CastleCsf => {
                Self::CastleCsf(FovealTable::new(usual.temporal_hz, usual.area_deg2))
            }
            SensitivityUnit::Tursun => Self::Tursun,
        }
    }

    /// Its unit.
    pub fn unit(&self) -> SensitivityUnit {
        match self {
            Self::CastleCsf(_) => SensitivityUnit::CastleCsf,
            Self::Tursun => SensitivityUnit::Tursun,
        }
    }

    /// Upper bound of the sensitivity of a unit in the two finest bands, the bands that rates remove.
    pub fn greatest(unit: SensitivityUnit) -> f32 {
        match unit {
            // 151 is the greatest that the test below finds.
            SensitivityUnit::CastleCsf => 160.0,
            // Twice 10 to the power of the greatest of Fit::QUARTER's knots.
            SensitivityUnit::Tursun => 3.4e6,
        }
    }

    /// Sensitivity in each band, finest first, > 0 and finite, of a tile with so many pixels per degree, at an
    /// eccentricity in degrees, to an eye adapted to a luminance in cd/m^2. Out of domain or NaN: as in [`Stimulus::clamped`].
    pub fn bands(
        &self,
        pixels_per_degree: f32,
        eccentricity_deg: f32,
        adaptation_cd_m2: f32,
    ) -> [f32; BANDS] {
        match self {
            Self::CastleCsf(table) => {
                let finest_cpd = BandFrequencies::Response.cpd(pixels_per_degree)[0];
                table.sensitivities(finest_cpd, adaptation_cd_m2, eccentricity_deg, VisualField::Worst)
            }
            Self::Tursun => {
                let cpd = BandFrequencies::Paper.cpd(pixels_per_degree);
                std::array::from_fn(|band| {
                    let fall = Fit::QUARTER.at(cpd[band], adaptation_cd_m2);
                    BAND_GAIN[band] * fall.at(eccentricity_deg, VisualField::Worst)
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At each node of castleCSF's table, and between Tursun's knots, at the gaze.
    #[test]
    fn nothing_exceeds_the_greatest() {
        for unit in [SensitivityUnit::CastleCsf, SensitivityUnit::Tursun] {
            let sensitivity = Sensitivity::new(unit);
            let octaves = (-20..40).map(|step| (step as f32 / 4.0).exp2());
            let luminances = (-40..60).map(|step| (step as f32 / 4.0).exp2());
            let seen = octaves.flat_map(|resolution| {
                let bands = luminances.clone().map(|luminance| sensitivity.bands(resolution, 0.0, luminance));
                bands.map(|bands| bands[0].max(bands[1])).collect::<Vec<_>>()
            });
            let most = seen.fold(0.0, f32::max);
            let greatest = Sensitivity::greatest(unit);
            assert!((0.8 * greatest..0.999 * greatest).contains(&most), "{unit:?}: {most} and {greatest}");
        }
    }
}
