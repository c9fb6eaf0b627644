//! The fixed parts. Metres; the visitor stands at the origin and looks towards -z.

use glam::{Mat4, Vec3, vec3};

use super::{Definition, Material, Part, mesh::Mesh};

pub mod lights;
pub mod motion;

/// The courtyard.
pub const SCENE: Definition = Definition {
    fixed: parts,
    moving: motion::parts,
    place: motion::placements,
    lights: lights::at,
    default_lights: lights::DEFAULT,
    environment: None,
};

/// Sky visibility under the roof and in the corner behind it.
const SHADE: f32 = 0.10;
const DARK: f32 = 0.008;
/// The columns' places along z.
const COLUMNS: [f32; 7] = [3.0, 0.0, -3.0, -6.0, -9.0, -12.0, -15.0];
const LEFT: f32 = -3.0;
const RIGHT: f32 = 3.4;

/// Ends of the lamp cables: from a left column to a right one, one for each pair of columns.
pub fn lamp_cable(index: usize) -> (Vec3, Vec3, f32) {
    let z = COLUMNS[1 + index % (COLUMNS.len() - 1)];
    (vec3(LEFT, 3.3, z), vec3(RIGHT, 3.5, z - 1.5), 0.45)
}

/// All fixed parts, roughly front to back.
pub fn parts() -> Vec<Part> {
    vec![
        Part::new(Material::Board, board()).glowing(Vec3::splat(0.35)),
        Part::new(Material::Metal, ironwork()),
        Part::new(Material::Plaster, columns()),
        Part::new(Material::Wood, woodwork()),
        Part::new(Material::Brick, walls()),
        Part::new(Material::Tiles, floor()),
        Part::new(Material::Plaster, ground()),
    ]
}

fn floor() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(LEFT, 0.0, 6.0), Vec3::X * (6.0 - LEFT), Vec3::Z * -24.0, 2.0, 1.0);
    mesh.rectangle(vec3(-6.0, 0.0, 6.0), Vec3::X * (LEFT + 6.0), Vec3::Z * -24.0, 2.0, SHADE);
    mesh
}

fn walls() -> Mesh {
    let mut mesh = Mesh::default();
    // Left wall, under the roof; its near part is the back of the dark corner.
    mesh.rectangle(vec3(-6.0, 0.0, 6.0), Vec3::Z * -11.2, Vec3::Y * 3.4, 1.0, DARK);
    mesh.rectangle(vec3(-6.0, 0.0, -5.2), Vec3::Z * -12.8, Vec3::Y * 3.4, 1.0, SHADE);
    // The dark corner's far wall.
    mesh.cuboid(vec3(-6.0, 0.0, -5.2), vec3(-4.2, 3.4, -5.0), 1.0, DARK);
    // Right wall with a gap, and the wall behind the visitor.
    mesh.cuboid(vec3(6.0, 0.0, -7.0), vec3(6.3, 2.6, 6.0), 1.0, 0.8);
    mesh.cuboid(vec3(6.0, 0.0, -18.0), vec3(6.3, 2.6, -9.0), 1.0, 0.8);
    mesh.rectangle(vec3(6.0, 0.0, 6.0), Vec3::X * -12.0, Vec3::Y * 3.4, 1.0, 0.3);
    // Parapet at the end.
    mesh.cuboid(vec3(-6.0, 0.0, -18.3), vec3(6.3, 0.9, -18.0), 1.0, 0.9);
    mesh
}

fn columns() -> Mesh {
    let mut mesh = Mesh::default();
    for z in COLUMNS {
        for (x, height, sky) in [(LEFT, 3.4, 0.45), (RIGHT, 3.6, 1.0)] {
            mesh.cuboid(vec3(x - 0.3, 0.0, z - 0.3), vec3(x + 0.3, 0.25, z + 0.3), 1.0, sky);
            mesh.column(vec3(x, 0.25, z), height - 0.45, (0.21, 0.17), 24, sky);
            mesh.cuboid(vec3(x - 0.27, height - 0.2, z - 0.27), vec3(x + 0.27, height, z + 0.27), 1.0, sky);
        }
    }
    mesh
}

/// The plain outside, with four round hills on the horizon.
fn ground() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.rectangle(vec3(-120.0, -0.4, 6.0), Vec3::X * 240.0, Vec3::Z * -170.0, 8.0, 1.0);
    for (x, z, radius) in
        [(-60.0, -110.0, 40.0), (-5.0, -140.0, 48.0), (50.0, -120.0, 38.0), (95.0, -90.0, 34.0)]
    {
        mesh.sphere(vec3(x, -radius * 0.78, z), radius, 32, 0.8);
    }
    mesh
}

fn woodwork() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.cuboid(vec3(-6.0, 3.4, -18.0), vec3(LEFT + 0.5, 3.6, 6.0), 1.0, 0.3);
    for step in 0..16 {
        let z = 5.0 - 1.5 * step as f32;
        mesh.cuboid(vec3(-6.0, 3.22, z - 0.06), vec3(LEFT + 0.45, 3.4, z + 0.06), 1.0, SHADE);
    }
    mesh.cuboid(vec3(-5.6, 0.0, -4.9), vec3(-4.7, 0.7, -4.2), 1.0, DARK);
    mesh.cuboid(vec3(-5.4, 0.7, -4.85), vec3(-4.9, 1.1, -4.4), 1.0, DARK);
    // A bench on the right.
    mesh.cuboid(vec3(4.6, 0.42, -4.6), vec3(5.2, 0.48, -2.4), 1.0, 0.9);
    mesh.cuboid(vec3(4.65, 0.0, -4.4), vec3(5.15, 0.42, -4.3), 1.0, 0.6);
    mesh.cuboid(vec3(4.65, 0.0, -2.7), vec3(5.15, 0.42, -2.6), 1.0, 0.6);
    mesh
}

fn ironwork() -> Mesh {
    let mut mesh = Mesh::default();
    for index in 0..COLUMNS.len() - 1 {
        let (from, to, sag) = lamp_cable(index);
        mesh.cable(from, to, sag, 0.005);
    }
    // Power lines along the right arcade and one across the view.
    for (x, y, radius) in [(2.2, 4.6, 0.002), (2.6, 4.8, 0.003), (3.0, 5.0, 0.005)] {
        mesh.cable(vec3(x, y, 5.0), vec3(x, y, -18.0), 0.5, radius);
    }
    mesh.cable(vec3(-5.8, 3.9, -10.0), vec3(6.1, 2.9, -7.5), 0.3, 0.002);
    // A fence of thin bars on the parapet.
    for bar in 0..82 {
        let x = -5.9 + 0.15 * bar as f32;
        mesh.column(vec3(x, 0.9, -18.15), 0.8, (0.008, 0.008), 6, 0.9);
    }
    mesh.cuboid(vec3(-6.0, 1.7, -18.17), vec3(6.3, 1.73, -18.13), 1.0, 0.9);
    // The notice board's posts.
    for x in [-0.86, 0.84] {
        let corner = board_pose().transform_point3(vec3(x, -1.25, -0.05));
        mesh.column(corner, 2.0, (0.02, 0.02), 12, 1.0);
    }
    mesh
}

fn board_pose() -> Mat4 {
    Mat4::from_translation(vec3(1.35, 1.25, -2.6)) * Mat4::from_rotation_y(-0.42)
}

fn board() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.picture(vec3(-0.8, -0.4, 0.0), Vec3::X * 1.6, Vec3::Y * 0.8, 0.6);
    mesh.transformed(board_pose())
}
