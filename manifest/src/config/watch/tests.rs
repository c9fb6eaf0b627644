use super::*;
use std::ffi::OsString;
use std::fs;
use tempfile::TempDir;

struct Home {
    folder: TempDir,
}

impl Home {
    fn new() -> Self {
        let home = Self { folder: TempDir::new().unwrap() };
        fs::create_dir_all(home.path("parafovea/apps")).unwrap();
        home
    }

    fn path(&self, below: &str) -> PathBuf {
        self.folder.path().join(below)
    }

    fn write(&self, below: &str, text: &str) {
        fs::write(self.path(below), text).unwrap();
    }

    fn watch(&self) -> Watch {
        let environment = Environment::new(false, |name| {
            (name == "XDG_CONFIG_HOME").then(|| OsString::from(self.folder.path()))
        });
        Watch::new(&environment, Some("game"), Path::new("exe"))
    }
}

/// The configuration that the watch reads in two looks.
fn read(watch: &mut Watch) -> Option<Result<Config, ConfigErrors>> {
    watch.poll().or_else(|| watch.poll())
}

/// Its hold time, which the tests edit.
fn hold(watch: &mut Watch) -> Option<u32> {
    read(watch).map(|read| read.unwrap().gaze.hold_ms)
}

#[test]
fn the_first_look_reads_and_without_a_file_gives_the_defaults() {
    let home = Home::new();
    let mut watch = home.watch();
    assert_eq!(hold(&mut watch), Some(Config::default().gaze.hold_ms));
    assert_eq!(watch.file(), None);
    assert_eq!(hold(&mut watch), None);
}

#[test]
fn an_edit_a_replacement_and_a_removal_are_seen_once_each() {
    let home = Home::new();
    home.write("parafovea/config.toml", "gaze.hold_ms = 1");
    let mut watch = home.watch();
    assert_eq!(hold(&mut watch), Some(1));
    assert_eq!(hold(&mut watch), None);

    home.write("parafovea/config.toml", "gaze.hold_ms = 20");
    assert_eq!(hold(&mut watch), Some(20));
    assert_eq!(hold(&mut watch), None);

    // As editors save: same length, and here even the same time of modification.
    let old = fs::metadata(home.path("parafovea/config.toml")).unwrap().modified().unwrap();
    home.write("parafovea/new", "gaze.hold_ms = 30");
    fs::File::options().write(true).open(home.path("parafovea/new")).unwrap().set_modified(old).unwrap();
    fs::rename(home.path("parafovea/new"), home.path("parafovea/config.toml")).unwrap();
    assert_eq!(hold(&mut watch), Some(30));
    assert_eq!(hold(&mut watch), None);

    fs::remove_file(home.path("parafovea/config.toml")).unwrap();
    assert_eq!(hold(&mut watch), Some(500));
    assert_eq!(hold(&mut watch), None);
}

/// An editor may empty a file before it writes it, or remove it before it puts another in its place.
#[test]
fn a_file_that_is_being_written_is_read_when_it_is_whole() {
    let home = Home::new();
    home.write("parafovea/config.toml", "gaze.hold_ms = 1");
    let mut watch = home.watch();
    assert_eq!(watch.poll().unwrap().unwrap().gaze.hold_ms, 1);
    for (half, value) in [("", 20), ("gaze.hold", 300)] {
        home.write("parafovea/config.toml", half);
        assert!(watch.poll().is_none(), "{half:?}");
        home.write("parafovea/config.toml", &format!("gaze.hold_ms = {value}"));
        assert!(watch.poll().is_none());
        assert_eq!(watch.poll().unwrap().unwrap().gaze.hold_ms, value);
    }
    fs::remove_file(home.path("parafovea/config.toml")).unwrap();
    assert!(watch.poll().is_none());
    assert_eq!(watch.file(), Some(home.path("parafovea/config.toml").as_path()), "the one in force");
    home.write("parafovea/config.toml", "gaze.hold_ms = 40");
    assert!(watch.poll().is_none());
    assert_eq!(watch.poll().unwrap().unwrap().gaze.hold_ms, 40);
}

#[test]
fn a_file_of_higher_precedence_takes_over_and_gives_back() {
    let home = Home::new();
    home.write("parafovea/config.toml", "gaze.hold_ms = 1");
    let mut watch = home.watch();
    assert_eq!(hold(&mut watch), Some(1));
    for (file, value) in [("parafovea/apps/exe.toml", 2), ("parafovea/apps/game.toml", 3)] {
        home.write(file, &format!("gaze.hold_ms = {value}"));
        assert_eq!(hold(&mut watch), Some(value));
        assert_eq!(watch.file(), Some(home.path(file).as_path()));
    }
    // Hidden by the one above it, and so without effect.
    home.write("parafovea/config.toml", "gaze.hold_ms = 400");
    assert_eq!(hold(&mut watch), None);
    fs::remove_file(home.path("parafovea/apps/game.toml")).unwrap();
    assert_eq!(hold(&mut watch), Some(2));
}

#[test]
fn a_broken_file_is_reported_once_and_then_its_repair_is_read() {
    let home = Home::new();
    home.write("parafovea/apps/game.toml", "gaze.hold_ms = 501");
    home.write("parafovea/config.toml", "gaze.hold_ms = 1");
    let mut watch = home.watch();
    let errors = read(&mut watch).unwrap().unwrap_err();
    assert_eq!(errors.lines().count(), 1);
    assert!(read(&mut watch).is_none());
    // Of another length: the time of modification may be the same, where the clock of files is coarse.
    home.write("parafovea/apps/game.toml", "gaze.hold_ms = 50");
    assert_eq!(hold(&mut watch), Some(50));
}

#[test]
fn a_missing_file_that_was_asked_for_is_an_error_until_it_is_there() {
    let home = Home::new();
    let file = home.path("mine.toml");
    let environment =
        Environment::new(false, |name| (name == "PARAFOVEA_CONFIG").then(|| file.clone().into_os_string()));
    let mut watch = Watch::new(&environment, None, Path::new("exe"));
    let errors = read(&mut watch).unwrap().unwrap_err().to_string();
    assert!(errors.contains("mine.toml: cannot be read: No such file"), "{errors}");
    assert!(read(&mut watch).is_none());
    fs::write(&file, "enabled = false").unwrap();
    assert!(!read(&mut watch).unwrap().unwrap().enabled);
}
