//! Maps of shading rates that are compared over the same pictures of the application alone; each costs the share of the pixels that it shades.
//!
//! On a device without shading rates the layer masks blocks and fills them, and an application skips and fills blocks as it can: both look otherwise
//! than rates do. So maps are compared by the look of hardware rates, or all of them by that of the mask.

use crate::points::{Extent, Sweep};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::rate::ShadingRate;
use parafovea_scene::openxr_toolkit::ScreenEllipses;
use parafovea_tests::measure::Technique;
use serde::{Deserialize, Serialize};

/// Look of a map over a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Look {
    /// One sample for each block of pixels, at its centre.
    #[default]
    Rates,
    /// The mask skips blocks of pixels, and its fill interpolates them.
    Mask,
}

impl Look {
    /// In a few words, for titles.
    pub fn text(self) -> &'static str {
        match self {
            Self::Rates => "by the look of hardware rates",
            Self::Mask => "by the look of the mask",
        }
    }
}

/// One technique whose map is known.
#[derive(Clone, Debug, PartialEq)]
pub struct HardwarePoint {
    /// Its sweep.
    pub sweep: Sweep,
    /// Its name in tables.
    pub name: String,
    /// Source of its map.
    pub rates: Rates,
    /// Smallest report that contains it.
    least: Extent,
}

/// Source of a map.
#[derive(Clone, Debug, PartialEq)]
pub enum Rates {
    /// FR as in "Audio-Visual Foveated Rendering": its four rates, rounded to the finer one, so that 1x1 reaches to 24.5 degrees with
    /// L1-C1, around the true gaze, without any safety limit.
    Fixed(FixedFoveation),
    /// Ellipses of OpenXR Toolkit, fixed on the screen.
    Ellipses(ScreenEllipses),
    /// One rate everywhere.
    Uniform(ShadingRate),
    /// The layer, on lavapipe that looks like a device with all rates: the maps that it attached, with all of its safety limits, by the gaze that the tracker reports.
    Layer(Technique),
}

/// The points of a report.
pub fn hardware_points(extent: Extent) -> Vec<HardwarePoint> {
    all().into_iter().filter(|point| point.least <= extent).collect()
}

fn all() -> Vec<HardwarePoint> {
    use Extent::{All, Full, Quick};
    let point =
        |sweep, name: &str, rates, least| HardwarePoint { sweep, name: name.to_owned(), rates, least };
    let mut points = Vec::new();
    for (pair, map) in FixedFoveation::PILOT.into_iter().enumerate() {
        let name = format!("FR L{}-C{} of the paper", pair / 3 + 1, pair % 3 + 1);
        let least = if [0, 2, 8].contains(&pair) { Quick } else { All };
        points.push(point(Sweep::FixedFoveation, &name, Rates::Fixed(map), least));
    }
    // For shares at the losses of the presets, which the paper's pairs exceed.
    for (times, least) in [(1.5, Full), (2.0, Full), (3.0, All)] {
        let FixedFoveation { foveal_deg, transitional_deg, .. } = FixedFoveation::L1_C1;
        let map = FixedFoveation {
            foveal_deg: times * foveal_deg,
            transitional_deg: times * transitional_deg,
            ..FixedFoveation::L1_C1
        };
        let name = format!("FR L1-C1 of the paper with radii x {times}");
        points.push(point(Sweep::FixedFoveation, &name, Rates::Fixed(map), least));
    }
    for (name, map) in [
        ("wide", ScreenEllipses::WIDE),
        ("balanced", ScreenEllipses::BALANCED),
        ("narrow", ScreenEllipses::NARROW),
    ] {
        let with = |rates: &str| format!("OpenXR Toolkit {name} ({rates})");
        points.push(point(Sweep::OpenXrToolkit, &with("performance"), Rates::Ellipses(map), Quick));
        let quality = Rates::Ellipses(map.with_quality_rates());
        points.push(point(Sweep::OpenXrToolkit, &with("quality"), quality, Full));
    }
    for (name, rate) in [("2x1", ShadingRate::R2X1), ("2x2", ShadingRate::R2X2), ("4x4", ShadingRate::R4X4)] {
        points.push(point(Sweep::Uniform, &format!("uniform {name}"), Rates::Uniform(rate), Full));
    }
    let mut layer = |sweep, name: &str, technique, least| {
        points.push(point(sweep, name, Rates::Layer(technique), least));
    };
    for (preset, least) in [("quality", Quick), ("balanced", Quick), ("performance", Quick)] {
        let name = format!("preset {preset}");
        layer(Sweep::Rates, &name, Technique::layer(&name, &preset_config(preset)), least);
    }
    // The preset without the parts that it enables for a GPU, and with the parts that the user may add: the gain of each.
    for preset in ["quality", "balanced", "performance"] {
        let name = format!("rings {preset}");
        let config = format!("{}mode = \"fixed\"\n", preset_config(preset));
        layer(Sweep::Rings, &name, Technique::layer(&name, &config), Full);
    }
    let name = "preset balanced (sound)";
    layer(Sweep::Sound, name, Technique::layer(name, &preset_config("balanced")).with_sound(), Full);
    points
}

/// A preset as a user selects it, with the gate open: it looks before it decides, and a dropped technique would not be seen here.
pub fn preset_config(preset: &str) -> String {
    format!("preset = \"{preset}\"\n[rates]\ngate = \"on\"\n")
}
