//! The layer of another commit, built beside the target folder's own things.

use crate::steps::{Steps, cargo, profile_folder};
use crate::tasks::in_root;
use std::path::PathBuf;
use std::process::Command;

/// Builds the layer of a commit in a working tree of its own, on top of earlier builds there: a short name of the commit,
/// and the library.
pub fn built(steps: &mut Steps, revision: &str) -> Result<(String, PathBuf), String> {
    let commit = git(&["rev-parse", "--verify", "--quiet", &format!("{revision}^{{commit}}")])
        .map_err(|_| format!("there is no commit `{revision}`"))?;
    let name = commit.chars().take(10).collect::<String>();
    let folder = profile_folder()?.join("../compare");
    let tree = folder.join(&name);
    if !tree.join("Cargo.toml").is_file() {
        // One whose folder is gone is still known to git.
        git(&["worktree", "prune"])?;
        let mut command = Command::new("git");
        command.args(["worktree", "add", "--detach", "--force"]).arg(&tree).arg(&commit);
        steps.run(&format!("git worktree of {name}"), in_root(&mut command))?;
    }
    let target = folder.join("target");
    let mut command = cargo();
    command.args(["build", "--locked", "--package", "parafovea-layer", "--lib"]).current_dir(&tree);
    steps.run(&format!("cargo build of {name}"), command.env("CARGO_TARGET_DIR", &target))?;
    // The next commit's is built over it.
    let (from, to) = (target.join("debug/libparafovea.so"), tree.join("libparafovea.so"));
    std::fs::copy(&from, &to).map_err(|error| format!("{}: {error}", from.display()))?;
    let library = to.canonicalize().map_err(|error| format!("{}: {error}", to.display()))?;
    Ok((name, library))
}

/// Output of git in the repository; git's messages as the error.
fn git(arguments: &[&str]) -> Result<String, String> {
    let mut command = Command::new("git");
    let output = in_root(command.args(arguments)).output().map_err(|error| format!("git: {error}"))?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned()),
        false => Err(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
    }
}
