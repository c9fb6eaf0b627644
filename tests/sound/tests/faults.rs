//! Faults of the server: the application runs on, its plans soon do without sound, not with a jump, and sound comes
//! back by itself.

use parafovea_sound::feature_lines::Line;
use parafovea_sound::server::Sink;
use parafovea_sound::signals::{Kind, sound};
use parafovea_sound::stage::{OUT, SAMPLE_RATE_HZ, Stage};
use std::time::{Duration, SystemTime};

/// Plans do without sound that soon, seconds.
const FALLBACK_S: f64 = 0.5;

/// Additional delay on a busy machine, seconds. A busy one adds its measured lateness.
const SLACK_S: f64 = 0.4;

/// Delay of a thread beyond which plans may miss the steps of a fallback, seconds.
const STEPS_MISSED_S: f64 = 0.1;

/// A stage where a loud sound is heard.
fn loud() -> Stage {
    let stage = Stage::new("window_s = 1.0").unwrap();
    play(&stage);
    stage
}

fn play(stage: &Stage) {
    let now = SystemTime::now();
    stage.player.play(sound(Kind::Pink, -12.0, SAMPLE_RATE_HZ, 1.0), true);
    let is_whole = |line: &Line| line.pays() && line.confidence.is_some_and(|confidence| confidence > 0.95);
    stage.wait("sound", is_whole, Some(now)).unwrap();
}

/// Plans stop to take sound after `failed`, by and by.
fn expect_fallback(stage: &Stage, what: &str, failed: SystemTime) {
    let line = stage.wait("fallback", |line| !line.pays(), Some(failed)).unwrap();
    let after = line.seconds_after(failed);
    let heard = stage.features();
    let steps: Vec<f32> = heard
        .iter()
        .filter(|line| line.time() > failed && line.seconds_after(failed) < after)
        .filter_map(|line| line.gamma_ld)
        .collect();
    println!("{what}: plans do without sound after {:.0} ms, in {} steps", 1000.0 * after, steps.len());
    let allowance_s = stage.lateness.allowance_s();
    assert!(after < FALLBACK_S + SLACK_S + allowance_s, "{what}: {after} s, {allowance_s} s late");
    assert!(steps.len() >= 2 || stage.lateness.worst_s() >= STEPS_MISSED_S, "{what}: at once: {steps:?}");
}

fn expect_return(stage: &Stage, what: &str, repaired: SystemTime) {
    let line = stage.wait("return of sound", Line::pays, Some(repaired)).unwrap();
    println!("{what}: sound is back after {:.0} ms", 1000.0 * line.seconds_after(repaired));
}

#[test]
fn an_output_that_is_unplugged_and_plugged_in_again() {
    let mut stage = loud();
    let failed = SystemTime::now();
    stage.server.unplug("out").unwrap();
    expect_fallback(&stage, "unplugged", failed);
    stage.wait_for_log("not captured: the ").unwrap();
    let repaired = SystemTime::now();
    stage.server.plug(OUT).unwrap();
    stage.play_again().unwrap();
    play(&stage);
    expect_return(&stage, "plugged in again", repaired);
    stage.finish().unwrap();
}

/// A server moves recordings to the default input when their source goes away.
#[test]
fn an_output_that_is_unplugged_does_not_lead_to_the_microphone() {
    let stage = loud();
    stage.server.command("load-module module-sine-source source_name=microphone rate=48000").unwrap();
    stage.server.command("set-default-source microphone").unwrap();
    let failed = SystemTime::now();
    stage.server.unplug("out").unwrap();
    expect_fallback(&stage, "unplugged beside a microphone", failed);
    let silent = SystemTime::now();
    std::thread::sleep(Duration::from_millis(1500));
    let heard: Vec<Line> = stage.features().into_iter().filter(|line| line.time() > silent).collect();
    assert!(heard.iter().all(|line| !line.pays()), "{heard:#?}");
    let outputs = stage.server.command("list-source-outputs").unwrap();
    assert!(outputs.contains("0 source output(s)"), "{outputs}");
    stage.finish().unwrap();
}

#[test]
fn a_server_that_is_killed_and_restarted() {
    let mut stage = loud();
    let failed = SystemTime::now();
    stage.server.kill();
    expect_fallback(&stage, "killed", failed);
    stage.wait_for_log("not captured: ").unwrap();
    let repaired = SystemTime::now();
    stage.server.restart().unwrap();
    stage.play_again().unwrap();
    play(&stage);
    expect_return(&stage, "restarted", repaired);
    stage.finish().unwrap();
}

#[test]
fn a_server_that_stands_still_for_half_a_minute() {
    let stage = loud();
    let failed = SystemTime::now();
    stage.server.set_stalled(true).unwrap();
    expect_fallback(&stage, "stalled", failed);
    // Longer than the time-out for the server: the connection is closed, and another one is made.
    std::thread::sleep(Duration::from_secs(30));
    let repaired = SystemTime::now();
    stage.server.set_stalled(false).unwrap();
    expect_return(&stage, "going on", repaired);
    stage.finish().unwrap();
}

#[test]
fn another_output_becomes_the_default() {
    let stage = loud();
    stage.server.plug(Sink { name: "other", sample_rate_hz: 44_100 }).unwrap();
    let switched = SystemTime::now();
    stage.server.command("set-default-sink other").unwrap();
    // Some servers leave running streams on their previous output.
    stage.server.command("move-sink-input 0 other").unwrap();
    stage.wait_for_log("other.monitor").unwrap();
    expect_return(&stage, "switched", switched);
    stage.server.unplug("other").unwrap();
    // Not an interruption of sound, which a busy machine may not show.
    let is_of_first = |line: &str| line.contains("capturing ") && line.contains("out.monitor");
    stage.wait_for_log_lines(2, is_of_first).unwrap();
    // Later than that by more than the window: all that is heard then is of the first output.
    let captured = SystemTime::now() + Duration::from_secs(2);
    let is_whole = |line: &Line| line.pays() && line.confidence.is_some_and(|share| share > 0.95);
    stage.wait("sound of the first output", is_whole, Some(captured)).unwrap();
    stage.finish().unwrap();
}

#[test]
fn an_output_that_comes_back_at_another_rate() {
    let mut stage = loud();
    for sample_rate_hz in [44_100, 96_000, 44_100] {
        let failed = SystemTime::now();
        stage.server.unplug("out").unwrap();
        expect_fallback(&stage, "another rate", failed);
        let repaired = SystemTime::now();
        stage.server.plug(Sink { sample_rate_hz, ..OUT }).unwrap();
        // The server gives an output without streams the rate of the first stream that is played to it.
        stage.wait_for_log(&format!("out.monitor, {sample_rate_hz} Hz")).unwrap();
        stage.play_again().unwrap();
        play(&stage);
        expect_return(&stage, &format!("{sample_rate_hz} Hz"), repaired);
    }
    stage.finish().unwrap();
}

#[test]
fn a_stream_of_what_is_no_number() {
    let stage = loud();
    let failed = SystemTime::now();
    stage.player.play(vec![f32::NAN; 9600], true);
    expect_fallback(&stage, "no number", failed);
    let heard = stage.features();
    assert!(heard.iter().all(|line| line.gamma_ld.is_none_or(f32::is_finite)));
    let repaired = SystemTime::now();
    play(&stage);
    expect_return(&stage, "numbers", repaired);
    stage.finish().unwrap();
}
