//! The techniques that are compared: sweeps, each from careful to careless, and the application alone, which is in all of them.

use crate::hardware::preset_config;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_tests::measure::Technique;
use serde::{Deserialize, Serialize};

/// Points of one kind, between which a user would choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sweep {
    /// The application alone, which is the end of every sweep: it costs 1 and loses nothing.
    Off,
    /// Smaller images, the option of every user.
    RenderScale,
    /// FR, by the application itself: the pairs of radii of "Audio-Visual Foveated Rendering"'s pilot study, with a periphery of 1/16.
    FixedFoveation,
    /// FR with the layer's fill: the same radii, with the layer's margins for tracker and latency.
    FilledFoveation,
    /// The ellipses of OpenXR Toolkit's presets, which stay where they are, by the application itself.
    OpenXrToolkit,
    /// One rate everywhere.
    Uniform,
    /// The layer's presets, as a user selects them.
    Rates,
    /// The rings of these presets, on a device on which they would measure contrast.
    Rings,
    /// The layer's rates by the contrast of the pictures, in silence.
    Contrast,
    /// The layer's rates by the contrast of the pictures and the sound of the scene, which may hide more.
    Sound,
    /// The layer's re-use of the periphery.
    Reuse,
    /// The layer's rates and re-use: all that saves time.
    RatesAndReuse,
    /// The layer's rates, re-use and chroma attenuation together, by eccentricity or by contrast and sound.
    Everything,
    /// The layer's chroma attenuation, whose gain is bits, not time.
    Chroma,
}

impl Sweep {
    /// All, in the order of tables.
    pub const ALL: [Self; 14] = [
        Self::Off,
        Self::RenderScale,
        Self::FixedFoveation,
        Self::FilledFoveation,
        Self::OpenXrToolkit,
        Self::Uniform,
        Self::Rates,
        Self::Rings,
        Self::Contrast,
        Self::Sound,
        Self::Reuse,
        Self::RatesAndReuse,
        Self::Everything,
        Self::Chroma,
    ];

    /// As people call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::RenderScale => "render scale",
            Self::FixedFoveation => "fixed foveation (FR)",
            Self::FilledFoveation => "fixed foveation, our fill",
            Self::OpenXrToolkit => "OpenXR Toolkit",
            Self::Uniform => "uniform rates",
            Self::Rates => "presets",
            Self::Rings => "rings of the presets",
            Self::Contrast => "rates by contrast, in silence",
            Self::Sound => "rates by contrast and sound",
            Self::Reuse => "re-use",
            Self::RatesAndReuse => "rates and re-use",
            Self::Everything => "everything",
            Self::Chroma => "chroma",
        }
    }
}

/// One technique of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Its sweep.
    pub sweep: Sweep,
    /// The technique.
    pub technique: Technique,
    /// Whether its time is measured; chroma attenuation cannot save any.
    pub is_timed: bool,
    /// Smallest report that contains it.
    least: Extent,
}

impl Point {
    /// Whether a report of this extent contains it.
    pub fn is_in(&self, extent: Extent) -> bool {
        self.least <= extent
    }
}

/// Extent of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Extent {
    /// Points for five minutes.
    Quick,
    /// Points for an hour and a half.
    Full,
    /// All points of all sweeps.
    All,
}

/// The points of a report, the application alone first.
pub fn points(extent: Extent) -> Vec<Point> {
    all().into_iter().filter(|point| point.is_in(extent)).collect()
}

fn all() -> Vec<Point> {
    use Extent::{All, Full, Quick};
    let timed = |sweep, technique, least| Point { sweep, technique, is_timed: true, least };
    let mut points = vec![timed(Sweep::Off, Technique::off(), Quick)];
    for (scale, least) in [(0.9, Full), (0.8, All), (0.7, Quick), (0.6, All), (0.5, Quick)] {
        points.push(timed(Sweep::RenderScale, Technique::render_scale(scale), least));
    }
    for (pair, map) in FixedFoveation::PILOT.into_iter().enumerate() {
        let name = format!("FR L{}-C{}", pair / 3 + 1, pair % 3 + 1);
        // From the one that paper A compares with to its most careless one.
        let least = match pair {
            0 | 8 => Quick,
            _ => All,
        };
        points.push(timed(Sweep::FixedFoveation, Technique::fixed_foveation(&name, map), least));
    }
    for (pair, least) in [(0, Full), (2, All), (8, Full)] {
        let (name, map) = (format!("L{}-C{}", pair / 3 + 1, pair % 3 + 1), FixedFoveation::PILOT[pair]);
        let stepped = Technique::stepped_foveation(&format!("FR {name} of the paper"), map);
        points.push(timed(Sweep::FixedFoveation, stepped, least));
        let config = format!(
            "preset = \"balanced\"\n[rates]\nmode = \"fixed\"\nfoveal_deg = {}\ntransitional_deg = {}\ngate = \"on\"\n[reuse]\nmode = \"off\"\n",
            map.foveal_deg, map.transitional_deg
        );
        let filled = Technique::layer(&format!("FR {name} (our fill)"), &config);
        points.push(timed(Sweep::FilledFoveation, filled, least));
    }
    for (preset, least) in [("wide", Full), ("balanced", Full), ("narrow", Full)] {
        points.push(timed(Sweep::OpenXrToolkit, Technique::openxr_toolkit(preset), least));
    }
    for (preset, least) in [("quality", Full), ("balanced", Quick), ("performance", Full), ("streaming", All)]
    {
        let technique = Technique::layer(&format!("preset {preset}"), &preset_config(preset));
        points.push(timed(Sweep::Rates, technique, least));
    }
    for preset in ["quality", "balanced", "performance"] {
        let config = |silence: &str| {
            format!(
                "preset = \"{preset}\"\n[rates]\nmode = \"audio-visual\"\nsilence = \"{silence}\"\ngate = \"on\"\n[chroma]\nmode = \"off\"\n"
            )
        };
        let in_silence = Technique::layer(&format!("contrast {preset}"), &config("contrast"));
        points.push(timed(Sweep::Contrast, in_silence, All));
        let with_sound = Technique::layer(&format!("sound {preset}"), &config("contrast")).with_sound();
        points.push(timed(Sweep::Sound, with_sound, if preset == "balanced" { Full } else { All }));
    }
    for (name, mode, periods, least) in [
        ("re-use 11112", "on", "11112", All),
        ("re-use 11223", "on", "11223", Full),
        ("re-use 11233", "on", "11233", All),
        ("re-use as in the paper", "paper", "11223", All),
    ] {
        let config = format!(
            "preset = \"none\"\n[rates]\ngate = \"on\"\n[reuse]\nmode = \"{mode}\"\nperiods = \"{periods}\"\n"
        );
        points.push(timed(Sweep::Reuse, Technique::layer(name, &config), least));
    }
    for (preset, least) in [("quality", Full), ("balanced", All), ("performance", All)] {
        let name = format!("rates and re-use {preset}");
        points.push(timed(Sweep::RatesAndReuse, layer(&name, preset, ["fixed", "on", "off"]), least));
    }
    for (preset, least) in [("quality", Full), ("balanced", Quick), ("performance", All)] {
        let name = format!("everything {preset}");
        points.push(timed(Sweep::Everything, layer(&name, preset, ["fixed", "on", "default"]), least));
    }
    for preset in ["quality", "balanced"] {
        let config = format!(
            "preset = \"{preset}\"\n[rates]\nmode = \"audio-visual\"\ngate = \"on\"\n[reuse]\nmode = \"on\"\n[chroma]\nmode = \"default\"\n"
        );
        let name = format!("everything with sound {preset}");
        points.push(timed(Sweep::Everything, Technique::layer(&name, &config).with_sound(), All));
    }
    let chroma = layer("chroma", "none", ["off", "off", "default"]);
    points.push(Point { sweep: Sweep::Chroma, technique: chroma, is_timed: false, least: Quick });
    points
}

/// The layer with the modes of rates, re-use and chroma; the gate is open, as before its decision, because techniques that it drops would
/// be missing here.
fn layer(name: &str, preset: &str, [rates, reuse, chroma]: [&str; 3]) -> Technique {
    let config = format!(
        "preset = \"{preset}\"\n[rates]\nmode = \"{rates}\"\ngate = \"on\"\n[reuse]\nmode = \"{reuse}\"\n[chroma]\nmode = \"{chroma}\"\n"
    );
    Technique::layer(name, &config)
}
