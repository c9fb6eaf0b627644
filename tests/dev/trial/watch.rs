//! A process with a limit to its time, and to that of everything that it starts.

use crate::processes::{Process, family, kill};
use std::fs::File;
use std::io::{Read, Result, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Interval between checks of a running process.
const POLL: Duration = Duration::from_millis(5);

/// Time limit for processes to exit after their parent: a killed process takes a moment.
const GRACE: Duration = Duration::from_secs(2);

/// The variable by which everything that a watched process starts is found.
const MARK: &str = "PARAFOVEA_WATCHED";

/// Output of a process.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Watched {
    /// None: it was killed at its time limit.
    pub status: Option<ExitStatus>,
    /// From its start to its end.
    pub time: Duration,
    /// Standard output and standard error, in the order in which they were written.
    pub output: String,
    /// Names of the processes that outlived it, and were killed.
    pub left_behind: Vec<String>,
}

/// Runs a command without standard input, within the time limit. No process that it started is left.
///
/// # Errors
/// It cannot be started, or its output cannot be kept.
pub fn watch(command: &mut Command, limit: Duration) -> Result<Watched> {
    run(command.stdin(Stdio::null()), limit)
}

/// As [`watch`], with a standard input that is empty and does not end: hello_xr quits with its input.
///
/// # Errors
/// As for [`watch`].
pub fn watch_with_open_input(command: &mut Command, limit: Duration) -> Result<Watched> {
    run(command.stdin(Stdio::piped()), limit)
}

fn run(command: &mut Command, limit: Duration) -> Result<Watched> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let id = format!("{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    // A file, not a pipe: a process that is left behind would keep a pipe open.
    let (path, mut output) = temporary_file(&id)?;
    command.env(MARK, &id).stdout(output.try_clone()?).stderr(output.try_clone()?);
    let start = Instant::now();
    let child = command.spawn();
    drop(std::fs::remove_file(path));
    let mark = format!("{MARK}={id}");
    let mut child = Family { child: child?, mark: &mark };
    let status = child.wait_until(start + limit)?;
    let time = start.elapsed();
    let left_behind = if status.is_some() { child.left_behind() } else { Vec::new() };
    drop(child);
    let mut text = Vec::new();
    output.rewind()?;
    output.read_to_end(&mut text)?;
    let output = String::from_utf8_lossy(&text).into_owned();
    let left_behind = left_behind.into_iter().map(|process| process.name).collect();
    Ok(Watched { status, time, output, left_behind })
}

fn temporary_file(id: &str) -> Result<(PathBuf, File)> {
    let path = std::env::temp_dir().join(Path::new(&format!("parafovea-watched-{id}.txt")));
    let file = File::options().read(true).append(true).create_new(true).open(&path)?;
    Ok((path, file))
}

/// A child, which has its standard input, and all that it starts. They are killed when it is dropped.
struct Family<'a> {
    child: Child,
    mark: &'a str,
}

impl Family<'_> {
    /// None at the deadline.
    fn wait_until(&mut self, deadline: Instant) -> Result<Option<ExitStatus>> {
        loop {
            // Not `wait`, which ends its standard input first.
            if let Some(status) = self.child.try_wait()? {
                return Ok(Some(status));
            }
            if Instant::now() >= deadline {
                return Ok(None);
            }
            std::thread::sleep(POLL);
        }
    }

    /// Processes that are still there though the child is not.
    fn left_behind(&self) -> Vec<Process> {
        let start = Instant::now();
        loop {
            let left = family(None, self.mark);
            if left.is_empty() || start.elapsed() > GRACE {
                return left;
            }
            std::thread::sleep(POLL);
        }
    }
}

impl Drop for Family<'_> {
    fn drop(&mut self) {
        // Again and again: a process may start another one while the list is read.
        let start = Instant::now();
        let is_alive = matches!(self.child.try_wait(), Ok(None));
        let root = is_alive.then(|| self.child.id());
        let mut killed: Vec<Process> = Vec::new();
        while start.elapsed() < GRACE {
            let mut left = family(root, self.mark);
            // Without its parent and our environment, nothing finds a killed process any more.
            left.extend(killed.into_iter().filter(Process::is_alive));
            if left.is_empty() {
                break;
            }
            kill(&left);
            killed = left;
            // Reaps it; it fails only for a process that was reaped before.
            drop(self.child.try_wait());
            std::thread::sleep(POLL);
        }
        drop(self.child.wait());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sh(script: &str, limit: Duration) -> Watched {
        watch(Command::new("sh").args(["-c", script]), limit).unwrap()
    }

    fn is_alive(id: &str) -> bool {
        family(id.trim().parse().ok(), "no such mark").iter().any(|process| process.name == "sleep")
    }

    #[test]
    fn output_and_status_of_a_process_that_ends() {
        let ended = sh("echo one; echo two >&2; exit 3", Duration::from_secs(60));
        assert_eq!(ended.status.unwrap().code(), Some(3));
        assert_eq!((ended.output.as_str(), ended.left_behind), ("one\ntwo\n", vec![]));
    }

    #[test]
    fn an_open_input_does_not_end() {
        let mut command = Command::new("sh");
        let reads = command.args(["-c", "timeout 0.3 cat; echo $?"]);
        assert_eq!(watch_with_open_input(reads, Duration::from_secs(60)).unwrap().output, "124\n");
        assert_eq!(sh("timeout 60 cat; echo $?", Duration::from_secs(120)).output, "0\n");
    }

    #[test]
    fn a_process_that_hangs_is_killed_with_its_children() {
        // In a session of its own, with nothing of our environment: as servers are started. On a busy machine, the shell needs a second
        // until it has printed.
        let ended = sh("env -i setsid sleep 600 & echo $!; wait", Duration::from_secs(4));
        assert_eq!(ended.status, None);
        assert!(ended.time < Duration::from_secs(60), "{:?}", ended.time);
        assert!(!ended.output.is_empty() && !is_alive(&ended.output), "{}", ended.output);
    }

    #[test]
    fn processes_that_are_left_behind_are_named_and_killed() {
        let ended = sh("setsid sleep 600 & echo $!; exit 0", Duration::from_secs(60));
        assert!(ended.status.unwrap().success());
        assert_eq!(ended.left_behind, ["sleep"]);
        assert!(!is_alive(&ended.output), "{}", ended.output);
    }
}
