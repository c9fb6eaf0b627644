//! A Direct3D 11 game as it reaches Vulkan and OpenXR through Proton: DXVK itself draws, and the program makes the OpenXR calls of Proton's
//! `wineopenxr` on DXVK's device, queue and textures.

mod com;
mod compiler;
mod d3d11;
mod interop;
mod look;
mod options;
mod scene;
mod session;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match session::run(&options::Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}
