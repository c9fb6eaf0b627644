//! `parafovea run`.

use parafovea_manifest::json::{DISABLE_VARIABLE, ENABLE_VARIABLE};
use std::env;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};

/// Becomes the application, with the layer turned on; returns only where that fails, with the exit codes of
/// env(1).
pub fn run(command: &[OsString]) -> ExitCode {
    let Some((program, arguments)) = command.split_first() else {
        return ExitCode::FAILURE;
    };
    if env::var_os(DISABLE_VARIABLE).is_some() {
        eprintln!("parafovea: {DISABLE_VARIABLE} is set, so the layer stays off");
    }
    let error = Command::new(program).args(arguments).env(ENABLE_VARIABLE, "1").exec();
    eprintln!("parafovea: {}: {error}", program.to_string_lossy());
    ExitCode::from(if error.kind() == ErrorKind::NotFound { 127 } else { 126 })
}
