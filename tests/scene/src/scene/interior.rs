//! A polished room: a mirror, steel and brass, marble, glazed tiles with joints, panels of light. Metres; the visitor
//! stands at the origin and looks towards -z.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Mat4, Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::{Definition, Material, Part, Placement, mesh::Mesh, turns};

/// The room.
pub const SCENE: Definition = Definition {
    fixed,
    moving,
    place,
    lights: lamps,
    default_lights: 6,
    environment: Some(Environment {
        sky_light: [0.16, 0.165, 0.17],
        ground_light: [0.09, 0.085, 0.08],
        mirror_z: BACK,
        has_mirror: 1.0,
        room_min: [-SIDE, 0.0, BACK],
        room_max: [SIDE, HEIGHT, FRONT],
        panels: 1.6,
        ..Environment::INDOORS
    }),
};

const SIDE: f32 = 4.0;
const BACK: f32 = -5.0;
const FRONT: f32 = 4.0;
const HEIGHT: f32 = 3.0;
/// The mirror's left, right, lower and upper edge in the far wall.
const MIRROR: [f32; 4] = [-1.6, 1.6, 0.7, 2.5];
const BALL: usize = 0;
const BLOCK: usize = 1;
const RING: usize = 2;

/// Position of one of the three circling spheres.
pub fn ball_at(index: usize, time: f64) -> Vec3 {
    let angle = turns(time, 0.06) + TAU * index as f32 / 3.0;
    let (sin, cos) = angle.sin_cos();
    vec3(0.3 + 1.15 * cos, 1.35 + 0.15 * (2.0 * angle).sin(), -2.9 + 0.9 * sin)
}

fn fixed() -> Vec<Part> {
    vec![
        Part::new(Material::Chrome, steel()),
        Part::new(Material::Brass, brass()),
        Part::new(Material::GlazedTiles, tiled_walls()),
        Part::new(Material::Paint, plain_walls()).tinted(vec3(0.62, 0.66, 0.68)),
        Part::new(Material::Lamp, panels()).glowing(Vec3::splat(1.7)),
        Part::new(Material::Marble, floor()),
    ]
}

fn floor() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(-SIDE, 0.0, FRONT), Vec3::X * SIDE * 2.0, Vec3::Z * (BACK - FRONT), 1.2, 0.9);
    // An island with a marble top.
    mesh.cuboid(vec3(1.3, 0.86, -3.6), vec3(2.7, 0.9, -1.8), 0.9, 0.9);
    mesh
}

/// The far wall around the mirror, and the left wall.
fn tiled_walls() -> Mesh {
    let mut mesh = Mesh::default();
    let [left, right, low, high] = MIRROR;
    let mut panel = |x0: f32, x1: f32, y0: f32, y1: f32| {
        mesh.rectangle(vec3(x0, y0, BACK), Vec3::X * (x1 - x0), Vec3::Y * (y1 - y0), 1.2, 0.9);
    };
    panel(-SIDE, left, 0.0, HEIGHT);
    panel(right, SIDE, 0.0, HEIGHT);
    panel(left, right, 0.0, low);
    panel(left, right, high, HEIGHT);
    mesh.rectangle(vec3(-SIDE, 0.0, FRONT), Vec3::Z * (BACK - FRONT), Vec3::Y * HEIGHT, 1.2, 0.9);
    // The island's body.
    mesh.cuboid(vec3(1.35, 0.0, -3.55), vec3(2.65, 0.86, -1.85), 0.9, 0.6);
    mesh
}

fn plain_walls() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(SIDE, 0.0, BACK), Vec3::Z * (FRONT - BACK), Vec3::Y * HEIGHT, 2.0, 0.9);
    mesh.rectangle(vec3(SIDE, 0.0, FRONT), Vec3::X * -SIDE * 2.0, Vec3::Y * HEIGHT, 2.0, 0.9);
    mesh.rectangle(vec3(-SIDE, HEIGHT, BACK), Vec3::X * SIDE * 2.0, Vec3::Z * (FRONT - BACK), 2.0, 0.6);
    mesh
}

/// Ceiling panels at the places that `surroundings` in the shader uses: 1.2 x 0.72 m every 2 m.
fn panels() -> Mesh {
    let mut mesh = Mesh::default();
    for (x, z) in panel_centres() {
        let corner = vec3(x - 0.6, HEIGHT - 0.005, z - 0.36);
        mesh.rectangle(corner, Vec3::X * 1.2, Vec3::Z * 0.72, 1.0, 0.9);
    }
    mesh
}

fn panel_centres() -> impl Iterator<Item = (f32, f32)> {
    [-3.0, -1.0, 1.0, 3.0].into_iter().flat_map(|x| [-3.0, -1.0, 1.0, 3.0].map(|z| (x, z)))
}

fn steel() -> Mesh {
    let mut mesh = Mesh::default();
    // A rack of bars, a rail, taps, and a large sphere on a foot.
    for bar in 0..22 {
        let z = -4.6 + 0.18 * bar as f32;
        mesh.rod(vec3(-3.6, 0.1, z), vec3(-3.6, 1.5, z), 0.01, 0.9);
    }
    mesh.rod(vec3(-3.6, 1.5, -4.7), vec3(-3.6, 1.5, -0.7), 0.018, 0.9);
    mesh.rod(vec3(2.0, 0.9, -2.4), vec3(2.0, 1.25, -2.4), 0.018, 0.9);
    mesh.rod(vec3(2.0, 1.25, -2.4), vec3(2.0, 1.25, -2.7), 0.016, 0.9);
    mesh.sphere(vec3(-1.75, 1.05, -3.3), 0.42, 48, 0.9);
    mesh.column(vec3(-1.75, 0.0, -3.3), 0.65, (0.22, 0.08), 32, 0.9);
    for x in [-2.9, 3.3] {
        mesh.column(vec3(x, 0.0, -4.4), HEIGHT, (0.12, 0.12), 32, 0.9);
    }
    mesh
}

/// The mirror's frame and the feet of the shelf.
fn brass() -> Mesh {
    let mut mesh = Mesh::default();
    let [left, right, low, high] = MIRROR;
    let at = |x, y| vec3(x, y, BACK + 0.02);
    for (from, to) in [
        (at(left, low), at(right, low)),
        (at(left, high), at(right, high)),
        (at(left, low), at(left, high)),
        (at(right, low), at(right, high)),
    ] {
        mesh.rod(from, to, 0.035, 0.9);
    }
    mesh.column(vec3(3.0, 0.0, -2.0), 1.1, (0.3, 0.04), 32, 0.9);
    mesh.sphere(vec3(3.0, 1.3, -2.0), 0.22, 40, 0.9);
    mesh
}

fn moving() -> Vec<Part> {
    let mut ball = Mesh::default();
    ball.sphere(Vec3::ZERO, 0.19, 40, 0.9);
    let mut block = Mesh::default();
    block.cuboid(Vec3::splat(-0.2), Vec3::splat(0.2), 0.4, 0.9);
    let mut ring = Mesh::default();
    for step in 0..24 {
        let at = |step: i32| {
            let (sin, cos) = (step as f32 / 24.0 * TAU).sin_cos();
            vec3(0.35 * cos, 0.35 * sin, 0.0)
        };
        ring.rod(at(step), at(step + 1), 0.03, 0.9);
    }
    vec![
        Part::new(Material::Chrome, ball),
        Part::new(Material::Brass, block),
        Part::new(Material::Paint, ring),
    ]
}

fn place(first: usize, time: f64, _: &[Light]) -> Vec<Placement> {
    let mut placed = Vec::new();
    for index in 0..3 {
        let tint = [vec3(1.0, 1.0, 1.0), vec3(1.0, 0.75, 0.6), vec3(0.65, 0.85, 1.0)][index];
        placed.push(Placement::new(first + BALL, Quat::IDENTITY, ball_at(index, time)).tinted(tint));
    }
    let spin =
        Quat::from_rotation_y(turns(time, 0.1)) * Quat::from_rotation_x(0.62) * Quat::from_rotation_z(0.79);
    placed.push(Placement::new(first + BLOCK, spin, vec3(-0.6, 1.6, -2.2)));
    let tilt = Quat::from_rotation_y(turns(time, 0.07)) * Quat::from_rotation_x(FRAC_PI_2 * 0.3);
    placed.push(Placement::new(first + RING, tilt, vec3(1.9, 1.55, -3.1)).tinted(vec3(0.8, 0.05, 0.04)));
    placed
}

/// Light of the panels, from every third of them, and a spot that moves along the ceiling.
fn lamps(time: f64, count: u32) -> Vec<Light> {
    let spot = Light {
        position: vec3(1.8 * turns(time, 0.13).sin(), 2.7, -2.4),
        range: 5.0,
        colour: vec3(1.0, 0.9, 0.75) * 0.9,
    };
    let own = panel_centres().step_by(3).map(|(x, z)| Light {
        position: vec3(x, HEIGHT - 0.25, z),
        range: 7.0,
        colour: vec3(1.0, 0.97, 0.93) * 0.75,
    });
    lights::first([spot].into_iter().chain(own), count, [vec3(-SIDE, 0.2, BACK), vec3(SIDE, 2.5, FRONT)])
}

/// From the room to the world behind the mirror, as the shader does it.
pub fn mirrored(position: Vec3) -> Vec3 {
    (Mat4::from_translation(Vec3::Z * 2.0 * BACK) * Mat4::from_scale(vec3(1.0, 1.0, -1.0)))
        .transform_point3(position)
}
