//! Sound that stops or is inaudible: plans soon take it for silence.

use parafovea_sound::player::{Player, SHORT_BUFFER_MS};
use parafovea_sound::signals::{Kind, sound};
use parafovea_sound::stage::{SAMPLE_RATE_HZ, Stage};
use std::time::{Duration, Instant, SystemTime};

/// Additional delay on a busy machine, seconds. A busy one adds its measured lateness.
const SLACK_S: f64 = 0.4;

/// A sound pays for something within `stage`.
fn play(stage: &Stage) {
    let now = SystemTime::now();
    stage.player.play(sound(Kind::Tone, -12.0, SAMPLE_RATE_HZ, 1.0), true);
    stage.wait("sound", |line| line.pays(), Some(now)).unwrap();
    std::thread::sleep(Duration::from_millis(600));
}

#[test]
fn the_end_of_a_sound_a_muted_output_and_one_without_volume_are_silence() {
    let mut stage = Stage::new("window_s = 1.0").unwrap();
    stage.player = Player::new(&stage.server.socket(), SAMPLE_RATE_HZ, SHORT_BUFFER_MS).unwrap();
    play(&stage);
    let stopped = SystemTime::now();
    stage.player.pause();
    let line = stage.wait("silence", |line| line.silent == Some(true), Some(stopped)).unwrap();
    let after = line.seconds_after(stopped);
    println!("silence {:.0} ms after the sound stopped", 1000.0 * after);
    assert!(after < 0.6 + SLACK_S + stage.lateness.allowance_s(), "{after} s");

    for (off, on) in [
        ("set-sink-mute out 1", "set-sink-mute out 0"),
        ("set-sink-volume out 0", "set-sink-volume out 65536"),
    ] {
        play(&stage);
        let muted = SystemTime::now();
        stage.server.command(off).unwrap();
        let line = stage.wait("silence", |line| line.silent == Some(true), Some(muted)).unwrap();
        let after = line.seconds_after(muted);
        println!("silence {:.0} ms after {off}", 1000.0 * after);
        assert!(after < 0.6 + SLACK_S + stage.lateness.allowance_s(), "{after} s");
        let unmuted = SystemTime::now();
        stage.server.command(on).unwrap();
        stage.wait("sound", |line| line.pays(), Some(unmuted)).unwrap();
        stage.player.pause();
        stage.wait("silence", |line| line.silent == Some(true), Some(unmuted)).unwrap();
    }
    stage.finish().unwrap();
}

#[test]
fn an_edit_ends_listening_and_begins_it_again() {
    let stage = Stage::new("window_s = 1.0").unwrap();
    play(&stage);
    stage.configure("source = \"off\"").unwrap();
    stage.wait_for_log("sound: capture ended").unwrap();
    let outputs = || stage.server.command("list-source-outputs").unwrap();
    let start = Instant::now();
    while !outputs().contains("0 source output(s)") {
        assert!(start.elapsed() < Duration::from_secs(10), "{}", outputs());
        std::thread::sleep(Duration::from_millis(20));
    }
    let again = SystemTime::now();
    stage.configure("source = \"system\"\nwindow_s = 1.0").unwrap();
    stage.wait("sound", |line| line.pays(), Some(again)).unwrap();
    stage.finish().unwrap();
}
