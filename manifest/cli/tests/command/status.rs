//! `parafovea status` and `parafovea gaze`.

use super::{complained, printed};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, StatusFile};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

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
