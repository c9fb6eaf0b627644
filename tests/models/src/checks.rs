//! The checkable numbers of the three papers, `data/checks.json`: A (audio-visual), B (frame rate), C (chroma), and
//! values of the contrast sensitivity functions.

use serde::Deserialize;
use std::collections::BTreeMap;

/// The whole file.
#[derive(Clone, Debug, Deserialize)]
pub struct Checks {
    /// Paper B: pixel rates of the update configurations.
    #[serde(rename = "B")]
    pub frame_rate: FrameRate,
    /// Paper C: the chroma curves.
    #[serde(rename = "C")]
    pub chroma: Chroma,
    /// Paper A: Table 1.
    #[serde(rename = "A")]
    pub audio_visual: AudioVisual,
    /// castleCSF, achromatic, temporal visual field.
    pub castle_ach_vis0: Vec<Sensitivity>,
    /// castleCSF, achromatic, nasal visual field.
    pub castle_ach_vis180: Vec<Sensitivity>,
    /// Tursun 2019, the set fitted at a quarter of the resolution.
    pub tursun_sfc4: Vec<TursunSensitivity>,
}

/// Paper B.
#[derive(Clone, Debug, Deserialize)]
pub struct FrameRate {
    /// Outer radii of the first four regions, degrees.
    pub radii_deg: [f64; 4],
    /// Share of the image that each region has, 0..=1.
    pub area_frac: [f64; 5],
    /// Percent of the pixels that each configuration renders.
    pub table: BTreeMap<String, PixelRate>,
    /// Allowed difference, percentage points.
    pub tol_points: f64,
}

/// One row of paper B's table, percent.
#[derive(Clone, Debug, Deserialize)]
pub struct PixelRate {
    /// As printed.
    pub paper: f64,
    /// From `radii_deg`.
    pub model: f64,
}

/// Paper C.
#[derive(Clone, Debug, Deserialize)]
pub struct Chroma {
    /// Gains: key "E" is normalised eccentricity, "cb0.7" the gain of Cb at Z = 0.7, and so on.
    pub curve: Vec<BTreeMap<String, f64>>,
    /// Mean gain over a disc, by the same keys.
    pub disc_mean: BTreeMap<String, f64>,
}

/// Paper A.
#[derive(Clone, Debug, Deserialize)]
pub struct AudioVisual {
    /// Table 1 with figures that follow from it.
    pub table1: Vec<Tuple>,
}

/// One item of paper A's Table 1.
#[derive(Clone, Debug, Deserialize)]
pub struct Tuple {
    /// Loudness, LUFS.
    pub lufs: f64,
    /// Frequency, kHz.
    pub khz: f64,
    /// Mean score of the participants.
    pub mu: f64,
    /// Eq. 1, loudness units.
    pub gld: f64,
    /// Eq. 2 of `khz`, kilo-mel.
    pub gfq: f64,
    /// Eq. 14 without visual loss.
    pub avpm0: f64,
    /// Eq. 17's alpha.
    pub alpha: f64,
}

/// A value of castleCSF.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Sensitivity {
    /// Spatial frequency, cycles per degree.
    pub rho: f64,
    /// Temporal frequency, Hz.
    pub omega: f64,
    /// Eccentricity, degrees.
    pub ecc: f64,
    /// Luminance, cd/m^2.
    #[serde(rename = "L")]
    pub luminance: f64,
    /// Area, square degrees.
    #[serde(rename = "A")]
    pub area: f64,
    /// Sensitivity.
    #[serde(rename = "S")]
    pub sensitivity: f64,
}

/// A value of Tursun's function.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct TursunSensitivity {
    /// Spatial frequency, cycles per degree.
    pub f: f64,
    /// Eccentricity, degrees.
    pub theta: f64,
    /// Adaptation luminance, cd/m^2.
    #[serde(rename = "La")]
    pub adaptation: f64,
    /// Sensitivity.
    #[serde(rename = "S")]
    pub sensitivity: f64,
}

/// Reads the file, which is part of the program.
///
/// # Panics
/// Where the file does not have this shape, which a test would have found.
pub fn checks() -> Checks {
    serde_json::from_str(include_str!("../data/checks.json")).expect("data/checks.json has this shape")
}
