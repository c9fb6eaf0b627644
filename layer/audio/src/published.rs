//! The newest features, for threads that must not wait.

use parafovea_core::audio::AudioFeatures;
use std::sync::atomic::{AtomicU64, Ordering, fence};

/// Number of tries of a reader when sets of features are written meanwhile. They come ten times a second, and to read them takes
/// nanoseconds.
const TRIES: u32 = 8;

/// Features, and their reliability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Set {
    /// Counts sets, from 1.
    pub serial: u64,
    /// Time of the last sample that counts, nanoseconds of the capture's clock.
    pub captured_ns: u64,
    /// The features.
    pub features: AudioFeatures,
    /// Share of the last seconds that was captured intact, 0..=1.
    pub confidence: f32,
}

/// One writer, any number of readers, none of which waits: a sequence lock whose readers give up after some tries.
#[derive(Debug, Default)]
pub struct Published {
    /// Odd while a set is being written; 0 before the first.
    sequence: AtomicU64,
    words: [AtomicU64; 5],
}

impl Published {
    /// Publishes the next set. To be called by one thread.
    pub fn publish(&self, set: &Set) {
        let before = self.sequence.load(Ordering::Relaxed);
        self.sequence.store(before.wrapping_add(1), Ordering::Relaxed);
        fence(Ordering::Release);
        for (word, value) in self.words.iter().zip(words(set)) {
            word.store(value, Ordering::Relaxed);
        }
        self.sequence.store(before.wrapping_add(2), Ordering::Release);
    }

    /// The newest set; nothing before the first.
    pub fn newest(&self) -> Option<Set> {
        for _ in 0..TRIES {
            let before = self.sequence.load(Ordering::Acquire);
            if before == 0 {
                return None;
            }
            let values = self.words.each_ref().map(|word| word.load(Ordering::Relaxed));
            fence(Ordering::Acquire);
            if before.is_multiple_of(2) && self.sequence.load(Ordering::Relaxed) == before {
                return Some(set(values));
            }
        }
        None
    }
}

fn words(set: &Set) -> [u64; 5] {
    let AudioFeatures { loudness_lufs, gamma_ld, gamma_fq_kilomel, silent } = set.features;
    let pair = |high: f32, low: f32| u64::from(high.to_bits()) << 32 | u64::from(low.to_bits());
    let last = pair(set.confidence, if silent { 1.0 } else { 0.0 });
    [set.serial, set.captured_ns, pair(loudness_lufs, gamma_ld), u64::from(gamma_fq_kilomel.to_bits()), last]
}

fn set([serial, captured_ns, levels, pitch, last]: [u64; 5]) -> Set {
    let high = |word: u64| f32::from_bits((word >> 32) as u32);
    let low = |word: u64| f32::from_bits(word as u32);
    let features = AudioFeatures {
        loudness_lufs: high(levels),
        gamma_ld: low(levels),
        gamma_fq_kilomel: low(pitch),
        silent: low(last) != 0.0,
    };
    Set { serial, captured_ns, features, confidence: high(last) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, AtomicUsize};

    /// A set with the same number in all parts.
    fn numbered(number: u64) -> Set {
        let value = number as f32;
        let features = AudioFeatures {
            loudness_lufs: value,
            gamma_ld: value,
            gamma_fq_kilomel: value,
            silent: number.is_multiple_of(2),
        };
        Set { serial: number, captured_ns: number, features, confidence: value }
    }

    #[test]
    fn a_set_comes_out_as_it_went_in() {
        let published = Published::default();
        assert_eq!(published.newest(), None);
        let silence =
            Set { serial: 7, captured_ns: u64::MAX, features: AudioFeatures::SILENT, confidence: 0.25 };
        for set in [numbered(1), silence] {
            published.publish(&set);
            assert_eq!(published.newest(), Some(set));
        }
    }

    #[test]
    fn readers_never_see_parts_of_two_sets() {
        let (published, is_over) = (Published::default(), AtomicBool::new(false));
        let reading = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            let reader = || {
                let mut last = 0;
                while !is_over.load(Ordering::Relaxed) {
                    if let Some(set) = published.newest() {
                        reading.fetch_add(usize::from(last == 0), Ordering::Relaxed);
                        assert_eq!(set, numbered(set.serial));
                        assert!(set.serial >= last);
                        last = set.serial;
                    }
                }
            };
            let readers = [scope.spawn(reader), scope.spawn(reader)];
            // On a busy machine readers may begin late: until all of them read.
            let mut number = 1;
            while number < 200_000 || reading.load(Ordering::Relaxed) < readers.len() {
                published.publish(&numbered(number));
                std::hint::spin_loop();
                number += 1;
            }
            is_over.store(true, Ordering::Relaxed);
            readers.into_iter().for_each(|reader| reader.join().unwrap());
        });
    }
}
