//! What there is to see: a courtyard between two arcades. Everything here is a pure function of the
//! animation time; nothing knows how it is drawn.

pub mod courtyard;
pub mod lights;
pub mod materials;
pub mod mesh;
pub mod motion;
pub mod noise;
pub mod text;
pub mod texture;

use glam::{Mat4, Vec3};

use self::mesh::Mesh;

/// Frames a second of the animation. It advances by rendered frames, not by the clock, so a frame number
/// means the same picture in every run.
pub const FRAMES_PER_SECOND: f64 = 90.0;

/// The animation time of a frame in seconds.
pub fn time_of(frame: u64) -> f64 {
    frame as f64 / FRAMES_PER_SECOND
}

/// What a surface is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Floor.
    Tiles,
    /// Walls.
    Brick,
    /// Columns and ground.
    Plaster,
    /// Roof, beams and crates.
    Wood,
    /// Cables, fence and machinery.
    Metal,
    /// The notice board.
    Board,
    /// Lamps: plain white, coloured by what they emit.
    Lamp,
}

impl Material {
    /// All materials, in the order of their numbers.
    pub const ALL: [Self; 7] =
        [Self::Tiles, Self::Brick, Self::Plaster, Self::Wood, Self::Metal, Self::Board, Self::Lamp];
}

/// A mesh and what it is made of.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its surface.
    pub material: Material,
    /// Its shape.
    pub mesh: Mesh,
}

/// One part, placed for one frame.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Index into [`Scene::parts`].
    pub part: usize,
    /// From the part's space to the world; rotation and translation only.
    pub transform: Mat4,
    /// Light it sends out by itself, linear RGB.
    pub emission: Vec3,
}

/// The shapes, which never change.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Fixed parts first (as many as [`Scene::fixed`]), then one for each kind of moving thing.
    pub parts: Vec<Part>,
    /// How many of the parts are drawn where they are.
    pub fixed: usize,
}

impl Scene {
    /// Builds all shapes.
    pub fn new() -> Self {
        let mut parts = courtyard::parts();
        let fixed = parts.len();
        parts.extend(motion::parts());
        Self { parts, fixed }
    }

    /// Everything to draw at a time, in drawing order; `lights` are those of the same time.
    pub fn placements(&self, time: f64, lights: &[lights::Light]) -> Vec<Placement> {
        let mut placed = motion::placements(self.fixed, time, lights);
        placed.extend((0..self.fixed).map(|part| Placement {
            part,
            transform: Mat4::IDENTITY,
            emission: if self.parts[part].material == Material::Board {
                Vec3::splat(0.35)
            } else {
                Vec3::ZERO
            },
        }));
        placed
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self::new()
    }
}
