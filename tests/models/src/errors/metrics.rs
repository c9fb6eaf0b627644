//! The errors that are measured, one module each. Every one is 0 where test and reference are equal.

pub(crate) mod chroma;
pub(crate) mod contrast;
pub(crate) mod flicker;
pub(crate) mod flip;
pub(crate) mod interocular;
pub(crate) mod squared;

use serde::Serialize;

/// A metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean squared difference of the sRGB-encoded components in 0..=1, so that -10 log10 of it is the PSNR.
    Squared,
    /// ꟻLIP's error, 0..=1, with the pixels per degree at the picture's centre: it takes one number for the whole
    /// picture, and knows nothing of gaze.
    Flip,
    /// Change of luminance contrast that stays, in just noticeable differences.
    Sustained,
    /// Change of luminance contrast that comes and goes, in just noticeable differences.
    Transient,
    /// Change of red-green contrast, in just noticeable differences.
    RedGreen,
    /// Change of yellow-violet contrast, in just noticeable differences.
    YellowViolet,
    /// RMS of the change's luminance over that of the surroundings at 8 to 30 Hz, pixel by pixel.
    Flicker,
    /// The same of the mean luminance of 16 x 16 pixels.
    AreaFlicker,
    /// Difference between both eyes in the age of the image, frames.
    InterocularAge,
    /// Difference between both eyes in the horizontal displacement of the image, arc minutes.
    InterocularDisparity,
}

impl Metric {
    /// All, in the order of the report.
    pub const ALL: [Self; 10] = [
        Self::Squared,
        Self::Flip,
        Self::Sustained,
        Self::Transient,
        Self::RedGreen,
        Self::YellowViolet,
        Self::Flicker,
        Self::AreaFlicker,
        Self::InterocularAge,
        Self::InterocularDisparity,
    ];

    /// As in the report's rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Squared => "squared",
            Self::Flip => "flip",
            Self::Sustained => "sustained",
            Self::Transient => "transient",
            Self::RedGreen => "red_green",
            Self::YellowViolet => "yellow_violet",
            Self::Flicker => "flicker",
            Self::AreaFlicker => "area_flicker",
            Self::InterocularAge => "interocular_age",
            Self::InterocularDisparity => "interocular_disparity",
        }
    }

    /// Unit of its figures.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Squared | Self::Flip => "1",
            Self::Sustained | Self::Transient | Self::RedGreen | Self::YellowViolet => "JND",
            Self::Flicker | Self::AreaFlicker => "contrast",
            Self::InterocularAge => "frames",
            Self::InterocularDisparity => "arcmin",
        }
    }

    /// Whether figures are roots of a mean power, so that a ring's mean is taken of the power.
    pub(crate) fn is_root_mean_square(self) -> bool {
        matches!(self, Self::Flicker | Self::AreaFlicker)
    }
}
