//! Reference of the kernel `decide`: from one view's parameters to a rate and an age for each of its tiles.
//!
//! Values of the whole frame are in [`DecideParams`], computed once; the work for a tile is its chord to the gaze, a few
//! comparisons, and its memory of the frame before. The GPU computes each tile's corners, chord and pixels per degree by
//! itself, which here are in the [`TileLattice`]; ages stay on the CPU, which has the update schedule.

use crate::frco::Allocation;
use crate::geometry::{ImagePlane, Reprojection, View};
use crate::layout::uniform;
use crate::perception::{BANDS, ContrastMap, TileContrast};
use crate::plan::{EyePlan, TileLattice, VisibleContrast};
use glam::{Quat, UVec2, Vec2, Vec3};

uniform! {
    /// Parameters of one view and frame.
    pub struct DecideParams {
        /// Gaze direction of the left eye, unit vector in the space of this view. A tile's eccentricity is that from the nearer
        /// of both gazes, so that both eyes agree about one direction of the world.
        pub gaze_left: [f32; 3],
        /// Angle by which the gaze may be off, degrees: taken off the eccentricity before contrast is judged.
        pub inflation_deg: f32,
        /// Gaze direction of the right eye.
        pub gaze_right: [f32; 3],
        /// Most that a tile may become coarser in this frame, in [`crate::plan::STEPS_PER_OCTAVE`].
        pub coarsening: u32,
        /// Squared chord from which on each coarser rate is permitted, finest rate first, rising.
        pub ring_chords: [f32; 4],
        /// The same for tiles that are still finer: farther out, so that a small motion does not change rates.
        pub coarsening_chords: [f32; 4],
        /// Coarseness of each of these rates in [`crate::plan::STEPS_PER_OCTAVE`], rising.
        pub levels: [u32; 4],
        /// Their texels, see [`crate::rate::ShadingRate::texel`].
        pub texels: [u32; 4],
        /// Allowed loss of visible contrast, the alpha of paper A Eq. 17, in the sense of [`Self::is_marginal`]; meaningless if no
        /// contrast is judged.
        pub budget: f32,
        /// The same for tiles that are still finer.
        pub coarsening_budget: f32,
        /// Units in which contrast is judged: 0 if only the rings count, 1
        /// [`CastleCsf`](crate::avpm::SensitivityUnit::CastleCsf), 2 [`Tursun`](crate::avpm::SensitivityUnit::Tursun).
        pub sensitivity: u32,
        /// Period of the frames at full rate of each tile with judged contrast: they reveal detail in its finest octaves
        /// alone; 0: never. See [`Self::with_full_rate_period`].
        pub full_rate_period: u32,
        /// [`ImagePlane::origin`](crate::geometry::ImagePlane::origin) of the view.
        pub plane_origin: [f32; 2],
        /// [`ImagePlane::step`](crate::geometry::ImagePlane::step) of the view.
        pub plane_step: [f32; 2],
        /// Size of the view, pixels.
        pub extent: [u32; 2],
        /// Pixels of the first tile that lie before the view.
        pub overhang: [u32; 2],
        /// Size of a tile, pixels.
        pub texel: [u32; 2],
        /// Columns and rows of tiles.
        pub tiles: [u32; 2],
        /// Number of the frame modulo `full_rate_period`: selects the tiles that are seen at full rate.
        pub full_rate_phase: u32,
        /// 1 if contrast was measured in a view of another orientation, see [`Self::measured_in`]; else 0, and each tile has its own
        /// contrast.
        pub is_turned: u32,
        /// 1 if some tiles are left out ([`crate::reuse::STALE`]); these are passed separately.
        pub has_stale: u32,
        /// [`Self::budget`] of tiles whose rate changed less than [`STEADY_MS`] ago.
        pub holding_budget: f32,
        /// First row of the homography from points (x, y, 1) on the plane one unit ahead to the tiles of measured contrast: its
        /// product with a point is the column of tiles, times the product with `measured_depth`.
        pub measured_column: [f32; 3],
        /// Time since the frame before, milliseconds, 0..=100.
        pub elapsed_ms: u32,
        /// The same for the row.
        pub measured_row: [f32; 3],
        /// Contrast, of both octaves that rates remove together, that is within every budget however well it is seen: the tile is
        /// flat, and decided without a sensitivity. Negative where there is no such contrast.
        pub flat_contrast: f32,
        /// Divisor of both: > 0 for directions ahead of the view in which contrast was measured.
        pub measured_depth: [f32; 3],
        /// 1 where budgets are prices of a sample, [`Allocation::EqualMarginalLoss`]; 0 where each tile may lose them.
        pub is_marginal: u32,
        /// Column and row of the tile corner nearest to the view's axis, modulo 2^32: frames at full rate are chosen by the distance from it,
        /// which a direction has in both eyes of parallel displays, to within a tile.
        pub axis_tile: [u32; 2],
        /// Always 0.
        pub unused: [u32; 2],
    }
}

/// Time after a change of its rate for which a tile is not shaded at full rate to measure it, milliseconds. Meanwhile, its contrast counts by
/// [`DecideParams::holding_budget`].
pub const STEADY_MS: u8 = 100;

/// A tile that has moved by less than this part of a tile is where it was.
const STILL: f32 = 1.0 / 8.0;

impl DecideParams {
    /// With each tile where contrast is judged seen at full rate once in `every` frames (0: never), of which this is number
    /// `frame`. For contrast that is measured in coarsely shaded images ([`crate::kernels::analyze::restore()`]).
    pub fn with_full_rate_period(mut self, every: u32, frame: u64) -> Self {
        self.full_rate_period = every;
        self.full_rate_phase = frame.checked_rem(every.into()).unwrap_or(0) as u32;
        self.axis_tile = self.axis_tile();
        self
    }

    fn axis_tile(&self) -> [u32; 2] {
        [0, 1].map(|axis| {
            let pixel = -self.plane_origin[axis] / self.plane_step[axis] + self.overhang[axis] as f32;
            let tile = (pixel / self.texel[axis] as f32).round();
            // A view beside its axis has negative tiles; without a step there is none.
            (tile as i32).cast_unsigned()
        })
    }

    /// With contrast that was measured while the view was `measured`, for a view that is `now` in this frame: distant content moves within
    /// the image as the head turns. If an orientation is invalid, or the turn is less than an eighth of a tile, the tiles stay at their
    /// places.
    pub fn measured_in(mut self, measured: &View, now: Quat) -> Self {
        self.is_turned = 0;
        let ahead = View { orientation: now, plane: ImagePlane { origin: Vec2::ZERO, step: Vec2::ONE } };
        let Some(map) = Reprojection::between(&ahead, measured) else { return self };
        let pixels = map.matrix().transpose();
        let texel = UVec2::from(self.texel).max(UVec2::ONE).as_vec2();
        let overhang = UVec2::from(self.overhang).as_vec2();
        self.measured_column = ((pixels.x_axis + pixels.z_axis * overhang.x) / texel.x).into();
        self.measured_row = ((pixels.y_axis + pixels.z_axis * overhang.y) / texel.y).into();
        self.measured_depth = pixels.z_axis.into();
        let [columns, rows] = self.tiles.map(|count| count.saturating_sub(1));
        let corners = [[0, 0], [columns, 0], [0, rows], [columns, rows]];
        let moves = |tile: [u32; 2]| {
            let away =
                self.measured_at(tile).map(|at| (at - UVec2::from(tile).as_vec2()).abs().max_element());
            !away.is_some_and(|away| away < STILL)
        };
        self.is_turned = u32::from(corners.into_iter().any(moves));
        self
    }

    /// Allocation of budgets to tiles.
    pub fn allocation(&self) -> Allocation {
        if self.is_marginal == 0 { Allocation::PerTile } else { Allocation::EqualMarginalLoss }
    }

    /// Position of a tile when contrast was measured, in tiles: whole numbers are tiles. `None` if it was behind the view.
    fn measured_at(&self, tile: [u32; 2]) -> Option<Vec2> {
        let pixel = (UVec2::from(tile).as_vec2() + 0.5) * UVec2::from(self.texel).as_vec2()
            - UVec2::from(self.overhang).as_vec2();
        let point = (Vec2::from(self.plane_origin) + Vec2::from(self.plane_step) * pixel).extend(1.0);
        let depth = Vec3::from(self.measured_depth).dot(point);
        let at =
            Vec2::new(Vec3::from(self.measured_column).dot(point), Vec3::from(self.measured_row).dot(point))
                / depth;
        (depth > 0.0).then_some(at - 0.5)
    }

    /// Contrast of tile `index`, counted row by row, in this frame: if it lay between tiles of the measured picture, the
    /// greatest of theirs; beyond that picture, the contrast of its border. NaN if the tile was behind the measured view.
    pub(crate) fn contrast(&self, map: &ContrastMap, index: u32) -> TileContrast {
        let [columns, rows] = self.tiles;
        if self.is_turned == 0 || columns == 0 || rows == 0 {
            return map.tiles.texels().get(index as usize).copied().unwrap_or_default();
        }
        let Some(at) = self.measured_at([index % columns, index / columns]) else {
            return TileContrast { bands: [f32::NAN; BANDS], adaptation_cd_m2: 0.0 };
        };
        let last = UVec2::new(columns - 1, rows - 1).as_vec2();
        let tile = |at: Vec2| at.clamp(Vec2::ZERO, last).as_uvec2();
        let (first, end) = (tile((at + STILL).floor()), tile((at - STILL).ceil()));
        let nearest = tile((at + 0.5).floor());
        let mut found = map.tiles.at(nearest.x, nearest.y);
        for [x, y] in [[first.x, first.y], [end.x, first.y], [first.x, end.y], [end.x, end.y]] {
            for (band, other) in found.bands.iter_mut().zip(map.tiles.at(x, y).bands) {
                *band = if other > *band { other } else { *band };
            }
        }
        found
    }

    /// Whether tile `index`, counted row by row, is shaded at 1x1 in this frame to measure its contrast. Neighbours have different frames.
    fn is_full_rate_frame(&self, index: u32) -> bool {
        let [columns, _] = self.tiles.map(|count| count.max(1));
        let [column, row] = [index % columns, index / columns];
        let [right, down] = [column.wrapping_sub(self.axis_tile[0]), row.wrapping_sub(self.axis_tile[1])];
        let phase = right.wrapping_mul(0x9e37_79b1).wrapping_add(down.wrapping_mul(0x85eb_ca6b)) >> 8;
        phase.checked_rem(self.full_rate_period) == Some(self.full_rate_phase)
    }
}

/// State of a view's tiles from frame to frame, and the space in which a frame is worked out.
#[derive(Clone, Debug, Default)]
pub struct TileMemory {
    /// Coarseness, in [`crate::plan::STEPS_PER_OCTAVE`]; between two rates while it grows.
    levels: Vec<u8>,
    /// Time since the rate changed, milliseconds, as far as it can be counted.
    ages_ms: Vec<u8>,
    /// Squared chord of each tile to the nearer of [`Self::gazes`].
    chords: Vec<f32>,
    /// Both gazes as they were last; `None` before the first frame.
    gazes: Option<[Vec3; 2]>,
    /// Coarseness that contrast permits each tile to keep, and to grow to.
    permitted: [Vec<u8>; 2],
}

impl TileMemory {
    /// Forgets everything: `tiles` tiles at full rate.
    pub fn reset(&mut self, tiles: usize) {
        self.levels.clear();
        self.levels.resize(tiles, 0);
        self.ages_ms.clear();
        self.ages_ms.resize(tiles, 0);
        self.chords.clear();
        self.chords.resize(tiles, 0.0);
        self.gazes = None;
        for permitted in &mut self.permitted {
            permitted.clear();
            permitted.resize(tiles, u8::MAX);
        }
    }
}

/// Decides the tiles of one view.
///
/// `due` marks the tiles to render. Without `contrast` the rings alone decide. `out` has the ages of the frame before.
/// All of them, and `memory`, have a place for each tile of `lattice`.
pub fn decide(
    params: &DecideParams,
    lattice: &mut TileLattice,
    due: &[bool],
    contrast: Option<VisibleContrast>,
    memory: &mut TileMemory,
    out: &mut EyePlan,
) {
    let gazes = [params.gaze_left, params.gaze_right].map(Vec3::from);
    // Without an eye tracker it is the same gaze in each frame.
    if memory.gazes.replace(gazes) != Some(gazes) {
        lattice.nearest(gazes, &mut memory.chords);
    }
    match contrast {
        Some(contrast) => {
            let TileMemory { ages_ms, chords, permitted, .. } = memory;
            contrast.permit(params, lattice.resolution(), chords, ages_ms, permitted);
        }
        None => memory.permitted.iter_mut().for_each(|permitted| permitted.fill(u8::MAX)),
    }
    coarsen(params, contrast.is_some(), memory);
    choose(params, &memory.levels, out.rates.texels_mut());
    for (age, due) in out.ages.texels_mut().iter_mut().zip(due) {
        *age = if *due { 0 } else { age.saturating_add(1) };
    }
}

/// Moves each tile's coarseness: at once down to the limit of rings and contrast, slowly up. On the way up it starts again from its
/// rate wherever it is not permitted to grow, so that it becomes coarser only after growth was permitted for the whole time.
fn coarsen(params: &DecideParams, is_judged: bool, memory: &mut TileMemory) {
    let step = params.coarsening.min(255) as u8;
    let elapsed_ms = params.elapsed_ms.min(255) as u8;
    let limits = params.levels.map(|level| level as u8);
    let TileMemory { levels, ages_ms, chords, permitted: [keep, grow], .. } = memory;
    limit_by_rings(keep, chords, &params.ring_chords, &params.levels);
    limit_by_rings(grow, chords, &params.coarsening_chords, &params.levels);
    if is_judged {
        for ((index, keep), age_ms) in (0..).zip(keep.iter_mut()).zip(&*ages_ms) {
            let is_full_rate = *age_ms >= STEADY_MS && params.is_full_rate_frame(index);
            *keep = if is_full_rate { 0 } else { *keep };
        }
    }
    for (((level, age_ms), keep), grow) in levels.iter_mut().zip(ages_ms).zip(&*keep).zip(&*grow) {
        let before = reached(*level, &limits);
        let grow = (*grow).min(*keep);
        *level = before.min(*keep).max(grow.min(level.saturating_add(step)));
        *age_ms = if reached(*level, &limits) == before { age_ms.saturating_add(elapsed_ms) } else { 0 };
    }
}

/// Lowers the permitted levels of tiles at these squared chords to the level of the last ring that each has reached; 0 before all rings.
fn limit_by_rings(permitted: &mut [u8], chords: &[f32], rings: &[f32; 4], levels: &[u32; 4]) {
    // Tiles at once: vectors hold this number of 32-bit and of 8-bit values.
    const LANES: usize = 16;
    // Rings rise, so that a tile at one of them is at all before it: the steps up to its level are added up.
    let [a, b, c, d] = *levels;
    let steps = [a, b.wrapping_sub(a), c.wrapping_sub(b), d.wrapping_sub(c)];
    let mut permitted = permitted.chunks_exact_mut(LANES);
    let mut chords = chords.chunks_exact(LANES);
    for (permitted, chords) in permitted.by_ref().zip(chords.by_ref()) {
        let mut reached = [0u32; LANES];
        for (ring, step) in rings.iter().zip(steps) {
            for (reached, chord) in reached.iter_mut().zip(chords) {
                *reached = reached.wrapping_add(if *chord >= *ring { step } else { 0 });
            }
        }
        for (permitted, reached) in permitted.iter_mut().zip(reached) {
            *permitted = (*permitted).min(reached as u8);
        }
    }
    for (permitted, chord) in permitted.into_remainder().iter_mut().zip(chords.remainder()) {
        *permitted = (*permitted).min(level_at(*chord, rings, levels));
    }
}

/// The coarseness of the coarsest rate that a tile has reached.
fn reached(level: u8, limits: &[u8; 4]) -> u8 {
    let mut rate = 0;
    for limit in limits {
        rate = if level >= *limit { *limit } else { rate };
    }
    rate
}

/// The coarsest rate whose coarseness a tile has reached.
fn choose(params: &DecideParams, levels: &[u8], texels: &mut [u8]) {
    let limits = params.levels.map(|level| level as u8);
    let rates = params.texels.map(|texel| texel as u8);
    for (texel, level) in texels.iter_mut().zip(levels) {
        let mut rate = 0;
        for (limit, coarser) in limits.into_iter().zip(rates) {
            rate = if *level >= limit { coarser } else { rate };
        }
        *texel = rate;
    }
}

/// The level of the last ring that `chord` has reached; 0 before them all.
fn level_at(chord: f32, rings: &[f32; 4], levels: &[u32; 4]) -> u8 {
    let mut level = 0;
    for (ring, next) in rings.iter().zip(levels) {
        level = if chord >= *ring { *next } else { level };
    }
    level as u8
}

#[cfg(test)]
mod tests;
