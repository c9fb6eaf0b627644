//! The safety limit that the periphery is not rendered more slowly than 30 times a second: paper B's slowest regions, 22.5 and
//! 18 Hz, lie where flicker is most likely to provoke seizures (15 to 25 Hz; Fisher et al., Epilepsia 46(9), 2005).

/// The slowest that a region is rendered unless asked for, times a second.
pub const MIN_UPDATE_HZ: f32 = 30.0;

/// A display of 90 Hz reports 89.99 or 90.01: from 99.9 % of a multiple of 30 on it counts as reached.
const REACHED: f32 = 0.999;

/// ... and stays reached down to 99 % (29.7 Hz), so that a rate that hovers around 90 does not change the picture
/// again and again.
const KEPT: f32 = 0.99;

/// Largest period at a measured frame rate: floor(frames per second / 30), 1..=9, where 99.9 % of a multiple of 30 is
/// that multiple. Rates that are NaN, infinite or below 60 give 1.
pub fn period_cap(frames_per_second: f32) -> u8 {
    cap_from(frames_per_second, REACHED)
}

fn cap_from(frames_per_second: f32, part: f32) -> u8 {
    if !frames_per_second.is_finite() {
        return 1;
    }
    // Limited before it becomes an integer; 9 is the largest factor there is.
    (frames_per_second / (MIN_UPDATE_HZ * part)).clamp(1.0, f32::from(super::MAX_FACTOR)) as u8
}

/// [`period_cap`] of a rate that is measured again and again: it falls only once the rate is more than 1 % short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeriodCap {
    cap: u8,
}

impl Default for PeriodCap {
    /// 1, until a rate is known.
    fn default() -> Self {
        Self { cap: 1 }
    }
}

impl PeriodCap {
    /// Takes the newest measured rate (frames the application finished in a second, averaged by the caller over
    /// a second or so) and gives the largest period, 1..=9.
    pub fn update(&mut self, frames_per_second: f32) -> u8 {
        let reached = period_cap(frames_per_second);
        let kept = cap_from(frames_per_second, KEPT);
        self.cap = self.cap.clamp(reached, kept);
        self.cap
    }
}
