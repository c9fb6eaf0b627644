//! The sound of a scene, synthesised, with a known loudness.

mod instruments;
#[cfg(test)]
mod tests;

use std::io::{Cursor, Seek, Write};

use anyhow::{Context, Result, bail};
use ebur128::{EbuR128, Mode};

use self::instruments::Mix;
use super::DURATION_S;
use crate::scene::SceneName;

/// Frames a second of every sound.
pub const RATE_HZ: u32 = 48_000;

/// A sound to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sound {
    /// The scene that it suits.
    pub scene: SceneName,
    /// Integrated loudness over its whole length (EBU R 128, ITU-R BS.1770-4), LUFS.
    pub loudness_lufs: f64,
}

impl Sound {
    /// The sound, 16 bits, left and right in turn, as long as the script.
    ///
    /// # Errors
    /// If it cannot be made as loud as it should be without clipping.
    pub fn samples(&self) -> Result<Vec<i16>> {
        let mut frames = self.mix();
        let gain = 10f64.powf((self.loudness_lufs - integrated_lufs(&frames)?) / 20.0) as f32;
        for sample in &mut frames {
            *sample *= gain;
        }
        if frames.iter().any(|sample| sample.abs() >= 1.0) {
            bail!("the sound of {:?} clips at {} LUFS", self.scene, self.loudness_lufs);
        }
        Ok(frames.into_iter().map(|sample| (sample * 32_767.0).round() as i16).collect())
    }

    /// The sound as a WAV file.
    ///
    /// # Errors
    /// Errors of [`Self::samples`] and of writing.
    pub fn write_wav(&self, to: impl Write + Seek) -> Result<()> {
        let spec = hound::WavSpec {
            channels: 2,
            sample_rate: RATE_HZ,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let mut writer = hound::WavWriter::new(to, spec)?;
        let samples = self.samples()?;
        let mut block = writer.get_i16_writer(samples.len() as u32);
        samples.into_iter().for_each(|sample| block.write_sample(sample));
        block.flush()?;
        writer.finalize().context("writing the sound")
    }

    /// The bytes of the WAV file.
    ///
    /// # Errors
    /// Errors of [`Self::write_wav`].
    pub fn wav(&self) -> Result<Vec<u8>> {
        let mut file = Cursor::new(Vec::new());
        self.write_wav(&mut file)?;
        Ok(file.into_inner())
    }

    /// The sound at the loudness of its parts' sum.
    fn mix(&self) -> Vec<f32> {
        let mut mix = Mix::new((DURATION_S * f64::from(RATE_HZ)) as usize);
        match self.scene {
            SceneName::Courtyard => {
                mix.wind(0.10, 900.0, 1);
                mix.birds(0.12, 9, 2);
                mix.steps(0.25, 0.62, 3);
            }
            SceneName::Cockpit => {
                mix.engine(0.35, 47.0, 4);
                mix.wind(0.35, 2200.0, 5);
            }
            SceneName::Foliage => {
                mix.wind(0.3, 1600.0, 6);
                mix.birds(0.10, 16, 7);
            }
            SceneName::Generated(_, seed) => {
                mix.wind(0.15, 1200.0, seed);
                mix.steps(0.2, 0.6, seed ^ 1);
            }
            SceneName::Library => {
                mix.wind(0.04, 300.0, 8);
                mix.ticks(0.25, 1.0);
                mix.steps(0.08, 0.75, 9);
            }
            SceneName::Interior => {
                mix.engine(0.06, 100.0, 10);
                mix.wind(0.12, 700.0, 11);
                mix.steps(0.2, 0.58, 12);
            }
            SceneName::Street => {
                mix.passing_cars(0.5, 4, 13);
                mix.engine(0.06, 31.0, 14);
                mix.murmur(0.06, 4, 15);
            }
            SceneName::Crowd => {
                mix.murmur(0.25, 14, 16);
                for walker in 0..5 {
                    mix.steps(0.12, 0.5 + 0.05 * f64::from(walker), 17 + walker);
                }
            }
        }
        mix.frames()
    }
}

/// Integrated loudness of a stereo sound.
fn integrated_lufs(frames: &[f32]) -> Result<f64> {
    let mut meter = EbuR128::new(2, RATE_HZ, Mode::I)?;
    meter.add_frames_f32(frames)?;
    Ok(meter.loudness_global()?)
}
