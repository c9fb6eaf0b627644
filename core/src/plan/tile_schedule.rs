//! An update schedule of the tiles of a view, as paper B has it for pixels.

use super::lattice::{TileLattice, chord_of_deg};
use crate::schedule::{REGIONS, Schedule};
use glam::Vec3;

/// Ages of the tiles of one view.
#[derive(Clone, Debug, Default)]
pub(super) struct TileSchedule {
    /// Frames since each was rendered, 255 for longer ago or never.
    ages: Vec<u8>,
    /// Squared chord from each to the nearer gaze.
    chords: Vec<f32>,
    frame: Option<u64>,
}

impl TileSchedule {
    /// Starts with `tiles` tiles, none of them ever rendered.
    pub(super) fn reset(&mut self, tiles: usize) {
        self.ages.clear();
        self.ages.resize(tiles, u8::MAX);
        self.chords.clear();
        self.chords.resize(tiles, 0.0);
        self.frame = None;
    }

    /// Notes that all tiles are rendered in `frame`.
    pub(super) fn rendered(&mut self, frame: u64) {
        self.ages.fill(0);
        self.frame = Some(frame);
    }

    /// Advances to `frame`, and writes whether each tile is due: in the frames that the period at its point nearest to either
    /// gaze (unit vectors, view space) divides, and at once if it would become older than that. The same frame again only adds tiles.
    pub(super) fn advance(
        &mut self,
        schedule: &Schedule,
        frame: u64,
        eye: usize,
        lattice: &mut TileLattice,
        gazes: [Vec3; 2],
        due: &mut [bool],
    ) {
        let passed =
            self.frame.map_or(u64::MAX, |last| frame.wrapping_sub(last)).min(u64::from(u8::MAX)) as u8;
        self.frame = Some(frame);
        lattice.nearest(gazes, &mut self.chords);
        let limits = schedule.regions.radii_deg.map(chord_of_deg);
        let periods = schedule.configuration.factors();
        let is_turn: [bool; REGIONS] = periods.map(|period| schedule.turn(frame, period, eye) == 0);
        for ((due, age), chord) in due.iter_mut().zip(&mut self.ages).zip(&self.chords) {
            // Comparing so makes a limit without a meaning unbounded, see `Regions`.
            let region = limits.iter().filter(|limit| *chord > **limit).count();
            let before = *age;
            *age = age.saturating_add(passed);
            *due = is_turn[region] || *age >= periods[region] || (passed == 0 && before == 0);
            if *due {
                *age = 0;
            }
        }
    }
}
