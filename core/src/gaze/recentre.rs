//! One-point recentring: the user looks at a dot in the head's forward direction, and the angle between the measured gaze and the dot
//! is the tracker's offset.

use super::fixation::{DotLook, DotTiming, Fixation, NoFixation, distance};

/// A saccade follows a new target after 200 to 250 ms (Carpenter 1988); the rest of the time before the measurement is for people.
/// Fixations of a scene last 200 to 400 ms, so that one of a second is intended.
const TIMING: DotTiming =
    DotTiming { settle_ns: 1_500_000_000, measured_ns: 3_000_000_000, fixation_ns: 1_000_000_000 };

/// The largest plausible offset, degrees. Headsets have a mean error of 1 to 2 degrees; more than this is a slipped headset, or a look at
/// something else.
pub const MAX_OFFSET_DEG: f32 = 10.0;

/// The offset of an eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeOffset {
    /// Angles to the left and upwards that are added to the gaze, degrees.
    pub offset_deg: [f32; 2],
    /// Root mean square of the distances of the samples from their median, degrees.
    pub spread_deg: f32,
}

/// Reason why a measurement gave no offset.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecentreFailure {
    /// Too few samples.
    #[error("the eye tracker did not see the eyes long enough")]
    NoGaze,
    /// No steady fixation, or several of them.
    #[error("the gaze did not rest on one point for a second")]
    Unsteady,
    /// An implausible offset, degrees.
    #[error("the gaze was {0:.0} degrees from the dot; more than 10 degrees are not corrected")]
    TooFar(f32),
}

/// A measurement. Allocates nothing once it is made.
#[derive(Clone, Debug)]
pub struct Recentring(DotLook);

impl Default for Recentring {
    fn default() -> Self {
        Self(DotLook::new(TIMING))
    }
}

impl Recentring {
    /// Takes the gaze of a frame that is shown at `now_ns`, which the first one begins: degrees to the left and upwards of the dot, and when
    /// the eyes looked there, on the same clock; `None` where they are not seen. Samples that come twice count once.
    pub fn push(&mut self, look: Option<([f32; 2], i64)>, now_ns: i64) {
        self.0.push(look, now_ns);
    }

    /// Whether no more samples are needed.
    pub fn is_over(&self) -> bool {
        self.0.is_over()
    }

    /// The offset of the steadiest fixation.
    ///
    /// # Errors
    /// The eyes were not seen or did not rest, or the offset is implausible.
    pub fn offset(&self) -> Result<GazeOffset, RecentreFailure> {
        let Fixation { centre_deg, spread_deg } = self.0.fixation().map_err(|reason| match reason {
            NoFixation::Unseen => RecentreFailure::NoGaze,
            NoFixation::Unsteady => RecentreFailure::Unsteady,
        })?;
        let far = distance(centre_deg, [0.0; 2]);
        if far > MAX_OFFSET_DEG {
            return Err(RecentreFailure::TooFar(far));
        }
        Ok(GazeOffset { offset_deg: centre_deg.map(|angle| 0.0 - angle), spread_deg })
    }
}

#[cfg(test)]
mod tests;
