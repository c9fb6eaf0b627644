//! PipeWire speaks PulseAudio's protocol: sound that is played into it is captured as well.

use parafovea_sound::feature_lines::lines;
use parafovea_sound::pipewire::PipeWire;
use parafovea_sound::player::{BUFFER_MS, Player};
use parafovea_sound::signals::{Kind, features, sound};
use parafovea_sound::stage::{SAMPLE_RATE_HZ, application, configuration};
use std::time::{Duration, Instant};

#[test]
fn sound_played_into_pipewire_is_captured() {
    let server = PipeWire::start().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("features.jsonl");
    let player = Player::new(&server.socket(), SAMPLE_RATE_HZ, BUFFER_MS).unwrap();
    let samples = sound(Kind::Tone, -20.0, SAMPLE_RATE_HZ, 1.0);
    player.play(samples.clone(), true);
    let run = application().unwrap().on(&configuration("source = \"system\"\nwindow_s = 1.0"));
    let run = run.env("PARAFOVEA_FEATURES_FILE", &file).env("XDG_RUNTIME_DIR", server.runtime_folder());
    let running = run.start().unwrap();
    let expected = *features(&samples, SAMPLE_RATE_HZ, &Default::default()).last().unwrap();
    let start = Instant::now();
    let is_right =
        |found: Option<f32>, expected: f32| found.is_some_and(|found| (found - expected).abs() < 0.5);
    while !lines(&file).last().is_some_and(|line| {
        is_right(line.loudness_lufs, -20.0) && is_right(line.gamma_fq_kilomel, expected.gamma_fq_kilomel)
    }) {
        assert!(start.elapsed() < Duration::from_secs(30), "{:?}\n{}", lines(&file).last(), running.log());
        std::thread::sleep(Duration::from_millis(20));
    }
    println!("heard: {:?}", lines(&file).last());
    drop(server);
    while lines(&file).last().is_some_and(|line| line.pays()) {
        assert!(start.elapsed() < Duration::from_secs(30), "{}", running.log());
        std::thread::sleep(Duration::from_millis(20));
    }
    running.quit().unwrap().expect_end().unwrap();
}
