//! Applications that run beside each other, of which one at a time has its frame.
//!
//! Other work of a machine slows a run down for seconds at a time. Consecutive runs differ by that; consecutive frames, a
//! fraction of a second apart, hardly do.

use super::order::FrameOrder;
use super::{Effort, Subject, Technique};
use crate::HarnessError;
use crate::record::Record;
use crate::run::{Application, Outcome, Run, Running};
use crate::scenario::Scenario;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, read_all};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Time limit for the start of an application, or for a frame.
const PATIENCE: Duration = Duration::from_secs(240);

/// Interval between checks for the connection of an application.
const POLL: Duration = Duration::from_millis(2);

/// A running application, whose frames wait for their turns.
pub struct Player {
    running: Running,
    /// Socket on which it asks for its frames.
    asks: UnixStream,
    /// Whether it waits for a frame.
    is_waiting: bool,
}

/// One turn of each technique: all are started and have their run-up one after the other, and then a frame each in turn
/// ([`play_in_turn`]). The outcomes are in the order of `techniques`.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn side_by_side(
    subject: &Subject,
    techniques: &[Technique],
    effort: Effort,
    with_gpu: bool,
    mut progress: impl FnMut(&Technique),
) -> Result<Vec<Outcome>, HarnessError> {
    let mut players = start_all(subject, techniques, effort, with_gpu, |technique, _| progress(technique))?;
    play_in_turn(&mut players, effort.frames);
    let finished = players
        .into_iter()
        .zip(techniques)
        .map(|(player, technique)| player.finish()?.expect_frames(effort.of(technique).length()));
    finished.collect()
}

/// Starts `subject` with each technique, one after the other, and lets each have its run-up. `progress` is called before each technique is
/// started, with the frames of its run-up.
///
/// # Errors
/// Errors of the harness, and an application that asks for no frame.
pub fn start_all(
    subject: &Subject,
    techniques: &[Technique],
    effort: Effort,
    with_gpu: bool,
    mut progress: impl FnMut(&Technique, u64),
) -> Result<Vec<Player>, HarnessError> {
    let folder = std::env::temp_dir();
    let sockets = tempfile::tempdir().map_err(HarnessError::file(&folder))?;
    let mut players = Vec::new();
    for (number, technique) in techniques.iter().enumerate() {
        let shorter = effort.of(technique);
        progress(technique, shorter.run_up);
        let subject = subject.later(effort.run_up - shorter.run_up);
        let mut scenario = subject.scenario(shorter);
        scenario.clock.turns = sockets.path().join(number.to_string());
        let listener =
            UnixListener::bind(&scenario.clock.turns).map_err(HarnessError::file(&scenario.clock.turns))?;
        let run = subject.run_as(technique, shorter, &scenario)?;
        let run = if with_gpu { run.gpu_timed() } else { run };
        let patience = PATIENCE * (techniques.len() as u32 + 1);
        let mut player = Player::start(run.timeout(patience).start()?, &listener, &scenario.clock.turns)?;
        for _ in 0..shorter.run_up {
            player.play();
        }
        players.push(player);
    }
    Ok(players)
}

/// Lets all have so many frames, one each in turn, in a [`FrameOrder`].
pub fn play_in_turn(players: &mut [Player], frames: u64) {
    let mut order = FrameOrder::of(players.len());
    for _ in 0..frames {
        order.next_frame().into_iter().for_each(|player| players[player].play());
    }
}

impl Player {
    /// Starts an application by itself, and waits for it to ask for its first frame. `configured` completes the run.
    ///
    /// # Errors
    /// Errors of the harness, and an application that asks for no frame.
    pub fn alone(
        application: &Application,
        mut scenario: Scenario,
        configured: impl FnOnce(Run) -> Run,
    ) -> Result<Self, HarnessError> {
        let folder = std::env::temp_dir();
        let sockets = tempfile::tempdir().map_err(HarnessError::file(&folder))?;
        let path = sockets.path().join("turns");
        let listener = UnixListener::bind(&path).map_err(HarnessError::file(&path))?;
        scenario.clock.turns.clone_from(&path);
        Self::start(configured(Run::new(application, &scenario)).start()?, &listener, &path)
    }

    /// The configuration file that the application reads.
    pub fn config_file(&self) -> PathBuf {
        self.running.config_file()
    }

    /// Waits for an application to ask for its first frame.
    fn start(mut running: Running, listener: &UnixListener, path: &Path) -> Result<Self, HarnessError> {
        listener.set_nonblocking(true).map_err(HarnessError::file(path))?;
        let start = Instant::now();
        let asks = loop {
            match listener.accept() {
                Ok((asks, _)) => break asks,
                Err(error) if error.kind() != ErrorKind::WouldBlock => {
                    return Err(HarnessError::file(path)(error));
                }
                Err(_) if running.has_ended() || start.elapsed() > PATIENCE => {
                    return Err(running.finish()?.failed("it did not ask for a frame"));
                }
                Err(_) => std::thread::sleep(POLL),
            }
        };
        let settled = asks.set_nonblocking(false).and_then(|()| asks.set_read_timeout(Some(PATIENCE)));
        settled.map_err(HarnessError::file(path))?;
        let mut player = Self { running, asks, is_waiting: false };
        player.listen();
        Ok(player)
    }

    /// Waits until the application waits for a frame. One that does not any more is at its end.
    fn listen(&mut self) {
        self.is_waiting = self.asks.read_exact(&mut [0]).is_ok();
    }

    /// Lets it have a frame, until it asks for the next one.
    pub fn play(&mut self) {
        if self.is_waiting && self.asks.write_all(&[0]).is_ok() {
            self.listen();
        }
    }

    /// The layer's status in it, as `parafovea status` reads it; none where there is no layer.
    pub fn status(&self) -> Option<Status> {
        let folder = self.running.runtime_folder();
        let environment =
            Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| folder.clone().into()));
        let found = read_all(&environment, SystemTime::now()).found;
        found.into_iter().next().map(|found| found.status)
    }

    /// Ends it at its current frame, and returns the record of its frames so far.
    ///
    /// # Errors
    /// As for [`Running::stop`].
    pub fn stop(self, frames: u64) -> Result<Record, HarnessError> {
        self.running.stop(frames)
    }

    /// Lets it finish.
    ///
    /// # Errors
    /// As for [`Running::finish`].
    pub fn finish(mut self) -> Result<Outcome, HarnessError> {
        while self.is_waiting {
            self.play();
        }
        self.running.finish()
    }
}
