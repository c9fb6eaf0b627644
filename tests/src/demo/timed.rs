//! Timed turns, and the layer's own account at their end.

use super::{Exhibit, work};
use crate::HarnessError;
use crate::measure::{Effort, Player, Samples, Subject, Technique, play_in_turn, start_all};
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

/// Frames after the run-up within which the first trial begins where there is one: status files are up to a second old.
const BEFORE_TRIAL: u64 = 90;

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
/// Errors of the harness, and an application that does not finish.
pub fn time(
    exhibit: &Exhibit,
    techniques: &[Technique],
    effort: Effort,
    progress: &mut Progress,
) -> Result<Vec<Timed>, HarnessError> {
    let none = || Timed { cpu_ms: Samples::default(), status: None };
    let mut all: Vec<Timed> = techniques.iter().map(|_| none()).collect();
    // Players are stopped as soon as they are not needed any more.
    let longest = Effort { frames: DECIDING + exhibit.warming + effort.frames + ASKING, ..effort };
    for turn in 1..=effort.turns {
        let names: Vec<&str> = techniques.iter().map(|technique| technique.name.as_str()).collect();
        let step = format!("{}: turn {turn} of {}, {}", exhibit.name(), effort.turns, names.join(" | "));
        progress.next(&step);
        let start = |subject: &Subject, techniques| start_all(subject, techniques, longest, false, |_, _| {});
        let (baseline, layers) = techniques.split_at(1);
        let mut decided = start(&exhibit.subject, layers)?;
        let deciding = decide(&mut decided, effort.run_up);
        // Timed frames are the same ones of the script.
        let mut players = start(&exhibit.subject.later(deciding), baseline)?;
        players.append(&mut decided);
        play_in_turn(&mut players, exhibit.warming);
        play_in_turn(&mut players, effort.frames);
        for ((mut player, technique), timed) in players.into_iter().zip(techniques).zip(&mut all) {
            let deciding = if technique.has_layer() { deciding } else { 0 };
            let run_up = effort.of(technique).run_up + deciding + exhibit.warming;
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

/// Lets all, which have had `run_up` frames, play on until no gate has a decision to make, and returns the frames that took.
fn decide(players: &mut [Player], run_up: u64) -> u64 {
    let start = Instant::now();
    let mut frames = 0;
    while frames < DECIDING
        && start.elapsed() < DECIDING_TIME
        && players.iter().any(|player| is_undecided(player.status(), run_up))
    {
        play_in_turn(players, LOOK);
        frames += LOOK;
    }
    frames
}

/// Whether a layer with that status has a decision to make: its first trial may be yet to come, or one is in progress.
fn is_undecided(status: Option<Status>, run_up: u64) -> bool {
    status.is_none_or(|status| {
        let gate = &status.rates_gate;
        let may_begin = status.frames < run_up + BEFORE_TRIAL && gate.mode == "auto" && gate.ratio.is_none();
        let is_on_trial = status.backend != "none" && gate.is_on_trial;
        status.inert.is_empty() && (is_on_trial || may_begin)
    })
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
