//! `parafovea run`.

use parafovea_manifest::json::{DISABLE_VARIABLE, ENABLE_VARIABLE, Half};
use parafovea_manifest::paths::Environment;
use std::env;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::os::unix::process::CommandExt;
use std::path::Path;
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
    if !is_installed() {
        eprintln!(
            "parafovea: the loaders cannot find the layer, so it has no effect; to install it: parafovea install"
        );
    }
    let error = Command::new(program).args(arguments).env(ENABLE_VARIABLE, "1").exec();
    let program = program.to_string_lossy();
    if error.kind() == ErrorKind::NotFound {
        eprintln!(
            "parafovea: {program}: not found in PATH; to run a program in another folder, give its full path"
        );
        return ExitCode::from(127);
    }
    eprintln!("parafovea: {program}: {error}");
    ExitCode::from(126)
}

/// Whether any folder of data files has a manifest of this layer. The doctor checks `VK_ADD_LAYER_PATH` and the like.
fn is_installed() -> bool {
    let environment = Environment::of_process(false);
    let of_system = env::var_os("XDG_DATA_DIRS").filter(|folders| !folders.is_empty());
    let of_system = of_system.unwrap_or_else(|| "/usr/local/share:/usr/share".into());
    let folders = env::split_paths(&of_system).chain(environment.data_home().map(Path::to_owned));
    folders.into_iter().any(|data| Half::BOTH.into_iter().any(|half| half.manifest_path(&data).exists()))
}
