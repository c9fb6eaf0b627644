//! `cargo dev run`: any OpenXR program with the layer as it was just built, nothing installed.

use parafovea_tests::artifacts::{Library, target_folder};
use parafovea_tests::installation::{Driver, Halves, Installation};
use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

const USAGE: &str = "usage: cargo dev run [--runtime mock|system] [--config FILE] -- COMMAND [ARGUMENT...]";

struct Request {
    mock: bool,
    config: Option<PathBuf>,
    command: Vec<OsString>,
}

fn main() -> ExitCode {
    // Returns only where the command could not be started: this process becomes the command.
    match parse(std::env::args_os().skip(1).collect()).and_then(become_command) {
        Ok(never) => match never {},
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn parse(arguments: Vec<OsString>) -> Result<Request, String> {
    let mut request = Request { mock: true, config: None, command: Vec::new() };
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        match argument.to_str() {
            Some("--runtime") => {
                let runtime = arguments.next().unwrap_or_default();
                request.mock = match runtime.to_str() {
                    Some("mock") => true,
                    Some("system") => false,
                    _ => {
                        return Err(format!(
                            "--runtime must be mock or system, not {}\n{USAGE}",
                            runtime.display()
                        ));
                    }
                };
            }
            Some("--config") => {
                let file = PathBuf::from(arguments.next().ok_or(USAGE)?);
                // Absolute, because the command may change its folder before it reads the file.
                let absolute = file.canonicalize().map_err(|error| format!("{}: {error}", file.display()))?;
                request.config = Some(absolute);
            }
            Some("--") => request.command.extend(arguments.by_ref()),
            _ => return Err(format!("unknown argument {}\n{USAGE}", argument.display())),
        }
    }
    if request.command.is_empty() { Err(USAGE.to_owned()) } else { Ok(request) }
}

fn become_command(request: Request) -> Result<std::convert::Infallible, String> {
    let library = Library::Parafovea.path().map_err(|error| error.to_string())?;
    let stage = target_folder().map_err(|error| error.to_string())?.join("stage");
    let halves = Halves { openxr: Some(library.clone()), vulkan: Some(library), ..Halves::default() };
    let installation = Installation::new(&stage, &halves).map_err(|error| error.to_string())?;
    let mut command = Command::new(&request.command[0]);
    command.args(&request.command[1..]).envs([installation.search_path()]).env("PARAFOVEA", "1");
    if request.mock {
        let environment = installation.mock_environment(Driver::Lavapipe);
        command.envs(environment.map_err(|error| error.to_string())?);
    }
    if let Some(config) = request.config {
        command.env("PARAFOVEA_CONFIG", config);
    }
    Err(format!("cannot start {}: {}", request.command[0].display(), command.exec()))
}
