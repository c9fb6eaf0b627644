//! The command line.

use crate::look::Look;
use clap::Parser;

/// An OpenXR application in Direct3D 11, on DXVK's Linux build: the game and Proton's part of its frames in one program.
#[derive(Parser, Clone, Debug)]
#[command(name = "parafovea-d3d11", version)]
pub struct Options {
    /// Way of drawing
    #[arg(long, value_enum)]
    pub look: Look,
    /// Width and height of an eye buffer, in pixels
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub size: u32,
    /// Number of frames before it requests the end of the session
    #[arg(long, default_value_t = 120)]
    pub frames: u64,
    /// Have commands submitted before xrEndFrame only, as Proton did until version 7
    #[arg(long)]
    pub flushes_late: bool,
}
