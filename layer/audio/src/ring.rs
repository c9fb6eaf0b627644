//! The one place where samples wait: a ring between the capturing thread and the analysing thread.

use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Capacity, milliseconds of sound: several times as much as comes in one piece.
const LENGTH_MS: u64 = 500;

/// The format of a stream's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Frames a second.
    pub sample_rate_hz: u32,
    /// Interleaved channels, in the order that [`parafovea_core::audio`] states.
    pub channels: u32,
}

/// A ring for a stream of this format.
pub fn ring(format: Format) -> (Writer, Reader) {
    // Whole frames: if the ring is full, none is cut, which would give its other samples to the wrong channels.
    let frames = (u64::from(format.sample_rate_hz) * LENGTH_MS / 1000).max(1);
    let (producer, consumer) = RingBuffer::new((frames * u64::from(format.channels)) as usize);
    let lost = Arc::new(AtomicU64::new(0));
    (Writer { producer, lost: lost.clone() }, Reader { consumer, lost })
}

/// The end that a callback has: neither waits nor allocates.
pub struct Writer {
    producer: Producer<f32>,
    lost: Arc<AtomicU64>,
}

impl Writer {
    /// Writes samples, of full scale 1. Samples that do not fit are lost, and counted.
    pub fn write(&mut self, samples: impl ExactSizeIterator<Item = f32>) {
        let count = samples.len();
        let room = self.producer.slots().min(count);
        let written = match self.producer.write_chunk_uninit(room) {
            Ok(chunk) => chunk.fill_from_iter(samples),
            Err(_) => 0,
        };
        if written < count {
            self.lost.fetch_add((count - written) as u64, Ordering::Relaxed);
        }
    }

    /// Writes samples as they come from a server: little-endian floats, multiplied by `gain`. Bytes beyond the last whole one are left out.
    pub fn write_f32_le(&mut self, bytes: &[u8], gain: f32) {
        let (samples, _) = bytes.as_chunks::<4>();
        self.write(samples.iter().map(|sample| gain * f32::from_le_bytes(*sample)));
    }
}

/// The end of the analysing thread.
pub struct Reader {
    consumer: Consumer<f32>,
    lost: Arc<AtomicU64>,
}

impl Reader {
    /// Hands everything that waits to `take`, in up to two pieces.
    pub fn read(&mut self, mut take: impl FnMut(&[f32])) {
        let waiting = self.consumer.slots();
        if let Ok(chunk) = self.consumer.read_chunk(waiting) {
            let (first, second) = chunk.as_slices();
            take(first);
            take(second);
            chunk.commit_all();
        }
    }

    /// Number of samples that were lost since the last call.
    pub fn lost(&self) -> u64 {
        self.lost.swap(0, Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overflow_is_counted_and_order_is_kept() {
        let (mut writer, mut reader) = ring(Format { sample_rate_hz: 100, channels: 1 });
        let samples: Vec<f32> = (0..60).map(|n| n as f32).collect();
        writer.write(samples.iter().copied());
        let mut read = Vec::new();
        reader.read(|piece| read.extend_from_slice(piece));
        assert_eq!(read, samples[..50]);
        assert_eq!((reader.lost(), reader.lost()), (10, 0));

        let bytes: Vec<u8> = samples[..30].iter().flat_map(|sample| sample.to_le_bytes()).collect();
        read.clear();
        writer.write_f32_le(&bytes[..119], 1.0);
        reader.read(|piece| read.extend_from_slice(piece));
        assert_eq!(read, samples[..29], "around the end of the ring, without the broken sample");
        read.clear();
        writer.write_f32_le(&bytes[..12], 0.5);
        reader.read(|piece| read.extend_from_slice(piece));
        assert_eq!(read, [0.0, 0.5, 1.0]);
    }

    #[test]
    fn an_overflow_cuts_no_frame() {
        for channels in [1, 2, 6, 8] {
            let (mut writer, mut reader) = ring(Format { sample_rate_hz: 11_025, channels });
            let channel = |sample: usize| (sample % channels as usize) as f32;
            for _ in 0..3 {
                writer.write((0..11_025 * channels as usize).map(channel));
                let mut read = Vec::new();
                reader.read(|piece| read.extend_from_slice(piece));
                assert!(
                    !read.is_empty() && read.len().is_multiple_of(channels as usize),
                    "{channels} channels"
                );
                assert!(read.iter().enumerate().all(|(sample, value)| *value == channel(sample)));
            }
        }
    }
}
