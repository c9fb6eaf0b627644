//! Progress of a long step and its remaining time, as one line on standard error.

use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Delay before the first line of a step.
const SILENCE: Duration = Duration::from_secs(3);

/// Between two lines where standard error is a file or a pipe: a log of a build is not to be full of them.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// Between two changes of the line on a terminal.
const BETWEEN_CHANGES: Duration = Duration::from_millis(250);

/// Shows the progress of one step.
pub struct Meter {
    step: String,
    start: Instant,
    shown: Option<Instant>,
    on_terminal: bool,
}

impl Meter {
    /// A step that starts now.
    pub fn new(step: &str) -> Self {
        Self {
            step: step.to_owned(),
            start: Instant::now(),
            shown: None,
            on_terminal: stderr().is_terminal(),
        }
    }

    /// Takes the part of the step that is done, 0..=1, and the work in hand.
    pub fn show(&mut self, done: f64, at_work_on: &str) {
        let rest = if self.on_terminal { BETWEEN_CHANGES } else { BETWEEN_LINES };
        let is_due = self.shown.map_or(self.start.elapsed() >= SILENCE, |shown| shown.elapsed() >= rest);
        if !is_due {
            return;
        }
        self.shown = Some(Instant::now());
        let line = line(&self.step, done, self.start.elapsed().as_secs_f64(), at_work_on);
        match self.on_terminal {
            // One line of a narrow terminal: a wrapped line could not be replaced.
            true => eprint!("\r\x1b[K{}", line.chars().take(79).collect::<String>()),
            false => eprintln!("{line}"),
        }
    }

    /// Clears the line.
    pub fn end(&self) {
        if self.on_terminal && self.shown.is_some() {
            eprint!("\r\x1b[K");
        }
    }
}

/// The line after so many seconds. The rest takes as long for its size as the part that is done.
fn line(step: &str, done: f64, elapsed_s: f64, at_work_on: &str) -> String {
    let done = done.clamp(0.0, 1.0);
    let left = match done {
        0.0 => String::new(),
        _ => match elapsed_s * (1.0 - done) / done {
            left_s if left_s < 90.0 => format!(", about {left_s:.0} s left"),
            left_s => format!(", about {:.0} min left", (left_s / 60.0).ceil()),
        },
    };
    format!("{step}: {:.0} %{left}: {at_work_on}", (100.0 * done).floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_is_estimated() {
        assert_eq!(line("build", 0.0, 5.0, "serde"), "build: 0 %: serde");
        assert_eq!(line("build", 0.5, 60.0, "naga"), "build: 50 %, about 60 s left: naga");
        assert_eq!(line("build", 0.1, 60.0, "naga"), "build: 10 %, about 9 min left: naga");
        assert_eq!(line("build", 2.0, 60.0, "naga"), "build: 100 %, about 0 s left: naga");
    }
}
