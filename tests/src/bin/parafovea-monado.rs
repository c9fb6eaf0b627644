//! `cargo dev monado gaze`: OSC packets drive hello_xr on Monado. Its argument is the folder of the system.

use parafovea_tests::monado::Bed;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(root) = std::env::args().nth(1) else {
        eprintln!("usage: cargo dev monado gaze");
        return ExitCode::FAILURE;
    };
    match Bed::new(Path::new(&root)).and_then(|bed| bed.follow_packets()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
