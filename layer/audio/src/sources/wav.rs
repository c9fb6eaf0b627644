//! A WAV file as the source of sound: for tests and demos.

use crate::ring::Format;
use crate::shared::Shared;
use crate::wav::{Wav, WavError};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::time::{Duration, Instant};

/// Interval at which samples are handed on.
const PERIOD: Duration = Duration::from_millis(20);

/// Later samples were not late: the process stood still, and does not catch up.
const LATEST: Duration = Duration::from_millis(200);

/// Plays a file over and over into the ring, as fast as it would be played, until the capture ends.
pub fn play(path: &Path, shared: &Shared) {
    if let Err(error) = play_on(path, shared) {
        shared.messages.say(format!("not captured: {}: {error}", path.display()));
    }
}

fn play_on(path: &Path, shared: &Shared) -> Result<(), WavError> {
    let mut file = Wav::new(BufReader::new(File::open(path).map_err(hound::Error::from)?))?;
    let format @ Format { sample_rate_hz, channels } = file.format();
    shared.messages.say(format!("capturing {} ({sample_rate_hz} Hz, {channels} channels)", path.display()));
    let mut writer = shared.begin(format);
    let mut piece = Vec::new();
    let (mut start, mut played) = (Instant::now(), 0u64);
    while !shared.is_stopped() {
        let due = (start.elapsed().as_secs_f64() * f64::from(sample_rate_hz)) as u64;
        if due - played > (LATEST.as_secs_f64() * f64::from(sample_rate_hz)) as u64 {
            (start, played) = (Instant::now(), 0);
            continue;
        }
        while played < due {
            let missing = u32::try_from(due - played).unwrap_or(u32::MAX);
            played += u64::from(file.read(missing, &mut piece)?);
            writer.write(piece.iter().copied());
        }
        std::thread::sleep(PERIOD);
    }
    Ok(())
}
