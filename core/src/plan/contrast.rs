//! Limits by contrast: the coarseness at which a tile loses no more visible contrast than the budget allows (paper A, Algorithm 2).

use super::lattice::deg_of_chord;
use super::rings::STEPS_PER_OCTAVE;
use super::sensitivity::Sensitivity;
use crate::frco::Allocation;
use crate::kernels::decide::{DecideParams, STEADY_MS};
use crate::perception::{BANDS, ContrastMap, TileContrast};

/// The contrast of one view, and its visibility.
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
        let allocation = params.allocation();
        let tiles = (0..).zip(resolution).zip(chords).zip(ages_ms);
        for ((keep, grow), (((index, resolution), chord), age_ms)) in keep.iter_mut().zip(grow).zip(tiles) {
            let tile = params.contrast(self.map, index);
            let visible = match is_flat(&tile, params.flat_contrast) {
                true => [0.0; BANDS],
                false => self.visible(&tile, *resolution, deg_of_chord(*chord) - params.inflation_deg),
            };
            let budget = if *age_ms < STEADY_MS { params.holding_budget } else { params.budget };
            *keep = level_within(allocation, visible, budget);
            *grow = level_within(allocation, visible, params.coarsening_budget);
        }
    }

    /// C_n of paper A Eq. 7 by band: contrast times sensitivity.
    fn visible(&self, tile: &TileContrast, resolution: f32, eccentricity_deg: f32) -> [f32; BANDS] {
        let sensitivity =
            self.sensitivity.bands(resolution, eccentricity_deg.max(0.0), tile.adaptation_cd_m2);
        std::array::from_fn(|band| tile.bands[band] * sensitivity[band])
    }
}

/// Whether a tile has too little contrast for an evaluation of its visibility.
fn is_flat(tile: &TileContrast, flat_contrast: f32) -> bool {
    let [finest, second, ..] = tile.bands;
    finest + second <= flat_contrast && tile.bands.iter().all(|contrast| contrast.is_finite())
}

fn level_within(allocation: Allocation, visible: [f32; BANDS], budget: f32) -> u8 {
    allocation.half_octaves(visible, budget) * (STEPS_PER_OCTAVE / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avpm::SensitivityUnit;
    use crate::image::Plane;
    use proptest::prelude::*;

    proptest! {
        /// The shortcut for flat tiles permits the coarseness that a full decision would: around the greatest contrast of flat tiles, and
        /// with values that are not numbers.
        #[test]
        fn flat_tiles_may_be_as_coarse_as_when_looked_at(
            is_castle in any::<bool>(), is_marginal in 0u32..2, budget in prop_oneof![0.0f32..5.0, Just(f32::INFINITY)], least in 0.2f32..1.0,
            share in 0.0f32..1.1, finest in 0.0f32..1.0, coarse in prop_oneof![8 => 0.0f32..1.0, 1 => Just(f32::NAN), 1 => Just(f32::INFINITY)],
            resolution in 1.0f32..80.0, chord in 0.0f32..1.0, luminance in 1e-3f32..1e4, age_ms in any::<u8>(),
        ) {
            let unit = if is_castle { SensitivityUnit::CastleCsf } else { SensitivityUnit::Tursun };
            let sensitivity = Sensitivity::new(unit);
            let marginal = DecideParams { is_marginal, ..bytemuck::Zeroable::zeroed() };
            let flat = DecideParams {
                budget,
                coarsening_budget: budget * least,
                holding_budget: budget * 1.35,
                tiles: [1, 1],
                flat_contrast: budget * least
                    / (marginal.allocation().greatest_factor() * Sensitivity::greatest(unit)),
                ..marginal
            };
            let removed = if flat.flat_contrast.is_finite() { share * flat.flat_contrast } else { share };
            let tile = TileContrast {
                bands: [removed * finest, removed * (1.0 - finest), coarse, 0.1],
                adaptation_cd_m2: luminance,
            };
            let map = ContrastMap { tiles: Plane::filled(1, 1, tile) };
            let permitted = |params: &DecideParams| {
                let mut permitted = [vec![0], vec![0]];
                let visible = VisibleContrast { map: &map, sensitivity: &sensitivity };
                visible.permit(params, &[resolution], &[chord], &[age_ms], &mut permitted);
                permitted
            };
            prop_assert_eq!(permitted(&flat), permitted(&DecideParams { flat_contrast: -1.0, ..flat }));
            let is_sound = coarse.is_finite() && budget.is_finite();
            prop_assert!(!(is_sound && share < 0.999) || is_flat(&tile, flat.flat_contrast));
        }
    }
}
