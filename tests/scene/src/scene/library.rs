//! A library at night, the failing case of foveation that knows only rings: dim shelves with legible spines
//! and small pools of lamp light. Metres; the visitor stands at the origin and looks towards -z.

use glam::{Mat4, Quat, Vec3, vec3};

use super::environment::Environment;
use super::lights::{self, Light};
use super::noise::hash;
use super::{Definition, Material, Part, Placement, mesh::Mesh, turns};

/// The library.
pub const SCENE: Definition = Definition {
    fixed,
    moving,
    place,
    lights: lamps,
    default_lights: 7,
    environment: Some(Environment {
        sky_light: [0.028, 0.030, 0.038],
        ground_light: [0.016, 0.014, 0.012],
        ..Environment::INDOORS
    }),
};

/// Half the width of the aisle.
const AISLE: f32 = 1.55;
const BAYS: u32 = 11;
const ROWS: u32 = 7;
/// Bays on each side whose books are things of their own.
const SINGLE_BOOKS: u32 = 2;
const LANTERN: usize = 0;
const PENDULUM: usize = 1;
const GLOBE: usize = 2;

/// Position of the lantern that is carried along the far shelves.
pub fn lantern_at(time: f64) -> Vec3 {
    let (sin, cos) = turns(time, 0.06).sin_cos();
    vec3(0.9 * cos, 1.15 + 0.03 * turns(time, 1.8).sin(), -6.5 + 3.2 * sin)
}

/// The middle of the spines of a bay and row; `right` for the shelves on the right.
pub fn spine(right: bool, bay: u32, row: u32) -> Vec3 {
    let x = if right { AISLE } else { -AISLE };
    vec3(x, 0.3 + 0.36 * row as f32, -0.9 - bay as f32)
}

fn fixed() -> Vec<Part> {
    vec![
        Part::new(Material::Pages, pages()),
        Part::new(Material::Spines, books()),
        Part::new(Material::Brass, lamp_stands()),
        Part::new(Material::Lamp, shades()).glowing(vec3(0.05, 0.35, 0.12)),
        Part::new(Material::Wood, woodwork()).tinted(Vec3::splat(0.7)),
        Part::new(Material::Cloth, carpet()).tinted(vec3(0.35, 0.06, 0.05)),
        Part::new(Material::Plaster, shell()).tinted(Vec3::splat(0.5)),
    ]
}

/// Books on both sides and on the shelf at the end; single ones where they are near, whole rows as one picture where
/// they are far.
fn books() -> Mesh {
    let mut mesh = Mesh::default();
    for number in 0..BAYS {
        let z = -0.4 - number as f32;
        if number < SINGLE_BOOKS {
            mesh.add(single_books(71 + number, false), left_bay(z));
            mesh.add(single_books(91 + number, true), right_bay(z));
        } else {
            mesh.add(rows_of_books(71 + number), left_bay(z));
            mesh.add(rows_of_books(91 + number), right_bay(z));
        }
    }
    for number in 0..3 {
        mesh.add(rows_of_books(111 + number), end_bay(number));
    }
    mesh
}

/// A bay of books with spines, tops and covers; the near end first, which is the right one in bays on the right.
fn single_books(seed: u32, from_the_right: bool) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..ROWS {
        let random = |index: u32, what| hash(index + 64 * row, what, seed);
        let bottom = 0.13 + 0.36 * row as f32;
        let mut places = Vec::new();
        let mut x = 0.03;
        while x < 0.93 {
            let index = places.len() as u32;
            let width = 0.024 + 0.03 * random(index, 0);
            places.push((index, x, width));
            x += width + 0.002;
        }
        if from_the_right {
            places.reverse();
        }
        // One in nine is missing.
        for (index, x, width) in places.into_iter().filter(|(index, ..)| random(*index, 3) > 0.11) {
            let (height, depth) = (0.21 + 0.10 * random(index, 1), 0.16 + 0.05 * random(index, 2));
            let cell = (random(index, 4) * 127.99) as u32;
            let corner = vec3(x, bottom, -0.22 + depth);
            let (u, v, back) = (Vec3::X * width, Vec3::Y * height, Vec3::Z * -depth);
            mesh.cell([corner, u, v], [32, 4], cell, 0.7);
            mesh.cell([corner + v, u, back], [32, 4], cell, 0.35);
            mesh.cell([corner + u, back, v], [32, 4], cell, 0.3);
            mesh.cell([corner + back, -back, v], [32, 4], cell, 0.3);
        }
    }
    mesh
}

/// A bay with pictures of rows of sixteen books.
fn rows_of_books(seed: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..ROWS {
        let corner = vec3(0.03, 0.13 + 0.36 * row as f32, -0.04);
        let cell = (hash(row, 0, seed) * 7.99) as u32;
        mesh.cell([corner, Vec3::X * 0.94, Vec3::Y * 0.28], [2, 4], cell, 0.7);
    }
    mesh
}

fn end_bay(number: u32) -> Mat4 {
    Mat4::from_translation(vec3(-1.5 + number as f32, 0.0, -11.6))
}

fn left_bay(z: f32) -> Mat4 {
    Mat4::from_translation(vec3(-AISLE, 0.0, z)) * Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2)
}

fn right_bay(z: f32) -> Mat4 {
    Mat4::from_translation(vec3(AISLE, 0.0, z - 1.0)) * Mat4::from_rotation_y(-std::f32::consts::FRAC_PI_2)
}

fn woodwork() -> Mesh {
    let mut mesh = Mesh::default();
    let mut bay = |pose: Mat4| {
        let mut shelf = Mesh::default();
        for row in 0..=ROWS {
            let y = 0.1 + 0.36 * row as f32;
            shelf.cuboid(vec3(0.0, y, -0.25), vec3(1.0, y + 0.03, 0.0), 0.5, 0.5);
        }
        shelf.cuboid(vec3(-0.02, 0.0, -0.25), vec3(0.02, 2.75, 0.01), 0.5, 0.5);
        shelf.rectangle(vec3(0.0, 0.0, -0.24), Vec3::X, Vec3::Y * 2.7, 0.5, 0.15);
        mesh.add(shelf, pose);
    };
    for number in 0..BAYS {
        let z = -0.4 - number as f32;
        bay(left_bay(z));
        bay(right_bay(z));
    }
    for number in 0..3 {
        bay(end_bay(number));
    }
    // A reading table with two legs a side, and a clock's case.
    mesh.cuboid(vec3(-0.55, 0.72, -3.6), vec3(0.55, 0.76, -1.7), 0.6, 0.8);
    for (x, z) in [(-0.5, -3.5), (0.45, -3.5), (-0.5, -1.8), (0.45, -1.8)] {
        mesh.cuboid(vec3(x, 0.0, z), vec3(x + 0.05, 0.72, z + 0.05), 0.5, 0.3);
    }
    mesh.cuboid(vec3(-0.25, 0.0, -9.4), vec3(0.25, 0.5, -9.2), 0.5, 0.5);
    mesh.cuboid(vec3(-0.25, 1.7, -9.4), vec3(0.25, 2.1, -9.2), 0.5, 0.5);
    mesh
}

fn pages() -> Mesh {
    let mut mesh = Mesh::default();
    for (x, z, turn) in [(-0.28, -2.0, 0.12), (0.22, -2.5, -0.3), (-0.2, -3.1, 0.4)] {
        let mut book = Mesh::default();
        book.picture(vec3(-0.2, 0.0, 0.14), Vec3::X * 0.4, vec3(0.0, 0.05, -0.26), 0.8);
        mesh.add(book, Mat4::from_translation(vec3(x, 0.775, z)) * Mat4::from_rotation_y(turn));
    }
    mesh
}

/// The lamps on the table: x, z.
const TABLE_LAMPS: [[f32; 2]; 2] = [[0.4, -1.95], [-0.42, -2.75]];

fn lamp_stands() -> Mesh {
    let mut mesh = Mesh::default();
    for [x, z] in TABLE_LAMPS {
        mesh.column(vec3(x, 0.76, z), 0.02, (0.09, 0.06), 20, 0.6);
        mesh.rod(vec3(x, 0.76, z), vec3(x, 1.12, z), 0.008, 0.6);
    }
    for index in 0..4 {
        let z = -1.4 - 3.0 * index as f32;
        mesh.rod(vec3(0.0, 2.45, z), vec3(0.0, 3.8, z), 0.006, 0.6);
    }
    mesh
}

fn shades() -> Mesh {
    let mut mesh = Mesh::default();
    for [x, z] in TABLE_LAMPS {
        mesh.column(vec3(x, 1.1, z), 0.09, (0.12, 0.05), 20, 0.6);
    }
    for index in 0..4 {
        mesh.column(vec3(0.0, 2.4, -1.4 - 3.0 * index as f32), 0.14, (0.17, 0.04), 20, 0.6);
    }
    mesh
}

fn carpet() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(-AISLE, 0.0, 3.0), Vec3::X * AISLE * 2.0, Vec3::Z * -14.6, 0.5, 0.8);
    mesh
}

fn shell() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(-3.4, 3.8, -13.0), Vec3::X * 6.8, Vec3::Z * 16.0, 2.0, 0.6);
    mesh.rectangle(vec3(-3.4, 0.0, -12.2), Vec3::X * 6.8, Vec3::Y * 3.8, 2.0, 0.5);
    mesh.rectangle(vec3(-3.4, 0.0, 3.0), Vec3::Z * -16.0, Vec3::Y * 3.8, 2.0, 0.5);
    mesh.rectangle(vec3(3.4, 0.0, -13.0), Vec3::Z * 16.0, Vec3::Y * 3.8, 2.0, 0.5);
    mesh.rectangle(vec3(3.4, 0.0, 3.0), Vec3::X * -6.8, Vec3::Y * 3.8, 2.0, 0.5);
    mesh
}

fn moving() -> Vec<Part> {
    let mut lantern = Mesh::default();
    lantern.sphere(Vec3::ZERO, 0.05, 16, 0.0);
    let mut pendulum = Mesh::default();
    pendulum.rod(Vec3::ZERO, vec3(0.0, -0.9, 0.0), 0.006, 0.6);
    pendulum.sphere(vec3(0.0, -0.95, 0.0), 0.08, 24, 0.6);
    let mut globe = Mesh::default();
    globe.sphere(Vec3::ZERO, 0.22, 32, 0.7);
    vec![
        Part::new(Material::Lamp, lantern),
        Part::new(Material::Brass, pendulum),
        Part::new(Material::Marble, globe),
    ]
}

fn place(first: usize, time: f64, _: &[Light]) -> Vec<Placement> {
    let swing = 0.3 * turns(time, 0.5).sin();
    let spin = Quat::from_rotation_z(0.4) * Quat::from_rotation_y(turns(time, 0.08));
    vec![
        Placement::new(first + LANTERN, Quat::IDENTITY, lantern_at(time)).glowing(vec3(2.4, 1.5, 0.6)),
        Placement::new(first + PENDULUM, Quat::from_rotation_z(swing), vec3(0.0, 1.7, -9.3)),
        Placement::new(first + GLOBE, spin, vec3(0.3, 1.0, -3.25)).tinted(vec3(0.5, 0.7, 0.9)),
    ]
}

/// The lantern, two lamps on the table, four that hang over the aisle, and two candles at the end that flicker.
fn lamps(time: f64, count: u32) -> Vec<Light> {
    const WARM: Vec3 = vec3(1.0, 0.68, 0.34);
    let lantern = Light { position: lantern_at(time), range: 3.6, colour: WARM * 0.7 };
    let table =
        TABLE_LAMPS.map(|[x, z]| Light { position: vec3(x, 1.08, z), range: 2.6, colour: WARM * 0.4 });
    let hanging = [0, 1, 2, 3].map(|index| Light {
        position: vec3(0.0, 2.36, -1.4 - 3.0 * index as f32),
        range: 3.4,
        colour: WARM * 1.5,
    });
    let candles = [-1.2, 1.2].map(|x| {
        let flicker = 0.8 + 0.12 * turns(time, 3.1 + f64::from(x)).sin() + 0.08 * turns(time, 7.3).sin();
        Light { position: vec3(x, 1.5, -11.2), range: 1.8, colour: WARM * 0.10 * flicker }
    });
    let own = [lantern].into_iter().chain(table).chain(hanging).chain(candles);
    lights::first(own, count, [vec3(-1.5, 0.2, -11.0), vec3(1.5, 2.5, 1.0)])
}
