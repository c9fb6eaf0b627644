//! `cargo dev gpu`: rates that the layer gives to passes, beside the same rates that the application sets itself.
//!
//! The layer writes down which map each pass of each frame had; the zoo's application then sets these maps by rate attachments of
//! its own (`parafovea-zoo --native-map`), without the layer. Every image must be the same, bit for bit: a difference is an error of the
//! layer. With it go times on the GPU: without rates, with the layer's, with the application's own, and with the layer attached and all
//! at 1x1, the cost of being ready.
//!
//! That takes a device with `VK_KHR_fragment_shading_rate`. Over the stand-in for one, which shades every pixel, images show little; the maps
//! and draws that it recorded are compared instead.

mod comparison;
mod results;
mod times;

pub use comparison::{Comparison, compare};
pub use results::{Results, StyleResults};
pub use times::{Times, time};

use crate::HarnessError;
use crate::device::Machine;
use crate::run::{Application, LayerMode, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_zoo::{STYLES, Style};
use std::path::Path;

/// Rings that stay where they are, and are never dropped: the same maps in every run. Rates by contrast are decided on a GPU, and the layer
/// does not know them.
const FIXED_RINGS: &str =
    "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n";

/// Attached, and all at 1x1.
const ATTACHED: &str =
    "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[rates]\nmode = \"fixed\"\ngate = \"off\"\n";

/// The variable with the file to which the layer writes maps.
const MAPS_VARIABLE: &str = "PARAFOVEA_PASSES_FILE";

/// The styles that can set rates themselves.
pub fn styles() -> impl Iterator<Item = &'static Style> + Clone {
    STYLES.iter().copied().filter(|style| style.can_set_rates)
}

/// Frames, and width and height of an eye buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Length {
    /// Frames of a run.
    pub frames: u64,
    /// Pixels.
    pub size: u32,
}

/// Source of the shading rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rates<'a> {
    /// The application alone.
    None,
    /// The layer.
    Layer,
    /// The layer, all of them 1x1.
    Attached,
    /// The application, with the rates of a file.
    Native(&'a Path),
}

fn run_of(
    machine: &Machine,
    style: &Style,
    length: Length,
    saved: &[u64],
    rates: Rates<'_>,
) -> Result<Run, HarnessError> {
    let (size, frames) = (length.size.to_string(), length.frames.to_string());
    let mut arguments = vec!["--style", style.name, "--size", &size, "--frames", &frames];
    let (layer, file) = match rates {
        Rates::None => (LayerMode::Absent, None),
        Rates::Layer => (LayerMode::On(FIXED_RINGS.to_owned()), None),
        Rates::Attached => (LayerMode::On(ATTACHED.to_owned()), None),
        Rates::Native(file) => (LayerMode::Absent, Some(file.to_string_lossy())),
    };
    if let Some(file) = &file {
        arguments.extend(["--native-map", file]);
    }
    let application = Application::ours("parafovea-zoo", &arguments)?;
    let scenario = Scenario::new(length.frames).sized(length.size, length.size).saving(saved);
    Ok(machine.set_up(Run::new(&application, &scenario)).layer(layer))
}
