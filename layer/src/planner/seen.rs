//! Views of the newest plan for people.

use super::SessionPlanner;
use crate::config::Config;
use crate::inputs::gaze::{direction, in_view};
use glam::Vec3;
use parafovea_core::image::Plane;
use parafovea_core::kernels::debug_view::{DebugView, MapShape, map_row_bytes};

/// An overlay over an eye buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DebugOverlay {
    /// Assumed direction of the gaze, or the direction of the dot, in the view's space, of any length; all 0 if it is not known.
    pub gaze: Vec3,
    /// Size of the map, and of its tiles.
    pub shape: MapShape,
    /// Whether the map holds only where the GPU has decided nothing.
    pub is_decided_on_gpu: bool,
}

impl SessionPlanner {
    /// The overlay of an eye's newest plan for `view`; its map, if it has one, goes to `map`. Nothing without a plan. The dot of
    /// [`DebugView::Ahead`] is `dot_deg` to the left and upwards of the centre of the view.
    pub fn seen(
        &self,
        config: &Config,
        eye: usize,
        view: DebugView,
        dot_deg: [f32; 2],
        map: &mut Vec<u8>,
    ) -> Option<DebugOverlay> {
        map.clear();
        let plan = &self.planner.as_ref()?.newest().eyes[eye];
        let rates = self.has_maps(config) && self.techniques.rates;
        let reuse = self.has_maps(config) && self.techniques.reuse;
        let shown = match view {
            DebugView::Rates => rates.then_some(&plan.rates),
            DebugView::Age => reuse.then_some(&plan.ages),
            DebugView::Eccentricity | DebugView::Gaze | DebugView::Ahead => None,
        };
        let shape = shown.map_or(MapShape::default(), |tiles| MapShape {
            extent: plan.extent,
            texel: plan.texel,
            tiles: [tiles.width(), tiles.height()],
        });
        if let Some(tiles) = shown {
            write_rows(tiles, map);
        }
        // The plan assumes that each eye looks at a near point, because its distance is unknown: the ray is between both eyes' rays.
        let [left, right] = plan.centres;
        let gaze = match view {
            // Where the gaze is unknown, angles are from the centre of the view, as the rings are.
            DebugView::Eccentricity => left + right,
            DebugView::Ahead => in_view(direction(dot_deg), self.views.orientation(eye)),
            _ if plan.gaze == Vec3::ZERO => Vec3::ZERO,
            _ => left + right,
        };
        Some(DebugOverlay { gaze, shape, is_decided_on_gpu: rates && self.gpu_decides() })
    }
}

/// Rows that begin with whole words.
fn write_rows(tiles: &Plane<u8>, map: &mut Vec<u8>) {
    let row_bytes = map_row_bytes(tiles.width()) as usize;
    for row in 0..tiles.height() {
        map.extend_from_slice(tiles.row(row));
        map.resize(map.len().next_multiple_of(row_bytes.max(1)), 0);
    }
}
