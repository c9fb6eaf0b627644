//! A square full of people who walk to and fro. Metres; the visitor stands at the origin and looks towards -z.

use glam::{Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::noise::hash;
use super::{Definition, Material, Part, Placement, mesh::Mesh, turns};

/// The square.
pub const SCENE: Definition = Definition {
    fixed,
    moving,
    place,
    lights: lanterns,
    default_lights: 6,
    environment: Some(Environment {
        cloud: 0.75,
        sun: [1.5, 1.4, 1.25],
        sky_light: [0.34, 0.37, 0.42],
        horizon: [0.75, 0.79, 0.84],
        zenith: [0.42, 0.5, 0.62],
        fog_per_m: 0.005,
        exposure: 0.75,
        ..Environment::DAY
    }),
};

/// Number of walking people.
pub const PEOPLE: u32 = 130;
/// Half the width of the square, where they turn up again on the other side.
const EDGE: f32 = 14.0;
const TORSO: usize = 0;
const HEAD: usize = 1;
const LIMB: usize = 2;

/// Position of a person's feet, orientation, and phase of the stride, radians.
fn walker(index: u32, time: f64) -> (Vec3, Quat, f32) {
    let random = |what| hash(index, what, 91);
    let z = -2.2 - 16.0 * random(0);
    let speed = 0.8 + 0.8 * random(1);
    let leftwards = random(2) < 0.5;
    let along = f64::from(random(3)) * f64::from(2.0 * EDGE) + time * f64::from(speed);
    let x = along.rem_euclid(f64::from(2.0 * EDGE)) as f32 - EDGE;
    let drift = 0.35 * (x * 0.5 + 6.0 * random(4)).sin();
    let turn = if leftwards { std::f32::consts::FRAC_PI_2 } else { -std::f32::consts::FRAC_PI_2 };
    let position = vec3(if leftwards { -x } else { x }, 0.0, z + drift);
    // A stride of two steps is 1.4 m.
    (position, Quat::from_rotation_y(turn), turns(along / 1.4, 1.0))
}

/// Position of a person's face.
pub fn face_at(index: u32, time: f64) -> Vec3 {
    walker(index, time).0 + Vec3::Y * (1.6 * tallness(index))
}

fn tallness(index: u32) -> f32 {
    0.97 + 0.06 * hash(index, 5, 91)
}

fn fixed() -> Vec<Part> {
    let mut houses = Mesh::default();
    for (index, x) in (0..).zip([-30.0, -21.0, -11.0, -1.0, 9.0, 20.0]) {
        let height = 7.0 + 4.0 * hash(index, 0, 92);
        houses.cuboid(vec3(x, 0.0, -28.0), vec3(x + 9.6, height, -22.0), 1.6, 0.9);
    }
    let mut windows = Mesh::default();
    for column in 0..30 {
        for row in 0..3 {
            let corner = vec3(-29.0 + 2.0 * column as f32, 1.2 + 2.3 * row as f32, -21.98);
            windows.cell([corner, Vec3::X, Vec3::Y * 1.4], [4, 4], column * 5 + row, 0.8);
        }
    }
    let mut signs = Mesh::default();
    for index in 0..8 {
        let corner = vec3(-20.0 + 5.2 * index as f32, 3.0, -21.9);
        signs.cell([corner, Vec3::X * 3.2, Vec3::Y * 0.55], [1, 8], index, 0.8);
    }
    let mut square = Mesh::default();
    square.rectangle(vec3(-40.0, 0.0, 10.0), Vec3::X * 80.0, Vec3::Z * -40.0, 2.0, 1.0);
    let mut posts = Mesh::default();
    for x in [-6.0, -2.0, 2.0, 6.0] {
        posts.column(vec3(x, 0.0, -6.0), 3.2, (0.06, 0.04), 12, 1.0);
    }
    vec![
        Part::new(Material::Metal, posts),
        Part::new(Material::Signs, signs).glowing(Vec3::splat(0.3)),
        Part::new(Material::Windows, windows),
        Part::new(Material::Brick, houses),
        Part::new(Material::Tiles, square),
    ]
}

fn moving() -> Vec<Part> {
    let mut torso = Mesh::default();
    torso.column(vec3(0.0, 0.82, 0.0), 0.3, (0.17, 0.15), 10, 0.9);
    torso.column(vec3(0.0, 1.1, 0.0), 0.36, (0.16, 0.21), 10, 0.9);
    torso.column(vec3(0.0, 1.46, 0.0), 0.06, (0.21, 0.06), 10, 1.0);
    let mut head = Mesh::default();
    head.column(vec3(0.0, 1.48, 0.0), 0.08, (0.055, 0.055), 8, 0.8);
    head.sphere(vec3(0.0, 1.64, 0.0), 0.115, 14, 1.0);
    // Hangs from a hip or a shoulder.
    let mut limb = Mesh::default();
    limb.column(vec3(0.0, -0.82, 0.0), 0.84, (0.05, 0.085), 8, 0.7);
    let mut bag = Mesh::default();
    bag.cuboid(vec3(-0.1, -0.95, -0.16), vec3(0.1, -0.65, 0.16), 0.4, 0.7);
    vec![
        Part::new(Material::Cloth, torso),
        Part::new(Material::Plastic, head),
        Part::new(Material::Cloth, limb),
        Part::new(Material::Cloth, bag),
    ]
}

/// A colour of clothes.
fn cloth(index: u32, what: u32) -> Vec3 {
    const COLOURS: [Vec3; 8] = [
        vec3(0.75, 0.08, 0.07),
        vec3(0.08, 0.16, 0.45),
        vec3(0.9, 0.88, 0.8),
        vec3(0.06, 0.06, 0.07),
        vec3(0.85, 0.6, 0.1),
        vec3(0.12, 0.4, 0.2),
        vec3(0.45, 0.3, 0.2),
        vec3(0.4, 0.5, 0.6),
    ];
    COLOURS[(hash(index, what, 93) * 7.99) as usize]
}

fn place(first: usize, time: f64, _: &[Light]) -> Vec<Placement> {
    const SKIN: [Vec3; 4] =
        [vec3(0.85, 0.6, 0.48), vec3(0.55, 0.34, 0.22), vec3(0.3, 0.17, 0.1), vec3(0.95, 0.72, 0.6)];
    let mut placed = Vec::new();
    let walkers: Vec<_> = (0..PEOPLE).map(|index| walker(index, time)).collect();
    // All torsos, then all heads and so on, so that each kind is one draw.
    let mut each = |part: usize, pose: &dyn Fn(u32, f32) -> (Vec3, Quat), tint: &dyn Fn(u32) -> Vec3| {
        for (index, (feet, facing, stride)) in (0..).zip(&walkers) {
            let (offset, swing) = pose(index, *stride);
            let bob = 0.02 * (2.0 * stride).cos() + (tallness(index) - 1.0);
            let position = *feet + *facing * offset + Vec3::Y * bob;
            placed.push(Placement::new(first + part, *facing * swing, position).tinted(tint(index)));
        }
    };
    each(TORSO, &|_, stride| (Vec3::ZERO, Quat::from_rotation_y(0.12 * stride.sin())), &|index| {
        cloth(index, 0)
    });
    each(HEAD, &|_, _| (Vec3::ZERO, Quat::IDENTITY), &|index| SKIN[(hash(index, 1, 93) * 3.99) as usize]);
    for side in [-1.0f32, 1.0] {
        let leg = move |_: u32, stride: f32| {
            (vec3(0.09 * side, 0.84, 0.0), Quat::from_rotation_x(0.5 * side * stride.sin()))
        };
        each(LIMB, &leg, &|index| cloth(index, 2));
        let arm = move |_: u32, stride: f32| {
            let swing =
                Quat::from_rotation_z(0.12 * side) * Quat::from_rotation_x(-0.45 * side * stride.sin());
            (vec3(0.24 * side, 1.46, 0.0), swing)
        };
        each(LIMB, &arm, &|index| cloth(index, 0));
    }
    placed
}

fn lanterns(time: f64, count: u32) -> Vec<Light> {
    let own = (0..6).map(|index| {
        let x = -7.5 + 3.0 * index as f32;
        let pulse = 0.7 + 0.3 * turns(time, 0.2 + 0.05 * f64::from(index)).sin();
        Light { position: vec3(x, 3.2, -6.0), range: 8.0, colour: vec3(1.0, 0.8, 0.5) * 1.2 * pulse }
    });
    lights::first(own, count, [vec3(-10.0, 1.0, -16.0), vec3(10.0, 4.0, 0.0)])
}
