//! A WAV file as what is heard: for tests and demos.

use crate::ring::Format;
use crate::shared::Shared;
use hound::{SampleFormat, WavReader};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::time::{Duration, Instant};

/// How often samples are handed on.
const PERIOD: Duration = Duration::from_millis(20);

/// What is late by more was not late: the process stood still, and does not catch up.
const LATEST: Duration = Duration::from_millis(200);

/// Plays a file over and over into the ring, as fast as it would be played, until the capture ends.
pub fn play(path: &Path, shared: &Shared) {
    if let Err(error) = play_on(path, shared) {
        shared.news.say(format!("hears nothing: {}: {error}", path.display()));
    }
}

fn play_on(path: &Path, shared: &Shared) -> Result<(), hound::Error> {
    let mut file = WavReader::open(path)?;
    let spec = file.spec();
    let format = Format { sample_rate_hz: spec.sample_rate, channels: u32::from(spec.channels) };
    let frames = file.duration();
    if frames == 0 || spec.channels == 0 {
        return Err(hound::Error::FormatError("it has no samples"));
    }
    let Format { sample_rate_hz, channels } = format;
    shared.news.say(format!("listens to {} ({sample_rate_hz} Hz, {channels} channels)", path.display()));
    let mut writer = shared.begin(format);
    let mut piece = Vec::new();
    let (mut start, mut played, mut position) = (Instant::now(), 0u64, 0u32);
    while !shared.is_stopped() {
        let due = (start.elapsed().as_secs_f64() * f64::from(sample_rate_hz)) as u64;
        if due - played > (LATEST.as_secs_f64() * f64::from(sample_rate_hz)) as u64 {
            (start, played) = (Instant::now(), 0);
            continue;
        }
        while played < due {
            let count = (due - played).min(u64::from(frames - position)) as u32;
            read(&mut file, count as usize * usize::from(spec.channels), &mut piece)?;
            writer.write(piece.iter().copied());
            played += u64::from(count);
            position += count;
            if position == frames {
                file.seek(0)?;
                position = 0;
            }
        }
        std::thread::sleep(PERIOD);
    }
    Ok(())
}

/// The next `count` samples, of full scale 1.
fn read(
    file: &mut WavReader<BufReader<File>>,
    count: usize,
    piece: &mut Vec<f32>,
) -> Result<(), hound::Error> {
    let spec = file.spec();
    piece.clear();
    match spec.sample_format {
        SampleFormat::Float => {
            for sample in file.samples::<f32>().take(count) {
                piece.push(sample?);
            }
        }
        SampleFormat::Int => {
            let scale = 1.0 / (1i64 << (spec.bits_per_sample.max(1) - 1)) as f32;
            for sample in file.samples::<i32>().take(count) {
                piece.push(sample? as f32 * scale);
            }
        }
    }
    Ok(())
}
