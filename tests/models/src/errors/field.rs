//! The image around the gaze: each pixel's ring, and the eye's eccentricity and resolution at each spot.

use crate::errors::clip::Eye;
use glam::{Vec2, Vec3};
use parafovea_core::geometry::{Fov, ImagePlane, eccentricity, pixels_per_degree};

/// Outer radii of the rings around the gaze, degrees; the last ring is everything beyond.
pub const RING_EDGES_DEG: [f32; 5] = [2.0, 5.0, 10.0, 20.0, 30.0];

/// Number of rings.
pub const RINGS: usize = RING_EDGES_DEG.len() + 1;

/// The rings as they are printed, degrees from the gaze.
pub const RING_NAMES: [&str; RINGS] = ["0-2", "2-5", "5-10", "10-20", "20-30", ">30"];

/// Side of the tiles that the worst one is sought among, pixels.
pub const TILE_PX: u32 = 16;

/// Side of the cells that share one sensitivity, pixels: half a tile, about a degree in today's headsets.
pub const CELL_PX: u32 = 8;

/// A cell of [`CELL_PX`] pixels, described at its centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub eccentricity_deg: f32,
    pub pixels_per_degree: f32,
}

/// Geometry of one picture for one direction of gaze.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub fov: Fov,
    pub gaze: Vec3,
    pub extent: [u32; 2],
    pub plane: ImagePlane,
    /// Ring of each pixel, row by row.
    pub rings: Vec<u8>,
    /// Tiles along a row, and rows of tiles; those at the right and lower edge may be narrower.
    pub tiles: [u32; 2],
    /// Pixels of each ring in each tile.
    pub tile_pixels: Vec<[u32; RINGS]>,
    /// Cells along a row, and rows of cells.
    pub cells_across: u32,
    pub cells: Vec<Cell>,
}

impl Field {
    pub fn new(eye: &Eye) -> Self {
        let extent @ [width, height] = eye.picture.extent();
        let plane = eye.fov.tangents().plane(extent);
        let degrees = |pixel: Vec2| eccentricity(eye.gaze, plane.direction(pixel)).to_degrees();
        let centre = |x: u32, y: u32| Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let rings = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let rings: Vec<u8> = rings.map(|(x, y)| ring(degrees(centre(x, y)))).collect();
        let tiles = extent.map(|side| side.div_ceil(TILE_PX));
        let mut tile_pixels = vec![[0; RINGS]; (tiles[0] * tiles[1]) as usize];
        for (y, row) in (0_u32..).zip(rings.chunks_exact(width as usize)) {
            for (x, &ring) in (0_u32..).zip(row) {
                tile_pixels[(y / TILE_PX * tiles[0] + x / TILE_PX) as usize][ring as usize] += 1;
            }
        }
        let [cells_across, cells_down] = extent.map(|side| side.div_ceil(CELL_PX));
        let cell = |x: u32, y: u32| {
            let last = Vec2::new(width as f32, height as f32);
            let from = Vec2::new((x * CELL_PX) as f32, (y * CELL_PX) as f32);
            let centre = from.midpoint((from + CELL_PX as f32).min(last));
            Cell { eccentricity_deg: degrees(centre), pixels_per_degree: pixels_per_degree(&plane, centre) }
        };
        let cells = (0..cells_down).flat_map(|y| (0..cells_across).map(move |x| (x, y)));
        let cells = cells.map(|(x, y)| cell(x, y)).collect();
        let (fov, gaze) = (eye.fov, eye.gaze);
        Self { fov, gaze, extent, plane, rings, tiles, tile_pixels, cells_across, cells }
    }

    /// Whether this is the geometry of `eye`, too.
    pub fn fits(&self, eye: &Eye) -> bool {
        self.fov == eye.fov && self.gaze == eye.gaze && self.extent == eye.picture.extent()
    }

    /// Whether the picture spans an angle and the gaze is a direction.
    pub fn is_a_view(&self) -> bool {
        self.central_pixels_per_degree() > 0.0 && self.gaze.is_finite() && self.gaze != Vec3::ZERO
    }

    /// Pixels per degree at the centre of the picture.
    pub fn central_pixels_per_degree(&self) -> f32 {
        pixels_per_degree(&self.plane, Vec2::new(self.extent[0] as f32, self.extent[1] as f32) / 2.0)
    }

    /// Centre of a tile, in pixels.
    pub fn tile_centre(&self, tile: usize) -> Vec2 {
        let [x, y] = self.tile_origin(tile).map(|from| from as f32);
        let last = Vec2::new(self.extent[0] as f32, self.extent[1] as f32);
        Vec2::new(x, y).midpoint((Vec2::new(x, y) + TILE_PX as f32).min(last))
    }

    /// Upper left pixel of a tile.
    pub fn tile_origin(&self, tile: usize) -> [u32; 2] {
        let tile = tile as u32;
        [tile % self.tiles[0] * TILE_PX, tile / self.tiles[0] * TILE_PX]
    }
}

/// The ring that an eccentricity lies in; a ring has its inner edge, not its outer one.
fn ring(eccentricity_deg: f32) -> u8 {
    RING_EDGES_DEG.iter().filter(|&&edge| eccentricity_deg >= edge).count() as u8
}
