//! Recent visible changes of content.

use super::{CELLS, Cell, CellAges};

/// The cells whose content changed visibly within the last frames: they ask to be refreshed in each frame until that is over.
#[derive(Clone, Debug)]
pub struct Activity {
    /// Number of remaining frames, by cell; 0: the cell is not among `cells`.
    left: Vec<u8>,
    /// Urgency of a refresh, by cell.
    needs: Vec<f32>,
    cells: Vec<Cell>,
    frame: Option<u64>,
    /// Whether all of the scene changed.
    is_cut: bool,
}

impl Default for Activity {
    fn default() -> Self {
        Self::new()
    }
}

impl Activity {
    /// Nothing has changed. The only call that allocates.
    pub fn new() -> Self {
        Self {
            left: vec![0; CELLS],
            needs: vec![0.0; CELLS],
            cells: Vec::with_capacity(CELLS),
            frame: None,
            is_cut: false,
        }
    }

    /// A cell changed, by a need above 1: it asks to be refreshed for `frames` frames from now on.
    pub fn changed(&mut self, cell: Cell, need: f32, frames: u8) {
        let index = cell.index();
        if self.left[index] == 0 {
            if frames == 0 {
                return;
            }
            self.cells.push(cell);
            self.needs[index] = 0.0;
        }
        self.left[index] = self.left[index].max(frames);
        self.needs[index] = self.needs[index].max(need);
    }

    /// All of the scene changed: the next frame refreshes everything.
    pub fn cut(&mut self) {
        self.is_cut = true;
    }

    /// Number of cells that ask for a refresh.
    pub fn count(&self) -> usize {
        self.cells.len()
    }

    /// Asks for the refreshes of `frame`, which has begun there ([`CellAges::advance`]). The same frame again asks for
    /// the same; a number that went back counts as a very long time. Returns whether everything is refreshed.
    pub fn ask(&mut self, frame: u64, ages: &mut CellAges) -> bool {
        let passed = self.frame.map_or(0, |last| frame.wrapping_sub(last)).min(u64::from(u8::MAX)) as u8;
        self.frame = Some(frame);
        let Self { left, needs, cells, .. } = self;
        cells.retain(|cell| {
            let index = cell.index();
            left[index] = left[index].saturating_sub(passed);
            let goes_on = left[index] > 0;
            if goes_on {
                ages.want_cell(*cell, needs[index]);
            }
            goes_on
        });
        let is_cut = std::mem::take(&mut self.is_cut);
        if is_cut {
            ages.require_all();
        }
        is_cut
    }
}

#[cfg(test)]
mod tests;
