//! Scenes from a seed: settings that were tuned on the other scenes can be judged on an unknown one. Metres; the visitor stands at the
//! origin and looks towards -z.

use clap::ValueEnum;
use glam::{Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::noise::hash;
use super::{Definition, Material, Part, Placement, mesh::Mesh, turns};

/// Kind of a scene generated from a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// A room full of things, with lamps of many colours.
    GeneratedRoom,
    /// A street with houses, posts, cables and signs, by day.
    GeneratedStreet,
}

/// Things that stand in a scene.
const THINGS: u32 = 26;
/// Things that move.
const MOVERS: u32 = 6;

const ROOM: Definition = Definition {
    fixed: Vec::new,
    moving,
    place: |_, _, _| Vec::new(),
    lights: |_, _| Vec::new(),
    default_lights: 7,
    environment: Some(Environment {
        sky_light: [0.05, 0.05, 0.055],
        ground_light: [0.03, 0.028, 0.025],
        ..Environment::INDOORS
    }),
};

const STREET: Definition = Definition {
    default_lights: 4,
    environment: Some(Environment { fog_per_m: 0.004, ..Environment::DAY }),
    ..ROOM
};

impl Kind {
    /// Both.
    pub const ALL: [Self; 2] = [Self::GeneratedRoom, Self::GeneratedStreet];

    /// Its name on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::GeneratedRoom => "generated-room",
            Self::GeneratedStreet => "generated-street",
        }
    }

    /// Parts that do not depend on the seed.
    pub fn definition(self) -> &'static Definition {
        match self {
            Self::GeneratedRoom => &ROOM,
            Self::GeneratedStreet => &STREET,
        }
    }
}

/// Random numbers of a seed, 0..1: the quantity `what` of the thing `index`.
fn random(seed: u32, index: u32, what: u32) -> f32 {
    hash(index, what, seed ^ 0x5eed)
}

fn choice<T: Copy>(from: &[T], random: f32) -> T {
    from[((random * from.len() as f32) as usize).min(from.len() - 1)]
}

/// Half the width, the depth and the height of the room or the street.
fn extent(kind: Kind, seed: u32) -> Vec3 {
    let random = |what: u32| random(seed, 0, 100 + what);
    match kind {
        Kind::GeneratedRoom => vec3(2.4 + 2.0 * random(0), 2.7 + 1.3 * random(1), 5.0 + 5.0 * random(2)),
        Kind::GeneratedStreet => vec3(5.0 + 3.0 * random(0), 6.0 + 5.0 * random(1), 24.0 + 12.0 * random(2)),
    }
}

/// Position of a thing on the floor, metres.
fn spot(kind: Kind, seed: u32, index: u32) -> Vec3 {
    let extent = extent(kind, seed);
    let (x, z) = (random(seed, index, 0), random(seed, index, 1));
    vec3(extent.x * (1.7 * x - 0.85), 0.0, -1.6 - (extent.z - 2.6) * z * z)
}

fn height(kind: Kind, seed: u32, index: u32) -> f32 {
    let most = if kind == Kind::GeneratedRoom { 1.6 } else { 2.6 };
    0.3 + most * random(seed, index, 2)
}

/// Fixation points: the things, pictures on the walls, and the distance.
pub fn targets(kind: Kind, seed: u32) -> Vec<Vec3> {
    let things =
        (0..THINGS).map(|index| spot(kind, seed, index) + Vec3::Y * (0.8 * height(kind, seed, index)));
    let pictures = (0..8).map(|index| picture_corner(kind, seed, index) + Vec3::Y * 0.2);
    let extent = extent(kind, seed);
    things.chain(pictures).chain([vec3(0.0, 1.5, -extent.z)]).collect()
}

/// The lower near corner of a picture, on the left wall or on the right one.
fn picture_corner(kind: Kind, seed: u32, index: u32) -> Vec3 {
    let extent = extent(kind, seed);
    let x = if index.is_multiple_of(2) { 0.02 - extent.x } else { extent.x - 0.02 };
    let z = -1.4 - (extent.z - 3.4) * (index as f32 + random(seed, index, 20)) / 9.0;
    vec3(x, 1.1 + 0.9 * random(seed, index, 21), z)
}

/// Everything that stands still.
pub fn fixed(kind: Kind, seed: u32) -> Vec<Part> {
    const THING_MATERIALS: [Material; 8] = [
        Material::Wood,
        Material::Brass,
        Material::Cloth,
        Material::Plastic,
        Material::Marble,
        Material::Brick,
        Material::Chrome,
        Material::Paint,
    ];
    let mut parts = vec![Part::new(Material::Metal, ironwork(kind, seed)), pictures(kind, seed)];
    for index in 0..THINGS {
        let tint = Vec3::from([3, 4, 5].map(|what| 0.25 + 0.75 * random(seed, index, what)));
        let material = choice(&THING_MATERIALS, random(seed, index, 6));
        parts.push(Part::new(material, thing(kind, seed, index)).tinted(tint));
    }
    parts.extend(shell(kind, seed));
    parts
}

fn thing(kind: Kind, seed: u32, index: u32) -> Mesh {
    let (foot, height) = (spot(kind, seed, index), height(kind, seed, index));
    let width = 0.12 + 0.5 * random(seed, index, 7);
    let mut mesh = Mesh::default();
    match (random(seed, index, 8) * 3.0) as u32 {
        0 => mesh.cuboid(foot - vec3(width, 0.0, width), foot + vec3(width, height, width), 0.5, 0.8),
        1 => {
            let top = width * (0.4 + 0.6 * random(seed, index, 9));
            mesh.column(foot, height, (width, top), 20, 0.8);
        }
        _ => {
            mesh.column(foot, height - 0.2, (0.08, 0.05), 12, 0.7);
            mesh.sphere(foot + Vec3::Y * height, 0.6 * width, 24, 0.9);
        }
    }
    mesh
}

/// Posts, rods and cables.
fn ironwork(kind: Kind, seed: u32) -> Mesh {
    let extent = extent(kind, seed);
    let mut mesh = Mesh::default();
    for index in 0..9 {
        let z = -1.0 - (extent.z - 1.5) * random(seed, index, 30);
        let end =
            |side: f32, what| vec3(side * extent.x, extent.y * (0.6 + 0.35 * random(seed, index, what)), z);
        mesh.cable(end(-1.0, 31), end(1.0, 32), 0.1 + 0.4 * random(seed, index, 33), 0.004);
        let post = vec3(extent.x * (1.8 * random(seed, index, 34) - 0.9), 0.0, z - 0.8);
        mesh.column(post, 0.9 * extent.y, (0.03, 0.03), 10, 0.8);
    }
    mesh
}

fn pictures(kind: Kind, seed: u32) -> Part {
    let (material, cells) = choice(
        &[
            (Material::Signs, [1, 8]),
            (Material::Screens, [2, 2]),
            (Material::Gauges, [4, 4]),
            (Material::Spines, [32, 4]),
        ],
        random(seed, 1, 40),
    );
    let mut mesh = Mesh::default();
    for index in 0..8 {
        let corner = picture_corner(kind, seed, index);
        // Seen from inside, from left to right: away on the left wall, towards the visitor on the right one.
        let along = if index.is_multiple_of(2) { Vec3::NEG_Z } else { Vec3::Z };
        mesh.cell([corner, along * 1.1, Vec3::Y * 0.5], cells, index, 0.8);
    }
    Part::new(material, mesh).glowing(Vec3::splat(0.2))
}

/// Floor, walls, and a ceiling or houses.
fn shell(kind: Kind, seed: u32) -> [Part; 2] {
    let extent = extent(kind, seed);
    let is_room = kind == Kind::GeneratedRoom;
    let mut floor = Mesh::default();
    let half = if is_room { extent.x } else { 3.0 * extent.x };
    floor.rectangle(vec3(-half, 0.0, 3.0), Vec3::X * (2.0 * half), Vec3::Z * -(extent.z + 3.0), 1.5, 0.8);
    let mut walls = Mesh::default();
    walls.cuboid(vec3(-extent.x - 0.4, 0.0, -extent.z), vec3(-extent.x, extent.y, 3.0), 1.4, 0.7);
    walls.cuboid(vec3(extent.x, 0.0, -extent.z), vec3(extent.x + 0.4, extent.y, 3.0), 1.4, 0.7);
    if is_room {
        walls.cuboid(vec3(-extent.x, 0.0, -extent.z - 0.3), vec3(extent.x, extent.y, -extent.z), 1.4, 0.7);
        walls.cuboid(vec3(-extent.x, extent.y, -extent.z), vec3(extent.x, extent.y + 0.2, 3.0), 1.4, 0.4);
    }
    let floors: &[Material] = match kind {
        Kind::GeneratedRoom => &[Material::Tiles, Material::Wood, Material::Marble],
        Kind::GeneratedStreet => &[Material::Asphalt, Material::Soil, Material::Tiles],
    };
    let wall = choice(&[Material::Plaster, Material::Brick, Material::GlazedTiles], random(seed, 2, 41));
    [Part::new(wall, walls), Part::new(choice(floors, random(seed, 3, 41)), floor)]
}

fn moving() -> Vec<Part> {
    let mut ball = Mesh::default();
    ball.sphere(Vec3::ZERO, 0.16, 24, 0.9);
    let mut cube = Mesh::default();
    cube.cuboid(Vec3::splat(-0.14), Vec3::splat(0.14), 0.3, 0.9);
    vec![Part::new(Material::Paint, ball), Part::new(Material::Plastic, cube)]
}

/// Places moving things, each on an ellipse of its own, and the others at rest.
pub fn place(kind: Kind, seed: u32, first: usize, time: f64) -> Vec<Placement> {
    let mover = |index: u32| {
        let rate = 0.05 + 0.15 * f64::from(random(seed, index, 50));
        let (sin, cos) = (turns(time, rate) + 6.0 * random(seed, index, 51)).sin_cos();
        let middle = spot(kind, seed, index) + Vec3::Y * (0.8 + 0.8 * random(seed, index, 52));
        let position = middle + vec3(0.5 * cos, 0.2 * sin, 0.4 * sin);
        let tint = Vec3::from([53, 54, 55].map(|what| 0.3 + 0.7 * random(seed, index, what)));
        let part = first + (index % 2) as usize;
        Placement::new(part, Quat::from_rotation_y(turns(time, rate)), position).tinted(tint)
    };
    // Each kind is one draw.
    (0..MOVERS).step_by(2).chain((1..MOVERS).step_by(2)).map(mover).collect()
}

/// Lamps of many colours, some of which pulse.
pub fn lights(kind: Kind, seed: u32, time: f64, count: u32) -> Vec<Light> {
    let extent = extent(kind, seed);
    let own = (0..kind.definition().default_lights).map(|index| {
        let [x, y, z] = [60, 61, 62].map(|what| random(seed, index, what));
        let pulse = 0.85 + 0.15 * turns(time, f64::from(0.1 + 0.3 * x)).sin();
        let colour = Vec3::from([63, 64, 65].map(|what| 0.35 + 0.65 * random(seed, index, what)));
        Light {
            position: vec3(
                extent.x * (1.6 * x - 0.8),
                extent.y * (0.5 + 0.4 * y),
                -1.0 - (extent.z - 2.0) * z,
            ),
            range: 5.0,
            colour: colour * pulse,
        }
    });
    lights::first(own, count, [vec3(-extent.x, 1.0, -extent.z), vec3(extent.x, extent.y, 0.0)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, SceneName};
    use glam::Mat4;

    fn corners(scene: &Scene) -> Vec<[f32; 3]> {
        scene.parts.iter().flat_map(|part| part.mesh.vertices.iter().map(|vertex| vertex.position)).collect()
    }

    #[test]
    fn a_seed_makes_one_scene_and_another_seed_another() {
        for kind in Kind::ALL {
            let of = |seed| Scene::new(SceneName::Generated(kind, seed));
            assert_eq!(corners(&of(7)), corners(&of(7)));
            assert_ne!(corners(&of(7)), corners(&of(8)), "{kind:?}");
            let places = |seed, time| {
                let placements = of(seed).placements(time, &[]).into_iter();
                placements.map(|placement| placement.transform).collect::<Vec<Mat4>>()
            };
            assert_eq!(places(7, 1.5), places(7, 1.5));
            assert_ne!(places(7, 0.0), places(7, 1.5), "something moves");
        }
    }

    #[test]
    fn everything_is_in_front_of_the_visitor_and_finite() {
        for (kind, seed) in Kind::ALL.into_iter().flat_map(|kind| (0..20).map(move |seed| (kind, seed))) {
            let size = extent(kind, seed);
            for index in 0..THINGS {
                let spot = spot(kind, seed, index);
                assert!(
                    spot.x.abs() < size.x && spot.z < -1.5 && spot.z > -size.z,
                    "{kind:?} {seed}: {spot}"
                );
            }
            let scene = Scene::new(SceneName::Generated(kind, seed));
            assert!(corners(&scene).iter().flatten().all(|number| number.is_finite()), "{kind:?} {seed}");
            assert_eq!(scene.lights(0.0, 3).len(), 3);
        }
    }
}
