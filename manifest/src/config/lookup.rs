//! Lookup of the configuration file.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::load;
use crate::paths::{Environment, file_stem};

/// The configuration for all users of the machine.
const SYSTEM_FILE: &str = "/etc/parafovea/config.toml";

/// The same file within a container of Steam, whose `/etc` is another (pressure-vessel: the system's files are below `/run/host`).
const SYSTEM_FILE_OUTSIDE: &str = "/run/host/etc/parafovea/config.toml";

/// The most links that the kernel follows for a path (path_resolution(7)).
const MAX_LINKS: usize = 40;

/// The places where the configuration of one application may be, first choice first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Places {
    files: Vec<PathBuf>,
    /// The one file was asked for by name.
    named: bool,
}

impl Places {
    /// `$PARAFOVEA_CONFIG` and nothing else, if it is set; otherwise `apps/<application name>.toml`,
    /// `apps/<executable>.toml` and `config.toml` in `$XDG_CONFIG_HOME/parafovea`, then
    /// `/etc/parafovea/config.toml`, in containers also of the system outside.
    ///
    /// `application` is the name that the application gives to OpenXR, once it is known; `executable` the
    /// path or name of its program. [`file_stem`] makes both fit for a file name.
    pub fn new(environment: &Environment, application: Option<&str>, executable: &Path) -> Self {
        if let Some(file) = environment.config_file() {
            return Self { files: vec![file.to_owned()], named: true };
        }
        let mut files = Vec::new();
        if let Some(home) = environment.config_home() {
            let folder = home.join("parafovea");
            let stems = [application.and_then(file_stem), executable.file_name().and_then(file_stem)];
            for stem in stems.into_iter().flatten() {
                let file = folder.join("apps").join(format!("{stem}.toml"));
                if !files.contains(&file) {
                    files.push(file);
                }
            }
            files.push(folder.join("config.toml"));
        }
        files.push(PathBuf::from(SYSTEM_FILE));
        if environment.is_container() {
            files.push(PathBuf::from(SYSTEM_FILE_OUTSIDE));
        }
        Self { files, named: false }
    }

    /// All of them.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The file that applies now; `None` if there is none: the defaults hold. A link to a missing file is no file. A place that cannot be
    /// looked at for another reason than that it is missing counts as having the file: reading it gives the reason.
    pub fn in_force(&self) -> Option<&Path> {
        self.find(|file| !is_missing(file))
    }

    /// The first that `exists`; `None` if none does. A file that `PARAFOVEA_CONFIG` names
    /// is found in any case: if it is missing, [`load`] reports that, and no defaults silently take its place.
    fn find(&self, exists: impl Fn(&Path) -> bool) -> Option<&Path> {
        self.files.iter().map(PathBuf::as_path).find(|file| self.named || exists(file))
    }
}

fn is_missing(file: &Path) -> bool {
    fs::metadata(file)
        .is_err_and(|error| matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory))
}

/// The missing target of a link, also of one to further links; `None` for anything else.
pub fn missing_target(link: &Path) -> Option<PathBuf> {
    let next = |link: &PathBuf| Some(link.parent()?.join(fs::read_link(link).ok()?));
    let targets = std::iter::successors(Some(link.to_owned()), next).skip(1).take(MAX_LINKS);
    targets.last().filter(|_| is_missing(link))
}

/// Whether any configuration of the user, for any application, gives the gaze to applications.
pub fn offers_gaze(environment: &Environment) -> bool {
    let apps = environment.config_home().map(|home| home.join("parafovea/apps"));
    let entries = apps.and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let of_apps = entries.map(|entry| entry.path()).filter(|path| path.extension() == Some("toml".as_ref()));
    let of_all = Places::new(environment, None, Path::new("")).files;
    let mut files = of_apps.chain(of_all).filter(|path| path.is_file());
    files.any(|path| load(&path).is_ok_and(|config| config.gaze.offer))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::OsString;
    use std::os::unix::fs::symlink;

    fn environment(elevated: bool, variables: &[(&str, &str)]) -> Environment {
        Environment::new(elevated, |name| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value))
        })
    }

    fn files(elevated: bool, variables: &[(&str, &str)], application: Option<&str>) -> Vec<String> {
        Places::new(&environment(elevated, variables), application, Path::new("/opt/game/bin.x86_64"))
            .files()
            .iter()
            .map(|file| file.display().to_string())
            .collect()
    }

    #[test]
    fn the_order_is_application_executable_user_system() {
        assert_eq!(
            files(false, &[("HOME", "/home/u"), ("XDG_CONFIG_HOME", "/c")], Some("My Game")),
            [
                "/c/parafovea/apps/My Game.toml",
                "/c/parafovea/apps/bin.x86_64.toml",
                "/c/parafovea/config.toml",
                "/etc/parafovea/config.toml",
            ]
        );
        assert_eq!(
            files(false, &[("HOME", "/home/u")], None),
            [
                "/home/u/.config/parafovea/apps/bin.x86_64.toml",
                "/home/u/.config/parafovea/config.toml",
                "/etc/parafovea/config.toml",
            ]
        );
        assert_eq!(files(false, &[], Some("My Game")), ["/etc/parafovea/config.toml"]);
        assert_eq!(
            files(false, &[("container", "pressure-vessel")], None),
            ["/etc/parafovea/config.toml", "/run/host/etc/parafovea/config.toml"]
        );
    }

    #[test]
    fn an_application_cannot_leave_the_folder_by_its_name() {
        let listed = files(false, &[("HOME", "/h")], Some("../../etc/passwd"));
        assert_eq!(listed[0], "/h/.config/parafovea/apps/___.._etc_passwd.toml");
    }

    #[test]
    fn a_file_asked_for_by_name_is_found_even_where_it_is_missing() {
        let variables = [("HOME", "/h"), ("PARAFOVEA_CONFIG", "/missing.toml")];
        let places = Places::new(&environment(false, &variables), Some("app"), Path::new("exe"));
        assert_eq!(places.find(|_| false), Some(Path::new("/missing.toml")));
        assert_eq!(places.files().len(), 1);
    }

    #[test]
    fn the_first_that_exists_is_found() {
        let places = Places::new(&environment(false, &[("HOME", "/h")]), Some("app"), Path::new("exe"));
        let global = Path::new("/h/.config/parafovea/config.toml");
        assert_eq!(places.find(|file| file == global || file.starts_with("/etc")), Some(global));
        assert_eq!(places.find(|_| true), Some(Path::new("/h/.config/parafovea/apps/app.toml")));
        assert_eq!(places.find(|_| false), None);
    }

    /// As stow and Nix leave them when a package is removed.
    #[test]
    fn a_link_to_a_missing_file_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let environment = environment(false, &[("XDG_CONFIG_HOME", folder.path().to_str().unwrap())]);
        let apps = folder.path().join("parafovea/apps");
        fs::create_dir_all(&apps).unwrap();
        let [app, exe, target] = ["app.toml", "exe.toml", "target"].map(|name| apps.join(name));
        symlink("exe.toml", &app).unwrap();
        symlink(&target, &exe).unwrap();
        let places = Places::new(&environment, Some("app"), Path::new("exe"));
        assert!(places.in_force().is_none_or(|file| file.starts_with("/etc")));
        assert_eq!(
            [&app, &exe, &target].map(|file| missing_target(file)),
            [Some(target.clone()), Some(target.clone()), None]
        );
        fs::write(&target, "").unwrap();
        assert_eq!(places.in_force(), Some(app.as_path()));
        assert_eq!([&app, &target].map(|file| missing_target(file)), [None, None]);
        // Any other fault is one of the file.
        fs::remove_file(&exe).unwrap();
        symlink(&exe, &exe).unwrap();
        assert_eq!((places.in_force(), missing_target(&app)), (Some(app.as_path()), None));
    }

    #[test]
    fn an_application_s_file_is_enough_to_offer_the_gaze() {
        let folder = tempfile::tempdir().unwrap();
        let home = folder.path().to_str().unwrap();
        let environment = environment(false, &[("XDG_CONFIG_HOME", home)]);
        let put = |name: &str, text: &str| {
            let file = folder.path().join("parafovea").join(name);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        };
        assert!(!offers_gaze(&environment));
        put("config.toml", "[gaze]\noffer = false\n");
        put("apps/note.txt", "[gaze]\noffer = true\n");
        put("apps/wrong.toml", "[gaze]\noffer = 1\n");
        assert!(!offers_gaze(&environment));
        put("apps/game.toml", "[gaze]\noffer = true\n");
        assert!(offers_gaze(&environment));
    }

    #[test]
    fn with_elevated_rights_only_the_system_file_counts() {
        let variables =
            [("HOME", "/h"), ("XDG_CONFIG_HOME", "/c"), ("PARAFOVEA_CONFIG", "/p.toml"), ("container", "x")];
        assert_eq!(files(true, &variables, Some("app")), ["/etc/parafovea/config.toml"]);
    }
}
