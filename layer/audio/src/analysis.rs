//! The analysis of sound on a thread of its own: from samples in the ring to published features.

use crate::published::Set;
use crate::ring::Reader;
use crate::shared::{Begun, Shared};
use parafovea_core::audio::{AudioFeatures, Continuity, FeatureExtractor, FormatError, INTERVAL_S};
use std::time::Duration;

/// Interval at which the ring is emptied: the longest wait of a sound in it.
const PERIOD: Duration = Duration::from_millis(20);

/// Analyses sound until the capture ends.
pub fn run(shared: &Shared) {
    let mut stream = None;
    let mut serial = 0;
    while !shared.is_stopped() {
        if let Some(begun) = shared.take_begun() {
            stream = match Stream::new(begun, shared) {
                Ok(stream) => Some(stream),
                Err(error) => {
                    shared.messages.say(format!("not captured: {error}"));
                    None
                }
            };
        }
        if let Some(stream) = &mut stream {
            stream.analyse(shared, &mut serial);
        }
        std::thread::sleep(PERIOD);
    }
}

/// Facts of a stream.
struct Stream {
    begun: Begun,
    extractor: FeatureExtractor,
    continuity: Continuity,
    hop: Hop,
    /// Sets that are published: each so many hops.
    publish_every: u32,
    /// Hops that were not published yet.
    unpublished: u32,
    was_muted: bool,
}

/// Captured part of the hop that is not complete yet.
#[derive(Clone, Copy, Default)]
struct Hop {
    /// Samples of a whole hop.
    length: usize,
    taken: usize,
    unfit: usize,
}

impl Stream {
    fn new(begun: Begun, shared: &Shared) -> Result<Self, FormatError> {
        let settings = &shared.settings.features;
        let extractor = FeatureExtractor::new(begun.format.sample_rate_hz, begun.format.channels, settings)?;
        // As the extractor rounds: whole frames of 100 ms.
        let frames = (u64::from(begun.format.sample_rate_hz) / 10) as usize;
        let length = frames * begun.format.channels as usize;
        let publish_every = (shared.settings.interval_s / INTERVAL_S).round().clamp(1.0, 10.0) as u32;
        Ok(Self {
            begun,
            extractor,
            continuity: Continuity::new(settings),
            hop: Hop { length, ..Hop::default() },
            publish_every,
            unpublished: 0,
            was_muted: false,
        })
    }

    /// Takes the sound that waits in the ring.
    fn analyse(&mut self, shared: &Shared, serial: &mut u64) {
        let is_muted = shared.is_muted();
        if is_muted != self.was_muted {
            self.was_muted = is_muted;
            self.forget(shared);
        }
        let lost = self.begun.reader.lost() as usize;
        self.hop.unfit += lost;
        let Self {
            begun: Begun { reader, .. }, extractor, continuity, hop, publish_every, unpublished, ..
        } = self;
        for_hops(reader, hop, |hop, samples, is_complete| {
            let mut newest = AudioFeatures::SILENT;
            if !is_muted {
                extractor.push(samples, |features| newest = features);
            }
            if !is_complete {
                return;
            }
            continuity.push(1.0 - hop.unfit as f32 / hop.length as f32);
            *unpublished += 1;
            if *unpublished >= *publish_every || is_muted {
                *unpublished = 0;
                *serial += 1;
                let confidence = if is_muted { 1.0 } else { continuity.confidence() };
                let captured_ns = shared.now_ns();
                shared.published.publish(&Set { serial: *serial, captured_ns, features: newest, confidence });
            }
        });
    }

    /// Starts again with the same stream: sound from before a pause does not belong to the sound after it.
    fn forget(&mut self, shared: &Shared) {
        let format = self.begun.format;
        let settings = &shared.settings.features;
        // The format was understood before.
        if let Ok(extractor) = FeatureExtractor::new(format.sample_rate_hz, format.channels, settings) {
            self.extractor = extractor;
            self.continuity = Continuity::new(settings);
            self.hop = Hop { length: self.hop.length, ..Hop::default() };
        }
    }
}

/// Empties the ring in pieces that end where hops end; `take` gets each piece, and whether it completes the hop.
fn for_hops(reader: &mut Reader, hop: &mut Hop, mut take: impl FnMut(&Hop, &[f32], bool)) {
    reader.read(|mut samples| {
        while !samples.is_empty() {
            let (piece, later) = samples.split_at((hop.length - hop.taken).min(samples.len()));
            samples = later;
            hop.taken += piece.len();
            hop.unfit += piece.iter().filter(|sample| !sample.is_finite()).count();
            let is_complete = hop.taken == hop.length;
            take(hop, piece, is_complete);
            if is_complete {
                *hop = Hop { length: hop.length, ..Hop::default() };
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::{Format, Writer};
    use crate::settings::Settings;
    use std::f32::consts::TAU;

    const FORMAT: Format = Format { sample_rate_hz: 8_000, channels: 1 };

    /// Samples of a hop.
    const HOP: usize = 800;

    /// A stream that nothing was heard of yet, and the end where its samples come from.
    fn stream(settings: Settings) -> (Shared, Stream, Writer) {
        let shared = Shared::new(settings);
        let writer = shared.begin(FORMAT);
        let stream = Stream::new(shared.take_begun().unwrap(), &shared).unwrap();
        (shared, stream, writer)
    }

    fn tone(samples: usize) -> impl ExactSizeIterator<Item = f32> {
        (0..samples).map(|n| 0.5 * (TAU * 1000.0 * n as f32 / FORMAT.sample_rate_hz as f32).sin())
    }

    /// Hears so many hops of a tone.
    fn analyse(
        hops: usize,
        shared: &Shared,
        stream: &mut Stream,
        writer: &mut Writer,
        serial: &mut u64,
    ) -> Set {
        for _ in 0..hops {
            writer.write(tone(HOP));
            stream.analyse(shared, serial);
        }
        shared.published.newest().unwrap()
    }

    #[test]
    fn sets_come_as_often_as_asked_for() {
        for (interval_s, sets) in [(0.1, 30), (0.3, 10), (1.0, 3), (0.0, 30), (9.0, 3)] {
            let (shared, mut stream, mut writer) = stream(Settings { interval_s, ..Settings::default() });
            let mut serial = 0;
            let newest = analyse(30, &shared, &mut stream, &mut writer, &mut serial);
            assert_eq!((serial, newest.serial), (sets, sets), "{interval_s}");
            assert!(!newest.features.silent && (newest.confidence - 1.0).abs() < 1e-6, "{newest:?}");
        }
    }

    #[test]
    fn lost_or_invalid_samples_lower_the_confidence() {
        let (shared, mut stream, mut writer) = stream(Settings::default());
        let mut serial = 0;
        analyse(30, &shared, &mut stream, &mut writer, &mut serial);
        // Half a second fits into the ring: a quarter of a second is lost.
        writer.write(tone(6_000));
        stream.analyse(&shared, &mut serial);
        let lost = analyse(1, &shared, &mut stream, &mut writer, &mut serial).confidence;
        assert!(lost < 1.0, "{lost}");

        analyse(30, &shared, &mut stream, &mut writer, &mut serial);
        for _ in 0..2 {
            writer.write([f32::NAN; HOP].into_iter());
            stream.analyse(&shared, &mut serial);
        }
        assert_eq!(shared.published.newest().unwrap().confidence, 0.0);
    }

    #[test]
    fn a_muted_output_is_silence_and_forgotten() {
        let (shared, mut stream, mut writer) = stream(Settings::default());
        let mut serial = 0;
        analyse(30, &shared, &mut stream, &mut writer, &mut serial);
        shared.set_muted(true);
        let muted = analyse(1, &shared, &mut stream, &mut writer, &mut serial);
        assert_eq!((muted.features, muted.confidence), (AudioFeatures::SILENT, 1.0));
        shared.set_muted(false);
        let first = analyse(1, &shared, &mut stream, &mut writer, &mut serial);
        assert!(!first.features.silent && first.confidence < 0.1, "{first:?}");
    }

    #[test]
    fn steady_state_does_not_allocate() {
        let (shared, mut stream, mut writer) = stream(Settings::default());
        let mut serial = 0;
        analyse(31, &shared, &mut stream, &mut writer, &mut serial);
        let bytes: Vec<u8> = tone(HOP).flat_map(f32::to_le_bytes).collect();
        let callback = allocation_counter::measure(|| writer.write_f32_le(&bytes, 0.5));
        assert_eq!(callback.count_total, 0);
        let hearing = allocation_counter::measure(|| stream.analyse(&shared, &mut serial));
        assert_eq!(hearing.count_total, 0);
        let reading = allocation_counter::measure(|| _ = std::hint::black_box(shared.published.newest()));
        assert_eq!(reading.count_total, 0);
    }
}
