//! The samples of a WAV file, over and over.

use crate::ring::Format;
use hound::{SampleFormat, WavReader};
use parafovea_core::audio::{FormatError, check_format};
use std::io::{Read, Seek};

/// Bits of the widest samples that are read.
const MAX_BITS: u16 = 32;

/// A file that is open.
pub struct Wav<R> {
    file: WavReader<R>,
    format: Format,
    frames: u32,
    position: u32,
}

/// Reason why a file cannot be read as sound.
#[derive(Debug, thiserror::Error)]
pub enum WavError {
    /// It cannot be read, or is no WAV file.
    #[error(transparent)]
    File(#[from] hound::Error),
    /// Its header asks for an unknown format.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// It has no frame.
    #[error("the file has no samples")]
    Empty,
}

impl<R: Read + Seek> Wav<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`WavError`].
    pub fn new(file: R) -> Result<Self, WavError> {
        let file = WavReader::new(file)?;
        let spec = file.spec();
        let format = Format { sample_rate_hz: spec.sample_rate, channels: u32::from(spec.channels) };
        // Checked before any allocation of the size that the header states.
        check_format(format.sample_rate_hz, format.channels)?;
        let frames = file.duration();
        if frames == 0 {
            return Err(WavError::Empty);
        }
        Ok(Self { file, format, frames, position: 0 })
    }

    /// The format of its samples.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Puts the next samples, of full scale 1, into `piece`: at most `frames` frames, fewer at the file's end, after which it starts again.
    /// Returns the number of frames.
    ///
    /// # Errors
    /// [`WavError::File`], also if samples are wider than 32 bits.
    pub fn read(&mut self, frames: u32, piece: &mut Vec<f32>) -> Result<u32, WavError> {
        let frames = frames.min(self.frames - self.position);
        let count = frames as usize * self.format.channels as usize;
        let spec = self.file.spec();
        piece.clear();
        match spec.sample_format {
            SampleFormat::Float => {
                for sample in self.file.samples::<f32>().take(count) {
                    piece.push(sample?);
                }
            }
            SampleFormat::Int => {
                // An extensible header may name any number of bits.
                let scale = 1.0 / (1i64 << (spec.bits_per_sample.clamp(1, MAX_BITS) - 1)) as f32;
                for sample in self.file.samples::<i32>().take(count) {
                    piece.push(sample? as f32 * scale);
                }
            }
        }
        self.position += frames;
        if self.position == self.frames {
            self.file.seek(0).map_err(hound::Error::from)?;
            self.position = 0;
        }
        Ok(frames)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// A file of 16-bit samples, with these values in its header.
    fn file(sample_rate_hz: u32, channels: u16, valid_bits: u16, samples: &[i16]) -> Cursor<Vec<u8>> {
        let data = 2 * samples.len() as u32;
        let block = 2 * u32::from(channels);
        let mut bytes = b"RIFF".to_vec();
        bytes.extend((60 + data).to_le_bytes());
        bytes.extend(b"WAVEfmt ");
        bytes.extend(40u32.to_le_bytes());
        bytes.extend(0xfffeu16.to_le_bytes());
        bytes.extend(channels.to_le_bytes());
        bytes.extend(sample_rate_hz.to_le_bytes());
        bytes.extend(sample_rate_hz.wrapping_mul(block).to_le_bytes());
        bytes.extend((block as u16).to_le_bytes());
        bytes.extend(16u16.to_le_bytes());
        bytes.extend(22u16.to_le_bytes());
        bytes.extend(valid_bits.to_le_bytes());
        bytes.extend(0u32.to_le_bytes());
        // KSDATAFORMAT_SUBTYPE_PCM
        bytes.extend([1, 0, 0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]);
        bytes.extend(b"data");
        bytes.extend(data.to_le_bytes());
        samples.iter().for_each(|sample| bytes.extend(sample.to_le_bytes()));
        Cursor::new(bytes)
    }

    #[test]
    fn samples_come_over_and_over() {
        let mut wav = Wav::new(file(8_000, 2, 16, &[16_384, -16_384, 0, -32_768, 32_767, 8_192])).unwrap();
        assert_eq!(wav.format(), Format { sample_rate_hz: 8_000, channels: 2 });
        let mut piece = Vec::new();
        assert_eq!(wav.read(2, &mut piece).unwrap(), 2);
        assert_eq!(piece, [0.5, -0.5, 0.0, -1.0]);
        assert_eq!(wav.read(2, &mut piece).unwrap(), 1);
        assert_eq!(piece.len(), 2);
        assert_eq!(wav.read(1, &mut piece).unwrap(), 1);
        assert_eq!(piece, [0.5, -0.5]);
    }

    /// No buffer gets as large as such a header states, and no bit is shifted out of a number.
    #[test]
    fn headers_that_no_device_has_are_refused() {
        let told = |sample_rate_hz, channels, bits| {
            let mut piece = Vec::new();
            let read = Wav::new(file(sample_rate_hz, channels, bits, &[0; 32]))
                .map(|mut wav| wav.read(1, &mut piece));
            match read {
                Ok(Ok(frames)) => format!("{frames} frames"),
                Ok(Err(error)) | Err(error) => error.to_string(),
            }
        };
        assert_eq!(told(48_000, 2, 16), "1 frames");
        assert_eq!(
            told(1_000_000_000, 2, 16),
            "a sample rate of 1000000000 Hz is not within 8000..=192000 Hz"
        );
        assert_eq!(told(0, 2, 16), "a sample rate of 0 Hz is not within 8000..=192000 Hz");
        assert_eq!(told(48_000, 32, 16), "32 channels are not within 1..=8");
        for bits in [33, 64, 400, u16::MAX] {
            let told = told(48_000, 2, bits);
            assert!(told != "1 frames" || bits <= MAX_BITS, "{bits} bits: {told}");
        }
        assert!(matches!(Wav::new(file(48_000, 2, 16, &[])).err(), Some(WavError::Empty)));
    }
}
