//! Scenarios for the mock runtime, and short forms for the settings of most runs.

pub use parafovea_mock_runtime::scenario::*;

/// Short forms, so that a run has only its own settings.
pub trait ScenarioExt {
    /// This number of frames with the mock runtime's defaults (two upright eyes of 90 by 90 degrees and 1024 by 1024
    /// pixels, a still head, the gaze at the centre of the view, simulated time), except that nothing is composited:
    /// runs are timed.
    fn new(frames: u64) -> Self;

    /// Saves the sub-images of these frames as the application submitted them.
    #[must_use]
    fn saving(self, frames: &[u64]) -> Self;

    /// Rests the gaze in one direction: degrees to the left and upwards.
    #[must_use]
    fn gazing(self, yaw_deg: f32, pitch_deg: f32) -> Self;

    /// Makes both views this large, in pixels.
    #[must_use]
    fn sized(self, width: u32, height: u32) -> Self;

    /// Lets time pass as it does outside.
    #[must_use]
    fn in_real_time(self) -> Self;
}

impl ScenarioExt for Scenario {
    fn new(frames: u64) -> Self {
        let mut scenario = Self::default();
        scenario.session.frames = frames;
        scenario.output.composite = false;
        scenario
    }

    fn saving(mut self, frames: &[u64]) -> Self {
        self.output.save_frames = frames.to_vec();
        self.output.save = vec![Picture::Submitted];
        self
    }

    fn gazing(mut self, yaw_deg: f32, pitch_deg: f32) -> Self {
        self.gaze = vec![Gaze { t: 0.0, yaw_deg, pitch_deg, tracked: true }];
        self
    }

    fn sized(mut self, width: u32, height: u32) -> Self {
        for view in &mut self.views {
            (view.width, view.height) = (width, height);
        }
        self
    }

    fn in_real_time(mut self) -> Self {
        self.clock.mode = ClockMode::Real;
        self
    }
}
