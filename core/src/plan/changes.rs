//! Changing content of the periphery, found in rendered images.

use crate::geometry::{View, eccentricity};
use crate::schedule::refresh::{RefreshSettings, VisibleChange};
use crate::schedule::{Activity, Cell, CellAges};
use glam::{Vec2, Vec3};

/// Refresh of changing content.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    settings: RefreshSettings,
    /// Present from the first change on.
    activity: Option<Activity>,
    /// Gaze directions in the world, by the newest plan.
    gazes: [Vec3; 2],
    /// The planned frame, and the number of cells refreshed in it.
    granted: (u64, usize),
}

/// The points of a tile whose cells it touches, parts of its sides: tiles of up to three degrees have no cell in between.
const POINTS: [f32; 3] = [0.0, 0.5, 1.0];

impl Changes {
    /// Some tiles of a picture of `all` tiles were compared.
    pub(super) fn seen(&mut self, view: &View, all: usize, tiles: impl ExactSizeIterator<Item = (u32, f32)>) {
        // In a frame without a due region, hardly more is compared than changed before: a moving object is no cut.
        let compared = tiles.len().max(all / 4);
        // A part of a tile is half as wide.
        let visible = VisibleChange::new((view.plane.step.abs().min_element() / 2.0).atan().to_degrees());
        // The smallest change that is visible at any eccentricity: most tiles change less.
        let least_change = self.settings.least_change(&visible);
        let mut changed = 0;
        for (word, change) in tiles {
            if change <= least_change {
                continue;
            }
            let tile = Vec2::new((word & 0xffff) as f32, (word >> 16) as f32);
            let direction = |point: Vec2| view.orientation * view.plane.direction(tile + point);
            let middle = direction(Vec2::splat(0.5));
            let least =
                self.gazes.map(|gaze| eccentricity(middle, gaze)).into_iter().fold(f32::MAX, f32::min);
            let need = self.settings.need(change, &visible, least.to_degrees());
            if need <= 1.0 {
                continue;
            }
            changed += 1;
            let activity = self.activity.get_or_insert_default();
            for (x, y) in POINTS.into_iter().flat_map(|y| POINTS.map(|x| (x, y))) {
                if let Some(cell) = Cell::of(direction(Vec2::new(x, y))) {
                    activity.changed(cell, need, self.settings.hold_frames);
                }
            }
        }
        if self.settings.is_scene_cut(changed, compared)
            && let Some(activity) = &mut self.activity
        {
            activity.cut();
        }
    }

    /// Refreshes changing cells, in a frame that has begun in `ages`; returns whether any cell is refreshed.
    pub(super) fn refresh(&mut self, frame: u64, gazes: [Vec3; 2], ages: &mut CellAges) -> bool {
        self.gazes = gazes;
        if self.granted.0 != frame {
            self.granted = (frame, 0);
        }
        let Some(activity) = &mut self.activity else {
            ages.finish(0);
            return false;
        };
        let is_cut = activity.ask(frame, ages);
        self.granted.1 += ages.finish(self.settings.limit_cells.saturating_sub(self.granted.1));
        is_cut || self.granted.1 > 0
    }
}

#[cfg(test)]
mod tests;
