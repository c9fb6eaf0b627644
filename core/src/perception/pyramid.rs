//! Gaussian and Laplacian pyramid of luminance: Burt and Adelson, "The Laplacian Pyramid as a Compact Image Code",
//! IEEE Transactions on Communications 31(4), 1983, with the binomial filter (1, 4, 6, 4, 1) / 16.
//!
//! Texel k of a level lies at texel 2k of the level before it, and a level has half its side, rounded up. Beyond the
//! edge the last texel repeats. Every sum is one texel plus weighted differences to it, so that a level
//! picture stays level to the last bit.

use super::{BANDS, luminance::as_luminance};
use crate::image::Plane;

/// Levels of the Gaussian pyramid beyond the picture itself: the coarsest band needs two beyond its own.
pub const LEVELS: usize = BANDS + 1;

/// The Gaussian pyramid of a picture, kept so that the next picture of the same size needs no memory.
#[derive(Clone, Debug, Default)]
pub struct Pyramid {
    levels: [Plane; LEVELS],
    row: Vec<f32>,
}

impl Pyramid {
    /// Level `level` in 1..=[`LEVELS`], cd/m^2; level 0 is the picture.
    pub fn level(&self, level: usize) -> &Plane {
        &self.levels[level - 1]
    }

    /// Makes all levels of `luminance`, in cd/m^2. Negative values and NaN count as 0, values above
    /// [`BRIGHTEST_CD_M2`](super::luminance::BRIGHTEST_CD_M2) as that.
    pub fn build(&mut self, luminance: &Plane) {
        self.build_rounded(luminance, |value| value);
    }

    /// As [`Self::build`], each texel of a level rounded by `round` before the next level is made of it.
    pub fn build_rounded(&mut self, luminance: &Plane, round: impl Fn(f32) -> f32) {
        reduce(luminance, as_luminance, &round, &mut self.levels[0], &mut self.row);
        for level in 1..LEVELS {
            let (finer, coarser) = self.levels.split_at_mut(level);
            reduce(&finer[level - 1], |value| value, &round, &mut coarser[0], &mut self.row);
        }
    }

    /// Levels that were made elsewhere, from level 1 on.
    pub fn of_levels(levels: [Plane; LEVELS]) -> Self {
        Self { levels, row: Vec::new() }
    }
}

/// Burt and Adelson's REDUCE: `fine` low-pass filtered, of each 2 x 2 texels one.
fn reduce(
    fine: &Plane,
    read: impl Fn(f32) -> f32,
    round: impl Fn(f32) -> f32,
    coarse: &mut Plane,
    row: &mut Vec<f32>,
) {
    let (width, height) = (fine.width(), fine.height());
    coarse.resize(width.div_ceil(2), height.div_ceil(2));
    if width == 0 || height == 0 {
        return;
    }
    row.clear();
    row.resize(width as usize + 4, 0.0);
    for y in 0..coarse.height() {
        let at = |offset: i64| fine.row((2 * i64::from(y) + offset).clamp(0, i64::from(height) - 1) as u32);
        let (a, b, c, d, e) = (at(-2), at(-1), at(0), at(1), at(2));
        for (x, out) in row[2..][..width as usize].iter_mut().enumerate() {
            *out = binomial([read(a[x]), read(b[x]), read(c[x]), read(d[x]), read(e[x])]);
        }
        let (first, last) = (row[2], row[width as usize + 1]);
        row[..2].fill(first);
        row[width as usize + 2..].fill(last);
        for (out, taps) in coarse.row_mut(y).iter_mut().zip(row.windows(5).step_by(2)) {
            *out = round(binomial([taps[0], taps[1], taps[2], taps[3], taps[4]]));
        }
    }
}

fn binomial([a, b, c, d, e]: [f32; 5]) -> f32 {
    c + ((a - c) + (e - c)) * (1.0 / 16.0) + ((b - c) + (d - c)) * (1.0 / 4.0)
}

/// Row `y` of Burt and Adelson's EXPAND of `coarse`, as wide as `out`: the prediction of the next finer level.
/// `row` is scratch.
pub(crate) fn expand_row(coarse: &Plane, y: u32, out: &mut [f32], row: &mut Vec<f32>) {
    let (k, last) = (y / 2, coarse.height() - 1);
    let (before, at, after) = (coarse.row(k.saturating_sub(1)), coarse.row(k), coarse.row((k + 1).min(last)));
    // One texel more at each end, which repeats the last.
    let n = at.len();
    row.clear();
    row.resize(n + 2, 0.0);
    for (x, out) in row[1..=n].iter_mut().enumerate() {
        *out =
            if y.is_multiple_of(2) { smooth(before[x], at[x], after[x]) } else { between(at[x], after[x]) };
    }
    (row[0], row[n + 1]) = (row[1], row[n]);
    for (out, taps) in out.chunks_mut(2).zip(row.windows(3)) {
        out[0] = smooth(taps[0], taps[1], taps[2]);
        if let Some(out) = out.get_mut(1) {
            *out = between(taps[1], taps[2]);
        }
    }
}

fn smooth(before: f32, at: f32, after: f32) -> f32 {
    at + ((before - at) + (after - at)) * (1.0 / 8.0)
}

fn between(at: f32, after: f32) -> f32 {
    at + (after - at) * 0.5
}

/// Row `y` of the level two finer than `coarse`, as wide as `out`, interpolated linearly. `row` is scratch.
pub(crate) fn upsampled_row(coarse: &Plane, y: u32, out: &mut [f32], row: &mut Vec<f32>) {
    let (k, last) = (y / 4, coarse.height() - 1);
    let (at, after) = (coarse.row(k), coarse.row((k + 1).min(last)));
    let along = (y % 4) as f32 * 0.25;
    let n = at.len();
    row.clear();
    row.resize(n + 1, 0.0);
    for (x, out) in row[..n].iter_mut().enumerate() {
        *out = at[x] + (after[x] - at[x]) * along;
    }
    row[n] = row[n - 1];
    for (out, ends) in out.chunks_mut(4).zip(row.windows(2)) {
        let step = (ends[1] - ends[0]) * 0.25;
        for (i, out) in out.iter_mut().enumerate() {
            *out = ends[0] + step * i as f32;
        }
    }
}

#[cfg(test)]
mod tests;
