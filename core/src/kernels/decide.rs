//! Reference of the kernel `decide`: from one view's parameters to a rate and an age for each of its tiles.
//!
//! What depends on the frame alone is in [`DecideParams`], computed once; what is left for a tile is its chord to the
//! gaze, a few comparisons, and its memory of the frame before. The GPU works out each tile's corners, chord and pixels per
//! degree by itself, which here are in the [`TileLattice`]; ages stay on the CPU, which knows whose turn it is.

use crate::layout::uniform;
use crate::plan::{EyePlan, TileLattice, VisibleContrast};

uniform! {
    /// Parameters of one view and frame.
    pub struct DecideParams {
        /// Where the left eye looks, unit vector in the space of this view. A tile's eccentricity is that from the
        /// nearer of both gazes, so that both eyes agree about one direction of the world.
        pub gaze_left: [f32; 3],
        /// Angle by which the gaze may be off, degrees: taken off the eccentricity before contrast is judged.
        pub inflation_deg: f32,
        /// Where the right eye looks.
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
        /// Greatest loss of visible contrast, the alpha of paper A Eq. 17; without meaning where no contrast is judged.
        pub budget: f32,
        /// The same for tiles that are still finer.
        pub coarsening_budget: f32,
        /// In whose units contrast is judged: 0 where only the rings count, 1
        /// [`CastleCsf`](crate::avpm::SensitivityUnit::CastleCsf), 2 [`Tursun`](crate::avpm::SensitivityUnit::Tursun).
        pub sensitivity: u32,
        /// Frames in which each tile where contrast is judged is seen at full rate once, so that detail which only
        /// its finest octaves hold is found; 0: never. See [`Self::looking`].
        pub look_every: u32,
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
        /// Whose turn it is to be seen at full rate, below `look_every`.
        pub look_at: u32,
        /// Reserved, up to a multiple of 16 bytes; 0.
        pub reserved: u32,
        /// As [`Self::reserved`].
        pub reserved_end: [u32; 2],
    }
}

impl DecideParams {
    /// With each tile where contrast is judged seen at full rate once in `every` frames (0: never), of which this is number
    /// `frame`. For contrast that is measured in what was shaded coarsely ([`crate::kernels::analyze::restore()`]).
    pub fn looking(mut self, every: u32, frame: u64) -> Self {
        self.look_every = every;
        self.look_at = frame.checked_rem(every.into()).unwrap_or(0) as u32;
        self
    }

    /// Whether it is the turn of tile `index`, counted row by row. Neighbours have their turns at different times.
    fn is_looked_at(&self, index: u32) -> bool {
        let turn = index.wrapping_mul(0x9e37_79b1) >> 8;
        turn.checked_rem(self.look_every) == Some(self.look_at)
    }
}

/// What a view's tiles remember from frame to frame, and the space in which a frame is worked out.
#[derive(Clone, Debug, Default)]
pub struct TileMemory {
    /// Coarseness, in [`crate::plan::STEPS_PER_OCTAVE`]; between two rates while it grows.
    levels: Vec<u8>,
    /// Squared chord of each tile in this frame.
    chords: Vec<f32>,
    /// Coarseness that contrast permits each tile to keep, and to grow to.
    permitted: [Vec<u8>; 2],
}

impl TileMemory {
    /// Forgets everything: `tiles` tiles at full rate.
    pub fn reset(&mut self, tiles: usize) {
        self.levels.clear();
        self.levels.resize(tiles, 0);
        self.chords.clear();
        self.chords.resize(tiles, 0.0);
        for permitted in &mut self.permitted {
            permitted.clear();
            permitted.resize(tiles, u8::MAX);
        }
    }
}

/// Decides the tiles of one view.
///
/// `due` says of each tile whether it is to be rendered. Without `contrast` the rings alone decide. `out` has the
/// ages of the frame before. All of them, and `memory`, have a place for each tile of `lattice`.
pub fn decide(
    params: &DecideParams,
    lattice: &mut TileLattice,
    due: &[bool],
    contrast: Option<VisibleContrast>,
    memory: &mut TileMemory,
    out: &mut EyePlan,
) {
    lattice.nearest([params.gaze_left.into(), params.gaze_right.into()], &mut memory.chords);
    match contrast {
        Some(contrast) => {
            contrast.permit(params, lattice.resolution(), &memory.chords, &mut memory.permitted)
        }
        None => memory.permitted.iter_mut().for_each(|permitted| permitted.fill(u8::MAX)),
    }
    coarsen(params, memory);
    if params.look_every > 0 && contrast.is_some() {
        for (index, level) in (0..).zip(&mut memory.levels) {
            *level = if params.is_looked_at(index) { 0 } else { *level };
        }
    }
    choose(params, &memory.levels, out.rates.texels_mut());
    for (age, due) in out.ages.texels_mut().iter_mut().zip(due) {
        *age = if *due { 0 } else { age.saturating_add(1) };
    }
}

/// Moves each tile's coarseness: at once down to what rings and contrast permit it to keep, slowly up.
fn coarsen(params: &DecideParams, memory: &mut TileMemory) {
    let step = params.coarsening.min(255) as u8;
    let [keep, grow] = &memory.permitted;
    let tiles = memory.levels.iter_mut().zip(&memory.chords).zip(keep.iter().zip(grow));
    for ((level, chord), (keep, grow)) in tiles {
        let keep = (*keep).min(level_at(*chord, &params.ring_chords, &params.levels));
        let grow = (*grow).min(level_at(*chord, &params.coarsening_chords, &params.levels)).min(keep);
        *level = (*level).min(keep).max(grow.min(level.saturating_add(step)));
    }
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
