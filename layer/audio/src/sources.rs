//! Sources of samples: the thread that gets them, and writes them into the ring.

mod loopback;
mod pulse;
mod wav;

use crate::settings::Source;
use crate::shared::Shared;
use std::time::Duration;

/// Time after a failure until the next try.
const AGAIN: Duration = Duration::from_millis(250);

/// Gets samples until the capture ends.
pub fn run(shared: &Shared) {
    match &shared.settings.source {
        Source::File(path) => wav::play(path, shared),
        Source::System => listen(shared),
    }
}

/// To the sound server, as PulseAudio and PipeWire have it; where there is none, to ALSA's loop-back card.
fn listen(shared: &Shared) {
    while !shared.is_stopped() {
        let why = match pulse::listen(shared) {
            Ok(()) => return,
            Err(error) if error.is_absence() => match loopback::listen(shared, pulse::is_there) {
                Ok(()) => {
                    shared.sleep(AGAIN);
                    continue;
                }
                Err(nor) => format!("{error}, and {nor}"),
            },
            Err(error) => error.to_string(),
        };
        shared.set_muted(false);
        shared.messages.say(format!("not captured: {why}; retrying"));
        shared.sleep(AGAIN);
    }
}
