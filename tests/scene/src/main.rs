//! The command: runs the scene until the session ends.

use std::process::ExitCode;

use clap::Parser;
use parafovea_scene::{options::Options, xr};

fn main() -> ExitCode {
    match xr::run(&Options::parse()) {
        Ok(frames) => {
            println!("parafovea-scene: {frames} frames");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("parafovea-scene: {error:#}");
            ExitCode::FAILURE
        }
    }
}
