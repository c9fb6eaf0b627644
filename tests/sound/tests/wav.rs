//! A WAV file as the source of sound.

use parafovea_sound::feature_lines::lines;
use parafovea_sound::signals::{CHANNELS, Kind, features, sound};
use parafovea_sound::stage::{application, configuration};
use std::time::{Duration, Instant};

const SAMPLE_RATE_HZ: u32 = 44_100;

#[test]
fn a_file_is_heard_as_if_it_were_played() {
    let folder = tempfile::tempdir().unwrap();
    let (file, features_file) = (folder.path().join("tone.wav"), folder.path().join("features.jsonl"));
    let samples = sound(Kind::Tone, -20.0, SAMPLE_RATE_HZ, 1.0);
    let spec = hound::WavSpec {
        channels: CHANNELS as u16,
        sample_rate: SAMPLE_RATE_HZ,
        bits_per_sample: 24,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(&file, spec).unwrap();
    samples.iter().for_each(|sample| writer.write_sample((sample * 8_388_607.0) as i32).unwrap());
    writer.finalize().unwrap();

    let config = configuration(&format!("source = \"file\"\nfile = \"{}\"\nwindow_s = 1.0", file.display()));
    let running =
        application().unwrap().on(&config).env("PARAFOVEA_FEATURES_FILE", &features_file).start().unwrap();
    let start = Instant::now();
    let is_whole = || {
        let heard = lines(&features_file);
        heard.last().filter(|line| line.confidence == Some(1.0)).copied()
    };
    // The file ends after a second, and starts again.
    let line = loop {
        if let Some(line) = is_whole().filter(|_| start.elapsed() > Duration::from_secs(2)) {
            break line;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "{}", running.log());
        std::thread::sleep(Duration::from_millis(20));
    };
    let settings = parafovea_core::audio::AudioSettings { window_s: 1.0, ..Default::default() };
    let expected = *features(&samples, SAMPLE_RATE_HZ, &settings).last().unwrap();
    assert!((line.loudness_lufs.unwrap() - expected.loudness_lufs).abs() < 0.1, "{line:?}, {expected:?}");
    assert!((line.gamma_fq_kilomel.unwrap() / expected.gamma_fq_kilomel - 1.0).abs() < 0.01);
    let log = running.quit().unwrap().expect_end().unwrap().log;
    assert!(log.contains("sound: capturing ") && log.contains("tone.wav (44100 Hz, 2 channels)"), "{log}");
}

#[test]
fn a_file_that_is_none_is_named() {
    let config = configuration("source = \"file\"\nfile = \"/nowhere/no.wav\"");
    let running = application().unwrap().on(&config).start().unwrap();
    let start = Instant::now();
    while !running.log().contains("not captured: /nowhere/no.wav") {
        assert!(start.elapsed() < Duration::from_secs(20), "{}", running.log());
        std::thread::sleep(Duration::from_millis(20));
    }
    running.quit().unwrap().expect_end().unwrap();
}
