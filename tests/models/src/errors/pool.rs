//! From a map of errors to figures per ring.

use crate::errors::field::{Field, RINGS, TILE_PX};
use parafovea_core::image::Plane;
use serde::Serialize;

/// Pixels of a tile in a ring, in each frame of the time that it is judged over, that make it count for the worst tile:
/// a quarter of a tile.
const LEAST_PIXELS: u32 = TILE_PX * TILE_PX / 4;

/// The exponent with which changes at many places add up to detection: that of probability summation over space, "Probability summation and
/// regional variation in contrast sensitivity across the visual field" (Robson and Graham 1981).
const DETECTION: f64 = 3.5;

/// Sums of a map's values and its pixels, by tile and ring, over one or more frames of one eye.
#[derive(Clone, Debug, Default)]
pub(crate) struct TileSums {
    values: Vec<[f64; RINGS]>,
    pixels: Vec<[u32; RINGS]>,
    frames: u32,
    /// Sum of the values to the power of [`DETECTION`], all pixels together.
    powers: f64,
}

impl TileSums {
    /// Adds one value for each pixel.
    pub fn add_map(&mut self, field: &Field, map: &Plane) {
        self.count(field);
        let (width, across) = (field.extent[0] as usize, field.tiles[0] as usize);
        let rows = map.texels().chunks_exact(width).zip(field.rings.chunks_exact(width));
        for (y, (values, rings)) in rows.enumerate() {
            let tiles = &mut self.values[y / TILE_PX as usize * across..][..across];
            let parts = values.chunks(TILE_PX as usize).zip(rings.chunks(TILE_PX as usize));
            for (tile, (values, rings)) in tiles.iter_mut().zip(parts) {
                for (&value, &ring) in values.iter().zip(rings) {
                    let value = f64::from(value);
                    tile[ring as usize] += value;
                    // The power of DETECTION, without a logarithm.
                    self.powers += value * value * value * value.sqrt();
                }
            }
        }
    }

    /// Adds one value for all pixels of each tile; tiles without one do not count.
    pub fn add_tiles(&mut self, field: &Field, values: impl Iterator<Item = Option<f32>>) {
        self.resize(field);
        for (((sum, pixels), counts), value) in
            self.values.iter_mut().zip(&mut self.pixels).zip(&field.tile_pixels).zip(values)
        {
            let Some(value) = value else { continue };
            for ring in 0..RINGS {
                sum[ring] += f64::from(value) * f64::from(counts[ring]);
                pixels[ring] += counts[ring];
            }
        }
        self.frames += 1;
    }

    /// Adds a value that `pixels` pixels of a tile have, all in one ring, to pixels that [`Self::add_zeros`] counted.
    pub fn add_value(&mut self, tile: usize, ring: u8, value: f32, pixels: u32) {
        self.values[tile][ring as usize] += f64::from(value) * f64::from(pixels);
    }

    /// Adds a map of zeros.
    pub fn add_zeros(&mut self, field: &Field) {
        self.count(field);
    }

    fn count(&mut self, field: &Field) {
        self.resize(field);
        for (sum, counts) in self.pixels.iter_mut().zip(&field.tile_pixels) {
            for ring in 0..RINGS {
                sum[ring] += counts[ring];
            }
        }
        self.frames += 1;
    }

    fn resize(&mut self, field: &Field) {
        self.values.resize(field.tile_pixels.len(), [0.0; RINGS]);
        self.pixels.resize(field.tile_pixels.len(), [0; RINGS]);
    }
}

/// Error and position of the worst tile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WorstTile {
    /// Mean error of its pixels in the ring.
    pub value: f64,
    /// 0 left, 1 right.
    pub eye: usize,
    /// Index of the frame; `None` for metrics of the whole clip.
    pub frame: Option<usize>,
    /// Its upper left pixel.
    pub pixel: [u32; 2],
}

/// One metric's figures, ring by ring.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pool {
    sums: [f64; RINGS],
    pixels: [u64; RINGS],
    worst: [Option<WorstTile>; RINGS],
    /// All rings and eyes, frame by frame, of metrics per frame.
    frames: Vec<FrameSums>,
}

/// Sums over all pixels of a frame.
#[derive(Clone, Copy, Debug, Default)]
struct FrameSums {
    values: f64,
    powers: f64,
    pixels: u64,
}

impl Pool {
    /// Takes in the sums of one eye; `of_mean` turns a tile's mean into its error (for instance power into RMS).
    ///
    /// A tile counts with its pixels in the ring, if these are [`LEAST_PIXELS`] or, in rings that are smaller, as many
    /// as any tile has.
    pub fn close(
        &mut self,
        sums: &TileSums,
        field: &Field,
        (eye, frame): (usize, Option<usize>),
        of_mean: fn(f64) -> f64,
    ) {
        if let Some(frame) = frame {
            self.frames.resize(self.frames.len().max(frame + 1), FrameSums::default());
            let of_frame = &mut self.frames[frame];
            of_frame.values += sums.values.iter().flatten().sum::<f64>();
            of_frame.powers += sums.powers;
            of_frame.pixels += sums.pixels.iter().flatten().map(|&pixels| u64::from(pixels)).sum::<u64>();
        }
        for ring in 0..RINGS {
            let most = sums.pixels.iter().map(|pixels| pixels[ring]).max().unwrap_or(0);
            let least = most.min(LEAST_PIXELS * sums.frames).max(1);
            for (tile, (values, pixels)) in sums.values.iter().zip(&sums.pixels).enumerate() {
                self.sums[ring] += values[ring];
                self.pixels[ring] += u64::from(pixels[ring]);
                if pixels[ring] < least {
                    continue;
                }
                let value = of_mean(values[ring] / f64::from(pixels[ring]));
                if self.worst[ring].is_none_or(|worst| value > worst.value) {
                    let pixel = field.tile_origin(tile);
                    self.worst[ring] = Some(WorstTile { value, eye, frame, pixel });
                }
            }
        }
    }

    /// Mean over the pixels of a ring, `None` where no picture shows it.
    pub fn mean(&self, ring: usize) -> Option<f64> {
        (self.pixels[ring] > 0).then(|| self.sums[ring] / self.pixels[ring] as f64)
    }

    /// Mean over the whole view of both eyes, frame by frame; empty for metrics of the whole clip.
    pub fn frame_means(&self) -> Vec<Option<f64>> {
        let mean = |sums: &FrameSums| (sums.pixels > 0).then(|| sums.values / sums.pixels as f64);
        self.frames.iter().map(mean).collect()
    }

    /// As [`Self::frame_means`], the mean of probability summation: the root of the mean of powers of 3.5. For maps of JND; 0 for metrics by
    /// tiles.
    pub fn detected_in_frames(&self) -> Vec<Option<f64>> {
        let mean = |sums: &FrameSums| sums.powers / sums.pixels as f64;
        let detected = |sums: &FrameSums| (sums.pixels > 0).then(|| mean(sums).powf(1.0 / DETECTION));
        self.frames.iter().map(detected).collect()
    }

    /// Pixels that the mean was taken over, in all frames and both eyes together.
    pub fn pixels(&self, ring: usize) -> u64 {
        self.pixels[ring]
    }

    /// The worst tile of a ring.
    pub fn worst(&self, ring: usize) -> Option<WorstTile> {
        self.worst[ring]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detection_adds_up_by_powers() {
        let mut pool = Pool::default();
        let sums = |powers| FrameSums { values: 0.0, powers, pixels: 4 };
        // One of four pixels with 2 JND, and all of them with 0.5.
        pool.frames = vec![sums(2f64.powf(3.5)), sums(4.0 * 0.5f64.powf(3.5)), FrameSums::default()];
        let detected = pool.detected_in_frames();
        assert!((detected[0].unwrap() - 2.0 * 0.25f64.powf(1.0 / 3.5)).abs() < 1e-12);
        assert!((detected[1].unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(detected[2], None);
    }
}
