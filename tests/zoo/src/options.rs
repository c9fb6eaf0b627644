//! The command line.

use crate::look::{Coarsest, Look};
use clap::Parser;
use std::path::PathBuf;

/// An OpenXR application in plain Vulkan that shows one scene in a selectable rendering style.
///
/// If the device lacks a feature of the style, it prints "skipped: no device with ..." and exits with 0.
#[derive(Parser, Clone, Debug)]
#[command(name = "parafovea-zoo", version)]
pub struct Options {
    /// Name of the style
    #[arg(long, required_unless_present_any = ["list", "devices", "shading_rates", "churn"])]
    pub style: Option<String>,
    /// Width and height of an eye buffer, in pixels
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub size: u32,
    /// Number of frames before it requests the end of the session
    #[arg(long, default_value_t = 120)]
    pub frames: u64,
    /// Frames to draw for a window after the session has ended: with a checksum of the last one. In the style offscreen-tonemap
    #[arg(long, default_value_t = 0)]
    pub window_frames: u64,
    /// First frame of the animation
    #[arg(long, default_value_t = 0)]
    pub first_frame: u64,
    /// Seed of the style `random` and of sessions
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Work of the application between locating its views and drawing them, in microseconds of each frame: a loop over memory
    #[arg(long, default_value_t = 0, value_name = "MICROSECONDS")]
    pub work: u64,
    /// Attach and synchronise an action set, as applications with controllers do
    #[arg(long)]
    pub actions: bool,
    /// Run sessions for this number of seconds, in random styles, or in that of --style, at random sizes (--seed); each creates and destroys
    /// all of its objects
    #[arg(long, value_name = "SECONDS")]
    pub churn: Option<u64>,
    /// Print every render pass of every frame, one JSON object per line
    #[arg(long)]
    pub passes: bool,
    /// Set shading rates by rate attachments with the maps of this file, which the layer has written to PARAFOVEA_PASSES_FILE. Passes
    /// without a map are at 1x1
    #[arg(long, value_name = "FILE")]
    pub native_map: Option<PathBuf>,
    /// Emulate the look of shading rates in shaders, with the maps of this file, as for --native-map
    #[arg(long, value_name = "FILE", conflicts_with = "native_map")]
    pub look: Option<PathBuf>,
    /// Coarsest rate of draws with shaders that discard, with --look
    #[arg(long, value_enum, default_value = "4x4", requires = "look")]
    pub look_discarding: Coarsest,
    /// Coarsest rate of passes that blend a history, with --look
    #[arg(long, value_enum, default_value = "1x1", requires = "look")]
    pub look_history: Coarsest,
    /// Draw the depth of discarding draws first, at 1x1, as pre-passes do, and their colour with an EQUAL depth test, with --look
    #[arg(long, requires = "look")]
    pub look_prepass: bool,
    /// Filter textures by the width of a pixel, as with explicit gradients, not by that of a fragment, with --look
    #[arg(long, requires = "look")]
    pub look_pixel_filter: bool,
    /// Print the devices, one JSON object per line
    #[arg(long)]
    pub devices: bool,
    /// Print the shading rates of devices with VK_KHR_fragment_shading_rate, one JSON object per line
    #[arg(long)]
    pub shading_rates: bool,
    /// Print the styles, one per line
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
