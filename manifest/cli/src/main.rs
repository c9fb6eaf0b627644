//! The `parafovea` command.

/// Writes a line to standard error. A reader that has gone, or a full disk, is no reason to panic.
macro_rules! complain {
    ($($arguments:tt)*) => {{
        use std::io::Write as _;
        drop(writeln!(std::io::stderr(), $($arguments)*));
    }};
}

mod config;
mod doctor;
mod gaze;
mod generate;
mod install;
mod profile;
mod run;
mod status;

use clap::{CommandFactory, Parser, Subcommand};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::ffi::OsString;
use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

/// Foveated rendering for existing OpenXR applications
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Install the layer for the current user, or for all users with --system; applications use it only on request
    Install {
        /// Library to install [default: libparafovea.so beside this program, in ../lib or in ../lib/parafovea]
        #[arg(long, value_name = "FILE")]
        library: Option<PathBuf>,
        #[command(flatten)]
        scope: install::Scope,
    },
    /// Remove the installed layer, and keep configuration and logs
    Uninstall {
        #[command(flatten)]
        scope: install::Scope,
    },
    /// Run an application with the layer
    Run {
        /// Application and its arguments
        #[arg(trailing_var_arg = true, required = true, value_name = "COMMAND")]
        command: Vec<OsString>,
    },
    /// Check the installation and suggest fixes
    Doctor {
        /// Application to check, by OpenXR application name or executable name
        #[arg(value_name = "APPLICATION")]
        application: Option<String>,
        #[command(flatten)]
        options: doctor::Options,
    },
    /// Show the state of the layer in running applications, updated every second
    Status {
        #[command(flatten)]
        options: status::Options,
    },
    /// Show source and quality of the gaze in running applications, updated every second; measure and correct the eye tracker
    Gaze {
        #[command(flatten)]
        options: gaze::Options,
    },
    /// List, show, change and check configuration files
    #[command(subcommand)]
    Profile(profile::Command),
    /// Print shell completions, the manual page or the reference of options
    Generate {
        /// Kind of output
        what: generate::What,
    },
    /// Check a configuration file, or print the default one
    #[command(subcommand)]
    Config(ConfigCommand),
}

#[derive(Subcommand)]
enum ConfigCommand {
    /// Check a configuration file
    Validate {
        /// Path of the file
        file: PathBuf,
    },
    /// Print a commented configuration file with every option and its default
    Default,
}

/// Standard output could not be written to.
static HAS_FAILED: AtomicBool = AtomicBool::new(false);

fn main() -> ExitCode {
    let code = perform();
    if HAS_FAILED.load(Ordering::Relaxed) { ExitCode::FAILURE } else { code }
}

fn perform() -> ExitCode {
    match Arguments::parse().command {
        Command::Install { library, scope } => install::install(library, scope),
        Command::Uninstall { scope } => install::uninstall(scope),
        Command::Run { command } => run::run(&command),
        Command::Doctor { application, options } => doctor::doctor(application, options),
        Command::Status { options } => status::status(options),
        Command::Gaze { options } => gaze::gaze(options),
        Command::Profile(command) => profile::profile(&command),
        Command::Generate { what } => generate::generate(what, &mut Arguments::command()),
        Command::Config(ConfigCommand::Validate { file }) => config::validate(&file),
        Command::Config(ConfigCommand::Default) => config::default(),
    }
}

/// Writes to standard output. A reader that ends early, as in `| head`, is not a failure; a full disk is one of the whole command,
/// reported once.
fn print(text: &str) {
    can_print(text);
}

/// As [`print`]; returns whether more can follow.
fn can_print(text: &str) -> bool {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Ok(()) => true,
        Err(error) => {
            if error.kind() != ErrorKind::BrokenPipe && !HAS_FAILED.swap(true, Ordering::Relaxed) {
                complain!("parafovea: standard output: {error}");
            }
            false
        }
    }
}

/// Waits for `time`, at most until the reader of standard output has gone, which a command without output would not notice; returns whether it
/// has gone.
fn has_lost_reader(time: Duration) -> bool {
    let stdout = io::stdout();
    // No event is asked for: a pipe without a reader is one in any case.
    let mut watched = [PollFd::new(&stdout, PollFlags::empty())];
    let until = Timespec::try_from(time).ok();
    match poll(&mut watched, until.as_ref()) {
        Ok(0) => false,
        Ok(_) => true,
        Err(_) => {
            sleep(time);
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn arguments_after_run_are_the_applications() {
        for arguments in [
            &["parafovea", "run", "--", "game", "--help", "-v"][..],
            &["parafovea", "run", "game", "--help", "-v"],
        ] {
            match Arguments::try_parse_from(arguments).map(|arguments| arguments.command) {
                Ok(Command::Run { command }) => assert_eq!(command, ["game", "--help", "-v"]),
                _ => panic!("{arguments:?}"),
            }
        }
    }
}
