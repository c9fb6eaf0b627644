//! What contrast permits: how coarse each tile may be before more of its contrast is lost than the budget allows
//! (paper A, Algorithm 2).

use super::lattice::deg_of_chord;
use super::rings::STEPS_PER_OCTAVE;
use super::sensitivity::Sensitivity;
use crate::frco::half_octaves_within;
use crate::kernels::decide::{DecideParams, STEADY_MS};
use crate::perception::{BANDS, ContrastMap, TileContrast};

/// The contrast of one view, and how much of it is seen.
#[derive(Clone, Copy, Debug)]
pub struct VisibleContrast<'a> {
    /// Contrast of each tile.
    pub map: &'a ContrastMap,
    /// Sensitivity to it.
    pub sensitivity: &'a Sensitivity,
}

impl VisibleContrast<'_> {
    /// Writes the coarseness that each tile may keep, and grow to, given its pixels per degree, its squared chord to the
    /// gaze, and the time since its rate changed, milliseconds.
    pub(crate) fn permit(
        &self,
        params: &DecideParams,
        resolution: &[f32],
        chords: &[f32],
        ages_ms: &[u8],
        [keep, grow]: &mut [Vec<u8>; 2],
    ) {
        let tiles = (0..).zip(resolution).zip(chords).zip(ages_ms);
        for ((keep, grow), (((index, resolution), chord), age_ms)) in keep.iter_mut().zip(grow).zip(tiles) {
            let tile = params.contrast(self.map, index);
            let visible = self.visible(&tile, *resolution, deg_of_chord(*chord) - params.inflation_deg);
            let budget = if *age_ms < STEADY_MS { params.holding_budget } else { params.budget };
            *keep = level_within(visible, budget);
            *grow = level_within(visible, params.coarsening_budget);
        }
    }

    /// C_n of paper A Eq. 7 by band: contrast times sensitivity.
    fn visible(&self, tile: &TileContrast, resolution: f32, eccentricity_deg: f32) -> [f32; BANDS] {
        let sensitivity =
            self.sensitivity.bands(resolution, eccentricity_deg.max(0.0), tile.adaptation_cd_m2);
        std::array::from_fn(|band| tile.bands[band] * sensitivity[band])
    }
}

fn level_within(visible: [f32; BANDS], budget: f32) -> u8 {
    half_octaves_within(visible, budget) * (STEPS_PER_OCTAVE / 2)
}
