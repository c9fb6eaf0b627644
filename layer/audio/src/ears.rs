//! The thread that hears: from samples in the ring to features that are published.

use crate::published::Set;
use crate::ring::Reader;
use crate::shared::{Begun, Shared};
use parafovea_core::audio::{AudioFeatures, Continuity, FeatureExtractor, FormatError, INTERVAL_S};
use std::time::Duration;

/// How often the ring is emptied: what a sound waits in it at most.
const PERIOD: Duration = Duration::from_millis(20);

/// Hears until the capture ends.
pub fn run(shared: &Shared) {
    let mut stream = None;
    let mut serial = 0;
    while !shared.is_stopped() {
        if let Some(begun) = shared.take_begun() {
            stream = match Stream::new(begun, shared) {
                Ok(stream) => Some(stream),
                Err(error) => {
                    shared.news.say(format!("hears nothing: {error}"));
                    None
                }
            };
        }
        if let Some(stream) = &mut stream {
            stream.hear(shared, &mut serial);
        }
        std::thread::sleep(PERIOD);
    }
}

/// What is known of a stream.
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

/// How much of the hop that is not complete yet was heard.
#[derive(Clone, Copy, Default)]
struct Hop {
    /// Samples of a whole hop.
    length: usize,
    heard: usize,
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

    /// Hears what waits in the ring.
    fn hear(&mut self, shared: &Shared, serial: &mut u64) {
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
                let heard_ns = shared.now_ns();
                shared.published.publish(&Set { serial: *serial, heard_ns, features: newest, confidence });
            }
        });
    }

    /// Begins anew with the same stream: what was heard before a pause is not what is heard after it.
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
            let (piece, later) = samples.split_at((hop.length - hop.heard).min(samples.len()));
            samples = later;
            hop.heard += piece.len();
            hop.unfit += piece.iter().filter(|sample| !sample.is_finite()).count();
            let is_complete = hop.heard == hop.length;
            take(hop, piece, is_complete);
            if is_complete {
                *hop = Hop { length: hop.length, ..Hop::default() };
            }
        }
    });
}
