//! An application that hears a server, and a program that plays to it.

use crate::feature_lines::{Line, lines};
use crate::lateness::Lateness;
use crate::player::{BUFFER_MS, Player};
use crate::server::{Server, Sink};
use anyhow::{Context, Result, bail};
use parafovea_tests::run::{Application, Outcome, Run, Running};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// Frames a second of the application: plans are made that often.
const REFRESH_HZ: f64 = 50.0;

/// The longest that an application runs here, seconds.
const LONGEST_S: f64 = 600.0;

/// Longest wait for an event.
const PATIENCE: Duration = Duration::from_secs(60);

/// Frames a second of the first output.
pub const SAMPLE_RATE_HZ: u32 = 48_000;

/// Output that exists from the beginning.
pub const OUT: Sink<'static> = Sink { name: "out", sample_rate_hz: SAMPLE_RATE_HZ };

/// The configuration of applications with sound: with chroma attenuated, so that there is something to plan; `audio` is the section
/// `[audio]`.
pub fn configuration(audio: &str) -> String {
    format!(
        "preset = \"none\"\n[gaze]\nsource = \"centre\"\n[chroma]\nmode = \"default\"\n[audio]\n{audio}\n"
    )
}

/// hello_xr, with small pictures, in real time, from an installation with the sound capture library.
///
/// # Errors
/// Something is not installed or not built.
pub fn application() -> Result<Run> {
    let mut scenario = Scenario::new((LONGEST_S * REFRESH_HZ) as u64).sized(64, 64).in_real_time();
    scenario.clock.refresh_hz = REFRESH_HZ;
    let application = Application::hello_xr("Vulkan2")?;
    Ok(Run::new(&application, &scenario)
        .with_audio_library()?
        .timeout(Duration::from_secs_f64(2.0 * LONGEST_S)))
}

/// A server, hello_xr that hears it, and a player.
pub struct Stage {
    /// The server.
    pub server: Server,
    /// The player.
    pub player: Player,
    /// Scheduling delay of this machine, from the beginning.
    pub lateness: Lateness,
    running: Running,
    file: PathBuf,
    _folder: tempfile::TempDir,
}

impl Stage {
    /// Sets everything up, and waits until the application hears silence. `audio` is added to its configuration.
    ///
    /// # Errors
    /// Something is not installed or not built, or the application does not hear.
    pub fn new(audio: &str) -> Result<Self> {
        let lateness = Lateness::start();
        let server = Server::start(&[OUT])?;
        let player = Player::new(&server.socket(), SAMPLE_RATE_HZ, BUFFER_MS)?;
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("features.jsonl");
        let config = configuration(&format!("source = \"system\"\n{audio}"));
        let run = application()?.on(&config).env("PARAFOVEA_FEATURES_FILE", &file);
        let running = run.env("XDG_RUNTIME_DIR", server.runtime_folder()).start()?;
        let stage = Self { server, player, lateness, running, file, _folder: folder };
        stage.wait("silence", |line| line.silent == Some(true), None)?;
        Ok(stage)
    }

    /// Features of plans so far.
    pub fn features(&self) -> Vec<Line> {
        lines(&self.file)
    }

    /// The application's log so far.
    pub fn log(&self) -> String {
        self.running.log()
    }

    /// Waits for a line that `is_it`, `after` that time if it is given.
    ///
    /// # Errors
    /// There is none for a long time.
    pub fn wait(&self, what: &str, is_it: impl Fn(&Line) -> bool, after: Option<SystemTime>) -> Result<Line> {
        let start = Instant::now();
        loop {
            let heard = self.features();
            let found =
                heard.iter().find(|line| is_it(line) && after.is_none_or(|after| line.time() > after));
            if let Some(line) = found {
                return Ok(*line);
            }
            if start.elapsed() > PATIENCE {
                let last = &heard[heard.len().saturating_sub(5)..];
                bail!("no {what}: {last:#?}\n{}", self.log());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits until the application logs a line with `text`.
    ///
    /// # Errors
    /// It does not for a long time.
    pub fn wait_for_log(&self, text: &str) -> Result<()> {
        self.wait_for_log_lines(1, |line| line.contains(text)).with_context(|| format!("no \"{text}\""))
    }

    /// Waits until the application has logged `count` such lines.
    ///
    /// # Errors
    /// It does not for a long time.
    pub fn wait_for_log_lines(&self, count: usize, is_it: impl Fn(&str) -> bool) -> Result<()> {
        let start = Instant::now();
        while self.log().lines().filter(|line| is_it(line)).count() < count {
            if start.elapsed() > PATIENCE {
                bail!("fewer than {count} such lines are logged:\n{}", self.log());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Ok(())
    }

    /// Changes the application's configuration; `audio` is the section `[audio]`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn configure(&self, audio: &str) -> Result<()> {
        Ok(std::fs::write(self.running.config_file(), configuration(audio))?)
    }

    /// Starts another player after the server of the last one was lost.
    ///
    /// # Errors
    /// The server refuses.
    pub fn play_again(&mut self) -> Result<()> {
        self.player = Player::new(&self.server.socket(), SAMPLE_RATE_HZ, BUFFER_MS)?;
        Ok(())
    }

    /// Has the application end, which it does by itself.
    ///
    /// # Errors
    /// It did not end well.
    pub fn finish(self) -> Result<Outcome> {
        Ok(self.running.quit()?.expect_end()?)
    }
}
