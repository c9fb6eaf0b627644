//! An application whose techniques are dropped: most of its frames pass without work of the layer.

use parafovea_manifest::status::Status;
use parafovea_tests::measure::Player;
use parafovea_tests::run::{Application, Run};
use parafovea_tests::scenario::{Scenario, ScenarioExt};
use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Most frames until the gate has decided: trials of 30 s at 90 Hz.
const DECIDING: u64 = 3000;

/// Most time for a change to appear in the status.
const PATIENCE: Duration = Duration::from_secs(60);

/// hello_xr, each of whose frames comes when it is let.
struct Playing {
    player: Player,
    frames: u64,
}

impl Playing {
    fn play(&mut self, frames: u64) {
        (0..frames).for_each(|_| self.player.play());
        self.frames += frames;
    }

    /// Plays until the status is as `is_there` demands.
    fn play_until(&mut self, is_there: impl Fn(&Status) -> bool) -> Status {
        let start = Instant::now();
        loop {
            self.play(1);
            let status = self.player.status();
            if let Some(status) = status.filter(|status| is_there(status)) {
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "{:?}", self.player.status());
            sleep(Duration::from_millis(20));
        }
    }
}

#[test]
fn a_dropped_technique_is_back_with_an_edit_of_the_configuration() {
    let application = Application::hello_xr("Vulkan2").unwrap();
    let scenario = Scenario::new(100_000).sized(128, 128);
    let gate = |mode: &str| format!("[rates]\ngate = \"{mode}\"\n");
    let configured = |run: Run| run.on(&gate("auto")).timeout(Duration::from_secs(300));
    let player = Player::alone(&application, scenario, configured).unwrap();
    let mut playing = Playing { player, frames: 0 };
    let is_dropped = |status: &Status| !status.rates_gate.is_kept && !status.rates_gate.is_on_trial;
    while !playing.player.status().as_ref().is_some_and(is_dropped) {
        assert!(playing.frames < DECIDING, "{:?}", playing.player.status());
        playing.play(30);
        sleep(Duration::from_millis(20));
    }

    // Three samples and the frames between them, which count although the layer has no work in them.
    playing.play(800);
    let frames = playing.frames;
    let status = playing.play_until(|status| status.frames >= frames);
    assert!(
        status.frames <= playing.frames && is_dropped(&status),
        "{} of {}",
        status.frames,
        playing.frames
    );
    assert_eq!(status.passes_matched, 0);

    fs::write(playing.player.config_file(), gate("on")).unwrap();
    playing.play_until(|status| status.rates_gate.mode == "on" && status.passes_matched == 2);
    let frames = playing.frames;
    playing.player.stop(frames).unwrap();
}
