//! Seven scenes, each a pure function of the animation time; nothing here knows how they are drawn.

pub mod canvas;
pub mod cockpit;
pub mod courtyard;
pub mod crowd;
pub mod environment;
pub mod foliage;
pub mod generated;
pub mod interior;
pub mod library;
pub mod lights;
pub mod materials;
pub mod mesh;
pub mod noise;
pub mod street;
pub mod text;
pub mod texture;

use std::f32::consts::TAU;

use clap::ValueEnum;
use glam::{Mat4, Quat, Vec3};

use self::environment::Environment;
use self::generated::Kind;
use self::lights::Light;
use self::mesh::Mesh;
pub use materials::Material;

/// Frames a second of the animation. It advances by rendered frames, not by the clock, so a frame number
/// means the same picture in every run.
pub const FRAMES_PER_SECOND: f64 = 90.0;

/// The animation time of a frame in seconds.
pub fn time_of(frame: u64) -> f64 {
    frame as f64 / FRAMES_PER_SECOND
}

/// The angle of something that turns `rate` times a second; whole turns are counted in f64, so it stays exact in
/// long runs.
pub fn turns(time: f64, rate: f64) -> f32 {
    ((time * rate).rem_euclid(1.0) as f32) * TAU
}

/// The scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SceneName {
    /// Brick, stone, wood and metal, lamps on thin cables, a notice board, a dark corner, a bright sky.
    #[default]
    Courtyard,
    /// Text at many sizes: instruments, labels, small print.
    Cockpit,
    /// Alpha-tested leaves and grass in the wind.
    Foliage,
    /// Dark: dim shelves, book spines with text, pools of lamp light.
    Library,
    /// Glossy: a mirror, metals, polished and tiled surfaces.
    Interior,
    /// Night, high contrast, thin lines: cables, railings, lane markings, lit windows.
    Street,
    /// A square full of people who walk.
    Crowd,
    /// Generated from a seed, to judge with unknown scenes.
    #[value(skip)]
    Generated(Kind, u32),
}

impl SceneName {
    /// All scenes that have a name, the default first.
    pub const ALL: [Self; 7] = [
        Self::Courtyard,
        Self::Cockpit,
        Self::Foliage,
        Self::Library,
        Self::Interior,
        Self::Street,
        Self::Crowd,
    ];

    /// The scene's parts.
    pub fn definition(self) -> &'static Definition {
        match self {
            Self::Courtyard => &courtyard::SCENE,
            Self::Cockpit => &cockpit::SCENE,
            Self::Foliage => &foliage::SCENE,
            Self::Library => &library::SCENE,
            Self::Interior => &interior::SCENE,
            Self::Street => &street::SCENE,
            Self::Crowd => &crowd::SCENE,
            Self::Generated(kind, _) => kind.definition(),
        }
    }

    /// Its name on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Courtyard => "courtyard",
            Self::Cockpit => "cockpit",
            Self::Foliage => "foliage",
            Self::Library => "library",
            Self::Interior => "interior",
            Self::Street => "street",
            Self::Crowd => "crowd",
            Self::Generated(kind, _) => kind.as_str(),
        }
    }
}

/// Functions of one file of a scene.
#[derive(Debug)]
pub struct Definition {
    /// Builds fixed parts.
    pub fixed: fn() -> Vec<Part>,
    /// Builds moving parts, about their own origin.
    pub moving: fn() -> Vec<Part>,
    /// Places the moving parts at a time; `first` is the index of the first of them. Always as many.
    pub place: fn(first: usize, time: f64, lights: &[Light]) -> Vec<Placement>,
    /// The first `count` lights at a time; fewer are a prefix of more.
    pub lights: fn(time: f64, count: u32) -> Vec<Light>,
    /// Default number of lights. It sets the cost of a frame.
    pub default_lights: u32,
    /// Sun, sky and reflections; the courtyard's are constants of its shader.
    pub environment: Option<Environment>,
}

/// A mesh and its material.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its surface.
    pub material: Material,
    /// Its shape.
    pub mesh: Mesh,
    /// Light that it sends out by itself where it is placed by the scene, linear RGB times albedo.
    pub emission: Vec3,
    /// Colour that multiplies its albedo where it is placed by the scene.
    pub tint: Vec3,
}

impl Part {
    /// A part that sends out no light, in the colour of its material.
    pub fn new(material: Material, mesh: Mesh) -> Self {
        Self { material, mesh, emission: Vec3::ZERO, tint: Vec3::ONE }
    }

    /// The same part, sending out light.
    #[must_use]
    pub fn glowing(self, emission: Vec3) -> Self {
        Self { emission, ..self }
    }

    /// The same part in another colour.
    #[must_use]
    pub fn tinted(self, tint: Vec3) -> Self {
        Self { tint, ..self }
    }
}

/// One part, placed for one frame.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Index into [`Scene::parts`].
    pub part: usize,
    /// From the part's space to the world; rotation and translation only.
    pub transform: Mat4,
    /// Light it sends out by itself, linear RGB times albedo.
    pub emission: Vec3,
    /// Colour that multiplies its albedo; the courtyard's shader has none.
    pub tint: Vec3,
}

impl Placement {
    /// A part, turned and then moved.
    pub fn new(part: usize, rotation: Quat, position: Vec3) -> Self {
        let transform = Mat4::from_rotation_translation(rotation, position);
        Self { part, transform, emission: Vec3::ZERO, tint: Vec3::ONE }
    }

    /// The same, sending out light.
    #[must_use]
    pub fn glowing(self, emission: Vec3) -> Self {
        Self { emission, ..self }
    }

    /// The same in another colour.
    #[must_use]
    pub fn tinted(self, tint: Vec3) -> Self {
        Self { tint, ..self }
    }
}

/// The shapes, which never change.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the scene.
    pub name: SceneName,
    /// Fixed parts first (as many as [`Scene::fixed`]), then one for each kind of moving thing.
    pub parts: Vec<Part>,
    /// Number of the fixed parts.
    pub fixed: usize,
}

impl Scene {
    /// Builds all shapes of a scene.
    pub fn new(name: SceneName) -> Self {
        let definition = name.definition();
        let mut parts = match name {
            SceneName::Generated(kind, seed) => generated::fixed(kind, seed),
            _ => (definition.fixed)(),
        };
        let fixed = parts.len();
        parts.extend((definition.moving)());
        Self { name, parts, fixed }
    }

    /// The materials of its parts, each once, in the order of their numbers.
    pub fn materials(&self) -> Vec<Material> {
        let mut materials: Vec<_> = self.parts.iter().map(|part| part.material).collect();
        materials.sort();
        materials.dedup();
        materials
    }

    /// The first `count` lights at a time in seconds.
    pub fn lights(&self, time: f64, count: u32) -> Vec<Light> {
        match self.name {
            SceneName::Generated(kind, seed) => generated::lights(kind, seed, time, count),
            _ => (self.name.definition().lights)(time, count),
        }
    }

    /// Everything to draw at a time, in drawing order; `lights` are the lights at the same time.
    pub fn placements(&self, time: f64, lights: &[Light]) -> Vec<Placement> {
        let mut placed = match self.name {
            SceneName::Generated(kind, seed) => generated::place(kind, seed, self.fixed, time),
            _ => (self.name.definition().place)(self.fixed, time, lights),
        };
        placed.extend(self.parts[..self.fixed].iter().enumerate().map(|(part, fixed)| Placement {
            part,
            transform: Mat4::IDENTITY,
            emission: fixed.emission,
            tint: fixed.tint,
        }));
        placed
    }
}
