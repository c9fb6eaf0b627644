//! The age of every cell of directions, and the cells that are rendered in this frame.

mod due;

use super::cells::{CELLS, Cell, PATCH_SIDE, PATCHES, SIDE, centre, patch_phase};
use super::tiles::{Cells, TileCells, Touched};
use super::{Phase, REGIONS, Schedule};
use crate::geometry::unit_direction;
use due::DueLines;
use glam::Vec3;

/// Largest angle between the centre of a cell and a point of it, degrees (1.53 by a test, and rounding).
pub(super) const CELL_RADIUS_DEG: f32 = 1.56;

/// Both eyes, as bits.
const BOTH: u8 = 0b11;

/// State of each cell: its period, its age, and whether it is rendered in this frame.
///
/// Order in a frame: [`Self::advance`]; then refreshes beyond the schedule ([`Self::require`], [`Self::want`],
/// [`super::refresh`]); then [`Self::finish`]; then the queries. Directions are in the space of [`Schedule::is_due`],
/// whose orientation is fixed in the world: a cell keeps its age while the head turns, as reprojected pixels do. (With
/// cells fixed to the head, content that moves against the order of phases could be older than its period for as long
/// as it moves.)
///
/// After [`Self::finish`] no cell is older than its period - 1 frames, for any movement of the gaze: a cell that a
/// faster region has reached is refreshed at once. A cell's period is that of its point nearest to either gaze, so a
/// region reaches up to a cell farther than its radius. The age is the greatest age of the picture; the planner has to
/// [`Self::require`] content that has come into view since.
#[derive(Clone, Debug)]
pub struct CellAges {
    /// Unit directions of the centres, by coordinate.
    centres: [Vec<f32>; 3],
    periods: Vec<u8>,
    /// Frames since the last refresh, 255 for longer ago or never, by eye.
    ages: [Vec<u8>; 2],
    /// Bit 0: left, bit 1: right.
    due: Vec<u8>,
    /// The same by lines, by eye.
    lines: [DueLines; 2],
    /// Urgency of a refresh, 0 if none is wanted.
    needs: Vec<f32>,
    /// Cells with a need above 0.
    wanted: Vec<Cell>,
    frame: Option<u64>,
}

impl Default for CellAges {
    fn default() -> Self {
        Self::new()
    }
}

impl CellAges {
    /// Nothing was ever rendered, and all is due. The only call that allocates.
    pub fn new() -> Self {
        let centres = (0..CELLS).map(|index| centre(Cell::from_index(index)));
        Self {
            centres: [0, 1, 2].map(|axis| centres.clone().map(|centre| centre[axis]).collect()),
            periods: vec![1; CELLS],
            ages: [vec![u8::MAX; CELLS], vec![u8::MAX; CELLS]],
            due: vec![BOTH; CELLS],
            lines: [DueLines::all(), DueLines::all()],
            needs: vec![0.0; CELLS],
            wanted: Vec::with_capacity(CELLS),
            frame: None,
        }
    }

    /// Goes on to `frame`: ages grow by the frames that passed, and a cell that is due by `schedule`, or would become
    /// older than its period, is rendered again.
    ///
    /// `gaze` is the gaze direction of each eye, of any length; one without a meaning (zero, not finite) is left out,
    /// and without both everything has the centre's period. The same frame again only adds due cells. A lower frame
    /// number than before counts as a very long time.
    pub fn advance(&mut self, schedule: &Schedule, frame: u64, gaze: [Vec3; 2]) {
        self.find_periods(schedule, gaze);
        let passed = match self.frame {
            Some(last) => frame.wrapping_sub(last).min(u64::from(u8::MAX)) as u8,
            None => u8::MAX,
        };
        self.frame = Some(frame);
        if passed > 0 {
            self.due.fill(0);
        }
        for eye in 0..2 {
            self.advance_eye(schedule, frame, eye, passed);
        }
    }

    fn advance_eye(&mut self, schedule: &Schedule, frame: u64, eye: usize, passed: u8) {
        let bit = 1 << eye;
        let factors = schedule.configuration.factors();
        let turns = factors.map(|period| schedule.turn(frame, period, eye));
        /// Cells of one row of patches of one face.
        const BAND: usize = PATCH_SIDE * SIDE;
        let bands = self.ages[eye].chunks_exact_mut(BAND).zip(self.due.chunks_exact_mut(BAND));
        for (band, ((ages, due), periods)) in bands.zip(self.periods.chunks_exact(BAND)).enumerate() {
            // By region and column: the period if it is due in this frame, else 0 (no period).
            let mut called = [[0; SIDE]; REGIONS];
            for (region, called) in called.iter_mut().enumerate() {
                for (patch, called) in called.chunks_exact_mut(PATCH_SIDE).enumerate() {
                    let phase = match schedule.phase {
                        Phase::Staggered => patch_phase(band * PATCHES + patch, factors[region]),
                        Phase::Aligned | Phase::AlternateEye => 0,
                    };
                    called.fill(if phase == turns[region] { factors[region] } else { 0 });
                }
            }
            let lines = ages.chunks_exact_mut(SIDE).zip(due.chunks_exact_mut(SIDE));
            for ((ages, due), periods) in lines.zip(periods.chunks_exact(SIDE)) {
                for i in 0..SIDE {
                    let period = periods[i];
                    let age = ages[i].saturating_add(passed);
                    let mut now = age >= period;
                    for called in &called {
                        now |= called[i] == period;
                    }
                    ages[i] = if now { 0 } else { age };
                    due[i] |= if now { bit } else { 0 };
                }
            }
        }
    }

    /// The period of each cell, from its point nearest to either gaze.
    fn find_periods(&mut self, schedule: &Schedule, gaze: [Vec3; 2]) {
        let factors = schedule.configuration.factors();
        let known = gaze.map(unit_direction);
        let [Some(left), Some(right)] = [known[0].or(known[1]), known[1].or(known[0])] else {
            self.periods.fill(factors[0]);
            return;
        };
        let limits = schedule.regions.radii_deg.map(limit);
        let steps: [u8; REGIONS - 1] = std::array::from_fn(|i| factors[i + 1] - factors[i]);
        let [x, y, z] = &self.centres;
        let centres = x.chunks_exact(LANES).zip(y.chunks_exact(LANES)).zip(z.chunks_exact(LANES));
        for (periods, ((x, y), z)) in self.periods.chunks_exact_mut(LANES).zip(centres) {
            let mut nearest = [0.0f32; LANES];
            for i in 0..LANES {
                let left = left.x * x[i] + left.y * y[i] + left.z * z[i];
                let right = right.x * x[i] + right.y * y[i] + right.z * z[i];
                nearest[i] = if left > right { left } else { right };
            }
            for i in 0..LANES {
                let mut factor = factors[0];
                for (limit, step) in limits.into_iter().zip(steps) {
                    let step = if nearest[i] < limit { step } else { 0 };
                    factor = u8::wrapping_add(factor, step);
                }
                periods[i] = factor;
            }
        }
    }

    /// Refreshes cells in this frame without regard to the limit: where history is missing, for example.
    pub fn require(&mut self, touched: &Touched) {
        touched.for_each(|cell| self.refresh(cell));
    }

    /// Refreshes everything: a scene cut, or no history at all.
    pub fn require_all(&mut self) {
        self.ages.iter_mut().for_each(|ages| ages.fill(0));
        self.due.fill(BOTH);
    }

    /// Asks for a refresh of cells that are not due. The larger `need` is, the sooner it is granted (of several
    /// for one cell the largest counts); 0 or less asks for nothing, NaN is the largest.
    pub fn want(&mut self, touched: &Touched, need: f32) {
        touched.for_each(|cell| self.want_cell(cell, need));
    }

    /// [`Self::want`] for one cell.
    pub fn want_cell(&mut self, cell: Cell, need: f32) {
        let need = if need.is_nan() { f32::INFINITY } else { need };
        if need <= 0.0 {
            return;
        }
        let known = &mut self.needs[cell.index()];
        if *known == 0.0 {
            self.wanted.push(cell);
        }
        *known = known.max(need);
    }

    /// Grants the most needed refreshes, at most `limit` cells, so that the load stays even; of equal needs the lower
    /// index first. The others have to be requested again. Returns the number of granted cells.
    pub fn finish(&mut self, limit: usize) -> usize {
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.retain(|cell| {
            let open = self.due[cell.index()] != BOTH;
            if !open {
                self.needs[cell.index()] = 0.0;
            }
            open
        });
        if limit < wanted.len() {
            let needs = &self.needs;
            wanted.select_nth_unstable_by(limit, |a, b| {
                needs[b.index()].total_cmp(&needs[a.index()]).then(a.cmp(b))
            });
        }
        let granted = limit.min(wanted.len());
        for (rank, &cell) in wanted.iter().enumerate() {
            self.needs[cell.index()] = 0.0;
            if rank < granted {
                self.refresh(cell);
            }
        }
        wanted.clear();
        self.wanted = wanted;
        for (eye, lines) in self.lines.iter_mut().enumerate() {
            lines.set(&self.due, eye);
        }
        granted
    }

    fn refresh(&mut self, cell: Cell) {
        self.due[cell.index()] = BOTH;
        self.ages.iter_mut().for_each(|ages| ages[cell.index()] = 0);
    }

    /// Whether a cell is rendered in this frame for an eye, 0 (left) or 1.
    pub fn is_due(&self, cell: Cell, eye: usize) -> bool {
        self.due[cell.index()] >> (eye & 1) & 1 == 1
    }

    /// Whether any cell of a tile is, so that the tile has to be rendered. As of the last [`Self::finish`].
    #[inline]
    pub fn any_due(&self, touched: &Touched, eye: usize) -> bool {
        match &touched.0 {
            &Cells::Block { lines, columns } => self.lines[eye & 1].any(lines, columns),
            Cells::Ranges(ranges) => ranges
                .iter()
                .enumerate()
                .any(|(face, range)| range.cells(face).any(|cell| self.is_due(cell, eye))),
        }
    }

    /// [`Self::any_due`] of all tiles of an image at once, row by row. A slice that is shorter gets the first ones.
    pub fn due_tiles(&self, tiles: &TileCells, eye: usize, due: &mut [bool]) {
        let (lines, columns) = tiles.blocks();
        let due_lines = &self.lines[eye & 1];
        for ((due, &lines), &columns) in due.iter_mut().zip(lines).zip(columns) {
            // Of a tile without a block the answer has no meaning, and is replaced below.
            *due = due_lines.any(lines, columns);
        }
        for (index, touched) in tiles.large() {
            if let Some(due) = due.get_mut(index) {
                *due = self.any_due(&touched, eye);
            }
        }
    }

    /// Frames since a cell was last rendered, 0 for this frame, 255 for longer ago or never.
    pub fn age(&self, cell: Cell, eye: usize) -> u8 {
        self.ages[eye & 1][cell.index()]
    }

    /// Number of frames within which a cell is rendered, 1..=9.
    pub fn period(&self, cell: Cell) -> u8 {
        self.periods[cell.index()]
    }
}

/// Cells that are compared at once; rows of cells are a multiple of it.
const LANES: usize = 16;

const _: () = assert!(SIDE.is_multiple_of(LANES));

/// Cosine that the centre of a cell has at least when some point of it lies within a radius.
fn limit(radius_deg: f32) -> f32 {
    let reach_deg = radius_deg + CELL_RADIUS_DEG;
    if reach_deg.is_nan() || reach_deg >= 180.0 {
        -2.0
    } else if radius_deg < 0.0 {
        2.0
    } else {
        reach_deg.to_radians().cos()
    }
}

#[cfg(test)]
mod tests;
