//! A cockpit that taxies along a runway: round instruments, screens, labels and a checklist in small print. Metres;
//! the pilot's eyes are 1.6 above the origin and look towards -z.

use glam::{Mat4, Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::{Definition, Material, Part, Placement, mesh::Mesh, turns};

/// The cockpit.
pub const SCENE: Definition = Definition {
    fixed,
    moving,
    place,
    lights: lamps,
    default_lights: 5,
    environment: Some(Environment { fog_per_m: 0.004, cloud: 0.5, ..Environment::DAY }),
};

/// Share of the light of sun and sky that reaches the panel.
const SHADE: f32 = 0.16;
/// The runway repeats after this many metres.
const PERIOD: f32 = 40.0;
/// Metres a second.
const SPEED: f64 = 9.0;
/// Places of the six instruments and of the compass on the panel: x, y.
const GAUGES: [[f32; 2]; 8] = [
    [-0.155, 0.25],
    [-0.045, 0.25],
    [0.065, 0.25],
    [0.175, 0.25],
    [-0.155, 0.135],
    [-0.045, 0.135],
    [0.065, 0.135],
    [0.175, 0.135],
];
const NEEDLE: usize = 0;
const RUNWAY: usize = 1;
const YOKE: usize = 2;
const LEVER: usize = 3;
const MARKS: usize = 4;
const SIGNS: usize = 5;

/// From the panel's own space (x to the right, y upwards along it, z out of it) to the world.
pub fn panel() -> Mat4 {
    Mat4::from_translation(vec3(0.0, 0.98, -0.62)) * Mat4::from_rotation_x(-0.28)
}

/// The middle of an instrument in the world.
pub fn gauge(index: usize) -> Vec3 {
    let [x, y] = GAUGES[index % GAUGES.len()];
    panel().transform_point3(vec3(x, y, 0.004))
}

/// A sign beside the runway that comes nearer.
pub fn sign_at(time: f64) -> Vec3 {
    vec3(-9.0, 1.0, runway_at(time) - 30.0 - PERIOD)
}

fn runway_at(time: f64) -> f32 {
    ((time * SPEED).rem_euclid(f64::from(PERIOD))) as f32
}

fn fixed() -> Vec<Part> {
    let mut dark = Mesh::default();
    let mut board = Mesh::default();
    board.cuboid(vec3(-0.85, -0.1, -0.06), vec3(0.85, 0.42, 0.0), 0.3, SHADE);
    dark.add(board, panel());
    // Glare shield, consoles, overhead panel, window posts.
    dark.cuboid(vec3(-0.9, 1.40, -0.98), vec3(0.9, 1.43, -0.66), 0.4, 0.7);
    dark.cuboid(vec3(-0.85, 0.6, -0.6), vec3(-0.5, 0.9, 0.5), 0.4, SHADE);
    dark.cuboid(vec3(0.5, 0.6, -0.6), vec3(0.85, 0.9, 0.5), 0.4, SHADE);
    dark.cuboid(vec3(-0.16, 0.6, -0.6), vec3(0.16, 0.93, -0.1), 0.4, SHADE);
    dark.cuboid(vec3(-0.6, 2.16, -0.75), vec3(0.6, 2.3, 0.6), 0.4, SHADE);
    // Floor and bulkhead.
    dark.cuboid(vec3(-1.0, 0.3, -1.0), vec3(1.0, 0.34, 0.8), 0.4, SHADE);
    dark.cuboid(vec3(-1.0, 0.3, -1.0), vec3(1.0, 1.4, -0.97), 0.4, SHADE);
    for x in [-0.9, 0.0, 0.9] {
        dark.rod(vec3(x, 1.4, -0.95), vec3(x * 0.7, 2.2, -0.7), 0.03, 0.6);
    }
    for x in [-1.0, 0.94] {
        dark.cuboid(vec3(x, 0.4, -1.0), vec3(x + 0.06, 1.35, 0.8), 0.4, 0.4);
        dark.rod(vec3(x + 0.03, 1.3, 0.1), vec3(x * 0.75, 2.2, 0.1), 0.04, 0.6);
    }
    vec![
        Part::new(Material::Screens, screens()).glowing(Vec3::splat(0.9)),
        Part::new(Material::Gauges, gauges()).glowing(Vec3::splat(0.12)),
        Part::new(Material::Placards, placards()).glowing(Vec3::splat(0.06)),
        Part::new(Material::Chrome, switches()),
        Part::new(Material::Plastic, dark).tinted(vec3(0.10, 0.11, 0.12)),
        Part::new(Material::Soil, meadow()),
    ]
}

fn screens() -> Mesh {
    let mut mesh = Mesh::default();
    for (cell, x) in [(2, -0.79), (0, -0.49), (1, 0.245), (3, 0.535)] {
        let width = 0.265;
        mesh.cell([vec3(x, 0.115, 0.003), Vec3::X * width, Vec3::Y * width], [2, 2], cell, SHADE);
    }
    mesh.transformed(panel())
}

fn gauges() -> Mesh {
    let mut mesh = Mesh::default();
    for (cell, [x, y]) in (0..).zip(GAUGES) {
        let corner = vec3(x - 0.052, y - 0.052, 0.003);
        mesh.cell([corner, Vec3::X * 0.104, Vec3::Y * 0.104], [4, 4], cell, SHADE);
    }
    mesh.transformed(panel())
}

/// Labels from 2 mm to 20 mm of letter height.
fn placards() -> Mesh {
    let mut mesh = Mesh::default();
    for (row, x) in [(0, -0.62), (1, -0.38), (2, -0.14), (3, 0.1), (4, 0.34), (5, 0.58)] {
        mesh.cell([vec3(x, 0.025, 0.003), Vec3::X * 0.2, Vec3::Y * 0.05], [2, 8], 2 * row, SHADE);
        mesh.cell([vec3(x, -0.04, 0.003), Vec3::X * 0.1, Vec3::Y * 0.025], [2, 8], 2 * (7 - row), SHADE);
    }
    let mut mesh = mesh.transformed(panel());
    // Under the overhead panel, above the windscreen, and large on the glare shield.
    for (row, z) in [(6, -0.72), (3, -0.5), (1, -0.28)] {
        mesh.cell([vec3(-0.5, 2.159, z), Vec3::X * 0.46, Vec3::Z * 0.115], [2, 8], 2 * row, SHADE);
        mesh.cell([vec3(0.04, 2.159, z), Vec3::X * 0.46, Vec3::Z * 0.115], [2, 8], 2 * (7 - row), SHADE);
    }
    mesh.cell([vec3(-0.32, 1.43, -0.655), Vec3::X * 0.64, Vec3::Y * 0.06], [2, 8], 14, 0.6);
    // The checklist leans on the right console, a copy of it lies on the left one.
    let page = |mesh: &mut Mesh, corner: Vec3, u: Vec3, v: Vec3| {
        mesh.cell([corner, u, v], [2, 1], 1, 0.4);
    };
    page(&mut mesh, vec3(0.34, 0.92, -0.33), vec3(0.26, 0.0, 0.14), vec3(-0.02, 0.27, -0.14) * 1.3);
    page(&mut mesh, vec3(-0.8, 0.902, -0.1), vec3(0.24, 0.0, 0.0), vec3(0.0, 0.0, -0.36));
    mesh
}

/// Toggles and the rims of the screens.
fn switches() -> Mesh {
    let mut mesh = Mesh::default();
    for index in 0..28 {
        let x = -0.61 + 0.045 * index as f32;
        let up = if index % 3 == 0 { -0.012 } else { 0.012 };
        mesh.rod(vec3(x, 0.095, 0.0), vec3(x, 0.095 + up, 0.028), 0.004, SHADE);
    }
    for x in [-0.79, -0.49, 0.245, 0.535] {
        for (from, to) in [([0.0, 0.0], [1.0, 0.0]), ([0.0, 1.0], [1.0, 1.0]), ([0.0, 0.0], [0.0, 1.0])] {
            let at = |[s, t]: [f32; 2]| vec3(x + 0.265 * s, 0.115 + 0.265 * t, 0.004);
            mesh.rod(at(from), at(to), 0.004, SHADE);
        }
    }
    mesh.transformed(panel())
}

fn meadow() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(-200.0, -0.9, 20.0), Vec3::X * 400.0, Vec3::Z * -260.0, 9.0, 1.0);
    for (x, z, radius) in [(-90.0, -160.0, 70.0), (10.0, -190.0, 80.0), (110.0, -170.0, 66.0)] {
        mesh.sphere(vec3(x, -radius * 0.8, z), radius, 32, 0.9);
    }
    mesh
}

fn moving() -> Vec<Part> {
    let mut needle = Mesh::default();
    needle.rod(vec3(0.0, -0.010, 0.003), vec3(0.0, 0.040, 0.003), 0.0012, 0.6);
    let mut runway = Mesh::default();
    runway.rectangle(vec3(-8.0, -0.8, 20.0 + PERIOD), Vec3::X * 16.0, Vec3::Z * -240.0, 6.0, 1.0);
    let mut marks = Mesh::default();
    for index in 0..24 {
        let z = 20.0 + PERIOD - 10.0 * index as f32;
        marks.rectangle(vec3(-0.25, -0.79, z), Vec3::X * 0.5, Vec3::Z * -5.0, 1.0, 1.0);
        for x in [-7.6, 7.4] {
            marks.rectangle(vec3(x, -0.79, z), Vec3::X * 0.2, Vec3::Z * -10.0, 1.0, 1.0);
            marks.sphere(vec3(x + 0.1, -0.7, z), 0.09, 8, 1.0);
        }
    }
    let mut signs = Mesh::default();
    for index in 0..6 {
        let z = PERIOD * (1.0 - index as f32) - 30.0;
        signs.cell([vec3(-10.5, 0.4, z), Vec3::X * 3.0, Vec3::Y * 1.2], [1, 8], 6, 1.0);
        signs.cell([vec3(8.6, 0.4, z - 12.0), Vec3::X * 3.0, Vec3::Y * 1.2], [1, 8], 5, 1.0);
    }
    let mut yoke = Mesh::default();
    yoke.rod(vec3(-0.14, 0.0, 0.0), vec3(0.14, 0.0, 0.0), 0.018, 0.4);
    for side in [-0.14, 0.14] {
        yoke.rod(vec3(side, -0.02, 0.0), vec3(side * 1.15, 0.12, 0.02), 0.016, 0.4);
    }
    let mut lever = Mesh::default();
    lever.rod(Vec3::ZERO, vec3(0.0, 0.14, 0.0), 0.006, 0.3);
    lever.sphere(vec3(0.0, 0.15, 0.0), 0.02, 12, 0.4);
    vec![
        Part::new(Material::Paint, needle),
        Part::new(Material::Asphalt, runway),
        Part::new(Material::Plastic, yoke),
        Part::new(Material::Brass, lever),
        Part::new(Material::Paint, marks),
        Part::new(Material::Signs, signs),
    ]
}

fn place(first: usize, time: f64, _: &[Light]) -> Vec<Placement> {
    let mut placed = Vec::new();
    for (index, [x, y]) in GAUGES.into_iter().enumerate() {
        let rate = 0.03 + 0.02 * index as f64;
        let turn = -1.6 * turns(time, rate).sin() + 0.02 * turns(time, 7.0 + index as f64).sin();
        let at = panel() * Mat4::from_translation(vec3(x, y, 0.004)) * Mat4::from_rotation_z(turn);
        let placement =
            Placement { transform: at, ..Placement::new(first + NEEDLE, Quat::IDENTITY, Vec3::ZERO) };
        placed.push(placement.tinted(vec3(1.0, 0.95, 0.85)).glowing(Vec3::splat(0.2)));
    }
    let roll = 0.12 * turns(time, 0.11).sin();
    let yoke = Placement::new(first + YOKE, Quat::from_rotation_z(roll), vec3(-0.32, 0.92, -0.36));
    placed.push(yoke.tinted(Vec3::splat(0.07)));
    for index in 0..3 {
        let tilt = -0.4 + 0.25 * turns(time, 0.07 + 0.02 * f64::from(index)).sin();
        let at = vec3(-0.06 + 0.06 * index as f32, 0.93, -0.3);
        placed.push(Placement::new(first + LEVER, Quat::from_rotation_x(tilt), at));
    }
    let along = Vec3::Z * runway_at(time);
    placed.push(Placement::new(first + MARKS, Quat::IDENTITY, along));
    placed.push(Placement::new(first + SIGNS, Quat::IDENTITY, along).glowing(Vec3::splat(0.4)));
    placed.push(Placement::new(first + RUNWAY, Quat::IDENTITY, along));
    placed
}

/// Floods along the panel, a dome lamp, and a beacon that blinks on the glare shield.
fn lamps(time: f64, count: u32) -> Vec<Light> {
    let flood = |x: f32| Light {
        position: panel().transform_point3(vec3(x, 0.40, 0.12)),
        range: 0.9,
        colour: vec3(1.0, 0.72, 0.45) * 0.06,
    };
    let dome = |x: f32| Light { position: vec3(x, 2.1, 0.1), range: 2.5, colour: vec3(0.8, 0.9, 1.0) * 0.25 };
    let beacon = 0.5 + 0.5 * turns(time, 1.0).sin();
    let own = [-0.5, -0.1, 0.3].map(flood).into_iter().chain([dome(0.0)]).chain([-0.3, 0.3].map(|x| Light {
        position: vec3(x, 1.9, -0.9),
        range: 2.0,
        colour: vec3(1.0, 0.15, 0.1) * 0.12 * beacon,
    }));
    lights::first(own, count, [vec3(-0.8, 0.9, -0.6), vec3(0.8, 2.1, 0.6)])
}
