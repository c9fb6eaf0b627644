//! Settings of the gaze model.

/// Settings of the gaze model. The defaults suit any tracker of 60 Hz or more. Negative values and NaN count as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeSettings {
    /// Longest loss of the gaze that counts as a blink, milliseconds; the last gaze is held meanwhile. A blink takes 100 to 400
    /// ms (BioNumbers; Volkmann et al. 1980), the longest about 500.
    pub hold_ms: f32,
    /// Time in which trust falls from 1 to 0 after that, milliseconds. 200 ms keeps the change to uniform rates from showing as a
    /// flash; it is our choice.
    pub ramp_down_ms: f32,
    /// Time in which trust rises from 0 to 1 once samples are valid again, milliseconds.
    pub ramp_up_ms: f32,
    /// Time after the landing of a saccade in which changes of the picture go unnoticed, milliseconds: an update of a
    /// gaze-contingent display is not detected more often than one in time up to 60 ms after landing (Loschky and Wolverton
    /// 2007), as sensitivity recovers from saccadic suppression within 50 to 100 ms (Volkmann 1986; Diamond, Ross and Morrone
    /// 2000). After a blink, tiles may not become coarser for as long.
    pub post_saccade_ms: f32,
    /// Smallest jump that is taken for a saccade, degrees, however quiet the tracker is. A smaller one stays within the
    /// least fovea, and the filter follows it.
    pub least_saccade_deg: f32,
    /// Speed below which a saccade is over, degrees a second: smooth pursuit stays below about 100, most of it
    /// below 50 (Carpenter 1988).
    pub saccade_end_deg_s: f32,
    /// Slowest pursuit, degrees a second: drift and tremor of fixation stay below about 1 (Carpenter 1988), a tracker's
    /// noise is in between.
    pub pursuit_deg_s: f32,
    /// Memory of the filter, milliseconds.
    pub memory_ms: f32,
    /// Farthest that eyes turn from the head's forward direction, degrees, at most 90: about 55 (Carpenter 1988), and a tracker's error.
    pub reach_deg: f32,
    /// Largest angle of the gaze outside of the views, degrees: a tracker's error, and the reach of the widest fovea.
    pub outside_deg: f32,
    /// Time after which a gaze that does not change by 0.005 degrees is not believed, milliseconds, if the head has also
    /// turned by more than [`Self::frozen_head_deg`].
    pub frozen_ms: f32,
    /// Turn of the head in that time above which the gaze counts as frozen, degrees: eyes that see turn against it.
    pub frozen_head_deg: f32,
    /// Age of a sample whose time is not known when the frame is shown, milliseconds: 45 to 81 from an eye movement to the first change of the
    /// display in three headsets with a cable (Stein et al. 2021); prediction by the runtime hides a part of it.
    pub latency_ms: f32,
}

impl Default for GazeSettings {
    fn default() -> Self {
        Self {
            hold_ms: 500.0,
            ramp_down_ms: 200.0,
            ramp_up_ms: 200.0,
            post_saccade_ms: 60.0,
            least_saccade_deg: 1.0,
            saccade_end_deg_s: 50.0,
            pursuit_deg_s: 4.0,
            memory_ms: 150.0,
            reach_deg: 65.0,
            outside_deg: 10.0,
            frozen_ms: 1000.0,
            frozen_head_deg: 10.0,
            latency_ms: 50.0,
        }
    }
}
