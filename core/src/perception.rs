//! Contrast of images, and its visibility.
//!
//! [`luminance`] makes cd/m^2 of colours, [`pyramid`] takes them apart into octaves of spatial frequency, and
//! [`crate::kernels::analyze`] keeps the contrast of each octave for each tile of a picture. [`extrapolate`] restores contrast that a
//! coarsely shaded tile no longer shows. [`csf`] gives the visibility of a contrast.

pub mod csf;
pub mod extrapolate;
pub mod luminance;
pub mod pyramid;

use crate::image::Plane;

/// Octave bands of spatial frequency that contrast is measured in, finest first.
pub const BANDS: usize = 4;

/// Contrast and luminance of a tile; in a buffer of the GPU five numbers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TileContrast {
    /// Contrast of each octave, finest first: change of luminance over the luminance around it, >= 0 and finite; 1 is
    /// a change as large as the mean. Where it is dark beside a light it exceeds 1.
    pub bands: [f32; BANDS],
    /// Mean luminance of the tile, which the eye is taken to be adapted to, cd/m^2, 0..=10,000.
    pub adaptation_cd_m2: f32,
}

/// Contrast of each tile of a picture, row by row from the upper left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContrastMap {
    /// One for each tile; those on the right and lower edge may be partly outside of the picture.
    pub tiles: Plane<TileContrast>,
}

/// Frequency at which the sensitivity to a band is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BandFrequencies {
    /// Nyquist * 2^-(i + 1): where the bands of this pyramid respond. Band 1 peaks at 0.46 of Nyquist * 2^-1, later
    /// ones at 0.44; weighted by the spectrum of natural pictures band 0, a high-pass, is centred at 0.53.
    #[default]
    Response,
    /// Nyquist * 2^-i, the upper end of each band, as in paper A and the fit of [`csf::tursun`].
    Paper,
}

impl BandFrequencies {
    /// Frequency of each band, cycles per degree, finest first, where one degree is `pixels_per_degree` > 0 pixels
    /// (Nyquist is half of that). Without a usable number 4 for all, where most is seen.
    pub fn cpd(self, pixels_per_degree: f32) -> [f32; BANDS] {
        if !pixels_per_degree.is_finite() || pixels_per_degree <= 0.0 {
            return [4.0; BANDS];
        }
        let finest = match self {
            Self::Response => pixels_per_degree / 4.0,
            Self::Paper => pixels_per_degree / 2.0,
        };
        [finest, finest / 2.0, finest / 4.0, finest / 8.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_octaves_below_nyquist() {
        assert_eq!(BandFrequencies::Paper.cpd(20.0), [10.0, 5.0, 2.5, 1.25]);
        assert_eq!(BandFrequencies::Response.cpd(20.0), [5.0, 2.5, 1.25, 0.625]);
        for unusable in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(BandFrequencies::Paper.cpd(unusable), [4.0; BANDS]);
        }
    }
}
