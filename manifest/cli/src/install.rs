//! `parafovea install` and `parafovea uninstall`.

use parafovea_manifest::install::{InstallError, LIBRARY_NAME, Step, plan_install, plan_uninstall};
use parafovea_manifest::paths::Environment;
use std::env;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Why nothing, or not everything, was done.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Install(#[from] InstallError),
    #[error("neither XDG_DATA_HOME nor HOME names an absolute path, so there is no place to install to")]
    NoHome,
    #[error("{LIBRARY_NAME} is not at {}; name it with --library", list(.0))]
    NoLibrary(Vec<PathBuf>),
}

fn list(places: &[PathBuf]) -> String {
    places.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(" or ")
}

/// Installs `library`, or the one that came with this program.
pub fn install(library: Option<PathBuf>, dry_run: bool) -> ExitCode {
    finish("already installed", dry_run, || {
        let library = library.map_or_else(beside_this_program, Ok)?;
        Ok(plan_install(&data_home()?, &library)?)
    })
}

/// Removes what [`install`] installed.
pub fn uninstall(dry_run: bool) -> ExitCode {
    finish("not installed", dry_run, || Ok(plan_uninstall(&data_home()?)?))
}

fn finish(nothing_to_do: &str, dry_run: bool, plan: impl FnOnce() -> Result<Vec<Step>, Failure>) -> ExitCode {
    let done = plan().and_then(|steps| {
        if steps.is_empty() {
            crate::print(&format!("{nothing_to_do}\n"));
        }
        for step in &steps {
            if !dry_run {
                step.apply()?;
            }
            crate::print(&format!("{}{step}\n", if dry_run { "would " } else { "" }));
        }
        Ok(())
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("parafovea: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn data_home() -> Result<PathBuf, Failure> {
    Environment::of_process(false).data_home().map(Path::to_owned).ok_or(Failure::NoHome)
}

/// The library where a build (`target/release`) or a package (`bin` and `lib`) puts it.
fn beside_this_program() -> Result<PathBuf, Failure> {
    let program = env::current_exe().unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new(""));
    let places = vec![folder.join(LIBRARY_NAME), folder.join("../lib").join(LIBRARY_NAME)];
    places.iter().find(|place| place.is_file()).cloned().ok_or(Failure::NoLibrary(places))
}
