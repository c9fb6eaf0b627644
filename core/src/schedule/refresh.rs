//! Updates ahead of their turn: where content has visibly changed.
//!
//! The rest of the rules is in [`super::CellAges`]: a cell that a faster region reached is refreshed at once, and
//! wishes are granted by need.

use crate::perception::csf::castle::achromatic_fall;
use crate::perception::csf::{SensitivityFall, Stimulus, VisualField};

/// Smallest shift that is seen at an eccentricity in degrees, arc minutes: the minimum angle of resolution.
///
/// 60 / 48 + 1.32 e, from Guenter et al. 2012, "Foveated 3D Graphics": 1 / 48 degree where one looks, and the lower of
/// the two slopes that their participants accepted (1.32 and 1.65 arc minutes per degree). That an image which is
/// out of place by less than the finest detail seen there is not noticed is our assumption. Negative and
/// NaN eccentricities count as 0.
pub fn visible_shift_arcmin(eccentricity_deg: f32) -> f32 {
    1.25 + 1.32 * eccentricity_deg.max(0.0)
}

/// Smallest visible change of luminance, as a share of the luminance around.
///
/// Late content flickers between two luminances, L and L (1 + c), whose contrast is about c / 2: visible from c = 2 /
/// sensitivity on, by castleCSF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleChange {
    sensitivity: SensitivityFall,
}

impl VisibleChange {
    /// For changes of a width of `width_deg` degrees, half a period of the spatial frequency: at 8 Hz, where flicker sensitivity peaks,
    /// over four square degrees, as moving content has edges that are longer than wide, at 50 cd/m^2, a bright part of a headset's image.
    /// These are our choice.
    pub fn new(width_deg: f32) -> Self {
        let stimulus = Stimulus {
            frequency_cpd: 0.5 / width_deg,
            temporal_hz: 8.0,
            eccentricity_deg: 0.0,
            luminance_cd_m2: 50.0,
            area_deg2: 4.0,
        };
        Self { sensitivity: achromatic_fall(&stimulus) }
    }

    /// The smallest change that is seen at an eccentricity in degrees, > 0.
    pub fn at(&self, eccentricity_deg: f32) -> f32 {
        2.0 / self.sensitivity.at(eccentricity_deg, VisualField::Worst)
    }
}

/// Threshold, duration and limit of refreshes. The numbers are our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefreshSettings {
    /// Change in units of [`VisibleChange`], above which a cell is refreshed.
    pub change: f32,
    /// Share of changed tiles among the compared ones that makes a scene cut, 0..=1.
    pub cut_share: f32,
    /// Most cells that are refreshed beyond the schedule in one frame ([`super::CellAges::finish`]).
    pub limit_cells: usize,
    /// Number of frames after its last visible change for which a cell is refreshed: longer than any period, so that it was
    /// compared again by then.
    pub hold_frames: u8,
}

impl Default for RefreshSettings {
    /// Half of the threshold of visibility, which is where half of the answers are; a cut when half of the tiles change;
    /// 256 cells, about 4 % of a view of 110 by 110 degrees; 12 frames.
    fn default() -> Self {
        Self { change: 0.5, cut_share: 0.5, limit_cells: 256, hold_frames: 12 }
    }
}

impl RefreshSettings {
    /// Urgency of a refresh for a change at an eccentricity in degrees: above 1 a refresh is wanted, the larger the sooner.
    /// Infinite for a change that is NaN, or a threshold that is not above 0.
    pub fn need(&self, change: f32, visible: &VisibleChange, eccentricity_deg: f32) -> f32 {
        let threshold = self.change * visible.at(eccentricity_deg);
        if change.is_nan() || threshold.is_nan() || threshold <= 0.0 {
            f32::INFINITY
        } else {
            change / threshold
        }
    }

    /// A change up to which [`Self::need`] is at most 1 at every eccentricity: sensitivity is greatest at the gaze. Negative where there
    /// is not such a change.
    pub fn least_change(&self, visible: &VisibleChange) -> f32 {
        let threshold = self.change * visible.at(0.0);
        if threshold > 0.0 { threshold } else { f32::NEG_INFINITY }
    }

    /// Whether so many tiles changed that the scene did, and everything is refreshed
    /// ([`super::CellAges::require_all`]). Never without tiles; a NaN share counts as 0.
    pub fn is_scene_cut(&self, changed: usize, tiles: usize) -> bool {
        tiles > 0 && changed as f32 >= self.cut_share.max(0.0) * tiles as f32
    }
}

#[cfg(test)]
mod tests;
