//! A test as a process of its own: its time limit, how it ended, and why it was skipped.
//!
//! `cargo dev test` runs tests this way; unit tests share processes, and run again alone if they do not pass.
//! A test that hangs is killed at its limit together with every process that it
//! started, so that it fails with its name and the others go on. A test that needs something that this machine lacks calls
//! [`skip()`]; it never passes by returning early.
//!
//! Only the standard library is used here, as in `cargo dev`.

#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test that cannot go on fails"))]

mod ended;
mod processes;
mod skip;
mod watch;

pub use ended::Ending;
pub use skip::{Lack, skip};
pub use watch::{Watched, watch, watch_with_open_input};

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

/// One test of a test binary, of the standard harness or of libtest-mimic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Trial {
    /// The test binary.
    pub binary: PathBuf,
    /// The name of the test in it, as `--list` prints it. None: the binary has no harness, and is one test.
    pub name: Option<String>,
    /// Whether to run the test though it is marked `#[ignore]`.
    pub even_ignored: bool,
    /// The working directory: that of the package, as cargo has it. None: that of this process.
    pub folder: Option<PathBuf>,
}

impl Trial {
    /// Runs the test within the time limit; returns its outcome, its time and its output.
    ///
    /// # Errors
    /// The binary cannot be started, or its output cannot be kept.
    pub fn run(&self, limit: Duration) -> std::io::Result<(Ending, Watched)> {
        let mut command = Command::new(&self.binary);
        if let Some(name) = &self.name {
            command.args([name, "--exact", "--nocapture"]);
        }
        if self.even_ignored {
            command.arg("--ignored");
        }
        if let Some(folder) = &self.folder {
            command.current_dir(folder).env("CARGO_MANIFEST_DIR", folder);
        }
        let watched = watch(command.env(skip::VARIABLE, "1"), limit)?;
        Ok((Ending::of(self.name.as_deref(), &watched), watched))
    }
}
