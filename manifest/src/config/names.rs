//! The two names of an application: the one that it gives to OpenXR, and the one of its program.

use crate::paths::{Environment, file_stem};
use crate::status::read_all;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The layer's log line for an OpenXR instance (`layer/src/xr/instance.rs`), up to the application's name.
const INSTANCE: &str = "OpenXR instance of \"";

/// The text after that name where the layer does nothing in the instance.
const INERT: &str = "\" inert: ";

/// The largest part of a log that is read, bytes: a log never holds more than 2 MiB.
const MAX_LOG_BYTES: u64 = 2 << 20;

/// Greatest number of similar names.
const MAX_SIMILAR: usize = 3;

/// Least similarity of those (Jaro-Winkler, 0..=1).
const MIN_SIMILARITY: f64 = 0.85;

/// The longest name that is compared, bytes.
const MAX_COMPARED: usize = 128;

/// Names of one application. The file of the first ranks before that of the second ([`Places`](super::Places)).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// The name that the application gives to OpenXR.
    pub application: Option<String>,
    /// The name of its program; empty if it is not known.
    pub executable: PathBuf,
}

impl Names {
    /// Both names of the application that `name` means: by the status of running applications, else by the latest log with that name; `None`
    /// if neither has it.
    pub fn known(environment: &Environment, name: &str, now: SystemTime) -> Option<Self> {
        let mut running = Self::running(environment, now);
        running.find(|names| names.is(name)).or_else(|| Self::logged(environment, name))
    }

    /// Names of applications that run or have a log and are spelt like `name`, for instance in another case or without `.exe`: the most similar
    /// first, three at most.
    pub fn similar(environment: &Environment, name: &str, now: SystemTime) -> Vec<String> {
        let mut names = BTreeSet::new();
        for running in Self::running(environment, now) {
            names.extend(running.application);
            names.insert(running.executable.to_string_lossy().into_owned());
        }
        for log in logs(environment) {
            names.extend(log.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
            names.extend(
                read(&log).iter().flat_map(|text| text.lines()).filter_map(application).map(str::to_owned),
            );
        }
        let plain = |name: &str| {
            let name = name.to_lowercase();
            name.strip_suffix(".exe").map(str::to_owned).unwrap_or(name)
        };
        let wanted = plain(name);
        let similar = names
            .into_iter()
            .filter(|name| name.len() <= MAX_COMPARED)
            .map(|name| (strsim::jaro_winkler(&plain(&name), &wanted), name));
        let mut similar: Vec<_> = similar.filter(|(similarity, _)| *similarity >= MIN_SIMILARITY).collect();
        similar.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        similar.into_iter().map(|(_, name)| name).take(MAX_SIMILAR).collect()
    }

    /// By the status of running applications.
    fn running(environment: &Environment, now: SystemTime) -> impl Iterator<Item = Self> {
        let running = read_all(environment, now).found;
        running.into_iter().map(|found| Self {
            application: Some(found.status.application).filter(|name| !name.is_empty()),
            executable: Path::new(&found.status.executable)
                .file_name()
                .map(PathBuf::from)
                .unwrap_or_default(),
        })
    }

    /// The two names of an application that never ran: `name` may be either.
    pub fn unknown(name: &str) -> Self {
        Self { application: Some(name.to_owned()), executable: name.into() }
    }

    fn is(&self, name: &str) -> bool {
        self.application.as_deref() == Some(name) || self.executable == Path::new(name)
    }

    /// By the logs, the latest first.
    fn logged(environment: &Environment, name: &str) -> Option<Self> {
        let stem = file_stem(name)?;
        logs(environment).iter().find_map(|path| {
            let executable = path.file_stem()?;
            let text = read(path)?;
            let is_executable = executable == stem.as_str();
            // The latest line counts: one program may give several names in turn.
            let named = text.lines().rev().filter_map(application);
            let application = named.into_iter().find(|found| is_executable || *found == name);
            (is_executable || application.is_some())
                .then(|| Self { application: application.map(str::to_owned), executable: executable.into() })
        })
    }
}

/// Paths of all logs, the latest first.
fn logs(environment: &Environment) -> Vec<PathBuf> {
    let folders = environment.state_homes().into_iter().map(|state| state.join("parafovea"));
    let entries = folders.filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    let entries = entries.map(|entry| entry.path());
    let mut logs: Vec<_> = entries
        .filter(|path| path.extension().is_some_and(|extension| extension == "log"))
        .filter_map(|path| Some((fs::metadata(&path).ok()?.modified().ok()?, path)))
        .collect();
    logs.sort_by(|one, other| other.cmp(one));
    logs.into_iter().map(|(_, path)| path).collect()
}

/// The application's name in a line of a log.
fn application(line: &str) -> Option<&str> {
    let (_, rest) = line.split_once(INSTANCE)?;
    let name = rest.strip_suffix('"').or_else(|| rest.rsplit_once(INERT).map(|(name, _)| name))?;
    (!name.is_empty()).then_some(name)
}

fn read(log: &Path) -> Option<String> {
    let file = File::open(log).ok()?;
    file.metadata().ok().filter(fs::Metadata::is_file)?;
    let mut bytes = Vec::new();
    file.take(MAX_LOG_BYTES).read_to_end(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paths::FLATPAK_STEAM;
    use crate::status::{Status, StatusFile};
    use std::time::Duration;
    use tempfile::TempDir;

    fn environment(home: &TempDir) -> Environment {
        let path = home.path().to_owned();
        Environment::new(false, |name| {
            ["HOME", "XDG_RUNTIME_DIR"].contains(&name).then(|| path.clone().into())
        })
    }

    fn log(home: &TempDir, name: &str, age_s: u64, lines: &[&str]) {
        let path = home.path().join(".local/state/parafovea").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let line = |line: &&str| format!("2026-01-02T03:04:05.678+01:00 77 INFO  {line}\n");
        fs::write(&path, lines.iter().map(line).collect::<String>()).unwrap();
        let file = File::options().write(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(age_s)).unwrap();
    }

    fn pair(application: &str, executable: &str) -> Option<Names> {
        Some(Names { application: Some(application.to_owned()), executable: executable.into() })
    }

    #[test]
    fn either_name_leads_to_both() {
        let home = TempDir::new().unwrap();
        let known = |name: &str| Names::known(&environment(&home), name, SystemTime::now());
        assert_eq!(known("Game.exe"), None);
        log(
            &home,
            "Game.exe.log",
            60,
            &["OpenXR instance of \"Launcher\"", "OpenXR instance of \"My \"Game\"\" inert: off"],
        );
        log(&home, "other.log", 30, &["OpenXR instance of \"My Game 2\"", "a pass of \"My \"Game\"\""]);
        log(&home, "silent.log", 0, &["nothing"]);
        assert_eq!(known("Game.exe"), pair("My \"Game\"", "Game.exe"));
        assert_eq!(known("My \"Game\""), pair("My \"Game\"", "Game.exe"));
        assert_eq!(known("Launcher"), pair("Launcher", "Game.exe"));
        assert_eq!(known("My Game 2"), pair("My Game 2", "other"));
        assert_eq!(known("silent"), Some(Names { application: None, executable: "silent".into() }));
        assert_eq!(known("My Game"), None);
        // The latest log with a name counts, and a running application before any.
        log(&home, "New.exe.log", 5, &["OpenXR instance of \"My \"Game\"\""]);
        assert_eq!(known("My \"Game\""), pair("My \"Game\"", "New.exe"));
        let status = StatusFile::new(&environment(&home), 7).unwrap().unwrap();
        let (executable, application) = ("Live.exe".to_owned(), "My \"Game\"".to_owned());
        status.write(&Status { pid: 7, executable, application, ..Status::default() }).unwrap();
        assert_eq!(known("My \"Game\""), pair("My \"Game\"", "Live.exe"));
        assert_eq!(known("Live.exe"), pair("My \"Game\"", "Live.exe"));
    }

    #[test]
    fn logs_in_the_flatpak_of_steam_count_too() {
        let home = TempDir::new().unwrap();
        log(&home, "other.log", 0, &["OpenXR instance of \"Other\""]);
        let folder = home.path().join(FLATPAK_STEAM).join(".local/state/parafovea");
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("Game.exe.log"), "INFO  OpenXR instance of \"My Game\"\n").unwrap();
        let known = Names::known(&environment(&home), "My Game", SystemTime::now());
        assert_eq!(known, pair("My Game", "Game.exe"));
    }
}
