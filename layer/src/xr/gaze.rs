//! Where a session's gaze comes from, as `gaze.source` says: the eye tracker through actions ([`super::actions`]), or a file.
//! Another way to ask a tracker would be one more arm of [`SessionGaze::look`].
//!
//! What a user asked for by name is recorded here.

use super::session::Session;
use crate::config::{Config, FilePath, GazeSource};
use crate::inputs::gaze::recording::Recording;
use crate::inputs::gaze::script::GazeScript;
use crate::planning::Look;
use openxr_sys as xr;
use std::fs::OpenOptions;
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The largest file that is read: a day at 100 Hz.
const MOST_BYTES: u64 = 1 << 28;

/// The gaze of a session, beside its actions.
#[derive(Debug, Default)]
pub struct SessionGaze(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    file: FilePath,
    script: Option<Arc<GazeScript>>,
    record: FilePath,
    recording: Option<Recording>,
    /// When the gaze was asked for first: the 0 of files.
    begin_ns: Option<i64>,
}

impl SessionGaze {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens the files that the configuration names, where these are others than before. Waits for the disk.
    pub fn open_files(&self, config: &Config) {
        let (file, record) = (wanted_file(config), config.gaze.record);
        // Whoever sees the change first opens the file, without the lock.
        let (file_is_new, record_is_new, before) = {
            let mut state = self.state();
            let is_new = (state.file != file, state.record != record);
            (state.file, state.record) = (file, record);
            let before = if is_new.1 { state.recording.take() } else { None };
            (is_new.0, is_new.1, before)
        };
        // It is written to its end.
        drop(before);
        if file_is_new {
            let script = file.path().and_then(read).map(Arc::new);
            self.state().script = script;
        }
        if record_is_new {
            let recording = record.path().and_then(record_to);
            self.state().recording = recording;
        }
    }

    /// Whether there is a gaze to be had, as far as is known.
    pub fn may_have_gaze(&self, session: &Session, config: &Config) -> bool {
        match config.gaze.source {
            GazeSource::Eyes => session.actions.may_have_gaze(),
            GazeSource::Centre => true,
            GazeSource::File => self.state().script.is_some(),
        }
    }

    /// Where the eyes look at `time`. Locates on this thread.
    pub fn look(&self, session: &Session, config: &Config, time: xr::Time) -> Look {
        let time_ns = time.as_nanos();
        let look = match config.gaze.source {
            GazeSource::Eyes => session.actions.look(session, time),
            GazeSource::Centre => Look::NoTracker,
            GazeSource::File => self.scripted(time_ns),
        };
        let mut state = self.state();
        if state.recording.is_some() {
            let begin = *state.begin_ns.get_or_insert(time_ns);
            if let Some(recording) = &mut state.recording {
                match look {
                    Look::NoTracker => {}
                    Look::Unseen => recording.note(seconds_since(begin, time_ns), None),
                    Look::At { direction, sampled_ns } => {
                        let at = if sampled_ns > 0 { sampled_ns } else { time_ns };
                        recording.note(seconds_since(begin, at), Some(direction));
                    }
                }
            }
        }
        look
    }

    fn scripted(&self, time_ns: i64) -> Look {
        let (script, begin) = {
            let mut state = self.state();
            let begin = *state.begin_ns.get_or_insert(time_ns);
            let Some(script) = state.script.clone() else { return Look::NoTracker };
            (script, begin)
        };
        match script.at(seconds_since(begin, time_ns)) {
            Some(direction) => Look::At { direction, sampled_ns: time_ns },
            None => Look::Unseen,
        }
    }
}

fn seconds_since(begin_ns: i64, time_ns: i64) -> f64 {
    time_ns.saturating_sub(begin_ns) as f64 * 1e-9
}

fn wanted_file(config: &Config) -> FilePath {
    if config.gaze.source == GazeSource::File { config.gaze.file } else { FilePath::NONE }
}

/// The gaze of a file; the log says why where there is none.
fn read(path: &Path) -> Option<GazeScript> {
    let read = || -> Result<GazeScript, String> {
        // O_NONBLOCK: opening a FIFO would else wait for somebody to write to it.
        let file = OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK).open(path);
        let file = file.map_err(|error| error.to_string())?;
        if !file.metadata().is_ok_and(|metadata| metadata.is_file()) {
            return Err("not a regular file".to_owned());
        }
        let mut text = String::new();
        file.take(MOST_BYTES).read_to_string(&mut text).map_err(|error| error.to_string())?;
        text.parse().map_err(|error: crate::inputs::gaze::script::GazeScriptError| error.to_string())
    };
    read().inspect_err(|reason| tracing::error!("no gaze: gaze.file = {path:?}: {reason}")).ok()
}

fn record_to(path: &Path) -> Option<Recording> {
    Recording::create(path)
        .inspect(|_| tracing::info!("recording the gaze to the file in gaze.record"))
        .inspect_err(|error| tracing::error!("no recording of the gaze: gaze.record = {path:?}: {error}"))
        .ok()
}
