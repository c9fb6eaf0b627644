//! The command line.

use crate::look::{Coarsest, Look};
use clap::Parser;
use std::path::PathBuf;

/// An OpenXR application in plain Vulkan that shows one scene in the style that is asked for.
///
/// Where the device cannot do what the style needs, it says "skipped: no device with ..." and exits with 0.
#[derive(Parser, Clone, Debug)]
#[command(name = "parafovea-zoo", version)]
pub struct Options {
    /// Name of the style
    #[arg(long, required_unless_present_any = ["list", "devices", "shading_rates", "churn"])]
    pub style: Option<String>,
    /// Width and height of an eye buffer, in pixels
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub size: u32,
    /// Frames after which it asks for the end of the session
    #[arg(long, default_value_t = 120)]
    pub frames: u64,
    /// Frame of the animation that is drawn first
    #[arg(long, default_value_t = 0)]
    pub first_frame: u64,
    /// Of the style `random`: which frames it records
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Work of the application between locating its views and drawing them, in microseconds of each frame: a loop over memory
    #[arg(long, default_value_t = 0, value_name = "MICROSECONDS")]
    pub work: u64,
    /// Attach and synchronise an action set, as applications with controllers do
    #[arg(long)]
    pub actions: bool,
    /// For so many seconds sessions that show many styles, or the one of --style, at many sizes (--seed), and make and destroy all that each
    /// needs
    #[arg(long, value_name = "SECONDS")]
    pub churn: Option<u64>,
    /// Print every render pass of every frame, one JSON object a line
    #[arg(long)]
    pub passes: bool,
    /// Set shading rates itself, by rate attachments whose maps are those that this file has for each pass of each frame: the
    /// lines that the layer writes to PARAFOVEA_PASSES_FILE. Passes without a map are at 1x1
    #[arg(long, value_name = "FILE")]
    pub native_map: Option<PathBuf>,
    /// Shade as coarsely as this file has it, which is one as for --native-map, in shaders: how it looks on a device with shading rates
    #[arg(long, value_name = "FILE", conflicts_with = "native_map")]
    pub look: Option<PathBuf>,
    /// Coarsest fragments of draws whose shaders discard, with --look
    #[arg(long, value_enum, default_value = "4x4", requires = "look")]
    pub look_discarding: Coarsest,
    /// Coarsest fragments of passes that blend a history, with --look
    #[arg(long, value_enum, default_value = "1x1", requires = "look")]
    pub look_history: Coarsest,
    /// Draw the depth of discarding draws at 1x1 first, as pre-passes do, and colour at equal depth alone, with --look
    #[arg(long, requires = "look")]
    pub look_prepass: bool,
    /// Filter by the width of a pixel, as explicit gradients have it, not by that of a fragment, with --look
    #[arg(long, requires = "look")]
    pub look_pixel_filter: bool,
    /// Print the devices, one JSON object a line
    #[arg(long)]
    pub devices: bool,
    /// Print the shading rates of devices with VK_KHR_fragment_shading_rate, one JSON object a line
    #[arg(long)]
    pub shading_rates: bool,
    /// Print the styles, one a line
    #[arg(long)]
    pub list: bool,
}

impl Options {
    /// Rules of the look of rates.
    pub(crate) fn rules(&self) -> Option<Look> {
        self.look.is_some().then_some(Look {
            discarding: self.look_discarding,
            history: self.look_history,
            prepass: self.look_prepass,
            pixel_filter: self.look_pixel_filter,
        })
    }
}
