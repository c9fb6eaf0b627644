//! Parts of the image that are rendered in a frame (paper B, "Evaluating Foveated Frame Rate Reduction in Virtual Reality for
//! Head-Mounted Displays").
//!
//! Each of the [`Regions`] around the gaze is rendered in one of f frames, by an [`UpdateConfiguration`], limited
//! by [`cap`]; [`Phase`] selects the frames.

mod activity;
mod ages;
pub mod cap;
mod cells;
mod configuration;
pub mod refresh;
mod regions;
mod tiles;

pub use activity::Activity;
pub use ages::CellAges;
pub use cells::{CELLS, Cell};
pub use configuration::{ConfigurationError, MAX_FACTOR, REGIONS, UpdateConfiguration};
pub use regions::{Regions, pixel_rate};
pub use tiles::{TileCells, Touched};

use glam::Vec3;

/// In which frames of its period a direction is rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Phase {
    /// All directions of a period together, in the frames that it divides: paper B. Every so often a frame
    /// renders everything, so the longest frame is as long as without a schedule.
    Aligned,
    /// Patches of [`Cell::PATCH_DEG`] degrees take turns, so that each frame renders about the same share.
    #[default]
    Staggered,
    /// As [`Self::Aligned`], with the right eye half a period later: the eyes see a direction at different ages.
    AlternateEye,
}

/// Update schedule: the frames in which each region is rendered.
///
/// In [`Phase::Aligned`] and [`Phase::Staggered`] the answers depend on direction, gaze and frame only, so that both
/// eyes see a direction at the same age, regardless of the tiles of their images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Schedule {
    /// Boundaries of the regions.
    pub regions: Regions,
    /// Update period of each region.
    pub configuration: UpdateConfiguration,
    /// In which frames.
    pub phase: Phase,
}

impl Schedule {
    /// Number of frames within which a direction at this eccentricity (degrees, from the nearer of both eyes'
    /// gaze) is rendered once, 1..=9. NaN gives the centre's.
    pub fn period_at(&self, eccentricity_deg: f32) -> u8 {
        self.configuration.factors()[self.regions.region_at(eccentricity_deg)]
    }

    /// Whether a direction is rendered in a frame: exactly once in any `period` frames that follow each other.
    ///
    /// `direction`, of any length, is in a space common to both eyes whose orientation is fixed in the world (the
    /// LOCAL space, its origin does not matter): then an object's turn stays its turn when the head moves. `eye` is
    /// 0 (left) or 1, and read by [`Phase::AlternateEye`] alone. A direction without a meaning and a period of 0 or above
    /// [`MAX_FACTOR`] are always due. At the wrap of `frame` (2^64) one turn may come late.
    pub fn is_due(&self, frame: u64, direction: Vec3, period: u8, eye: usize) -> bool {
        if !(2..=MAX_FACTOR).contains(&period) {
            return true;
        }
        match Cell::of(direction) {
            Some(cell) => self.turn(frame, period, eye) == cell.phase_for(self.phase, period),
            None => true,
        }
    }

    /// The phase that is due in a frame, 0..period.
    pub(crate) fn turn(&self, frame: u64, period: u8, eye: usize) -> u8 {
        let late = if self.phase == Phase::AlternateEye && eye == 1 { period / 2 } else { 0 };
        // Reduced first: frame + late could overflow.
        let turn = (frame % u64::from(period)) as u8 + period - late;
        turn % period
    }
}

#[cfg(test)]
mod tests;
