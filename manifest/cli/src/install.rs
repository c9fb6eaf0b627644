//! `parafovea install` and `parafovea uninstall`.

use crate::doctor::surroundings;
use parafovea_manifest::config::offers_gaze;
use parafovea_manifest::doctor::{
    SYSTEM_DATA, Surroundings, installed_elsewhere, installed_in_flatpak, removal,
};
use parafovea_manifest::install::{InstallError, LIBRARY_NAME, Step, plan_install, plan_uninstall};
use parafovea_manifest::paths::Environment;
use std::ffi::OsStr;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs};

/// Reason why nothing, or not everything, was done.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Install(#[from] InstallError),
    #[error(
        "no folder to install into: neither XDG_DATA_HOME nor HOME is an absolute path; set HOME to your home folder"
    )]
    NoHome,
    #[error(
        "sudo makes this the installation of root alone; run it without sudo, or with --system for all users"
    )]
    Sudo,
    #[error("{LIBRARY_NAME} is in none of these places: {}; give its path with --library", list(.0))]
    NoLibrary(Vec<PathBuf>),
    #[error(
        "the layer is already installed, and games would load a second installation too: {}; to install it here, first remove the other: {removal}",
        list(.paths)
    )]
    InstalledElsewhere { paths: Vec<PathBuf>, removal: String },
}

fn list(places: &[PathBuf]) -> String {
    places.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Whom it is installed for.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Scope {
    /// Apply to the installation for all users, below /usr/local/share; needs root
    #[arg(long)]
    system: bool,
    /// Print the steps without taking them
    #[arg(long)]
    dry_run: bool,
}

/// Installs `library`, or the one that came with this program.
pub fn install(library: Option<PathBuf>, scope: Scope) -> ExitCode {
    const NEXT: &str = "\
installed; the layer stays off until you turn it on for a game.
To check the installation: parafovea doctor
To play: parafovea run -- GAME, or in Steam the launch options PARAFOVEA=1 %command%
";
    finish(["already installed", NEXT], scope, || {
        let library = match library {
            Some(library) => library,
            None => library_beside_this_program().ok_or_else(|| Failure::NoLibrary(places()))?,
        };
        let data = scope.data()?;
        if let Some((paths, removal)) = elsewhere(&data) {
            return Err(Failure::InstalledElsewhere { paths, removal });
        }
        // The settings of the other users are unknown here; without `gaze.offer`, their games have no eye gaze.
        let offers_gaze = scope.system || offers_gaze(&Environment::of_process(false));
        Ok(plan_install(&data, &library, offers_gaze)?)
    })
}

/// Removes the files of [`install`].
pub fn uninstall(scope: Scope) -> ExitCode {
    let mut kept = Vec::new();
    let code = finish(["not installed", ""], scope, || {
        let removal = plan_uninstall(&scope.data()?)?;
        kept = removal.kept;
        Ok(removal.steps)
    });
    if !kept.is_empty() {
        crate::print(&format!(
            "kept, because Parafovea did not install these files, or they were edited: {}\n",
            list(&kept)
        ));
    }
    for (paths, removal) in scope.data().iter().flat_map(|data| [elsewhere(data), in_flatpak(data)]).flatten()
    {
        crate::print(&format!("still installed: {}; to remove it: {removal}\n", list(&paths)));
    }
    code
}

/// Manifests in the home of Steam's Flatpak, unless that is `data`, and the command that removes these. Games outside have no view of them.
fn in_flatpak(data: &Path) -> Option<(Vec<PathBuf>, String)> {
    let surroundings = surroundings();
    let mut paths = installed_in_flatpak(&surroundings);
    paths.retain(|path| !path.starts_with(data));
    with_removal(&surroundings, paths)
}

fn with_removal(surroundings: &Surroundings, paths: Vec<PathBuf>) -> Option<(Vec<PathBuf>, String)> {
    let removal = removal(surroundings, paths.iter().map(PathBuf::as_path));
    (!paths.is_empty()).then_some((paths, removal))
}

/// Manifests of installations outside of `data`, if there are any, and the commands that remove these.
fn elsewhere(data: &Path) -> Option<(Vec<PathBuf>, String)> {
    let surroundings = surroundings();
    let paths = installed_elsewhere(&surroundings, data);
    with_removal(&surroundings, paths)
}

fn finish(
    [nothing_to_do, next]: [&str; 2],
    Scope { system, dry_run }: Scope,
    plan: impl FnOnce() -> Result<Vec<Step>, Failure>,
) -> ExitCode {
    let done = plan().and_then(|steps| {
        if steps.is_empty() {
            crate::print(&format!("{nothing_to_do}\n"));
        }
        for step in &steps {
            match (dry_run, system) {
                (true, _) => {}
                (false, true) => step.apply_for_all_users()?,
                (false, false) => step.apply()?,
            }
            crate::print(&format!("{}{step}\n", if dry_run { "would " } else { "" }));
        }
        if !dry_run && !steps.is_empty() {
            crate::print(next);
        }
        Ok(())
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            complain!("parafovea: {failure}");
            ExitCode::FAILURE
        }
    }
}

impl Scope {
    /// Folder for data files.
    fn data(self) -> Result<PathBuf, Failure> {
        if self.system {
            return Ok(PathBuf::from(SYSTEM_DATA));
        }
        let user = fs::metadata("/proc/self").map(|process| process.uid()).ok();
        if is_by_sudo(user, env::var_os("SUDO_UID").as_deref()) {
            return Err(Failure::Sudo);
        }
        Environment::of_process(false).data_home().map(Path::to_owned).ok_or(Failure::NoHome)
    }
}

/// The library where a build (`target/release`), an archive (`bin` and `lib`) or a package (`bin` and `lib/parafovea`) puts it.
pub fn library_beside_this_program() -> Option<PathBuf> {
    places().into_iter().find(|place| place.is_file())
}

fn places() -> Vec<PathBuf> {
    let program = env::current_exe().unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new(""));
    let above = folder.parent().unwrap_or(Path::new(""));
    [folder.to_owned(), above.join("lib"), above.join("lib/parafovea")]
        .map(|place| place.join(LIBRARY_NAME))
        .to_vec()
}

/// Whether `sudo` runs this process as root for another user (sudo, "SUDO_UID").
fn is_by_sudo(user: Option<u32>, sudo_uid: Option<&OsStr>) -> bool {
    user == Some(0) && sudo_uid.is_some_and(|caller| caller != "0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sudo_installs_for_all_users_only() {
        let of = |user, caller: Option<&str>| is_by_sudo(Some(user), caller.map(OsStr::new));
        assert!(of(0, Some("1000")));
        assert!(!of(0, None) && !of(0, Some("0")), "a root user");
        assert!(!of(1000, Some("1000")), "a variable that was left over");
        assert!(!is_by_sudo(None, Some(OsStr::new("1000"))));
    }
}
