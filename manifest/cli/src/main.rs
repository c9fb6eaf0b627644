//! The `parafovea` command.

mod config;
mod fit;
mod install;
mod run;

use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Makes OpenXR applications render less where the eye does not see it.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Install the layer for this user; applications do not use it until asked to
    Install {
        /// The library to install [default: libparafovea.so beside this program or in ../lib]
        #[arg(long, value_name = "FILE")]
        library: Option<PathBuf>,
        /// Only say what would be done
        #[arg(long)]
        dry_run: bool,
    },
    /// Remove what install installed; configuration and logs stay
    Uninstall {
        /// Only say what would be done
        #[arg(long)]
        dry_run: bool,
    },
    /// Run an application with the layer
    Run {
        /// The application and its arguments
        #[arg(trailing_var_arg = true, required = true, value_name = "COMMAND")]
        command: Vec<OsString>,
    },
    /// Fit the model of sound and vision to the scores of a study of your own, and print its coefficients
    Fit {
        /// Comma-separated text with the columns loudness_lufs (or gamma_ld), frequency_khz (or gamma_fq), gamma_vis and mu
        study: PathBuf,
    },
    /// Check or write configuration files
    #[command(subcommand)]
    Config(ConfigCommand),
}

#[derive(Subcommand)]
enum ConfigCommand {
    /// Say what is wrong with a configuration file
    Validate {
        /// The file
        file: PathBuf,
    },
    /// Print a configuration file with every option, its meaning and its default
    Default,
}

fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::Install { library, dry_run } => install::install(library, dry_run),
        Command::Uninstall { dry_run } => install::uninstall(dry_run),
        Command::Run { command } => run::run(&command),
        Command::Fit { study } => fit::fit(&study),
        Command::Config(ConfigCommand::Validate { file }) => config::validate(&file),
        Command::Config(ConfigCommand::Default) => config::default(),
    }
}

/// Writes to standard output. That nobody reads it, as in `| head`, is no failure.
fn print(text: &str) {
    let _ = io::stdout().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn what_follows_run_is_the_applications_own() {
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
