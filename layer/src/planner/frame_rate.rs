//! The frame rate.

/// The window of the average, nanoseconds.
const WINDOW_NS: f32 = 1e9;

/// Frames a second, from the times at which frames are shown.
#[derive(Debug, Default)]
pub struct FrameRate {
    last_ns: Option<i64>,
    /// Mean of the steps between frames, nanoseconds.
    step_ns: Option<f32>,
}

impl FrameRate {
    /// A frame is shown at `time_ns`, the `count`th since the last call. After frames of a second each, or when the clock went back, the
    /// measurement starts again.
    pub fn frame_at(&mut self, time_ns: i64, count: u32) {
        let passed_ns = self.last_ns.replace(time_ns).map(|last| time_ns.saturating_sub(last) as f32);
        let step_ns = passed_ns.map(|passed| passed / count.max(1) as f32);
        self.step_ns = match (step_ns.filter(|step| (1.0..WINDOW_NS).contains(step)), self.step_ns) {
            (None, _) => None,
            (first, None) => first,
            (Some(step), Some(mean)) => Some(mean + (step - mean) * (step / WINDOW_NS)),
        };
    }

    /// Frames a second, Hz; 0 where that is not known.
    pub fn hz(&self) -> f32 {
        self.step_ns.map_or(0.0, |step| 1e9 / step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_known_from_the_second_frame_on_and_follows() {
        let mut rate = FrameRate::default();
        let mut now = 5;
        rate.frame_at(now, 1);
        assert_eq!(rate.hz(), 0.0);
        for _ in 0..90 {
            now += 11_111_111;
            rate.frame_at(now, 1);
            assert!((rate.hz() - 90.0).abs() < 0.01, "{}", rate.hz());
        }
        for _ in 0..45 * 5 {
            now += 22_222_222;
            rate.frame_at(now, 1);
        }
        assert!((rate.hz() - 45.0).abs() < 0.5, "{}", rate.hz());
        rate.frame_at(now + 90 * 22_222_222, 90);
        assert!((rate.hz() - 45.0).abs() < 0.5, "frames in between are counted: {}", rate.hz());
    }

    #[test]
    fn a_pause_or_a_clock_that_goes_back_or_stands_begins_anew() {
        for next in [10_000_000_000, 5, 0] {
            let mut rate = FrameRate::default();
            rate.frame_at(0, 1);
            rate.frame_at(5, 1);
            assert!(rate.hz() > 0.0);
            rate.frame_at(next, 1);
            assert_eq!(rate.hz(), 0.0, "{next}");
        }
    }
}
