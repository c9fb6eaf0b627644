//! PipeWire speaks PulseAudio's protocol: sound that is played into it is captured as well.

use parafovea_core::audio::AudioFeatures;
use parafovea_sound::feature_lines::{Line, lines};
use parafovea_sound::pipewire::PipeWire;
use parafovea_sound::player::{BUFFER_MS, Player};
use parafovea_sound::signals::{Kind, features, sound};
use parafovea_sound::stage::{SAMPLE_RATE_HZ, application, configuration};
use parafovea_tests::run::Running;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Loudness of the played tone, LUFS.
const LEVEL_LUFS: f32 = -20.0;

/// The longest wait for a state.
const PATIENCE: Duration = Duration::from_secs(30);

/// A player of a tone, and hello_xr that hears it.
struct Hearing {
    _player: Player,
    running: Running,
    file: PathBuf,
    _folder: tempfile::TempDir,
    /// Features of the tone.
    played: AudioFeatures,
}

impl Hearing {
    fn of(server: &PipeWire) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("features.jsonl");
        let player = Player::new(&server.socket(), SAMPLE_RATE_HZ, BUFFER_MS).unwrap();
        let samples = sound(Kind::Tone, LEVEL_LUFS, SAMPLE_RATE_HZ, 1.0);
        player.play(samples.clone(), true);
        let run = application().unwrap().on(&configuration("source = \"system\"\nwindow_s = 1.0"));
        let run = run.env("PARAFOVEA_FEATURES_FILE", &file).env("XDG_RUNTIME_DIR", server.runtime_folder());
        let running = run.start().unwrap();
        let played = *features(&samples, SAMPLE_RATE_HZ, &Default::default()).last().unwrap();
        Self { _player: player, running, file, _folder: folder, played }
    }

    /// Waits until the newest line `is_it`.
    fn wait(&self, what: &str, is_it: impl Fn(&Line) -> bool) {
        let start = Instant::now();
        loop {
            let last = lines(&self.file).last().copied();
            if last.as_ref().is_some_and(&is_it) {
                println!("{what}: {last:?}");
                return;
            }
            assert!(start.elapsed() < PATIENCE, "no {what}: {last:?}\n{}", self.running.log());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits for the tone at this loudness.
    fn wait_for_tone(&self, lufs: f32) {
        let is_right =
            |found: Option<f32>, expected: f32| found.is_some_and(|found| (found - expected).abs() < 0.5);
        self.wait(&format!("tone of {lufs} LUFS"), |line| {
            is_right(line.loudness_lufs, lufs)
                && is_right(line.gamma_fq_kilomel, self.played.gamma_fq_kilomel)
        });
    }
}

#[test]
fn sound_played_into_pipewire_is_captured() {
    let server = PipeWire::start().unwrap();
    let hearing = Hearing::of(&server);
    hearing.wait_for_tone(LEVEL_LUFS);
    drop(server);
    hearing.wait("end of the sound", |line| !line.pays());
    hearing.running.quit().unwrap().expect_end().unwrap();
}

#[test]
fn a_volume_that_pipewires_monitor_does_not_contain_counts() {
    let mut server = PipeWire::start().unwrap();
    server.plug("quiet").unwrap();
    let hearing = Hearing::of(&server);
    hearing.wait_for_tone(LEVEL_LUFS);
    // PulseAudio's scale is cubic.
    server.set_volume("quiet", 60).unwrap();
    hearing.wait_for_tone(LEVEL_LUFS + 60.0 * 0.6f32.log10());
    // -80 LUFS: below the gate of BS.1770.
    server.set_volume("quiet", 10).unwrap();
    hearing.wait("silence", |line| line.silent == Some(true));
    server.set_volume("quiet", 100).unwrap();
    hearing.wait_for_tone(LEVEL_LUFS);
    hearing.running.quit().unwrap().expect_end().unwrap();
}
