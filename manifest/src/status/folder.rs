//! The folders with the files.

use super::request::request_file;
use super::{FRESH_S, Status, correction, view, watch};
use crate::paths::Environment;
use crate::private_file;
use std::fs::{self, DirBuilder, File};
use std::io::{self, Read};
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// More than a status has.
const MAX_BYTES: u64 = 1 << 18;

/// A file of an application that ended is removed when it is as old as this.
const FORGOTTEN: Duration = Duration::from_secs(60);

/// The kinds of requests, which are extensions of their files.
const REQUESTS: [&str; 3] = [view::KIND, correction::KIND, watch::KIND];

/// The file of a process; it goes when this is dropped.
#[derive(Debug)]
pub struct StatusFile {
    path: PathBuf,
    next: PathBuf,
    requests: [PathBuf; REQUESTS.len()],
}

impl StatusFile {
    /// Makes the folder for the file of the process `pid`; `None` without a folder for it. Requests to an earlier process of that
    /// number are removed, and so are statuses of applications that ended long ago.
    ///
    /// # Errors
    /// The folder cannot be made, or belongs to another user.
    pub fn new(environment: &Environment, pid: u32) -> io::Result<Option<Self>> {
        let Some(folder) = environment.status_folder() else { return Ok(None) };
        make(&folder)?;
        let metadata = fs::symlink_metadata(&folder)?;
        let above = folder.parent().map(fs::metadata).transpose()?;
        if !metadata.is_dir() || above.is_some_and(|above| above.uid() != metadata.uid()) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        sweep(&folder, SystemTime::now());
        let requests = REQUESTS.map(|kind| request_file(&folder, pid, kind));
        for request in &requests {
            let _ = fs::remove_file(request);
        }
        let path = folder.join(format!("{pid}.json"));
        Ok(Some(Self { path, next: folder.join(format!(".{pid}")), requests }))
    }

    /// Replaces the last status by `status`: readers see the one or the other, never a part. A folder that was removed is made again.
    ///
    /// # Errors
    /// The file system refuses.
    pub fn write(&self, status: &Status) -> io::Result<()> {
        let text = serde_json::to_vec(status)?;
        let replace = || private_file::replace(&self.path, &self.next, &text);
        replace().or_else(|error| match self.path.parent() {
            Some(folder) if error.kind() == io::ErrorKind::NotFound => make(folder).and_then(|()| replace()),
            _ => Err(error),
        })
    }
}

/// Makes a folder that only this user may read, if it is missing.
fn make(folder: &Path) -> io::Result<()> {
    DirBuilder::new().recursive(true).mode(0o700).create(folder)
}

impl Drop for StatusFile {
    fn drop(&mut self) {
        // There is no receiver for errors; remaining files expire by their age.
        for file in [&self.path, &self.next].into_iter().chain(&self.requests) {
            let _ = fs::remove_file(file);
        }
    }
}

/// A status that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The status.
    pub status: Status,
    /// Time since it was written.
    pub age: Duration,
    /// Path of the application's log; `None` without a folder for it.
    pub log: Option<PathBuf>,
}

/// Number of files of applications that ended without removing theirs.
pub type Gone = usize;

/// The content of all folders.
#[derive(Debug, Default)]
pub struct Statuses {
    /// Every fresh status of an application, by process.
    pub found: Vec<Found>,
    /// The number of outdated ones.
    pub gone: Gone,
    /// Folders that exist, but cannot be read.
    pub unreadable: Vec<UnreadableStatus>,
}

/// A folder that cannot be read. `Display` is one line that names it.
#[derive(Debug, thiserror::Error)]
#[error("{}: {error}", path.display())]
pub struct UnreadableStatus {
    /// Its path.
    pub path: PathBuf,
    /// The error of the system.
    pub error: io::Error,
}

/// Reads every status; files that are old for long are removed.
pub fn read_all(environment: &Environment, now: SystemTime) -> Statuses {
    let Statuses { mut found, mut gone, mut unreadable } = Statuses::default();
    let mut paths = Vec::new();
    for folder in environment.status_folders() {
        match fs::read_dir(&folder) {
            Ok(entries) => paths.extend(entries.flatten().map(|entry| (folder.clone(), entry.path()))),
            Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {}
            Err(error) => unreadable.push(UnreadableStatus { path: folder, error }),
        }
    }
    for (folder, path) in paths {
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        // A file that is replaced meanwhile is read by the next look.
        let Some((status, age)) = read(&path, now) else { continue };
        if age <= Duration::from_secs(FRESH_S) {
            let log = environment.log_file_with_status(&folder, Path::new(&status.executable));
            found.push(Found { status, age, log });
        } else if age <= FORGOTTEN {
            gone += 1;
        } else {
            remove(&path);
        }
    }
    found.sort_by_key(|found| found.status.pid);
    Statuses { found, gone, unreadable }
}

/// Removes the statuses of applications that ended long ago without removing theirs: folders of containers outlive the system's start.
fn sweep(folder: &Path, now: SystemTime) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let age = || age(&entry.metadata().ok()?, now);
        if path.extension().is_some_and(|extension| extension == "json")
            && age().is_some_and(|age| age > FORGOTTEN)
        {
            remove(&path);
        }
    }
}

/// Removes a status, and requests to its application.
fn remove(path: &Path) {
    let _ = fs::remove_file(path);
    for kind in REQUESTS {
        let _ = fs::remove_file(path.with_extension(kind));
    }
}

/// Age of a file. With a time in the future, by a clock that was put back since, the distance to that time.
fn age(metadata: &fs::Metadata, now: SystemTime) -> Option<Duration> {
    Some(now.duration_since(metadata.modified().ok()?).unwrap_or_else(|ahead| ahead.duration()))
}

fn read(path: &Path, now: SystemTime) -> Option<(Status, Duration)> {
    let file = File::open(path).ok()?;
    let metadata = file.metadata().ok().filter(|metadata| metadata.is_file())?;
    let age = age(&metadata, now)?;
    let mut text = Vec::new();
    file.take(MAX_BYTES).read_to_end(&mut text).ok()?;
    Some((serde_json::from_slice(&text).ok()?, age))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paths::FLATPAK_STEAM;
    use crate::status::{Decision, Topic};
    use std::os::unix::fs::{PermissionsExt, symlink};
    use tempfile::TempDir;

    fn environment(folder: &TempDir) -> Environment {
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| folder.path().into()))
    }

    /// Statuses of folders that can all be read.
    fn read(environment: &Environment, now: SystemTime) -> (Vec<Found>, Gone) {
        let Statuses { found, gone, unreadable } = read_all(environment, now);
        assert!(unreadable.is_empty(), "{unreadable:?}");
        (found, gone)
    }

    fn status(pid: u32) -> Status {
        Status {
            pid,
            decisions: vec![Decision {
                topic: Topic::Scene,
                reason: String::new(),
                line: "a pass".to_owned(),
            }],
            ..Status::default()
        }
    }

    #[test]
    fn a_status_is_read_until_the_application_ends() {
        let runtime = TempDir::new().unwrap();
        let environment = environment(&runtime);
        let now = SystemTime::now();
        assert_eq!(read(&environment, now), (Vec::new(), 0));
        let [one, other] = [7, 3].map(|pid| StatusFile::new(&environment, pid).unwrap().unwrap());
        one.write(&status(7)).unwrap();
        other.write(&status(1)).unwrap();
        other.write(&status(3)).unwrap();
        let (found, gone) = read(&environment, now);
        assert_eq!(
            found.iter().map(|found| found.status.clone()).collect::<Vec<_>>(),
            [status(3), status(7)]
        );
        assert_eq!(gone, 0);
        drop(one);
        assert_eq!(read(&environment, now).0.len(), 1);
        drop(other);
        assert_eq!(fs::read_dir(runtime.path().join("parafovea")).unwrap().count(), 0);
    }

    #[test]
    fn a_status_within_a_container_is_read_outside_and_takes_requests() {
        let folder = TempDir::new().unwrap();
        let of = |runtime: &str, container: &str| {
            Environment::new(false, |name| match name {
                "HOME" => Some(folder.path().join("home").into()),
                "XDG_RUNTIME_DIR" => Some(folder.path().join(runtime).into()),
                "container" => Some(container.into()),
                _ => None,
            })
        };
        let (host, game) = (of("run", ""), of("run of the container", "pressure-vessel"));
        let file = StatusFile::new(&game, 7).unwrap().unwrap();
        file.write(&Status { executable: "game".to_owned(), ..status(7) }).unwrap();
        let (found, _) = read(&host, SystemTime::now());
        let log = folder.path().join("home/.local/state/parafovea/game.log");
        assert_eq!(found.iter().map(|found| found.log.clone()).collect::<Vec<_>>(), [Some(log)]);
        view::ask_view(&host, 7, Some(crate::options::DebugView::Gaze)).unwrap();
        assert_eq!(view::AskedView::new(&game, 7).look(), Some(crate::options::DebugView::Gaze));
        drop(file);
        assert_eq!(read(&host, SystemTime::now()).0, []);
    }

    #[test]
    fn a_status_in_the_flatpak_of_steam_is_found_with_its_log() {
        let home = TempDir::new().unwrap();
        let flatpak = home.path().join(FLATPAK_STEAM);
        let of = |home: &Path, container: &str| {
            Environment::new(false, |name| match name {
                "HOME" => Some(home.into()),
                "container" => Some(container.into()),
                _ => None,
            })
        };
        let file = StatusFile::new(&of(&flatpak, "pressure-vessel"), 7).unwrap().unwrap();
        file.write(&Status { executable: "game".to_owned(), ..status(7) }).unwrap();
        let (found, _) = read(&of(home.path(), ""), SystemTime::now());
        let log = flatpak.join(".local/state/parafovea/game.log");
        assert_eq!(found.iter().map(|found| found.log.clone()).collect::<Vec<_>>(), [Some(log)]);
    }

    #[test]
    fn a_folder_that_cannot_be_read_is_named_and_hides_no_other() {
        let folder = TempDir::new().unwrap();
        let environment = Environment::new(false, |name| match name {
            "HOME" => Some(folder.path().into()),
            "XDG_RUNTIME_DIR" => Some(folder.path().join("run").into()),
            _ => None,
        });
        let file = StatusFile::new(&environment, 7).unwrap().unwrap();
        file.write(&status(7)).unwrap();
        // Not even root can read a link to itself.
        let shared = folder.path().join(".local/state/parafovea/running");
        fs::create_dir_all(shared.parent().unwrap()).unwrap();
        symlink(&shared, &shared).unwrap();
        let Statuses { found, unreadable, .. } = read_all(&environment, SystemTime::now());
        assert_eq!(found.len(), 1);
        let [fault] = unreadable.as_slice() else { panic!("{unreadable:?}") };
        assert!(fault.to_string().starts_with(&format!("{}: Too many levels", shared.display())), "{fault}");
    }

    #[test]
    fn only_the_user_can_read_it() {
        let runtime = TempDir::new().unwrap();
        let file = StatusFile::new(&environment(&runtime), 7).unwrap().unwrap();
        file.write(&status(7)).unwrap();
        let mode = |path: &str| fs::metadata(runtime.path().join(path)).unwrap().permissions().mode() & 0o777;
        assert_eq!((mode("parafovea"), mode("parafovea/7.json")), (0o700, 0o600));
    }

    #[test]
    fn an_old_status_is_not_shown_and_in_the_end_removed() {
        let runtime = TempDir::new().unwrap();
        let environment = environment(&runtime);
        let file = StatusFile::new(&environment, 7).unwrap().unwrap();
        file.write(&status(7)).unwrap();
        let later = |seconds| SystemTime::now() + Duration::from_secs(seconds);
        assert_eq!(read(&environment, later(FRESH_S + 1)), (Vec::new(), 1));
        let path = runtime.path().join("parafovea/7.json");
        assert!(path.exists());
        assert_eq!(read(&environment, later(3600)), (Vec::new(), 0), "it may have ended as it should");
        assert!(!path.exists());
        file.write(&status(7)).unwrap();
        let ahead = SystemTime::now() - Duration::from_secs(FRESH_S + 1);
        assert_eq!(read(&environment, ahead), (Vec::new(), 1), "the clock was put back");
    }

    #[test]
    fn a_new_status_removes_those_of_long_ago() {
        let runtime = TempDir::new().unwrap();
        let environment = environment(&runtime);
        let [old, running] = [3, 4].map(|pid| StatusFile::new(&environment, pid).unwrap().unwrap());
        old.write(&status(3)).unwrap();
        running.write(&status(4)).unwrap();
        view::ask_view(&environment, 3, None).unwrap();
        let file = File::options().write(true).open(runtime.path().join("parafovea/3.json")).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(3600)).unwrap();
        drop(StatusFile::new(&environment, 7).unwrap());
        let left: Vec<_> = fs::read_dir(runtime.path().join("parafovea")).unwrap().flatten().collect();
        assert_eq!(left.iter().map(fs::DirEntry::file_name).collect::<Vec<_>>(), ["4.json"]);
    }

    #[test]
    fn files_that_are_no_status_are_skipped() {
        let runtime = TempDir::new().unwrap();
        let folder = runtime.path().join("parafovea");
        fs::create_dir(&folder).unwrap();
        fs::create_dir(folder.join("1.json")).unwrap();
        fs::write(folder.join("2.json"), "{").unwrap();
        fs::write(folder.join("3"), "{}").unwrap();
        fs::write(folder.join("4.json"), "{\"pid\": 4, \"of_a_later_version\": 1}").unwrap();
        let (found, _) = read(&environment(&runtime), SystemTime::now());
        assert_eq!(found.iter().map(|found| found.status.pid).collect::<Vec<_>>(), [4]);
    }

    #[test]
    fn without_a_place_nothing_is_written() {
        assert!(StatusFile::new(&Environment::default(), 7).unwrap().is_none());
        let runtime = TempDir::new().unwrap();
        fs::write(runtime.path().join("parafovea"), "").unwrap();
        assert!(StatusFile::new(&environment(&runtime), 7).is_err());
    }
}
