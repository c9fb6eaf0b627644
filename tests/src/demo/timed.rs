//! Timed turns, and the layer's own account at their end.

use super::{Exhibit, work};
use crate::HarnessError;
use crate::measure::{Effort, Player, Samples, Technique, play_in_turn, start_all};
use crate::progress::Progress;
use parafovea_manifest::status::Status;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Frames behind the timed ones, in which the layer is asked for its status. It writes that once a second.
const ASKING: u64 = 40;

/// Most frames that the gate has for its decision: 30 s at the runtime's 90 Hz, in which each trial ends.
const DECIDING: u64 = 2700;

/// Most time that the gate has for its decision.
const DECIDING_TIME: Duration = Duration::from_secs(60);

/// Frames between two looks at the status.
const LOOK: u64 = 15;

/// Between two of those frames: the layer takes a frame's figures 100 ms before it writes them.
const PAUSE: Duration = Duration::from_millis(80);

/// Consecutive frames whose ratio counts as one measurement: the spread of a result is that of these blocks.
pub const BLOCK: usize = 10;

/// Times of one technique.
pub struct Timed {
    /// CPU time of the process, milliseconds a frame.
    pub cpu_ms: Samples,
    /// The layer's status after the last turn; none without the layer.
    pub status: Option<Status>,
}

/// Times `techniques`, the first of which is the baseline, side by side.
///
/// # Errors
/// Those of the harness, and an application that does not come to its end.
pub fn time(
    exhibit: &Exhibit,
    techniques: &[Technique],
    effort: Effort,
    progress: &mut Progress,
) -> Result<Vec<Timed>, HarnessError> {
    let none = || Timed { cpu_ms: Samples::default(), status: None };
    let mut all: Vec<Timed> = techniques.iter().map(|_| none()).collect();
    // Players are stopped as soon as they are not needed any more.
    let longest = Effort { frames: DECIDING + effort.frames + ASKING, ..effort };
    for turn in 1..=effort.turns {
        let names: Vec<&str> = techniques.iter().map(|technique| technique.name.as_str()).collect();
        let step = format!("{}: turn {turn} of {}, {}", exhibit.name(), effort.turns, names.join(" | "));
        progress.next(&step);
        let mut players = start_all(&exhibit.subject, techniques, longest, false, |_, _| {})?;
        let deciding = decide(&mut players, techniques, effort.run_up);
        play_in_turn(&mut players, effort.frames);
        for ((mut player, technique), timed) in players.into_iter().zip(techniques).zip(&mut all) {
            let run_up = effort.of(technique).run_up + deciding;
            if turn == effort.turns && technique.has_layer() {
                timed.status = status(&mut player, run_up + effort.frames);
            }
            let mut cpu_ms = player.stop(run_up + effort.frames)?.cpu_ms_of_frames(run_up);
            cpu_ms.truncate(effort.frames as usize);
            cpu_ms.chunks(BLOCK).for_each(|block| timed.cpu_ms.push(block.to_vec()));
            progress.add(work::rendering(exhibit, effort.of(technique)));
        }
    }
    Ok(all)
}

/// Lets all, which have had `run_up` frames, play on until no gate of theirs has a decision to make, and returns the frames that took.
fn decide(players: &mut [Player], techniques: &[Technique], run_up: u64) -> u64 {
    let start = Instant::now();
    let mut frames = 0;
    while frames < DECIDING && start.elapsed() < DECIDING_TIME && has_undecided(players, techniques, run_up) {
        play_in_turn(players, LOOK);
        frames += LOOK;
    }
    frames
}

/// Whether a layer has a decision to make; one whose status is of the first `run_up` frames may have.
fn has_undecided(players: &[Player], techniques: &[Technique], run_up: u64) -> bool {
    let layers = players.iter().zip(techniques).filter(|(_, technique)| technique.has_layer());
    let is_undecided = |status: Status| {
        let is_on_trial = status.backend != "none" && status.rates_gate.is_on_trial;
        status.inert.is_empty() && (status.frames < run_up || is_on_trial)
    };
    layers.map(|(player, _)| player.status()).any(|status| status.is_none_or(is_undecided))
}

/// The status that the layer writes after so many frames.
fn status(player: &mut Player, frames: u64) -> Option<Status> {
    for _ in 0..ASKING {
        player.play();
        sleep(PAUSE);
        let status = player.status();
        if status.as_ref().is_some_and(|status| status.frames >= frames) {
            return status;
        }
    }
    player.status()
}
