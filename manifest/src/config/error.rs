//! Errors of a configuration, one line each.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use crate::options::Config;

/// One thing that is wrong. `Display` is one line, without the file's name; [`ConfigErrors`] adds that.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// A directory, FIFO, socket or device.
    #[error("is not a regular file")]
    NotAFile,
    /// More than [`MAX_BYTES`](super::MAX_BYTES).
    #[error("is larger than the limit of {limit} bytes")]
    TooLarge {
        /// The most that is read.
        limit: u64,
    },
    /// Not UTF-8.
    #[error("line {line}: not UTF-8 text")]
    NotText {
        /// The line of the first wrong byte, from 1.
        line: usize,
    },
    /// Not TOML; also a key that is set twice.
    #[error("line {line}: not valid TOML: {message}{}", at(.found))]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The parser's message.
        message: String,
        /// The text that the message refers to.
        found: Option<String>,
    },
    /// A key that is not in the table of options.
    #[error("line {line}: unknown key {key}{}", did_you_mean(.suggestion))]
    UnknownKey {
        /// The line, from 1.
        line: usize,
        /// The key as it was written, with its section.
        key: String,
        /// The option whose key is nearest to it.
        suggestion: Option<String>,
    },
    /// A value of the wrong type, out of range or not among the choices.
    #[error("line {line}: {key} = {value} is not allowed{}; allowed: {allowed}", at(.reason))]
    NotAllowed {
        /// The line, from 1.
        line: usize,
        /// The option's key.
        key: String,
        /// The value as it was written.
        value: String,
        /// The reason against it, if the allowed values do not tell it.
        reason: Option<String>,
        /// The values that the option takes.
        allowed: String,
    },
    /// The plateau of full colour is not smaller than the angle at which the curves end.
    #[error(
        "line {line}: chroma.plateau_deg = {plateau} and chroma.max_eccentricity_deg = {max}: \
         plateau_deg must be less than max_eccentricity_deg"
    )]
    Misordered {
        /// The line, from 1, of the later of the two.
        line: usize,
        /// `chroma.plateau_deg`, degrees.
        plateau: f32,
        /// `chroma.max_eccentricity_deg`, degrees.
        max: f32,
    },
    /// There are more errors than are listed.
    #[error("{count} more errors")]
    More {
        /// Number of errors beyond those listed.
        count: usize,
    },
}

fn at(found: &Option<String>) -> String {
    found.as_ref().map(|found| format!(": {found}")).unwrap_or_default()
}

fn did_you_mean(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map(|key| format!("; did you mean {key}?")).unwrap_or_default()
}

/// The longest piece of a file that an error repeats, in characters.
const MAX_QUOTED: usize = 80;

/// `text` as a piece of one line: control characters escaped, cut where it is long.
pub(super) fn one_line(text: &str) -> String {
    let mut line = String::new();
    for (count, character) in text.chars().enumerate() {
        if count == MAX_QUOTED {
            line.push('…');
            break;
        }
        if character.is_control() || matches!(character, '\u{2028}' | '\u{2029}') {
            line.extend(character.escape_default());
        } else {
            line.push(character);
        }
    }
    line
}

/// Everything that is wrong with one file. `Display` has a line for each, which starts with the file's name.
#[derive(Debug)]
pub struct ConfigErrors {
    path: PathBuf,
    errors: Vec<ConfigError>,
    turns_off: bool,
}

impl ConfigErrors {
    pub(super) fn new(path: &Path, errors: Vec<ConfigError>) -> Self {
        Self { path: path.to_owned(), errors, turns_off: false }
    }

    /// As [`Self::new`]; `turns_off`: the file has `enabled = false`.
    pub(super) fn of_table(path: &Path, errors: Vec<ConfigError>, turns_off: bool) -> Self {
        Self { path: path.to_owned(), errors, turns_off }
    }

    /// Whether the file has `enabled = false` among its errors. The off switch of a game that crashes with the layer has to work with any other
    /// key, such as one of a later version.
    pub fn turns_off(&self) -> bool {
        self.turns_off
    }

    /// The configuration of an application that starts with this file: the defaults, turned off if the file does that.
    pub fn at_start(&self) -> Config {
        Config { enabled: !self.turns_off, ..Config::default() }
    }

    /// The lines of the message, one for each error.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        let file = self.path.display().to_string().replace(char::is_control, "_");
        self.errors.iter().map(move |error| format!("{file}: {error}"))
    }

    /// The errors, in the order of the file.
    pub fn errors(&self) -> &[ConfigError] {
        &self.errors
    }
}

impl fmt::Display for ConfigErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, line) in self.lines().enumerate() {
            write!(f, "{}{line}", if index == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

impl std::error::Error for ConfigErrors {}
