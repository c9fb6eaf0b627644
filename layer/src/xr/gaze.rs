//! Source of a session's gaze, selected by `gaze.source`: the eye tracker through actions ([`super::actions`]), OSC packets, or a
//! file. Another way to ask a tracker would be one more arm of [`SessionGaze::look`].
//!
//! The gaze is recorded here, too, if `gaze.record` names a file.

use super::session::Session;
use crate::config::{Config, FilePath, GazeSource};
use crate::inputs::gaze::auto::{ActiveGazeSource, Auto, PacketDelay};
use crate::inputs::gaze::correction::SessionGazeCorrection;
use crate::inputs::gaze::osc::{Listener, OscSource};
use crate::inputs::gaze::recording::{Recording, seconds_since};
use crate::inputs::gaze::script::GazeScript;
use crate::inputs::gaze::{Look, degrees, turned};
use crate::status::StatusSnapshot;
use glam::Vec3;
use openxr_sys as xr;
use parafovea_core::gaze::{GazeDelay, GazePhase, TimedGaze};
use std::fs::OpenOptions;
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// The largest file that is read: a day at 100 Hz.
const MOST_BYTES: u64 = 1 << 28;

/// The gaze of a session, beside its actions.
#[derive(Debug, Default)]
pub struct SessionGaze {
    state: Mutex<State>,
    correction: Arc<SessionGazeCorrection>,
}

#[derive(Debug, Default)]
struct State {
    file: FilePath,
    script: Option<Arc<GazeScript>>,
    record: FilePath,
    recording: Option<Recording>,
    /// Time at which the gaze was asked for first: the 0 of files.
    begin_ns: Option<i64>,
    osc: OscSource,
    auto: Auto,
    /// Of packets, by the runtime's eye tracker.
    delay: GazeDelay,
    /// Source of the newest gaze.
    active_source: ActiveGazeSource,
}

impl SessionGaze {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins without a gaze; the gaze of eye trackers gets the correction.
    pub fn new(correction: Arc<SessionGazeCorrection>) -> Self {
        Self { state: Mutex::default(), correction }
    }

    /// Opens the files and the port that the configuration names, where these are others than before. Waits for the disk.
    /// `may_have_eyes`: the runtime may have an eye tracker.
    pub fn open(&self, config: &Config, may_have_eyes: bool, now: Instant) {
        self.open_port(config, may_have_eyes, now);
        let (file, record) = (wanted_file(config), config.gaze.record);
        // The first thread that sees the change opens the file, without the lock.
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

    /// Receives OSC packets, or receives none any more, as the configuration and the runtime's eye tracker ask for.
    fn open_port(&self, config: &Config, may_have_eyes: bool, now: Instant) {
        let address = config.gaze.osc_listen.socket();
        let (is_due, ended) = {
            let mut state = self.state();
            let is_wanted = match config.gaze.source {
                GazeSource::Osc => true,
                // A port is opened only if nothing else has a gaze; then it stays.
                GazeSource::Auto => !may_have_eyes || state.auto.misses_eyes() || state.osc.is_open(),
                GazeSource::Eyes | GazeSource::Centre | GazeSource::File => false,
            };
            state.osc.want(is_wanted.then_some(address), config.gaze.osc_scale_deg, now)
        };
        // It waits for the thread, without the lock.
        drop(ended);
        if !is_due {
            return;
        }
        let listener = Listener::begin(address, config.gaze.osc_scale_deg);
        let state = listener.as_ref().map(drop).map_err(ToString::to_string);
        let has_changed = self.state().osc.opened(address, listener, now);
        match state {
            Ok(()) if config.gaze.osc_listen.is_loopback() => {
                tracing::info!("receiving the gaze from OSC packets at {address}");
            }
            Ok(()) => tracing::warn!(
                "receiving the gaze from OSC packets at {address}: other computers can send them, too"
            ),
            // The user has not asked for packets by name.
            Err(error) if has_changed && config.gaze.source == GazeSource::Auto => {
                tracing::info!("no gaze from OSC packets: gaze.osc_listen = \"{address}\": {error}")
            }
            Err(error) if has_changed => {
                tracing::error!("no gaze from OSC packets: gaze.osc_listen = \"{address}\": {error}");
            }
            Err(_) => {}
        }
    }

    /// The session ends: no packet is received any more, and the port is free.
    pub fn close(&self) {
        let listener = self.state().osc.close();
        drop(listener);
    }

    /// Writes the source of the gaze, and the counts and the delay of packets.
    pub fn write_status(&self, snapshot: &mut StatusSnapshot) {
        let state = self.state();
        snapshot.active_gaze_source = state.active_source;
        snapshot.osc = state.osc.status();
        snapshot.packet_delay_ms = state.delay.delay_ms();
        drop(state);
        snapshot.drift_deg = self.correction.drift_deg();
    }

    /// Takes the phase of the gaze by the `look` of a frame, for its drift, and the frame's display time, nanoseconds. A gaze of no tracker
    /// has no drift.
    pub fn note_phase(&self, look: Look, phase: GazePhase, time_ns: i64) {
        let active_source = self.state().active_source;
        if matches!(active_source, ActiveGazeSource::Eyes | ActiveGazeSource::Osc) {
            self.correction.note_phase(active_source, look, phase, time_ns);
        }
    }

    /// Position of the dot of debug view "ahead", degrees to the left of and above the forward direction.
    pub fn dot_deg(&self) -> [f32; 2] {
        self.correction.dot_deg()
    }

    /// Whether a gaze may be available, as far as is known.
    pub fn may_have_gaze(&self, session: &Session, config: &Config) -> bool {
        match config.gaze.source {
            GazeSource::Auto => session.actions.may_have_gaze() || self.state().osc.is_open(),
            GazeSource::Eyes => session.actions.may_have_gaze(),
            GazeSource::Osc => self.state().osc.is_open(),
            GazeSource::Centre => true,
            GazeSource::File => self.state().script.is_some(),
        }
    }

    /// Gaze at `time`. Locates on this thread.
    pub fn look(&self, session: &Session, config: &Config, time: xr::Time) -> Look {
        let time_ns = time.as_nanos();
        let packets = |delay| self.state().osc.look(time_ns, delay);
        let (active_source, look) = match config.gaze.source {
            GazeSource::Auto => {
                let delay = self.state().packet_delay();
                let (eyes, packets) = (session.actions.look(session, time), packets(delay));
                let mut state = self.state();
                state.compare(eyes, packets, delay);
                state.auto.choose(eyes, packets, time_ns)
            }
            GazeSource::Eyes => (ActiveGazeSource::Eyes, session.actions.look(session, time)),
            GazeSource::Osc => (ActiveGazeSource::Osc, packets(PacketDelay::ASSUMED)),
            GazeSource::Centre => (ActiveGazeSource::Centre, Look::NoTracker),
            GazeSource::File => (ActiveGazeSource::File, self.scripted(time_ns)),
        };
        let look = match active_source {
            ActiveGazeSource::Eyes | ActiveGazeSource::Osc => {
                let look = turned(look, config.gaze.offset_deg.left_up_deg());
                self.correction.corrected(active_source, look, time_ns)
            }
            ActiveGazeSource::Centre | ActiveGazeSource::File => look,
        };
        let mut state = self.state();
        state.active_source = active_source;
        if state.recording.is_some() {
            let begin = *state.begin_ns.get_or_insert(time_ns);
            if let Some(recording) = &mut state.recording {
                recording.note_look(look, begin, time_ns);
            }
        }
        look
    }

    /// Gaze at `time_ns`, for an application that the user gives the gaze to (`gaze.offer`). [`Look::NoTracker`] without a source of
    /// the layer's own. The layer's own gaze, its recording and measurements are not touched.
    pub fn application_look(&self, config: &Config, time_ns: i64) -> Look {
        match Offered::of(config) {
            Some(Offered::Packets) => {
                let look = self.state().osc.application_look(time_ns, PacketDelay::ASSUMED);
                let look = turned(look, config.gaze.offset_deg.left_up_deg());
                self.correction.corrected_for_application(ActiveGazeSource::Osc, look)
            }
            Some(Offered::File) => self.scripted(time_ns),
            None => Look::NoTracker,
        }
    }

    /// Whether there is a gaze to give to the application at this moment, be it of closed eyes.
    pub fn has_gaze_for_application(&self, config: &Config) -> bool {
        match Offered::of(config) {
            Some(Offered::Packets) => self.state().osc.has_sender(),
            Some(Offered::File) => self.state().script.is_some(),
            None => false,
        }
    }

    fn scripted(&self, time_ns: i64) -> Look {
        let (script, begin) = {
            let mut state = self.state();
            let begin = *state.begin_ns.get_or_insert(time_ns);
            let Some(script) = state.script.clone() else { return Look::NoTracker };
            (script, begin)
        };
        match script.at(seconds_since(begin, time_ns)) {
            Some(direction) => Look::At { direction, sampled_ns: time_ns, uncertainty_ns: 0 },
            None => Look::Unseen,
        }
    }
}

impl State {
    /// The delay of packets: measured, or assumed.
    fn packet_delay(&self) -> PacketDelay {
        self.delay.delay_ms().map_or(PacketDelay::ASSUMED, PacketDelay::measured)
    }

    /// Takes the gazes of both sources, if both are present, for the delay of packets, whose times are by `delay`.
    fn compare(&mut self, eyes: Look, packets: Look, delay: PacketDelay) {
        if packets == Look::NoTracker {
            // The next sender may have another delay.
            if self.delay.has_begun() {
                self.delay = GazeDelay::default();
            }
        } else if eyes != Look::NoTracker {
            self.delay.push(timed(eyes, 0), timed(packets, delay.delay_ns));
        }
    }
}

/// A gaze whose time is known, so much later; `None` for any other.
fn timed(look: Look, later_ns: i64) -> Option<TimedGaze> {
    match look {
        Look::At { direction, sampled_ns, .. } if sampled_ns > 0 && direction != Vec3::ZERO => {
            Some((degrees(direction), sampled_ns.saturating_add(later_ns)))
        }
        Look::At { .. } | Look::Unseen | Look::NoTracker => None,
    }
}

/// A source of the layer's own whose gaze applications can get.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offered {
    /// OSC packets.
    Packets,
    /// A file.
    File,
}

impl Offered {
    /// The source that the user gives to applications; `None` if there is none.
    pub fn of(config: &Config) -> Option<Self> {
        if !config.enabled || !config.gaze.offer {
            return None;
        }
        match config.gaze.source {
            GazeSource::Auto | GazeSource::Osc => Some(Self::Packets),
            GazeSource::File => config.gaze.file.path().map(|_| Self::File),
            GazeSource::Eyes | GazeSource::Centre => None,
        }
    }
}
fn wanted_file(config: &Config) -> FilePath {
    if config.gaze.source == GazeSource::File { config.gaze.file } else { FilePath::NONE }
}

/// The gaze of a file; `None` if it cannot be read, with the reason in the log.
fn read(path: &Path) -> Option<GazeScript> {
    let read = || -> Result<GazeScript, String> {
        // O_NONBLOCK: otherwise opening a FIFO would wait for a writer.
        let file = OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK).open(path);
        let file = file.map_err(|error| error.to_string())?;
        let metadata = file.metadata().map_err(|error| error.to_string())?;
        if !metadata.is_file() {
            return Err("not a regular file".to_owned());
        }
        if metadata.len() > MOST_BYTES {
            return Err(format!("{} bytes, more than the allowed {MOST_BYTES}", metadata.len()));
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

#[cfg(test)]
mod tests;
