//! The command line.

use clap::{Parser, ValueEnum};

use crate::openxr_toolkit::ScreenEllipses;
use crate::renderer::{Foveation, Radii};
use crate::scene::generated::Kind;
use crate::scene::{SceneName, lights};

/// Scenes in virtual reality: an OpenXR application with costly per-pixel lighting.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub struct Options {
    /// The scene.
    #[arg(long, value_enum, default_value_t)]
    pub scene: SceneName,
    /// In place of it, a scene that is made of --seed.
    #[arg(long, value_enum, requires = "seed", conflicts_with = "scene")]
    pub generated: Option<Kind>,
    /// The seed of a generated scene.
    #[arg(long, value_name = "N", requires = "generated")]
    pub seed: Option<u32>,
    /// Quit after this many rendered frames [default: when the runtime ends the session].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub frames: Option<u64>,
    /// Number of the first frame, from which the animation starts.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=1 << 32))]
    pub first_frame: u64,
    /// No animation: every frame is the first one.
    #[arg(long)]
    pub still: bool,
    /// Speed of the animation, relative to its normal speed.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = parse_pace)]
    pub pace: f64,
    /// Turn off all lights in the frame of this number, as in a cut to another scene.
    #[arg(long, value_name = "N")]
    pub lights_out: Option<u64>,
    /// Number of point lights; each costs about the same [default: as many as the scene has].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(lights::MAX)))]
    pub lights: Option<u32>,
    /// Arrangement of the eye buffers in swapchains.
    #[arg(long, value_enum, default_value_t = Arrangement::Separate)]
    pub swapchain: Arrangement,
    /// Create new swapchains before the frame of this number, by --change-to and --change-size.
    #[arg(long, value_name = "N")]
    pub change_at: Option<u64>,
    /// Arrangement of the eye buffers from then on [default: as before].
    #[arg(long, value_enum, requires = "change_at")]
    pub change_to: Option<Arrangement>,
    /// Size of an eye buffer from then on [default: as before].
    #[arg(long, value_name = "WxH", value_parser = parse_size, requires = "change_at")]
    pub change_size: Option<[u32; 2]>,
    /// Number of sessions, one after the other.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub sessions: u32,
    /// Format of the eye buffers.
    #[arg(long, value_enum, default_value_t = ColourFormat::Srgb)]
    pub format: ColourFormat,
    /// Size of an eye buffer in texels [default: the runtime's recommendation].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Submit the depth buffers too (XR_KHR_composition_layer_depth).
    #[arg(long)]
    pub depth_layer: bool,
    /// Shade all texels up to EF degrees from the gaze (or from the view's axis if the runtime has no gaze), fewer from there to
    /// ET degrees, and a share of 1/16 or 1/4 beyond; fill the others from their neighbours. Or shade by the position on the screen,
    /// as with OpenXR Toolkit's presets "Wide", "Balanced" and "Narrow".
    #[arg(long, value_name = "EF,ET,SHARE | toolkit-wide | toolkit-balanced | toolkit-narrow", value_parser = parse_foveation, conflicts_with = "depth_layer")]
    pub foveation: Option<Foveation>,
    /// Round the share of texels between EF and ET up to 1, 1/4, 1/8 or 1/16.
    #[arg(long, requires = "foveation")]
    pub stepped: bool,
    /// Show the notice board in a quad layer as well.
    #[arg(long)]
    pub quad: bool,
    /// Attach no action sets.
    #[arg(long)]
    pub no_actions: bool,
}

/// Arrangement of the eye buffers in swapchains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Arrangement {
    /// A swapchain for each eye.
    Separate,
    /// One swapchain with two array layers.
    Array,
    /// One swapchain of twice the width, drawn in one pass.
    DoubleWide,
}

/// Format of the eye buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ColourFormat {
    /// Eight bits, encoded by the format.
    Srgb,
    /// Eight bits, encoded by the shader.
    Unorm,
    /// Sixteen-bit floats, linear.
    Hdr,
}

impl Options {
    /// Foveation that leaves out texels. `None` without `--foveation`.
    pub fn foveation(&self) -> Option<Foveation> {
        self.foveation.map(|foveation| match foveation {
            Foveation::Radii(radii) => Foveation::Radii(Radii { stepped: self.stepped, ..radii }),
            Foveation::Ellipses(_) => foveation,
        })
    }

    /// Number of lights.
    pub fn light_count(&self) -> u32 {
        self.lights.unwrap_or(self.scene().definition().default_lights)
    }

    /// The scene, named or generated.
    pub fn scene(&self) -> SceneName {
        match (self.generated, self.seed) {
            (Some(kind), Some(seed)) => SceneName::Generated(kind, seed),
            _ => self.scene,
        }
    }
}

fn parse_pace(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(pace @ 0.0..=10.0) => Ok(pace),
        _ => Err(format!("{text:?} is not a number from 0 to 10")),
    }
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once('x').ok_or("expected WxH, as in 1024x1024")?;
    let side = |text: &str| match text.parse::<u32>() {
        Ok(side @ 1..=16384) => Ok(side),
        _ => Err(format!("{text:?} is not a number from 1 to 16384")),
    };
    Ok([side(width)?, side(height)?])
}

/// Reads `--foveation`.
///
/// # Errors
/// A text with the expected format.
pub fn parse_foveation(text: &str) -> Result<Foveation, String> {
    let ellipses = match text {
        "toolkit-wide" => Some(ScreenEllipses::WIDE),
        "toolkit-balanced" => Some(ScreenEllipses::BALANCED),
        "toolkit-narrow" => Some(ScreenEllipses::NARROW),
        _ => None,
    };
    if let Some(ellipses) = ellipses {
        return Ok(Foveation::Ellipses(ellipses));
    }
    let expected =
        || "expected EF,ET,SHARE, as in 14.34,27.08,1/16, or toolkit-wide, -balanced or -narrow".to_owned();
    let [foveal, transitional, share] =
        text.split(',').collect::<Vec<_>>().try_into().map_err(|_| expected())?;
    let angle = |text: &str| match text.parse::<f32>() {
        Ok(angle @ 0.0..=180.0) => Ok(angle),
        _ => Err(format!("{text:?} is not an angle from 0 to 180 degrees")),
    };
    let (foveal_deg, transitional_deg) = (angle(foveal)?, angle(transitional)?);
    if foveal_deg > transitional_deg {
        return Err(format!("ET is {transitional_deg}, which is less than EF, {foveal_deg}"));
    }
    let peripheral = match share {
        "1/16" => 1.0 / 16.0,
        "1/4" => 1.0 / 4.0,
        _ => return Err(format!("{share:?} is neither 1/16 nor 1/4")),
    };
    Ok(Foveation::Radii(Radii { foveal_deg, transitional_deg, peripheral, stepped: false }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        for wrong in ["640", "x", "0x480", "640x-1", "640x99999"] {
            assert!(parse_size(wrong).is_err(), "{wrong} was taken");
        }
    }

    #[test]
    fn foveations() {
        let radii = |foveal_deg, transitional_deg, peripheral| {
            Ok(Foveation::Radii(Radii { foveal_deg, transitional_deg, peripheral, stepped: false }))
        };
        assert_eq!(parse_foveation("14.34,27.08,1/16"), radii(14.34, 27.08, 0.0625));
        assert_eq!(parse_foveation("0,0,1/4"), radii(0.0, 0.0, 0.25));
        for (text, ellipses) in [
            ("toolkit-wide", ScreenEllipses::WIDE),
            ("toolkit-balanced", ScreenEllipses::BALANCED),
            ("toolkit-narrow", ScreenEllipses::NARROW),
        ] {
            assert_eq!(parse_foveation(text), Ok(Foveation::Ellipses(ellipses)));
        }
        for wrong in ["", "14.34", "14,27", "14,27,1/8", "14,x,1/4", "27,14,1/4", "-1,3,1/4", "NaN,3,1/4"] {
            assert!(parse_foveation(wrong).is_err(), "{wrong} was taken");
        }
    }
}
