//! Running commands one after the other, with their times, stopping at the first that fails.

use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

/// The folder of this program: `target/debug`, or the one of the profile and `CARGO_TARGET_DIR`.
pub fn profile_folder() -> Result<PathBuf, String> {
    let own =
        std::env::current_exe().map_err(|error| format!("cannot find this program's own path: {error}"))?;
    own.parent().map(PathBuf::from).ok_or_else(|| format!("{} has no folder", own.display()))
}

/// The cargo that started us.
pub fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Completed steps, each with its duration.
#[derive(Default)]
pub struct Steps {
    done: Vec<(String, Duration)>,
}

impl Steps {
    /// Runs one command, its output going where ours goes; an error names the step and how it ended.
    pub fn run(&mut self, name: &str, command: &mut Command) -> Result<(), String> {
        let status = self.time(name, || command.status());
        let status = status.map_err(|error| format!("{name}: cannot start: {error}"))?;
        if status.success() { Ok(()) } else { Err(format!("{name} ({status})")) }
    }

    /// Does one step that is not a command.
    pub fn time<T>(&mut self, name: &str, step: impl FnOnce() -> T) -> T {
        eprintln!("cargo dev: {name}");
        let start = Instant::now();
        let result = step();
        self.done.push((name.to_owned(), start.elapsed()));
        result
    }

    /// Prints the duration of each step.
    pub fn summary(&self) {
        eprintln!("cargo dev: times");
        for (name, time) in &self.done {
            eprintln!("  {:>7.1} s  {name}", time.as_secs_f64());
        }
        let total: Duration = self.done.iter().map(|(_, time)| *time).sum();
        eprintln!("  {:>7.1} s  in total", total.as_secs_f64());
    }
}
