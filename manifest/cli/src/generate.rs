//! `parafovea generate`: for packages, and for shells that are set up by hand.

use clap::{Command, ValueEnum};
use clap_complete::Shell;
use std::process::ExitCode;

/// Kind of output.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum What {
    /// Completions for bash
    Bash,
    /// Completions for zsh
    Zsh,
    /// Completions for fish
    Fish,
    /// Manual page, for section 1
    Man,
    /// Reference of all options, in Markdown
    Options,
}

/// Prints it.
pub fn generate(what: What, command: &mut Command) -> ExitCode {
    let mut text = Vec::new();
    let shell = match what {
        What::Bash => Shell::Bash,
        What::Zsh => Shell::Zsh,
        What::Fish => Shell::Fish,
        What::Options => {
            crate::print(&parafovea_manifest::options::reference());
            return ExitCode::SUCCESS;
        }
        What::Man => {
            if let Err(error) = manual(command, &mut text) {
                eprintln!("parafovea: {error}");
                return ExitCode::FAILURE;
            }
            crate::print(&String::from_utf8_lossy(&text));
            return ExitCode::SUCCESS;
        }
    };
    clap_complete::generate(shell, command, "parafovea", &mut text);
    crate::print(&String::from_utf8_lossy(&text));
    ExitCode::SUCCESS
}

/// One page with every subcommand.
fn manual(command: &Command, text: &mut Vec<u8>) -> std::io::Result<()> {
    let page = clap_mangen::Man::new(command.clone());
    page.render(text)
}
