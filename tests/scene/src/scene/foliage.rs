//! A clearing in a wood: leaves and grass cut out by alpha, moved by the wind. Metres; the visitor stands at the origin
//! and looks towards -z.

use std::f32::consts::TAU;

use glam::{Mat4, Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::noise::hash;
use super::{Definition, Material, Part, Placement, mesh::Mesh, turns};

/// The clearing.
pub const SCENE: Definition = Definition {
    fixed,
    moving,
    place,
    lights: fireflies,
    default_lights: 1,
    environment: Some(Environment {
        sun_direction: [0.485_071, 0.727_607, -0.485_071],
        fog_per_m: 0.012,
        wind: 0.11,
        cloud: 0.3,
        sky_light: [0.22, 0.28, 0.34],
        ..Environment::DAY
    }),
};

/// Trunks: x, z, radius.
const TREES: [[f32; 3]; 14] = [
    [-1.9, -3.2, 0.16],
    [2.3, -3.9, 0.20],
    [-4.2, -5.4, 0.24],
    [0.7, -7.2, 0.18],
    [4.8, -6.6, 0.26],
    [-2.4, -8.6, 0.22],
    [-6.8, -2.2, 0.22],
    [6.6, -2.6, 0.24],
    [-6.4, -10.0, 0.28],
    [2.6, -11.5, 0.25],
    [7.4, -11.0, 0.30],
    [-0.8, -14.0, 0.28],
    [-4.0, 3.5, 0.2],
    [3.8, 4.0, 0.2],
];
const BUTTERFLY: usize = 0;
const WING: usize = 1;

/// Position of the butterfly.
pub fn butterfly_at(time: f64) -> Vec3 {
    let (sin, cos) = turns(time, 0.05).sin_cos();
    vec3(1.1 * sin, 1.45 + 0.12 * turns(time, 0.23).sin(), -2.4 + 0.5 * cos)
}

/// A trunk's place at eye height.
pub fn trunk(index: usize) -> Vec3 {
    let [x, z, _] = TREES[index % TREES.len()];
    vec3(x, 1.6, z)
}

fn fixed() -> Vec<Part> {
    let mut bark = Mesh::default();
    for [x, z, radius] in TREES {
        bark.column(vec3(x, -0.1, z), 6.5, (radius * 1.2, radius * 0.6), 16, 0.6);
        for branch in 0..5 {
            let seed = (x * 10.0) as i32 as u32;
            let (sin, cos) = (hash(branch, seed, 61) * TAU).sin_cos();
            let from = vec3(x, 1.7 + 0.75 * branch as f32, z);
            bark.rod(from, from + vec3(1.1 * sin, 0.55, 1.1 * cos), radius * 0.25, 0.6);
        }
    }
    let mut ground = Mesh::default();
    ground.rectangle(vec3(-60.0, 0.0, 12.0), Vec3::X * 120.0, Vec3::Z * -120.0, 3.0, 0.7);
    vec![
        Part::new(Material::Grass, grass()),
        Part::new(Material::Leaves, shrubs()).tinted(vec3(0.75, 1.0, 0.6)),
        Part::new(Material::Leaves, crowns()),
        Part::new(Material::Bark, bark),
        Part::new(Material::Soil, ground),
    ]
}

/// A card that grows from a root.
struct Card {
    root: Vec3,
    turn: f32,
    lean: f32,
    size: f32,
    sky: f32,
}

/// A mesh of cards, front to back.
fn mesh_of(mut cards: Vec<Card>) -> Mesh {
    let distance = |card: &Card| card.root.distance(vec3(0.0, 1.6, 0.0));
    cards.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let mut mesh = Mesh::default();
    for Card { root, turn, lean, size, sky } in cards {
        let mut one = Mesh::default();
        one.picture(vec3(-size / 2.0, 0.0, 0.0), Vec3::X * size, Vec3::Y * size, sky);
        let pose = Quat::from_rotation_y(turn) * Quat::from_rotation_x(lean);
        mesh.add(one, Mat4::from_rotation_translation(pose, root));
    }
    mesh
}

fn crowns() -> Mesh {
    let cards = (0..).zip(TREES).flat_map(|(tree, [x, z, radius])| {
        (0..40).map(move |leaf| {
            let random = |index| hash(tree * 256 + leaf, index, 62);
            let height = random(0);
            let (sin, cos) = (random(1) * TAU).sin_cos();
            let reach = (0.3 + 1.5 * random(2)) * (1.0 - 0.5 * height) * (radius / 0.2);
            Card {
                root: vec3(x + reach * sin, 1.9 + 4.3 * height, z + reach * cos),
                turn: random(4) * TAU,
                lean: 2.4 * (random(3) - 0.5) - 0.6,
                size: 0.55 + 0.5 * random(5),
                sky: 0.45 + 0.5 * height,
            }
        })
    });
    mesh_of(cards.collect())
}

/// Bushes around the clearing, near enough to look at single leaves.
fn shrubs() -> Mesh {
    let cards = (0..14).flat_map(|bush| {
        let angle = -1.9 + 3.8 * bush as f32 / 13.0;
        let distance = 2.4 + 2.2 * hash(bush, 0, 63);
        let centre = vec3(distance * angle.sin(), 0.0, -distance * angle.cos());
        (0..15).map(move |leaf| {
            let random = |index| hash(bush * 64 + leaf, index, 64);
            let (sin, cos) = (random(1) * TAU).sin_cos();
            let reach = 0.55 * random(2);
            Card {
                root: centre + vec3(reach * sin, 0.75 * random(0), reach * cos),
                turn: random(3) * TAU,
                lean: 0.9 * (random(4) - 0.6),
                size: 0.4 + 0.25 * random(5),
                sky: 0.7,
            }
        })
    });
    mesh_of(cards.collect())
}

fn grass() -> Mesh {
    let cards = (0..330).map(|tuft| {
        let random = |index| hash(tuft, index, 65);
        let angle = (random(0) - 0.5) * 4.4;
        // Denser near the visitor.
        let distance = 1.1 + 8.9 * random(1) * random(1);
        Card {
            root: vec3(distance * angle.sin(), -0.02, -distance * angle.cos()),
            turn: random(2) * TAU,
            lean: 0.3 * (random(3) - 0.5),
            size: 0.22 + 0.24 * random(4),
            sky: 0.8,
        }
    });
    mesh_of(cards.collect())
}

fn moving() -> Vec<Part> {
    let mut body = Mesh::default();
    body.rod(vec3(0.0, 0.0, -0.03), vec3(0.0, 0.0, 0.03), 0.006, 1.0);
    let mut wing = Mesh::default();
    // Both faces; the joint with the body is at x = 0.
    wing.rectangle(vec3(0.0, 0.0, 0.035), Vec3::X * 0.07, Vec3::Z * -0.07, 0.2, 1.0);
    wing.rectangle(vec3(0.07, -0.001, 0.035), Vec3::X * -0.07, Vec3::Z * -0.07, 0.2, 1.0);
    vec![Part::new(Material::Bark, body), Part::new(Material::Paint, wing)]
}

fn place(first: usize, time: f64, _: &[Light]) -> Vec<Placement> {
    let at = butterfly_at(time);
    let ahead = butterfly_at(time + 0.05) - at;
    let turn = Quat::from_rotation_y((-ahead.x).atan2(-ahead.z));
    let flap = 0.9 * turns(time, 6.0).sin();
    let mut placed = vec![Placement::new(first + BUTTERFLY, turn, at)];
    for side in [0.0, std::f32::consts::PI] {
        let wing = turn * Quat::from_rotation_y(side) * Quat::from_rotation_z(0.3 + flap);
        placed.push(Placement::new(first + WING, wing, at).tinted(vec3(1.0, 0.35, 0.05)));
    }
    placed
}

fn fireflies(time: f64, count: u32) -> Vec<Light> {
    let own = (0..count).map(|index| {
        let phase = hash(index, 0, 66);
        let (sin, cos) = (turns(time, 0.07) + phase * TAU).sin_cos();
        Light {
            position: vec3(2.0 * sin, 0.7 + 0.6 * hash(index, 1, 66), -3.0 - 1.2 * cos),
            range: 2.5,
            colour: vec3(0.8, 1.0, 0.3) * 0.25,
        }
    });
    lights::first(own, count, [Vec3::ZERO, Vec3::ONE])
}
