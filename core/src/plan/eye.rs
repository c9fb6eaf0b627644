//! The planner's state of one view from frame to frame.

use super::frame::EyePlan;
use super::input::EyeInput;
use super::lattice::{LatticeShape, TileLattice};
use super::rules::{FrameRules, RateLimit};
use super::settings::PlanSettings;
use super::tile_updates::TileUpdates;
use crate::chroma::ChromaTemporalFilter;
use crate::geometry::{Fov, rotation};
use crate::image::Plane;
use crate::kernels::decide::{TileMemory, decide};
use glam::Quat;

/// State of one view: the directions of its tiles, their rates and their updates.
#[derive(Clone, Debug, Default)]
pub(super) struct EyeMemory {
    shape: Option<LatticeShape>,
    pub(super) lattice: TileLattice,
    pub(super) updates: TileUpdates,
    pub(super) tiles: TileMemory,
    pub(super) filter: ChromaTemporalFilter,
    /// Whether the plan that was made last has every tile rendered at full rate, and nothing could have become coarser.
    pub(super) is_full: bool,
}

impl EyeMemory {
    /// Adapts to the view, and resets the tiles if its shape has changed. Returns the rotation from the view's space to
    /// the common one; `None` if the view has no area or no direction.
    ///
    /// A view that only turns keeps its tiles: orientations that are computed from poses tremble in their last bits.
    pub(super) fn set_view(&mut self, input: &EyeInput, texel: [u32; 2], out: &mut EyePlan) -> Option<Quat> {
        let usable = usable(input);
        let fov = if usable.is_some() { input.fov } else { NO_FOV };
        let shape = LatticeShape { fov, ..input.shape(texel) };
        if self.shape != Some(shape) {
            self.shape = Some(shape);
            self.is_full = false;
            self.lattice.set(&shape);
            let [columns, rows] = self.lattice.tiles();
            let tiles = columns as usize * rows as usize;
            self.tiles.reset(tiles);
            self.updates.reset(tiles);
            out.rates = Plane::filled(columns, rows, 0);
            out.ages = Plane::filled(columns, rows, u8::MAX);
            out.offset = input.offset;
            out.extent = input.extent;
            out.texel = self.lattice.texel();
            out.fov = fov;
        }
        usable
    }

    /// Plans every tile at full rate, as settings without rates and without a schedule have it. Frame after frame that is the same plan,
    /// and costs nothing for each tile.
    pub(super) fn plan_at_full_rate(
        &mut self,
        rules: &FrameRules,
        settings: &PlanSettings,
        out: &mut EyePlan,
    ) {
        out.by_contrast = None;
        out.rings = RateLimit::FULL_RATE.rings;
        let params = rules.params(settings, out.centres, &RateLimit::FULL_RATE, &self.lattice);
        out.decision = params;
        if self.is_full {
            return;
        }
        self.is_full = true;
        self.updates.update_all();
        decide(&params, &mut self.lattice, self.updates.due(), None, &mut self.tiles, out);
    }
}

const NO_FOV: Fov = Fov { left: 0.0, right: 0.0, up: 0.0, down: 0.0 };

/// The orientation as a unit quaternion, where the view has an area and a direction.
fn usable(input: &EyeInput) -> Option<Quat> {
    let Fov { left, right, up, down } = input.fov;
    let finite = [left, right, up, down].iter().all(|angle| angle.is_finite());
    let edges = input.fov.tangents();
    let has_area = finite && edges.left != edges.right && edges.up != edges.down;
    rotation(input.orientation).filter(|_| has_area)
}
