//! Distances from a depth image.

/// Mapping of the values of a depth image to distances, as in `XrCompositionLayerDepthInfoKHR`.
///
/// The nearer plane may be either one (reversed depth), and either may be infinitely far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// `minDepth`: the value of the first plane, 0..=1.
    pub min_depth: f32,
    /// `maxDepth`: the value of the second plane, 0..=1, above `min_depth`.
    pub max_depth: f32,
    /// `nearZ`: distance of the first plane, metres, above 0, may be infinite.
    pub near_z: f32,
    /// `farZ`: distance of the second plane, metres, above 0, may be infinite.
    pub far_z: f32,
}

/// The distance that counts as infinite, metres: nothing moves there when a head does.
pub const MAX_VIEW_DISTANCE_M: f32 = 1e6;

/// Distance along -z of view space at the depth value `depth`, metres, above 0 and at most
/// [`MAX_VIEW_DISTANCE_M`].
///
/// 1 / distance is linear in depth, from 1 / near at `min_depth` to 1 / far at `max_depth`; values beyond either
/// count as that. Invalid values (NaN, a plane at 0 or behind, equal bounds) count as infinitely far, where only the
/// view's orientation counts.
pub fn view_distance(depth: f32, range: &DepthRange) -> f32 {
    let DepthRange { min_depth, max_depth, near_z, far_z } = *range;
    let t = ((depth - min_depth) / (max_depth - min_depth)).clamp(0.0, 1.0);
    let inverse = near_z.recip() * (1.0 - t) + far_z.recip() * t;
    let is_meant = max_depth > min_depth && near_z > 0.0 && far_z > 0.0;
    // Not `<`: NaN is far away too.
    if is_meant && inverse > MAX_VIEW_DISTANCE_M.recip() {
        inverse.recip().max(f32::MIN_POSITIVE)
    } else {
        MAX_VIEW_DISTANCE_M
    }
}

/// Linear mapping of the values of a depth image to nearness, 1 / distance along -z of view space in 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearness {
    /// Nearness of the value 0, 1/m, were it within [`Self::bounds`].
    pub at_zero: f32,
    /// Nearness of the value 1 minus that, 1/m.
    pub slope: f32,
    /// The least and the greatest value; values beyond count as the nearer of both.
    pub bounds: [f32; 2],
}

impl Nearness {
    /// Mapping of the values of a range; `None` if that is invalid (NaN, a plane at 0 or behind, equal bounds).
    pub fn new(range: &DepthRange) -> Option<Self> {
        let DepthRange { min_depth, max_depth, near_z, far_z } = *range;
        let slope = (far_z.recip() - near_z.recip()) / (max_depth - min_depth);
        let at_zero = near_z.recip() - slope * min_depth;
        let is_meant = max_depth > min_depth && near_z > 0.0 && far_z > 0.0;
        (is_meant && at_zero.is_finite() && slope.is_finite()).then_some(Self {
            at_zero,
            slope,
            bounds: [min_depth, max_depth],
        })
    }

    /// Nearness of a value, 1/m.
    pub fn at(&self, depth: f32) -> f32 {
        self.at_zero + self.slope * depth.max(self.bounds[0]).min(self.bounds[1])
    }
}

#[cfg(test)]
mod tests;
