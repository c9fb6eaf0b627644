//! How much of each style is run.

use parafovea_tests::scenario::{Gaze, Scenario, ScenarioExt};

/// Frames and size of a run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Frames.
    pub frames: u64,
    /// Side of an eye's picture, pixels.
    pub size: u32,
}

impl Effort {
    /// All of it where `PARAFOVEA_ZOO` is "full", as `cargo dev zoo` sets it, or else this share.
    pub fn or_share(frames: u64, size: u32) -> Self {
        if is_full() { Self { frames: 120, size: 256 } } else { Self { frames, size } }
    }

    /// The scenario of a run whose gaze rests straight ahead.
    pub fn scenario(self) -> Scenario {
        Scenario::new(self.frames).sized(self.size, self.size)
    }

    /// The same, with a gaze that jumps from one place to another three times a second, and follows something between.
    pub fn scenario_of_moving_gaze(self) -> Scenario {
        let mut scenario = self.scenario();
        let directions: [(f32, f32); 5] =
            [(-18.0, 4.0), (12.0, -9.0), (3.0, 14.0), (20.0, 0.0), (-6.0, -12.0)];
        scenario.gaze = (0..)
            .zip(directions.iter().cycle())
            .take(12)
            .flat_map(|(jump, &(yaw_deg, pitch_deg))| {
                let t = f64::from(jump) / 3.0;
                let at = |t, ahead| Gaze { t, yaw_deg: yaw_deg + ahead, pitch_deg, tracked: true };
                [at(t, 0.0), at(t + 0.28, 2.0)]
            })
            .collect();
        scenario
    }
}

/// Whether all of it is run.
pub fn is_full() -> bool {
    std::env::var_os("PARAFOVEA_ZOO").is_some_and(|value| value == "full")
}
