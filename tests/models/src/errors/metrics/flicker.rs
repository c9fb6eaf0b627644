//! Energy of the change at frequencies of visible flicker.
//!
//! At each pixel the change's luminance over that of the surroundings is a series over the clip. Its mean is taken out, it
//! is weighted by a Hann window of power 1 (the transform takes the series for periodic, and the step from its end
//! to its beginning would have all frequencies), and of its discrete Fourier transform the bins within [`BAND_HZ`]
//! remain. Transformed back, the power at each frame goes to the ring that the pixel lies in at that frame. The distance
//! of bins is the refresh rate over the number of frames; half the amplitude of the bin next to the band shows in it.

use crate::errors::field::{CELL_PX, Field, TILE_PX};
use crate::errors::pool::TileSums;
use parafovea_core::image::Plane;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex, num_complex::Complex};
use std::rc::Rc;
use std::sync::Arc;

/// From where periods of four frames and more blink at common refresh rates to where fusion begins in the fovea.
pub const BAND_HZ: [f32; 2] = [8.0, 30.0];

/// One eye's frames.
pub(crate) struct Series<'a> {
    /// Change of luminance, cd/m^2.
    pub changes: &'a [Plane],
    /// Geometry of each frame.
    pub fields: &'a [Rc<Field>],
    /// Mean adaptation luminance over the clip, by cell, cd/m^2.
    pub adaptation_cd_m2: &'a [f32],
}

/// Power of each pixel's, and of each tile's, change within the band. `None` for clips of less than two cycles of
/// the slowest flicker, 23 frames at 90 Hz.
pub(crate) fn power(series: &Series, refresh_hz: f32) -> Option<[TileSums; 2]> {
    let mut filter = BandPass::new(series.changes.len(), refresh_hz)?;
    let first = &series.fields[0];
    let mut sums = [TileSums::default(), TileSums::default()];
    series.fields.iter().for_each(|field| sums.iter_mut().for_each(|sums| sums.add_zeros(field)));
    let mut area = vec![0.0; series.changes.len()];
    for tile in 0..first.tile_pixels.len() {
        area.fill(0.0);
        let pixels = tile_pixels(first, tile);
        for index in pixels.clone() {
            let weight = 1.0 / series.adaptation_cd_m2[cell(first, index)];
            let change = series.changes.iter().map(|change| weight * change.texels()[index]);
            if !filter.load(change) {
                continue;
            }
            area.iter_mut().zip(&filter.frames).for_each(|(area, change)| *area += change);
            for (field, value) in series.fields.iter().zip(filter.pass()) {
                sums[0].add_value(tile, field.rings[index], value * value, 1);
            }
        }
        let count = pixels.count() as f32;
        if filter.load(area.iter().map(|sum| sum / count)) {
            for (field, value) in series.fields.iter().zip(filter.pass()) {
                for (ring, &count) in (0_u8..).zip(&field.tile_pixels[tile]) {
                    sums[1].add_value(tile, ring, value * value, count);
                }
            }
        }
    }
    Some(sums)
}

/// Indices of a tile's pixels.
fn tile_pixels(field: &Field, tile: usize) -> impl Iterator<Item = usize> + Clone {
    let [width, height] = field.extent;
    let [left, top] = field.tile_origin(tile);
    let columns = left..(left + TILE_PX).min(width);
    let rows = top..(top + TILE_PX).min(height);
    rows.flat_map(move |y| columns.clone().map(move |x| (y * width + x) as usize))
}

/// The cell that a pixel lies in.
fn cell(field: &Field, index: usize) -> usize {
    let (x, y) = (index % field.extent[0] as usize, index / field.extent[0] as usize);
    y / CELL_PX as usize * field.cells_across as usize + x / CELL_PX as usize
}

/// A filter with a room for one series.
struct BandPass {
    forward: Arc<dyn RealToComplex<f32>>,
    inverse: Arc<dyn ComplexToReal<f32>>,
    /// Bins that remain.
    bins: std::ops::RangeInclusive<usize>,
    frames: Vec<f32>,
    /// Hann's, with a mean square of 1.
    window: Vec<f32>,
    spectrum: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
}

impl BandPass {
    fn new(frames: usize, refresh_hz: f32) -> Option<Self> {
        let bin_hz = refresh_hz / frames.max(1) as f32;
        if 2.0 * bin_hz > BAND_HZ[0] {
            return None;
        }
        // The highest bin of an even number of frames is half the refresh rate, which the band may end at.
        let last = ((BAND_HZ[1] / bin_hz) as usize).min(frames / 2);
        let bins = (BAND_HZ[0] / bin_hz).ceil() as usize..=last;
        let mut planner = RealFftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(frames), planner.plan_fft_inverse(frames));
        let scratch = forward.get_scratch_len().max(inverse.get_scratch_len());
        Some(Self {
            bins,
            frames: forward.make_input_vec(),
            window: (0..frames).map(|at| hann((at as f32 + 0.5) / frames as f32)).collect(),
            spectrum: forward.make_output_vec(),
            scratch: vec![Complex::default(); scratch],
            forward,
            inverse,
        })
    }

    /// Takes a series; returns false if it is 0 throughout.
    fn load(&mut self, series: impl Iterator<Item = f32>) -> bool {
        self.frames.iter_mut().zip(series).for_each(|(to, from)| *to = from);
        self.frames.iter().any(|&value| value != 0.0)
    }

    /// The part of the series within the band.
    fn pass(&mut self) -> impl Iterator<Item = f32> + '_ {
        let count = self.frames.len();
        let mean = self.frames.iter().sum::<f32>() / count as f32;
        self.frames
            .iter_mut()
            .zip(&self.window)
            .for_each(|(value, weight)| *value = (*value - mean) * weight);
        // The buffers have the lengths of the plans: neither transform fails.
        let _ = self.forward.process_with_scratch(&mut self.frames, &mut self.spectrum, &mut self.scratch);
        for (bin, value) in self.spectrum.iter_mut().enumerate() {
            if !self.bins.contains(&bin) {
                *value = Complex::default();
            } else if 2 * bin == count {
                value.im = 0.0;
            }
        }
        let _ = self.inverse.process_with_scratch(&mut self.spectrum, &mut self.frames, &mut self.scratch);
        self.frames.iter().map(move |value| value / count as f32)
    }
}

/// Hann's window over 0..=1, scaled to a mean square of 1.
fn hann(at: f32) -> f32 {
    (2.0_f32 / 3.0).sqrt() * (1.0 - (std::f32::consts::TAU * at).cos())
}

#[cfg(test)]
mod tests;
