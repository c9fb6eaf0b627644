//! The tiles of a view that are rendered in a frame: tiles that are due, and tiles that came into view since the last frame.

use super::lattice::TileLattice;
use super::tile_schedule::TileSchedule;
use crate::geometry::FovTangents;
use crate::schedule::{CellAges, Schedule, TileCells};
use glam::{Quat, Vec3};

/// Part of a pixel that a corner may lie beyond the border of the last frame's view: rounding.
const SLACK_PIXELS: f32 = 0.5;

/// Due tiles of one view, and its state from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct TileUpdates {
    /// Whether each tile is to be rendered.
    due: Vec<bool>,
    cells: TileCells,
    schedule: TileSchedule,
    /// Orientation of the view in the world in the previous frame, by its last plan; `None` without a usable image.
    last: Option<Quat>,
    /// The same in this frame, by the newest plan.
    now: Option<Quat>,
    frame: u64,
}

impl TileUpdates {
    /// Forgets the last frame: `tiles` tiles, all due.
    pub(super) fn reset(&mut self, tiles: usize) {
        self.due.clear();
        self.due.resize(tiles, true);
        self.schedule.reset(tiles);
        (self.last, self.now) = (None, None);
    }

    /// Whether each tile is to be rendered.
    pub(super) fn due(&self) -> &[bool] {
        &self.due
    }

    /// Begins frame number `frame`, perhaps again, with the view's orientation in the world; `None` if it is unknown.
    pub(super) fn begin(&mut self, frame: u64, orientation: Option<Quat>) {
        if self.frame != frame {
            self.frame = frame;
            self.last = self.now;
        }
        self.now = orientation;
    }

    /// Marks all tiles as due.
    pub(super) fn update_all(&mut self) {
        self.due.fill(true);
        self.schedule.rendered(self.frame);
    }

    /// Marks the tiles with due cells of `eye`, and the tiles that came into view since the last frame.
    pub(super) fn update_directions(&mut self, lattice: &TileLattice, ages: &CellAges, eye: usize) {
        let view = self.now.and_then(|now| Some((now, lattice.tile_view(now)?)));
        let Some((last, (now, view))) = self.last.zip(view) else {
            self.update_all();
            return;
        };
        self.cells.update(&view, lattice.tiles(), 1);
        ages.due_tiles(&self.cells, eye, &mut self.due);
        self.reveal(lattice, last.inverse() * now);
    }

    /// Marks the tiles that are due by the schedule of tiles, around the gazes in the view's space.
    pub(super) fn update_tiles(
        &mut self,
        lattice: &mut TileLattice,
        schedule: &Schedule,
        eye: usize,
        gazes: [Vec3; 2],
    ) {
        self.schedule.advance(schedule, self.frame, eye, lattice, gazes, &mut self.due);
    }

    /// Adds the tiles that are not wholly within the last view, into whose space `to_last` leads.
    ///
    /// That view is bounded by four planes, and along a line of corners each of them cuts off one end.
    fn reveal(&mut self, lattice: &TileLattice, to_last: Quat) {
        let (Some(edges), [across, down]) = (lattice.edges(SLACK_PIXELS), lattice.lines()) else { return };
        let planes = inward(edges).map(|normal| to_last.inverse() * normal);
        let mut upper = Span::on(&planes, down[0]);
        for (due, y) in self.due.chunks_exact_mut(across.len() - 1).zip(&down[1..]) {
            let lower = Span::on(&planes, *y);
            let span = Span { from: upper.from.max(lower.from), to: upper.to.min(lower.to) };
            for (due, x) in due.iter_mut().zip(across.windows(2)) {
                let inside = span.from <= x[0].min(x[1]) && x[0].max(x[1]) <= span.to;
                *due |= !inside;
            }
            upper = lower;
        }
    }
}

/// Normals of the planes through the eye and the edges, pointing into the view.
fn inward(edges: FovTangents) -> [Vec3; 4] {
    let (left, right) = (edges.left.min(edges.right), edges.left.max(edges.right));
    let (down, up) = (edges.down.min(edges.up), edges.down.max(edges.up));
    [
        Vec3::new(1.0, 0.0, left),
        Vec3::new(-1.0, 0.0, -right),
        Vec3::new(0.0, 1.0, down),
        Vec3::new(0.0, -1.0, -up),
    ]
}

/// The part of a line (x, y, -1) that lies within planes.
struct Span {
    from: f32,
    to: f32,
}

impl Span {
    fn on(planes: &[Vec3; 4], y: f32) -> Self {
        let mut span = Self { from: f32::NEG_INFINITY, to: f32::INFINITY };
        for normal in planes {
            // Inside is where normal.x x + rest >= 0.
            let rest = normal.y * y - normal.z;
            let end = -rest / normal.x;
            if normal.x > 0.0 {
                span.from = span.from.max(end);
            } else if normal.x < 0.0 {
                span.to = span.to.min(end);
            } else if rest < 0.0 {
                span.to = f32::NEG_INFINITY;
            }
        }
        span
    }
}
