//! A street at night: cables, railings, lane markings, lit windows, signs, head lamps. Metres; the visitor stands at the
//! origin, in the middle of the road, and looks towards -z.

use glam::{Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::noise::hash;
use super::{Definition, Material, Part, Placement, mesh::Mesh};

/// The street.
pub const SCENE: Definition = Definition {
    fixed,
    moving,
    place,
    lights: lamps,
    default_lights: 8,
    environment: Some(Environment {
        sun_direction: [-0.48, 0.6, -0.64],
        sun: [0.035, 0.045, 0.06],
        sky_light: [0.010, 0.012, 0.018],
        ground_light: [0.012, 0.010, 0.008],
        zenith: [0.002, 0.003, 0.008],
        horizon: [0.020, 0.018, 0.022],
        cloud: 0.25,
        stars: 0.35,
        fog_per_m: 0.002,
        ..Environment::DAY
    }),
};

/// Distance of the facades from the centre line of the road, metres.
const FACADE: f32 = 6.5;
/// Distance of the kerbs from the centre line of the road, metres.
const KERB: f32 = 4.0;
/// Distance between lamp posts.
const POSTS: f32 = 12.0;
const CAR: usize = 0;
const WHEELS: usize = 1;
const HEAD_LAMPS: usize = 2;
const TAIL_LAMPS: usize = 3;
/// Cars: lane, metres a second towards the visitor, place at the start.
const CARS: [[f32; 3]; 5] =
    [[-1.9, 7.0, -50.0], [-1.9, 7.0, -20.0], [1.9, -6.0, -8.0], [1.9, -6.0, -36.0], [1.9, -6.0, -60.0]];
/// The length of road that the cars go round on.
const LOOP: f32 = 84.0;

/// Position of a car.
pub fn car_at(index: usize, time: f64) -> Vec3 {
    let [x, speed, start] = CARS[index % CARS.len()];
    // Away from the visitor by 7 m at least: the loop is behind -7.
    let along = (f64::from(start + 91.0) + time * f64::from(speed)).rem_euclid(f64::from(LOOP)) as f32;
    vec3(x, 0.0, along - 91.0)
}

/// A shop sign's middle.
pub fn sign(index: usize) -> Vec3 {
    let side = if index.is_multiple_of(2) { -1.0 } else { 1.0 };
    vec3(side * (FACADE - 0.1), 3.3, -5.0 - 4.5 * index as f32)
}

fn fixed() -> Vec<Part> {
    let mut lit = [Mesh::default(), Mesh::default(), Mesh::default()];
    let mut dark = Mesh::default();
    windows(&mut lit, &mut dark);
    let [warm, white, blue] = lit;
    vec![
        Part::new(Material::Signs, signs()).glowing(Vec3::splat(2.2)),
        Part::new(Material::Windows, warm).glowing(vec3(1.1, 0.85, 0.5)),
        Part::new(Material::Windows, white).glowing(vec3(0.8, 0.85, 0.9)),
        Part::new(Material::Windows, blue).glowing(vec3(0.18, 0.3, 0.5)),
        Part::new(Material::Windows, dark),
        Part::new(Material::Lamp, lamp_heads()).glowing(vec3(6.0, 4.6, 3.0)),
        Part::new(Material::Lamp, fairy_lights()).glowing(vec3(2.0, 1.5, 0.8)),
        Part::new(Material::Paint, cables()).tinted(Vec3::splat(0.8)).glowing(Vec3::splat(0.05)),
        Part::new(Material::Paint, ironwork()).tinted(vec3(0.55, 0.6, 0.62)),
        Part::new(Material::Paint, markings()),
        Part::new(Material::Brick, facades()),
        Part::new(Material::Plaster, pavements()).tinted(Vec3::splat(0.6)),
        Part::new(Material::Asphalt, road()),
    ]
}

fn road() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(-KERB, 0.0, 12.0), Vec3::X * KERB * 2.0, Vec3::Z * -120.0, 2.5, 1.0);
    mesh
}

fn pavements() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.cuboid(vec3(-FACADE, -0.1, -108.0), vec3(-KERB, 0.14, 12.0), 2.0, 0.9);
    mesh.cuboid(vec3(KERB, -0.1, -108.0), vec3(FACADE, 0.14, 12.0), 2.0, 0.9);
    mesh
}

fn markings() -> Mesh {
    let mut mesh = Mesh::default();
    let mut strip = |x: f32, z: f32, width: f32, length: f32| {
        mesh.rectangle(vec3(x, 0.006, z), Vec3::X * width, Vec3::Z * -length, 1.0, 1.0);
    };
    for index in 0..36 {
        strip(-0.07, 6.0 - 3.0 * index as f32, 0.14, 1.6);
    }
    for x in [-KERB + 0.25, KERB - 0.37] {
        strip(x, 12.0, 0.12, 118.0);
    }
    // A crossing.
    for index in 0..8 {
        strip(-3.6 + 0.95 * index as f32, -6.2, 0.5, 2.8);
    }
    mesh
}

fn facades() -> Mesh {
    let mut mesh = Mesh::default();
    for (index, z) in (0..).zip([12.0, -4.0, -20.0, -38.0, -54.0, -74.0, -92.0]) {
        let height = 10.0 + 5.0 * hash(index, 0, 81);
        let next = z - 18.5;
        mesh.cuboid(vec3(-FACADE - 5.0, 0.0, next), vec3(-FACADE, height, z - 0.4), 1.4, 0.7);
        mesh.cuboid(vec3(FACADE, 0.0, next), vec3(FACADE + 5.0, height - 1.5, z - 0.4), 1.4, 0.7);
    }
    mesh.cuboid(vec3(-14.0, 0.0, -112.0), vec3(14.0, 11.0, -108.0), 1.4, 0.7);
    mesh
}

/// Windows in rows on both sides; a third are lit.
fn windows(lit: &mut [Mesh; 3], dark: &mut Mesh) {
    for side in 0..2 {
        for row in 0..4 {
            for column in 0..52 {
                let random = |what| hash(column + 64 * row, what, 82 + side);
                let (y, z) = (1.2 + 2.6 * row as f32, 8.0 - 2.1 * column as f32);
                let mesh = match random(0) {
                    0.0..0.18 => &mut lit[0],
                    0.18..0.30 => &mut lit[1],
                    0.30..0.36 => &mut lit[2],
                    _ => &mut *dark,
                };
                let (corner, u) = if side == 0 {
                    (vec3(-FACADE + 0.02, y, z), Vec3::Z * -1.1)
                } else {
                    (vec3(FACADE - 0.02, y, z - 1.1), Vec3::Z * 1.1)
                };
                mesh.cell([corner, u, Vec3::Y * 1.5], [4, 4], (random(1) * 15.99) as u32, 0.6);
            }
        }
    }
}

/// Signs stand out from the facades, so that they are read along the street.
fn signs() -> Mesh {
    let mut mesh = Mesh::default();
    for index in 0..16 {
        let middle = sign(index);
        let inwards = -middle.x.signum();
        let left = middle.x + if inwards > 0.0 { 0.1 } else { -2.1 };
        mesh.cell([vec3(left, 3.1, middle.z), Vec3::X * 2.0, Vec3::Y * 0.5], [1, 8], index as u32, 0.8);
    }
    mesh
}

fn posts() -> impl Iterator<Item = Vec3> {
    (0..9).flat_map(|index| {
        let z = -3.0 - POSTS * index as f32;
        [vec3(-KERB - 0.4, 0.0, z), vec3(KERB + 0.4, 0.0, z - POSTS / 2.0)]
    })
}

fn lamp_heads() -> Mesh {
    let mut mesh = Mesh::default();
    for post in posts() {
        mesh.sphere(post + vec3(-0.8 * post.x.signum(), 4.95, 0.0), 0.13, 12, 0.0);
    }
    mesh
}

/// The ends of the wires that span the street, by post.
fn spans() -> impl Iterator<Item = (Vec3, Vec3)> {
    posts().map(|post| (vec3(post.x, 6.2, post.z), vec3(-post.x, 6.2, post.z)))
}

/// Small bulbs along every other span wire.
fn fairy_lights() -> Mesh {
    const SAG: f32 = 0.25;
    let mut mesh = Mesh::default();
    for (from, to) in spans().step_by(2) {
        for bulb in 1..16 {
            let t = bulb as f32 / 16.0;
            let at = from.lerp(to, t) - Vec3::Y * (SAG * 4.0 * t * (1.0 - t) + 0.03);
            mesh.sphere(at, 0.022, 6, 0.0);
        }
    }
    mesh
}

/// Span wires, the wires of a tram, and two thin cables.
fn cables() -> Mesh {
    let mut mesh = Mesh::default();
    for (from, to) in spans() {
        mesh.cable(from, to, 0.25, 0.006);
    }
    for (x, y, radius) in [(-1.9, 5.6, 0.008), (1.9, 5.6, 0.008), (-2.2, 6.4, 0.012), (2.6, 7.4, 0.004)] {
        for span in 0..5 {
            let z = 9.0 - 22.0 * span as f32;
            mesh.cable(vec3(x, y, z), vec3(x, y, z - 22.0), 0.35, radius);
        }
    }
    mesh
}

/// Posts and railings.
fn ironwork() -> Mesh {
    let mut mesh = Mesh::default();
    for post in posts() {
        mesh.column(post, 5.2, (0.07, 0.045), 10, 0.9);
        let top = post + Vec3::Y * 5.15;
        mesh.rod(top, top - Vec3::X * (0.8 * post.x.signum()), 0.03, 0.9);
    }
    for x in [-KERB - 0.1, KERB + 0.1] {
        for bar in 0..240 {
            let z = 2.0 - 0.13 * bar as f32;
            mesh.rod(vec3(x, 0.14, z), vec3(x, 1.05, z), 0.007, 0.9);
        }
        for y in [0.3, 1.05] {
            mesh.rod(vec3(x, y, 2.0), vec3(x, y, -29.2), 0.016, 0.9);
        }
    }
    mesh
}

fn moving() -> Vec<Part> {
    let mut car = Mesh::default();
    car.cuboid(vec3(-0.8, 0.3, -2.0), vec3(0.8, 0.85, 2.0), 1.0, 0.9);
    car.cuboid(vec3(-0.68, 0.85, -1.1), vec3(0.68, 1.4, 0.9), 1.0, 0.9);
    let mut wheels = Mesh::default();
    for (x, z) in [(-0.85, -1.3), (-0.85, 1.3), (0.65, -1.3), (0.65, 1.3)] {
        wheels.cuboid(vec3(x, 0.0, z - 0.3), vec3(x + 0.2, 0.6, z + 0.3), 1.0, 0.5);
    }
    let (mut head, mut tail) = (Mesh::default(), Mesh::default());
    for x in [-0.6, 0.6] {
        head.sphere(vec3(x, 0.62, 2.0), 0.11, 12, 0.0);
        tail.cuboid(vec3(x - 0.14, 0.58, -2.03), vec3(x + 0.14, 0.7, -1.99), 1.0, 0.0);
    }
    vec![
        Part::new(Material::Paint, car),
        Part::new(Material::Metal, wheels),
        Part::new(Material::Lamp, head),
        Part::new(Material::Lamp, tail),
    ]
}

fn place(first: usize, time: f64, _: &[Light]) -> Vec<Placement> {
    let mut placed = Vec::new();
    for part in [CAR, WHEELS, HEAD_LAMPS, TAIL_LAMPS] {
        for (index, [_, speed, _]) in CARS.into_iter().enumerate() {
            // Head lamps are at +z; who drives away is turned round.
            let turn = Quat::from_rotation_y(if speed > 0.0 { 0.0 } else { std::f32::consts::PI });
            let placement = Placement::new(first + part, turn, car_at(index, time));
            placed.push(match part {
                CAR => placement
                    .tinted([vec3(0.5, 0.03, 0.03), vec3(0.03, 0.06, 0.2), Vec3::splat(0.6)][index % 3]),
                HEAD_LAMPS => placement.glowing(vec3(9.0, 8.6, 7.5)),
                TAIL_LAMPS => placement.glowing(vec3(2.5, 0.1, 0.06)),
                _ => placement,
            });
        }
    }
    placed
}

/// The nearest street lamps, then the light of the cars on the road.
fn lamps(time: f64, count: u32) -> Vec<Light> {
    let street = posts().take(6).map(|post| Light {
        position: post + vec3(-0.8 * post.x.signum(), 4.7, 0.0),
        range: 16.0,
        colour: vec3(1.0, 0.74, 0.42) * 12.0,
    });
    let cars = (0..CARS.len()).map(|index| {
        let ahead = if CARS[index][1] > 0.0 { 3.2 } else { -3.2 };
        Light {
            position: car_at(index, time) + vec3(0.0, 0.6, ahead),
            range: 8.0,
            colour: vec3(1.0, 0.95, 0.85) * 1.5,
        }
    });
    lights::first(street.chain(cars), count, [vec3(-6.0, 0.5, -40.0), vec3(6.0, 4.0, 0.0)])
}
