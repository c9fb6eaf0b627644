//! Writes the gaze to a file, for a user who asked for that by the file's name.
//!
//! A thread of its own does the writing: frames never wait for a disk. Lines that it cannot keep up with are left out.

use super::Look;
use super::script::GazeLine;
use crate::abi::threads::spawn;
use glam::Vec3;
use std::fs::OpenOptions;
use std::io::{BufWriter, ErrorKind, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::JoinHandle;

/// Most lines that may wait to be written: ten seconds at 100 Hz.
const MOST_WAITING: usize = 1000;

/// A recording that goes on until it is dropped.
#[derive(Debug)]
pub struct Recording {
    /// Present until it is dropped.
    lines: Option<SyncSender<GazeLine>>,
    writer: Option<JoinHandle<()>>,
    newest: Option<f64>,
    /// Age of the newest sample at its display time, nanoseconds.
    age_ns: i64,
}

impl Recording {
    /// Begins a recording, in a new file that only this user may read. The file is created with its first line: OpenVR games by xrizer and
    /// OpenComposite have a short session before the one that they play in, without a frame.
    ///
    /// # Errors
    ///
    /// The file exists already, or its folder does not; or the thread cannot be started.
    pub fn create(path: &Path) -> std::io::Result<Self> {
        if path.symlink_metadata().is_ok() {
            return Err(ErrorKind::AlreadyExists.into());
        }
        path.parent().filter(|folder| !folder.as_os_str().is_empty()).map(Path::metadata).transpose()?;
        let (lines, waiting) = sync_channel(MOST_WAITING);
        let path = path.to_owned();
        let writer = spawn("parafovea-gaze", move || write(&path, &waiting))?;
        Ok(Self { lines: Some(lines), writer: Some(writer), newest: None, age_ns: 0 })
    }

    /// Adds the answer of the eye tracker for the frame shown at `time_ns`; times count from `begin_ns`. Lost eyes have no time of their own: they
    /// are as old as the sample before, so that the next sample is newer.
    pub fn note_look(&mut self, look: Look, begin_ns: i64, time_ns: i64) {
        match look {
            Look::NoTracker => {}
            Look::Unseen => self.note(seconds_since(begin_ns, time_ns.saturating_sub(self.age_ns)), None),
            Look::At { direction, sampled_ns, .. } => {
                let at_ns = if sampled_ns > 0 { sampled_ns } else { time_ns };
                self.age_ns = time_ns.saturating_sub(at_ns);
                self.note(seconds_since(begin_ns, at_ns), Some(direction));
            }
        }
    }

    /// Adds the direction of the gaze, `seconds` after the first time; `None` if the eyes were not tracked. A time that is not newer than
    /// the newest is ignored.
    fn note(&mut self, seconds: f64, direction: Option<Vec3>) {
        if self.newest.is_some_and(|newest| seconds <= newest) {
            return;
        }
        self.newest = Some(seconds);
        if let Some(lines) = &self.lines {
            // Full: this line is left out. Without a receiver the writer has said why.
            let _ = lines.try_send(GazeLine { seconds, direction });
        }
    }
}

/// Time since `begin_ns`, seconds.
pub fn seconds_since(begin_ns: i64, time_ns: i64) -> f64 {
    time_ns.saturating_sub(begin_ns) as f64 * 1e-9
}

impl Drop for Recording {
    /// Waits until all is written.
    fn drop(&mut self) {
        self.lines = None;
        if let Some(writer) = self.writer.take() {
            // A writer that panicked has written as much as it could.
            let _ = writer.join();
        }
    }
}

fn write(path: &Path, lines: &Receiver<GazeLine>) {
    if let Err(error) = write_lines(path, lines) {
        tracing::error!("recording of the gaze to {path:?} ended: {error}");
    }
}

fn write_lines(path: &Path, lines: &Receiver<GazeLine>) -> std::io::Result<()> {
    let Ok(first) = lines.recv() else { return Ok(()) };
    let mut file = BufWriter::new(OpenOptions::new().write(true).create_new(true).mode(0o600).open(path)?);
    writeln!(file, "# seconds, degrees left, degrees up; seconds alone: lost eyes\n{first}")?;
    loop {
        let line = match lines.try_recv() {
            Ok(line) => line,
            Err(TryRecvError::Disconnected) => return file.flush(),
            Err(TryRecvError::Empty) => {
                // Applications end without notice.
                file.flush()?;
                match lines.recv() {
                    Ok(line) => line,
                    Err(_) => return Ok(()),
                }
            }
        };
        writeln!(file, "{line}")?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::gaze::script::GazeScript;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_recording_can_be_played_and_is_private() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gaze.csv");
        let mut recording = Recording::create(&path).unwrap();
        let look = Vec3::new(0.1, 0.2, -1.0);
        for (seconds, direction) in
            [(0.0, Some(Vec3::NEG_Z)), (0.1, Some(look)), (0.1, None), (0.05, None), (0.2, None)]
        {
            recording.note(seconds, direction);
        }
        drop(recording);
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().count(), 4, "{text}");
        let script: GazeScript = text.parse().unwrap();
        assert!(script.at(0.1).unwrap().abs_diff_eq(look.normalize(), 1e-6));
        assert_eq!(script.at(0.2), None);
        assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    }

    /// Samples of 50 ms of age, at 100 Hz, with a blink of three frames.
    #[test]
    fn no_sample_after_a_blink_is_lost() {
        const AGE_NS: i64 = 50_000_000;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gaze.csv");
        let mut recording = Recording::create(&path).unwrap();
        let begin_ns = 1_000_000_000;
        for frame in 0..20 {
            let time_ns = begin_ns + frame * 10_000_000;
            let look = match frame {
                8..11 => Look::Unseen,
                _ => Look::At { direction: Vec3::NEG_Z, sampled_ns: time_ns - AGE_NS, uncertainty_ns: 0 },
            };
            recording.note_look(look, begin_ns, time_ns);
        }
        drop(recording);
        let text = std::fs::read_to_string(&path).unwrap();
        let seconds: Vec<f64> = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| line.split(',').next().unwrap().trim().parse().unwrap())
            .collect();
        let expected: Vec<f64> = (0..20).map(|frame| f64::from(frame) * 0.01 - 0.05).collect();
        assert_eq!(seconds.len(), expected.len(), "{text}");
        assert!(seconds.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{text}");
        assert!(text.parse::<GazeScript>().is_ok(), "{text}");
    }

    #[test]
    fn a_session_without_frames_leaves_the_file_to_the_next() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gaze.csv");
        drop(Recording::create(&path).unwrap());
        let mut recording = Recording::create(&path).unwrap();
        recording.note(0.0, Some(Vec3::NEG_Z));
        drop(recording);
        assert_eq!(std::fs::read_to_string(&path).unwrap().lines().count(), 2);
        assert!(Recording::create(&folder.path().join("no/gaze.csv")).is_err());
    }

    #[test]
    fn a_file_that_is_there_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gaze.csv");
        std::fs::write(&path, "dear").unwrap();
        assert!(Recording::create(&path).is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "dear");
    }
}
