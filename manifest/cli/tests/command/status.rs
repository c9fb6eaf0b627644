//! `parafovea status` and `parafovea gaze`.

use super::{complained, printed};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, StatusFile};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// More than any command takes to end.
const PATIENCE: Duration = Duration::from_secs(20);

/// The command in a session with a runtime folder.
fn in_session(home: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_parafovea"));
    command.args(arguments).env_clear().env("HOME", home).env("XDG_RUNTIME_DIR", home.join("run"));
    command
}

#[test]
fn a_folder_that_cannot_be_read_is_named_and_hides_no_game() {
    let home = TempDir::new().unwrap();
    let runtime = home.path().join("run");
    let environment =
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| runtime.clone().into()));
    let file = StatusFile::new(&environment, 7).unwrap().unwrap();
    file.write(&Status { pid: 7, application: "Game".to_owned(), ..Status::default() }).unwrap();
    // Not even root can read a link to itself.
    let shared = home.path().join(".local/state/parafovea/running");
    fs::create_dir_all(shared.parent().unwrap()).unwrap();
    symlink(&shared, &shared).unwrap();
    for arguments in [["status", "--once"].as_slice(), &["status", "--once", "--json"], &["gaze", "--once"]] {
        let output = in_session(home.path(), arguments).output().unwrap();
        let text = printed(&output);
        assert!(text.contains("Game"), "{text}");
        let complaint = complained(&output);
        assert!(complaint.starts_with(&format!("parafovea: {}: ", shared.display())), "{complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
    }
}

/// Without a game, nothing is written, so no write fails.
#[test]
fn it_ends_with_its_reader_even_without_output() {
    let home = TempDir::new().unwrap();
    let arguments = [["status", "--json"].as_slice(), &["gaze", "--json"], &["status"]];
    let mut commands = arguments.map(|arguments| {
        let mut command = in_session(home.path(), arguments).stdout(Stdio::piped()).spawn().unwrap();
        assert!(command.try_wait().unwrap().is_none(), "it waits for games");
        drop(command.stdout.take());
        command
    });
    let begin = Instant::now();
    for (command, arguments) in commands.iter_mut().zip(arguments) {
        let ended = loop {
            match command.try_wait().unwrap() {
                None if begin.elapsed() < PATIENCE => sleep(Duration::from_millis(20)),
                ended => break ended,
            }
        };
        if ended.is_none() {
            command.kill().unwrap();
        }
        assert!(ended.is_some_and(|status| status.success()), "{arguments:?}: {ended:?}");
    }
}

/// With a reader, it goes on.
#[test]
fn it_stays_for_a_reader_that_waits() {
    let home = TempDir::new().unwrap();
    let mut command = in_session(home.path(), &["status", "--json"]).stdout(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(1500));
    let ended = command.try_wait().unwrap();
    command.kill().unwrap();
    command.wait().unwrap();
    assert_eq!(ended, None);
}
