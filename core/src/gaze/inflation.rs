//! Enlargement of the fovea for the error and the latency of the gaze.

/// Largest radius that motion alone gives the fovea, degrees.
///
/// 700 deg/s for 60 ms would be 42 degrees, most of the display in full, at each of the three or so saccades a
/// second. At such speeds fine detail is suppressed, and the map is allowed 60 ms to follow after landing
/// (Loschky and Wolverton 2007); few natural saccades are longer than 30 degrees, so that the landing point nearly always lies inside.
pub const MAX_FOVEAL_RADIUS_DEG: f32 = 30.0;

/// Radius of the fovea as rendered, degrees: base + tracker error + motion.
///
/// `base_deg` is the fovea's own radius, `tracker_error_deg` the possible error of the tracker, `motion_deg` the possible turn
/// of the eyes between their measurement and the image ([`super::GazeState::motion_deg`]). The answer is at most
/// [`MAX_FOVEAL_RADIUS_DEG`], but never below base + tracker error, and never above 180. Negative terms count as 0. An error or
/// motion that is NaN or infinite gives [`MAX_FOVEAL_RADIUS_DEG`] or the base, whichever is larger (the gaze could be anywhere
/// near); a NaN base gives 180.
pub fn foveal_inflation_deg(base_deg: f32, tracker_error_deg: f32, motion_deg: f32) -> f32 {
    let base = if base_deg.is_nan() { 180.0 } else { base_deg.clamp(0.0, 180.0) };
    if ![tracker_error_deg, motion_deg].into_iter().all(f32::is_finite) {
        return base.max(MAX_FOVEAL_RADIUS_DEG);
    }
    let still = base + tracker_error_deg.max(0.0);
    let moving = still + motion_deg.max(0.0);
    moving.min(still.max(MAX_FOVEAL_RADIUS_DEG)).min(180.0)
}
