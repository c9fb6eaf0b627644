//! Prints the directory of the loader, for `LD_LIBRARY_PATH`, after building it where that is needed:
//! `LD_LIBRARY_PATH=$(cargo run -q -p parafovea-openxr-loader) hello_xr -g Vulkan2`.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/../../target").into());
    match parafovea_openxr_loader::build(Path::new(&target)) {
        Ok(directory) => {
            println!("{}", directory.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}
