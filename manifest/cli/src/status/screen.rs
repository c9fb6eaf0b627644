//! Live text on a screen of limited size.

use std::io::{self, IsTerminal};
use std::os::fd::AsFd;
use std::process::{Command, Stdio};

/// Back to the top left corner, and all below it cleared.
const CLEAR: &str = "\x1b[H\x1b[2J";

/// Size of a screen, in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Lines.
    rows: usize,
    /// Characters in a line.
    columns: usize,
}

/// The text in the place of all that the terminal shows, as far as it fits; without a terminal, the text alone.
pub fn live(text: String) -> String {
    if !io::stdout().is_terminal() {
        return text;
    }
    let fitted = match size() {
        Some(size) => fit(&text, size),
        None => text,
    };
    format!("{CLEAR}{fitted}")
}

/// The size of the terminal at standard output, by stty(1): it may change at any time.
fn size() -> Option<Size> {
    let terminal = io::stdout().as_fd().try_clone_to_owned().ok()?;
    let mut stty = Command::new("stty");
    let output = stty.arg("size").stdin(Stdio::from(terminal)).stderr(Stdio::null()).output().ok()?;
    parse(&String::from_utf8(output.stdout).ok()?)
}

/// The output of `stty size`. Zero: not known.
fn parse(output: &str) -> Option<Size> {
    let (rows, columns) = output.trim().split_once(' ')?;
    let size = Size { rows: rows.parse().ok()?, columns: columns.parse().ok()? };
    (size.rows > 1 && size.columns > 0).then_some(size)
}

/// The first lines of `text` that fit, each cut to the width, so that nothing scrolls away; the last one counts those left out.
fn fit(text: &str, size: Size) -> String {
    // The cursor rests in the last row.
    let rows = size.rows.saturating_sub(1);
    let lines: Vec<&str> = text.lines().collect();
    let shown = if lines.len() > rows { rows.saturating_sub(1) } else { lines.len() };
    let left = lines.len() - shown;
    let more = (left > 0).then(|| format!("... {left} more: --once"));
    let shown = lines.iter().take(shown).copied().chain(more.as_deref());
    shown.map(|line| line.chars().take(size.columns).chain(['\n']).collect::<String>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_cut_to_the_screen() {
        let fit = |text: &str, rows, columns| fit(text, Size { rows, columns });
        let text = "game\n  state\n  gaze\n  decisions é\n";
        assert_eq!(fit(text, 5, 20), text, "the cursor has a row of its own");
        assert_eq!(fit(text, 4, 20), "game\n  state\n... 2 more: --once\n");
        assert_eq!(fit(text, 2, 20), "... 4 more: --once\n");
        assert_eq!(fit(text, 9, 13), text);
        assert_eq!(fit(text, 9, 12), text.replace(" é", " "));
        assert_eq!(fit("", 9, 9), "");
        for rows in 0..9 {
            assert!(fit(text, rows, 3).lines().count() <= rows.saturating_sub(1).max(1), "{rows}");
        }
    }

    #[test]
    fn a_terminal_without_a_size_is_not_cut_to() {
        assert_eq!(parse("24 80\n"), Some(Size { rows: 24, columns: 80 }));
        for unknown in ["0 0\n", "1 80", "24 0", "", "24", "a b"] {
            assert_eq!(parse(unknown), None, "{unknown}");
        }
    }
}
