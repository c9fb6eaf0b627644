//! Sums over the tiles of a plan.

use super::frame::EyePlan;
use super::lattice::MAX_SIDE;
use crate::rate::ShadingRate;

/// Cost of a plan, relative to shading every pixel of every frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Tiles of the view.
    pub tiles: u32,
    /// Tiles that are rendered in this frame.
    pub tiles_due: u32,
    /// Mean of [`ShadingRate::fraction`] over the pixels of the view, 1/16..=1; 1 without pixels.
    pub mean_rate: f32,
    /// Invocations in this frame for each pixel of the view, 0..=1: the mean rate over the tiles that are rendered.
    pub pixel_share: f32,
}

impl Default for Statistics {
    fn default() -> Self {
        Self { tiles: 0, tiles_due: 0, mean_rate: 1.0, pixel_share: 1.0 }
    }
}

impl Statistics {
    /// Sums up the tiles of a plan. A tile that the border of the view cuts counts with the pixels that are in it.
    pub(super) fn new(plan: &EyePlan) -> Self {
        let EyePlan { rates, ages, .. } = plan;
        let [columns, rows] = [rates.width(), rates.height()];
        // Pixels of the view that a column (axis 0) or row (1) of tiles covers.
        let covered = |axis: usize, index: u32| {
            let texel = plan.texel[axis];
            let line = |index: u32| {
                (index * texel).saturating_sub(plan.offset[axis] % texel).min(plan.extent[axis].min(MAX_SIDE))
            };
            line(index + 1) - line(index)
        };
        if columns == 0 || rows == 0 {
            return Self::default();
        }
        // Only the outermost columns can be narrower than a texel.
        let last = columns as usize - 1;
        let parts = [0..1, 1..last.max(1), last.max(1)..columns as usize];
        let (mut pixels, mut due, mut shaded, mut rendered) = (0, 0, 0, 0);
        for row in 0..rows {
            let (rates, ages) = (rates.row(row), ages.row(row));
            for part in parts.clone().into_iter().filter(|part| !part.is_empty()) {
                let area = u64::from(covered(0, part.start as u32) * covered(1, row));
                let sums = Sums::of(&rates[part.clone()], &ages[part.clone()]);
                pixels += area * part.len() as u64;
                due += sums.due;
                shaded += area * u64::from(sums.shaded);
                rendered += area * u64::from(sums.rendered);
            }
        }
        let mean = |sum: u64| (sum as f64 / (pixels * 16) as f64) as f32;
        Self { tiles: columns * rows, tiles_due: due, mean_rate: mean(shaded), pixel_share: mean(rendered) }
    }
}

/// Sums over tiles of one size; rates in sixteenths.
struct Sums {
    due: u32,
    shaded: u32,
    rendered: u32,
}

impl Sums {
    fn of(rates: &[u8], ages: &[u8]) -> Self {
        let mut sums = Self { due: 0, shaded: 0, rendered: 0 };
        for (texel, age) in rates.iter().zip(ages) {
            let sixteenths = u32::from(SIXTEENTHS[usize::from(*texel & 15)]);
            let due = u32::from(*age == 0);
            sums.due += due;
            sums.shaded += sixteenths;
            sums.rendered += sixteenths * due;
        }
        sums
    }
}

/// [`ShadingRate::fraction`] in sixteenths, by texel; 1 where there is no such rate.
const SIXTEENTHS: [u8; 16] = {
    let mut table = [16; 16];
    let mut texel = 0;
    while texel < 16 {
        if let Some(rate) = ShadingRate::from_texel(texel) {
            table[texel as usize] = (16 / (rate.width() * rate.height())) as u8;
        }
        texel += 1;
    }
    table
};
