//! A build of some programs, with its progress.

use crate::meter::Meter;
use std::io::{BufReader, Read};
use std::process::{Command, Stdio};

/// Runs a cargo command that builds, and shows its progress; its warnings and errors go to standard error.
///
/// # Errors
/// A command that cannot be started, or that fails.
pub fn build_with_progress(step: &str, cargo: &mut Command) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{step}: {error}");
    // Cargo draws its bar over and over, for terminals of that width.
    cargo.env("CARGO_TERM_PROGRESS_WHEN", "always").env("CARGO_TERM_PROGRESS_WIDTH", "200");
    let mut child = cargo.stderr(Stdio::piped()).spawn().map_err(failed)?;
    if let Some(output) = child.stderr.take() {
        follow(&mut Meter::new(step), BufReader::new(output)).map_err(failed)?;
    }
    let status = child.wait().map_err(failed)?;
    if status.success() { Ok(()) } else { Err(format!("{step} ({status})")) }
}

fn follow(meter: &mut Meter, mut output: impl Read) -> std::io::Result<()> {
    let mut line = Vec::new();
    loop {
        line.clear();
        let mut byte = [0];
        // The bar ends with a carriage return, and no line end.
        let is_end = loop {
            match output.read(&mut byte)? {
                0 => break true,
                _ if matches!(byte[0], b'\r' | b'\n') => break false,
                _ => line.push(byte[0]),
            }
        };
        let text = String::from_utf8_lossy(&line).replace("\x1b[K", "");
        match progress(&text) {
            Some(Progress::Bar(done, crates)) => meter.show(done, crates),
            Some(Progress::Note) => {}
            None if text.trim().is_empty() => {}
            None => {
                meter.end();
                eprintln!("{text}");
            }
        }
        if is_end {
            meter.end();
            return Ok(());
        }
    }
}

/// A line of cargo about its progress.
#[derive(Debug, PartialEq)]
enum Progress<'a> {
    /// The share of crates that are built, and those in hand.
    Bar(f64, &'a str),
    /// One crate begun or done: the bar has it too.
    Note,
}

/// None for anything else, such as warnings and errors.
fn progress(line: &str) -> Option<Progress<'_>> {
    let line = line.trim();
    if line.starts_with("Building [") {
        let (counts, crates) = line.split_once("] ")?.1.split_once(':').unwrap_or_default();
        let (done, all) = counts.split_once('/')?;
        let (done, all): (f64, f64) = (done.trim().parse().ok()?, all.trim().parse().ok()?);
        return Some(Progress::Bar(done / all.max(1.0), crates.trim()));
    }
    let notes = ["Compiling ", "Fresh ", "Finished ", "Downloaded ", "Downloading ", "Locking ", "Updating "];
    notes.iter().any(|note| line.starts_with(note)).then_some(Progress::Note)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_is_told_from_messages() {
        let bar = "    Building [====>      ] 12/48: naga, wgpu-core(build)";
        assert_eq!(progress(bar), Some(Progress::Bar(0.25, "naga, wgpu-core(build)")));
        assert_eq!(progress("   Compiling naga v30.0.1"), Some(Progress::Note));
        for message in ["error[E0308]: mismatched types", "warning: unused", "  --> src/main.rs:3:5"] {
            assert_eq!(progress(message), None, "{message}");
        }
    }
}
