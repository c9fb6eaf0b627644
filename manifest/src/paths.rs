//! Locations of files: the XDG base directories, from an environment that the caller passes.
//!
//! Source: XDG Base Directory Specification 0.8.

use crate::quirks::QUIRKS_VARIABLE;
use std::borrow::Cow;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// The places of files from a process's environment, taken once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Environment {
    config_file: Option<PathBuf>,
    config_home: Option<PathBuf>,
    data_home: Option<PathBuf>,
    state_home: Option<PathBuf>,
    cache_home: Option<PathBuf>,
    runtime_dir: Option<PathBuf>,
    home: Option<PathBuf>,
    is_container: bool,
    quirks: Option<OsString>,
}

/// The homes of Flatpaks, below `$HOME` (Flatpak, "Sandbox Permissions").
pub const FLATPAK_HOMES: &str = ".var/app";

/// The home of Steam's games where Steam is a Flatpak, below `$HOME`.
pub const FLATPAK_STEAM: &str = ".var/app/com.valvesoftware.Steam";

/// Home of Steam as a snap, below the user's.
pub const SNAP_STEAM: &str = "snap/steam/common";

/// The variable that containers set to their name (systemd, "Container Interface").
const CONTAINER_VARIABLE: &str = "container";

/// Containers of games, which have a runtime folder of their own, and share the home: Flatpak, and pressure-vessel of Steam.
const CONTAINERS: [&str; 2] = ["flatpak", "pressure-vessel"];

impl Environment {
    /// Takes the variables from `variable`, which looks a variable up (`|name| std::env::var_os(name)`).
    ///
    /// A process with `elevated` rights must not follow paths that the user chose: nothing is taken then,
    /// and only `/etc` is left. As the XDG specification demands, a base directory that is not absolute is
    /// ignored, and so is an empty variable.
    pub fn new(elevated: bool, variable: impl Fn(&str) -> Option<OsString>) -> Self {
        if elevated {
            return Self::default();
        }
        let set = |name| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let absolute = |name| set(name).filter(|path| path.is_absolute());
        let home = absolute("HOME");
        let base = |name, below_home| absolute(name).or_else(|| Some(home.as_ref()?.join(below_home)));
        Self {
            config_file: set("PARAFOVEA_CONFIG"),
            config_home: base("XDG_CONFIG_HOME", ".config"),
            data_home: base("XDG_DATA_HOME", ".local/share"),
            state_home: base("XDG_STATE_HOME", ".local/state"),
            cache_home: base("XDG_CACHE_HOME", ".cache"),
            runtime_dir: absolute("XDG_RUNTIME_DIR"),
            is_container: variable(CONTAINER_VARIABLE)
                .is_some_and(|name| CONTAINERS.iter().any(|known| name == *known)),
            home,
            quirks: variable(QUIRKS_VARIABLE),
        }
    }

    /// The environment of this process.
    pub fn of_process(elevated: bool) -> Self {
        Self::new(elevated, |name| std::env::var_os(name))
    }

    /// `$HOME`.
    pub fn home(&self) -> Option<&Path> {
        self.home.as_deref()
    }

    /// The file that `PARAFOVEA_CONFIG` names.
    pub fn config_file(&self) -> Option<&Path> {
        self.config_file.as_deref()
    }

    /// `$XDG_CONFIG_HOME`, or `~/.config`; `None` without a home.
    pub fn config_home(&self) -> Option<&Path> {
        self.config_home.as_deref()
    }

    /// `$XDG_DATA_HOME`, or `~/.local/share`.
    pub fn data_home(&self) -> Option<&Path> {
        self.data_home.as_deref()
    }

    /// `$XDG_STATE_HOME`, or `~/.local/state`.
    pub fn state_home(&self) -> Option<&Path> {
        self.state_home.as_deref()
    }

    /// `$XDG_CACHE_HOME`, or `~/.cache`.
    pub fn cache_home(&self) -> Option<&Path> {
        self.cache_home.as_deref()
    }

    /// `$XDG_RUNTIME_DIR`: for files that exist as long as the user is logged in.
    pub fn runtime_dir(&self) -> Option<&Path> {
        self.runtime_dir.as_deref()
    }

    /// Whether this process runs in a container of games: Flatpak, or Steam's pressure-vessel.
    pub fn is_container(&self) -> bool {
        self.is_container
    }

    /// The folder for the status of this process: `$XDG_RUNTIME_DIR/parafovea`. Containers of games have a runtime folder of their own, but
    /// share the home, so in them it is `$XDG_STATE_HOME/parafovea/running`.
    pub fn status_folder(&self) -> Option<PathBuf> {
        if self.is_container {
            self.shared_status_folder()
        } else {
            Some(self.runtime_dir()?.join("parafovea"))
        }
    }

    /// The folders with the status of applications, this process's own first: outside and inside containers, and in Steam's Flatpak.
    pub fn status_folders(&self) -> Vec<PathBuf> {
        let mut folders = Vec::from_iter(self.status_folder());
        for folder in self.state_homes().iter().map(|state| shared_status_folder(state)) {
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
        folders
    }

    /// The state folders of applications: this process's own, and that of Steam's Flatpak.
    pub fn state_homes(&self) -> Vec<PathBuf> {
        let flatpak = self.home.as_ref().map(|home| home.join(FLATPAK_STEAM).join(".local/state"));
        let mut homes = Vec::from_iter(self.state_home().map(Path::to_owned));
        homes.extend(flatpak.filter(|flatpak| !homes.contains(flatpak)));
        homes
    }

    fn shared_status_folder(&self) -> Option<PathBuf> {
        self.state_home().map(shared_status_folder)
    }

    /// The value of [`QUIRKS_VARIABLE`]; empty where it is not set.
    pub fn quirks(&self) -> Cow<'_, str> {
        self.quirks.as_deref().unwrap_or_default().to_string_lossy()
    }

    /// Path of the log of `executable` (its path or its name): `$XDG_STATE_HOME/parafovea/<name>.log`.
    pub fn log_file(&self, executable: &Path) -> Option<PathBuf> {
        log_file(self.state_home()?, executable)
    }

    /// Path of the log of an application whose status is in `status_folder`, one of [`Self::status_folders`].
    pub fn log_file_with_status(&self, status_folder: &Path, executable: &Path) -> Option<PathBuf> {
        let homes = self.state_homes();
        let has_status = |state: &&PathBuf| shared_status_folder(state) == status_folder;
        log_file(homes.iter().find(has_status).or(homes.first())?, executable)
    }
}

fn log_file(state_home: &Path, executable: &Path) -> Option<PathBuf> {
    let name = executable.file_name().and_then(file_stem)?;
    Some(state_home.join("parafovea").join(format!("{name}.log")))
}

fn shared_status_folder(state_home: &Path) -> PathBuf {
    state_home.join("parafovea/running")
}

/// The longest name before an extension: file systems allow 255 bytes in all.
const STEM_BYTES: usize = 200;

/// `name`, chosen by an application, as the stem of a file name: `/`, control characters, invalid UTF-8 and leading dots become `_`, and it
/// is cut to 200 bytes; `None` if it is empty.
pub fn file_stem(name: impl AsRef<OsStr>) -> Option<String> {
    let mut stem = String::new();
    let mut leading = true;
    for character in name.as_ref().to_string_lossy().chars() {
        leading &= character == '.';
        let unfit =
            leading || character == '/' || character.is_control() || character == char::REPLACEMENT_CHARACTER;
        let character = if unfit { '_' } else { character };
        if stem.len() + character.len_utf8() > STEM_BYTES {
            break;
        }
        stem.push(character);
    }
    (!stem.is_empty()).then_some(stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn environment(elevated: bool, variables: &[(&str, &str)]) -> Environment {
        Environment::new(elevated, |name| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value))
        })
    }

    #[test]
    fn base_directories_are_the_variables_or_below_home() {
        let home = environment(false, &[("HOME", "/home/u")]);
        assert_eq!(home.config_home(), Some(Path::new("/home/u/.config")));
        assert_eq!(home.data_home(), Some(Path::new("/home/u/.local/share")));
        assert_eq!(home.state_home(), Some(Path::new("/home/u/.local/state")));
        let set =
            environment(false, &[("HOME", "/home/u"), ("XDG_DATA_HOME", "/d"), ("XDG_STATE_HOME", "/s")]);
        assert_eq!(set.data_home(), Some(Path::new("/d")));
        assert_eq!(set.log_file(Path::new("/bin/game")), Some(PathBuf::from("/s/parafovea/game.log")));
    }

    #[test]
    fn empty_and_relative_base_directories_are_ignored() {
        let variables =
            [("HOME", "/h"), ("XDG_DATA_HOME", ""), ("XDG_CONFIG_HOME", "here"), ("PARAFOVEA_CONFIG", "")];
        let odd = environment(false, &variables);
        assert_eq!(odd.data_home(), Some(Path::new("/h/.local/share")));
        assert_eq!(odd.config_home(), Some(Path::new("/h/.config")));
        assert_eq!(odd.config_file(), None);
        assert_eq!(environment(false, &[("HOME", "")]), Environment::default());
    }

    #[test]
    fn containers_have_their_status_in_the_home_that_they_share() {
        let host = [("HOME", "/h"), ("XDG_RUNTIME_DIR", "/run/user/1")];
        let [host, inside] = [
            environment(false, &host),
            environment(false, &[&host[..], &[("container", "pressure-vessel")]].concat()),
        ];
        let shared = Path::new("/h/.local/state/parafovea/running");
        assert_eq!(host.status_folder().as_deref(), Some(Path::new("/run/user/1/parafovea")));
        assert_eq!(inside.status_folder().as_deref(), Some(shared));
        let flatpak = PathBuf::from("/h/.var/app/com.valvesoftware.Steam/.local/state/parafovea/running");
        assert_eq!(
            host.status_folders(),
            ["/run/user/1/parafovea".into(), shared.to_owned(), flatpak.clone()]
        );
        assert_eq!(inside.status_folders(), [shared.to_owned(), flatpak]);
        assert_eq!(
            environment(true, &[("HOME", "/h"), ("container", "flatpak")]).status_folders(),
            [""; 0].map(PathBuf::from)
        );
    }

    #[test]
    fn a_log_is_in_the_state_folder_of_its_applications_status() {
        let host = environment(false, &[("HOME", "/h"), ("XDG_RUNTIME_DIR", "/run/user/1")]);
        let own = PathBuf::from("/h/.local/state/parafovea/game.log");
        let flatpak = PathBuf::from("/h/.var/app/com.valvesoftware.Steam/.local/state/parafovea/game.log");
        let logs = host.status_folders();
        let logs = logs.iter().map(|folder| host.log_file_with_status(folder, Path::new("game")).unwrap());
        assert_eq!(logs.collect::<Vec<_>>(), [own.clone(), own, flatpak]);
        assert_eq!(Environment::default().log_file_with_status(Path::new("/r"), Path::new("game")), None);
    }

    /// Containers for development, such as toolbox, have the user's runtime folder.
    #[test]
    fn other_containers_are_as_the_system() {
        for name in ["", "podman", "oci", "Flatpak"] {
            let inside = environment(
                false,
                &[("HOME", "/h"), ("XDG_RUNTIME_DIR", "/run/user/1"), ("container", name)],
            );
            assert_eq!(inside.status_folder(), Some(PathBuf::from("/run/user/1/parafovea")), "{name}");
        }
    }

    #[test]
    fn elevated_rights_leave_nothing_of_the_environment() {
        let all = [
            "HOME",
            "XDG_CONFIG_HOME",
            "XDG_DATA_HOME",
            "XDG_STATE_HOME",
            "XDG_RUNTIME_DIR",
            "container",
            "PARAFOVEA_CONFIG",
        ];
        let elevated = Environment::new(true, |name| all.contains(&name).then(|| OsString::from("/x")));
        assert_eq!(elevated, Environment::default());
        assert_eq!(elevated.log_file(Path::new("game")), None);
    }

    #[test]
    fn a_stem_is_one_file_name() {
        for (name, stem) in [
            ("Beat Saber", "Beat Saber"),
            ("a/b", "a_b"),
            ("..", "__"),
            (".hidden", "_hidden"),
            ("v1.2", "v1.2"),
            ("tab\tnul\0", "tab_nul_"),
            ("ゲーム", "ゲーム"),
        ] {
            assert_eq!(file_stem(name).as_deref(), Some(stem));
        }
        assert_eq!(file_stem(""), None);
        let long = file_stem("é".repeat(500)).unwrap();
        assert_eq!(long, "é".repeat(100));
    }
}
