//! `parafovea run`.

use parafovea_manifest::json::{DISABLE_VARIABLE, ENABLE_VARIABLE, Half};
use parafovea_manifest::loader_filters::{ENABLE_LAYERS, enabling};
use parafovea_manifest::paths::Environment;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Becomes the application, with the layer turned on; returns only where that fails, with the exit codes of
/// env(1).
pub fn run(command: &[OsString]) -> ExitCode {
    let Some((program, arguments)) = command.split_first() else {
        return ExitCode::FAILURE;
    };
    if env::var_os(DISABLE_VARIABLE).is_some() {
        complain!("parafovea: {DISABLE_VARIABLE} is set, so the layer stays off");
    }
    if !is_installed() {
        complain!(
            "parafovea: the layer is not installed in the usual folders, so it may have no effect; to install it: parafovea install; to check: parafovea doctor"
        );
    }
    let mut application = Command::new(program);
    application.args(arguments).env(ENABLE_VARIABLE, "1");
    // Applications that turn the layers of other programs off at their start, as Blender does, keep this one.
    application.env(ENABLE_LAYERS, enabling(env::var_os(ENABLE_LAYERS)));
    let error = application.exec();
    let name = program.to_string_lossy();
    if error.kind() != ErrorKind::NotFound {
        complain!("parafovea: {name}: {error}");
        return ExitCode::from(126);
    }
    // The system gives the same error where the program exists, but not the one that is to run it.
    match find(program, env::var_os("PATH").as_deref()) {
        Some(file) => {
            complain!("parafovea: {name}: {}", missing_interpreter(&beginning(&file)));
            ExitCode::from(126)
        }
        None if name.contains('/') => {
            complain!("parafovea: {name}: does not exist");
            ExitCode::from(127)
        }
        None => {
            complain!(
                "parafovea: {name}: not found in PATH; to run a program in another folder, give its full path"
            );
            ExitCode::from(127)
        }
    }
}

/// The file of a program: its path, or the first of its name in the folders of `PATH`.
fn find(program: &OsStr, path: Option<&OsStr>) -> Option<PathBuf> {
    let program = Path::new(program);
    if program.components().count() > 1 || program.is_absolute() {
        return program.exists().then(|| program.to_owned());
    }
    env::split_paths(path?).map(|folder| folder.join(program)).find(|file| file.is_file())
}

/// The first bytes of a file; empty if it cannot be read.
fn beginning(file: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Without them, the message is less exact.
    let _ = File::open(file).and_then(|file| file.take(256).read_to_end(&mut bytes));
    bytes
}

/// A message about the missing interpreter of a program that begins with these bytes.
fn missing_interpreter(beginning: &[u8]) -> String {
    let Some(line) = beginning.strip_prefix(b"#!") else {
        return "its interpreter (the dynamic loader) is missing; perhaps it was built for another system or architecture".to_owned();
    };
    let line = line.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let line = String::from_utf8_lossy(line);
    let interpreter = line.trim_start_matches([' ', '\t']).split([' ', '\t']).next().unwrap_or_default();
    match interpreter.strip_suffix('\r') {
        Some(interpreter) => format!(
            "its first line ends in a carriage return, as on Windows, so the interpreter {interpreter} is not found; convert the file to Unix line endings"
        ),
        None => format!("its interpreter {interpreter} is missing"),
    }
}

/// Whether any folder of data files has a manifest of this layer. The doctor checks `VK_ADD_LAYER_PATH` and the like.
fn is_installed() -> bool {
    let environment = Environment::of_process(false);
    let of_system = env::var_os("XDG_DATA_DIRS").filter(|folders| !folders.is_empty());
    let of_system = of_system.unwrap_or_else(|| "/usr/local/share:/usr/share".into());
    let folders = env::split_paths(&of_system).chain(environment.data_home().map(Path::to_owned));
    folders.into_iter().any(|data| Half::BOTH.into_iter().any(|half| half.manifest_path(&data).exists()))
}
