//! Timed turns, and the layer's own account at their end.

use super::{Exhibit, work};
use crate::HarnessError;
use crate::measure::{Effort, Player, Samples, Technique, play_in_turn, start_all};
use crate::progress::Progress;
use parafovea_manifest::status::Status;
use std::thread::sleep;
use std::time::Duration;

/// Frames behind the timed ones, in which the layer is asked for its status. It writes that once a second.
const ASKING: u64 = 40;

/// Between two of those frames: the layer takes a frame's figures 100 ms before it writes them.
const PAUSE: Duration = Duration::from_millis(80);

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
    let with_asking = Effort { frames: effort.frames + ASKING, ..effort };
    for turn in 1..=effort.turns {
        let names: Vec<&str> = techniques.iter().map(|technique| technique.name.as_str()).collect();
        let step = format!("{}: turn {turn} of {}, {}", exhibit.name(), effort.turns, names.join(" | "));
        progress.next(&step);
        let mut players = start_all(&exhibit.subject, techniques, with_asking, false, |_, _| {})?;
        play_in_turn(&mut players, effort.frames);
        for ((mut player, technique), timed) in players.into_iter().zip(techniques).zip(&mut all) {
            let own = with_asking.of(technique);
            if turn == effort.turns && technique.has_layer() {
                timed.status = status(&mut player, own.run_up + effort.frames);
            }
            let outcome = player.finish()?.expect_frames(own.length())?;
            let mut cpu_ms = outcome.record.cpu_ms_of_frames(own.run_up);
            cpu_ms.truncate(effort.frames as usize);
            timed.cpu_ms.push(cpu_ms);
            progress.add(work::rendering(exhibit, effort.of(technique)));
        }
    }
    Ok(all)
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
