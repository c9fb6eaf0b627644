//! Tests whose server goes away in the middle, and is waited for: each fails within its limit.

use parafovea_sound::pipewire::PipeWire;
use parafovea_sound::player::{BUFFER_MS, Player};
use parafovea_sound::stage::{SAMPLE_RATE_HZ, Stage, application, configuration};
use parafovea_trial::{Ending, Trial};
use std::time::{Duration, SystemTime};

/// Long enough for the servers to start on most machines.
const LIMIT: Duration = Duration::from_secs(6);

/// The longest limit that a machine gets on which they take longer.
const LONGEST_LIMIT: Duration = Duration::from_secs(100);

/// Printed by the tests once their server is gone.
const GONE: &str = "the server is gone";

/// Additional time for the end of all its processes on a busy machine.
const SLACK: Duration = Duration::from_secs(30);

/// Runs one of the ignored tests below as `cargo dev test` runs a test, with a shorter limit.
fn assert_fails_in_time(name: &str) {
    let name = format!("limits::{name}");
    let binary = std::env::current_exe().unwrap();
    let trial = Trial { binary, name: Some(name), even_ignored: true, folder: None };
    let mut limit = LIMIT;
    loop {
        let (ending, watched) = trial.run(limit).unwrap();
        assert!(matches!(ending, Ending::Failed(_) | Ending::OverLimit), "{ending:?}\n{}", watched.output);
        assert!(watched.time < limit + SLACK, "{:?}\n{}", watched.time, watched.output);
        if watched.output.contains(GONE) {
            println!("{ending:?} after {:.1} s\n{}", watched.time.as_secs_f64(), watched.output);
            return;
        }
        limit *= 2;
        assert!(limit < LONGEST_LIMIT, "the server is never there\n{}", watched.output);
    }
}

#[test]
fn without_wireplumber_a_test_fails_in_time() {
    assert_fails_in_time("wireplumber_killed");
}

#[test]
fn without_pulseaudio_a_test_fails_in_time() {
    assert_fails_in_time("pulseaudio_killed");
}

#[test]
fn with_a_runtime_that_stands_still_a_test_fails_in_time() {
    assert_fails_in_time("runtime_stalled");
}

#[test]
#[ignore = "started by other tests, and fails"]
fn wireplumber_killed() {
    let mut server = PipeWire::start().unwrap();
    server.kill("wireplumber");
    println!("{GONE}");
    Player::new(&server.socket(), SAMPLE_RATE_HZ, BUFFER_MS).unwrap();
}

#[test]
#[ignore = "started by other tests, and fails"]
fn pulseaudio_killed() {
    let mut stage = Stage::new("window_s = 1.0").unwrap();
    let killed = SystemTime::now();
    stage.server.kill();
    println!("{GONE}");
    stage.wait("sound", |line| line.pays(), Some(killed)).unwrap();
}

#[test]
#[ignore = "started by other tests, and fails"]
fn runtime_stalled() {
    let running = application().unwrap().on(&configuration("source = \"off\"")).start().unwrap();
    // SAFETY: sends a signal to a child of ours that was not waited for yet.
    assert_eq!(unsafe { libc::kill(running.process_id() as libc::pid_t, libc::SIGSTOP) }, 0);
    println!("{GONE}");
    running.quit().unwrap().expect_end().unwrap();
}
