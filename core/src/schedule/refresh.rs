//! What has to be rendered anew although its turn has not come.
//!
//! The rest of the rules is in [`super::CellAges`]: a cell that a faster region reached is refreshed at once, and
//! wishes are granted by need.

/// Smallest shift that is seen at an eccentricity in degrees, arc minutes: the minimum angle of resolution.
///
/// 60 / 48 + 1.32 e, from Guenter et al. 2012, "Foveated 3D Graphics": 1 / 48 degree where one looks, and the lower of
/// the two slopes that their participants accepted (1.32 and 1.65 arc minutes per degree). That an image which is
/// out of place by less than the finest detail seen there is not noticed is our assumption. Negative and
/// NaN eccentricities count as 0.
pub fn visible_shift_arcmin(eccentricity_deg: f32) -> f32 {
    1.25 + 1.32 * eccentricity_deg.max(0.0)
}

/// What is known of a tile that would be re-used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Whether all of the tile, re-projected, lies in the picture that is to be re-used.
    pub in_history: bool,
    /// Least eccentricity of the tile from either eye's gaze, degrees.
    pub eccentricity_deg: f32,
    /// How far the content may be out of place after re-projection (by the head's translation, or motion in the
    /// scene), arc minutes.
    pub shift_arcmin: f32,
    /// Change of content since it was last rendered: |difference of luminance| / adaptation luminance (the temporal
    /// difference of `analyze`).
    pub content_change: f32,
}

/// From when on a tile is refreshed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefreshSettings {
    /// Shift in units of [`visible_shift_arcmin`].
    pub shift: f32,
    /// [`Evidence::content_change`].
    pub content_change: f32,
    /// Share of tiles with a change of content that makes a scene cut, 0..=1.
    pub cut_share: f32,
    /// Most cells that are refreshed beyond the schedule in one frame ([`super::CellAges::finish`]).
    pub limit_cells: usize,
}

impl Default for RefreshSettings {
    /// A visible shift; a change of 5 % of the luminance around, about what is seen in large fields in the periphery with
    /// certainty; a cut when half of the tiles change; 256 cells, about 4 % of a view of 110 by 110 degrees. The latter three
    /// are our choice.
    fn default() -> Self {
        Self { shift: 1.0, content_change: 0.05, cut_share: 0.5, limit_cells: 256 }
    }
}

/// What a tile asks for beyond the schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refresh {
    /// Nothing.
    Unneeded,
    /// To be refreshed if the limit allows it; above 1, the larger the sooner ([`super::CellAges::want`]).
    Wanted(f32),
    /// To be refreshed in any case, for there is nothing to re-use ([`super::CellAges::require`]).
    Required,
}

impl RefreshSettings {
    /// What the evidence asks for. A shift or change that is NaN, or a threshold that is not above 0, wants a
    /// refresh with infinite need.
    pub fn judge(&self, evidence: &Evidence) -> Refresh {
        if !evidence.in_history {
            return Refresh::Required;
        }
        let shift = need(evidence.shift_arcmin, self.shift * visible_shift_arcmin(evidence.eccentricity_deg));
        let change = need(evidence.content_change, self.content_change);
        let need = shift.max(change);
        if need > 1.0 { Refresh::Wanted(need) } else { Refresh::Unneeded }
    }

    /// Whether so many tiles changed that the scene did, and everything is refreshed
    /// ([`super::CellAges::require_all`]). Never without tiles; a NaN share counts as 0.
    pub fn is_scene_cut(&self, changed: usize, tiles: usize) -> bool {
        tiles > 0 && changed as f32 >= self.cut_share.max(0.0) * tiles as f32
    }
}

/// `value` in units of `threshold`.
fn need(value: f32, threshold: f32) -> f32 {
    if value.is_nan() || threshold.is_nan() || threshold <= 0.0 { f32::INFINITY } else { value / threshold }
}

#[cfg(test)]
mod tests;
