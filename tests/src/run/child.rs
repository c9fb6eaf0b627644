//! The application's process: its standard input stays open, its output goes to files, its time is limited.

use crate::HarnessError;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Interval between checks of a running application.
const POLL: Duration = Duration::from_millis(5);

pub(super) struct Child {
    process: std::process::Child,
    /// hello_xr quits when its standard input ends.
    input: Option<ChildStdin>,
    deadline: Instant,
    output: [PathBuf; 2],
}

/// Exit of an application.
pub(super) struct Exit {
    /// None: killed because its time was over.
    pub status: Option<ExitStatus>,
    /// Its output, standard output before standard error.
    pub output: String,
}

impl Child {
    pub(super) fn start(
        mut command: Command,
        folder: &Path,
        timeout: Duration,
    ) -> Result<Self, HarnessError> {
        let output = ["stdout.txt", "stderr.txt"].map(|name| folder.join(name));
        let [stdout, stderr] = &output;
        let create = |path: &Path| File::create(path).map_err(HarnessError::file(path));
        command.stdin(Stdio::piped()).stdout(create(stdout)?).stderr(create(stderr)?);
        let program = PathBuf::from(command.get_program());
        let mut process = command.spawn().map_err(|source| HarnessError::Start { program, source })?;
        let input = process.stdin.take();
        Ok(Self { process, input, deadline: Instant::now() + timeout, output })
    }

    /// Ends its standard input.
    pub(super) fn close_input(&mut self) {
        self.input = None;
    }

    /// Its process.
    pub(super) fn id(&self) -> u32 {
        self.process.id()
    }

    /// Whether the process has ended, or its state is unknown.
    pub(super) fn has_ended(&mut self) -> bool {
        !matches!(self.process.try_wait(), Ok(None))
    }

    /// Waits for its end, or kills it when its time is over. Its standard input ends once `is_done`.
    pub(super) fn finish(mut self, is_done: impl Fn() -> bool) -> Result<Exit, HarnessError> {
        let wait = HarnessError::file(Path::new("the running application"));
        let status = loop {
            match self.process.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if Instant::now() < self.deadline => {
                    if self.input.is_some() && is_done() {
                        self.close_input();
                    }
                    std::thread::sleep(POLL);
                }
                Ok(None) => break None,
                Err(error) => return Err(wait(error)),
            }
        };
        // Undecodable bytes are of no interest here, and a missing file is an application that printed nothing.
        let read =
            |path: &PathBuf| String::from_utf8_lossy(&std::fs::read(path).unwrap_or_default()).into_owned();
        let output = self.output.each_ref().map(read).concat();
        Ok(Exit { status, output })
    }
}

impl Drop for Child {
    /// Nothing that the harness started outlives it.
    fn drop(&mut self) {
        // Both fail only for a process that has ended already.
        drop(self.process.kill());
        drop(self.process.wait());
    }
}
