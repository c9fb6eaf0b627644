//! `parafovea generate`: for packages, and for shells that are set up by hand.

use clap::{Command, ValueEnum};
use clap_complete::Shell;
use clap_mangen::Man;
use std::io::{self, Write};
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
                complain!("parafovea: {error}");
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

/// One page for the command and all subcommands, each with its options.
fn manual(command: &mut Command, text: &mut Vec<u8>) -> io::Result<()> {
    // Subcommands get their whole names.
    command.build();
    Man::new(command.clone()).render(text)?;
    subcommands(command, text)
}

/// A section for each visible subcommand, with its usage, description and options as subsections.
fn subcommands(command: &Command, text: &mut Vec<u8>) -> io::Result<()> {
    for command in
        command.get_subcommands().filter(|command| !command.is_hide_set() && command.get_name() != "help")
    {
        let page = Man::new(command.clone());
        let mut parts = Vec::new();
        page.render_synopsis_section(&mut parts)?;
        page.render_description_section(&mut parts)?;
        if command.get_arguments().any(|argument| !argument.is_hide_set()) {
            page.render_options_section(&mut parts)?;
        }
        let name = command.get_bin_name().unwrap_or(command.get_name());
        writeln!(text, ".SH \"{}\"", name.to_uppercase())?;
        text.extend(String::from_utf8_lossy(&parts).replace(".SH ", ".SS ").into_bytes());
        subcommands(command, text)?;
    }
    Ok(())
}
