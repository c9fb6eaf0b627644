//! The log of this process: one line for each event, in `$XDG_STATE_HOME/parafovea/<executable>.log`.
//!
//! A file, because Proton discards standard error. Failures here are ignored: logging never stops the application, and never panics. Gaze
//! directions are never logged.

mod file;

use crate::abi::local_time::LocalTime;
use crate::abi::{Enablement, executable};
use file::BoundedFile;
use parafovea_manifest::options::LogLevel;
use parafovea_manifest::paths::Environment;
use std::fmt::{self, Write};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, Once, PoisonError};
use std::time::SystemTime;
use tracing::field::{Field, Visit};
use tracing::metadata::LevelFilter;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};

/// Target of the events that name an application. They are logged at every level: the command `parafovea` learns from them that two names belong
/// together.
pub const NAMES: &str = "parafovea::names";

/// Target of the event of an accepted edit. Warnings and errors after it are logged again, as they may concern the edit.
pub const EDIT: &str = "parafovea::edit";

/// [`LogLevel`] as a number, for [`set_level`].
static LEVEL: AtomicU8 = AtomicU8::new(LogLevel::Info as u8);

/// Opens the log, the first time it is called in a process; each half calls it first. A process with elevated
/// rights gets none: its environment is not to be trusted with a place for files.
pub fn start() {
    static STARTED: Once = Once::new();
    STARTED.call_once(|| {
        let environment = Environment::of_process(Enablement::of_process() == Enablement::Elevated);
        let Some(file) = environment.log_file(&executable()).and_then(|path| BoundedFile::open(&path)) else {
            return;
        };
        // Fails where this process has a subscriber already: a test that links us as a Rust library.
        let _ =
            tracing::subscriber::set_global_default(Log { file: Mutex::new(file), logged: Mutex::default() });
    });
}

/// From now on, events up to this level are written.
pub fn set_level(level: LogLevel) {
    if LEVEL.swap(level as u8, Ordering::Relaxed) != level as u8 {
        tracing::callsite::rebuild_interest_cache();
    }
}

fn max_level() -> LevelFilter {
    let level = LEVEL.load(Ordering::Relaxed);
    match level {
        _ if level == LogLevel::Error as u8 => LevelFilter::ERROR,
        _ if level == LogLevel::Warn as u8 => LevelFilter::WARN,
        _ if level == LogLevel::Debug as u8 => LevelFilter::DEBUG,
        _ => LevelFilter::INFO,
    }
}

/// Writes events to the file; spans are not used in this library.
struct Log {
    file: Mutex<BoundedFile>,
    logged: Mutex<LoggedTexts>,
}

/// Warnings and errors in the file since the last edit of the configuration: a failure in every frame is logged once.
#[derive(Default)]
struct LoggedTexts(Vec<u64>);

impl LoggedTexts {
    /// So many are remembered; those after them are logged every time.
    const MOST: usize = 256;

    /// Whether a text was not logged before.
    fn is_new(&mut self, text: &str) -> bool {
        let mut hasher = DefaultHasher::new();
        text.hash(&mut hasher);
        let hash = hasher.finish();
        if self.0.contains(&hash) {
            return false;
        }
        if self.0.len() < Self::MOST {
            self.0.push(hash);
        }
        true
    }
}

impl Subscriber for Log {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event()
            && (*metadata.level() <= max_level() || [NAMES, EDIT].contains(&metadata.target()))
    }

    fn max_level_hint(&self) -> Option<LevelFilter> {
        Some(max_level().max(LevelFilter::INFO))
    }

    fn event(&self, event: &Event<'_>) {
        let metadata = event.metadata();
        if metadata.target() == EDIT {
            *self.logged.lock().unwrap_or_else(PoisonError::into_inner) = LoggedTexts::default();
            if *metadata.level() > max_level() {
                return;
            }
        }
        let now = LocalTime::at(SystemTime::now());
        let mut line = Line::new(&now, *metadata.level());
        let start = line.0.len();
        event.record(&mut line);
        let is_warning = *metadata.level() <= Level::WARN;
        let text = line.0.get(start..).unwrap_or_default();
        if is_warning && !self.logged.lock().unwrap_or_else(PoisonError::into_inner).is_new(text) {
            return;
        }
        self.file.lock().unwrap_or_else(PoisonError::into_inner).append(&line.finish());
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// One line as it is put together: local time, process, level, message, other fields.
struct Line(String);

impl Line {
    fn new(now: &dyn fmt::Display, level: Level) -> Self {
        let mut line = String::with_capacity(128);
        // Writing to a string cannot fail.
        let _ = write!(line, "{now} {} {level:5} ", std::process::id());
        Self(line)
    }

    fn finish(self) -> String {
        // Names that an application chose may hold anything; an event is one line.
        let mut line = self.0.replace(|character: char| character.is_control(), " ");
        line.push('\n');
        line
    }
}

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        let _ = match field.name() {
            "message" => write!(self.0, "{value:?}"),
            name => write!(self.0, " {name}={value:?}"),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_told_once() {
        let mut logged = LoggedTexts::default();
        assert_eq!(
            ["a", "b", "a", "b", "c"].map(|text| logged.is_new(text)),
            [true, true, false, false, true]
        );
        for number in 0..2 * LoggedTexts::MOST {
            logged.is_new(&number.to_string());
        }
        assert_eq!(logged.0.len(), LoggedTexts::MOST);
        assert!(!logged.is_new("a"));
    }

    #[test]
    fn an_event_is_one_line_with_time_and_level() {
        let mut line = Line::new(&"1970-01-01T01:00:01.500+01:00", Level::WARN);
        line.0.push_str("a\nb");
        let text = line.finish();
        assert_eq!(text, format!("1970-01-01T01:00:01.500+01:00 {} WARN  a b\n", std::process::id()));
    }

    #[test]
    fn names_are_logged_at_every_level_and_errors_again_after_an_edit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("game.log");
        let file = Mutex::new(BoundedFile::open(&path).unwrap());
        tracing::subscriber::with_default(Log { file, logged: Mutex::default() }, || {
            set_level(LogLevel::Error);
            tracing::info!(target: NAMES, "OpenXR instance of \"Game\"");
            for _ in 0..2 {
                tracing::error!("wrong");
                tracing::info!("seen");
            }
            tracing::info!(target: EDIT, "configuration changed");
            tracing::error!("wrong");
            set_level(LogLevel::Info);
            tracing::info!(target: EDIT, "configuration changed");
        });
        let log = std::fs::read_to_string(&path).unwrap();
        let texts = log.lines().map(|line| line.splitn(3, ' ').nth(2).unwrap());
        let names = "INFO  OpenXR instance of \"Game\"";
        let expected = [names, "ERROR wrong", "ERROR wrong", "INFO  configuration changed"];
        assert_eq!(texts.collect::<Vec<_>>(), expected);
    }
}
