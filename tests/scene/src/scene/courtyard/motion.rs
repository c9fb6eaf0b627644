//! Moving things: crates that turn, a pendulum, a cart, spheres in orbit, and the bodies of the lamps.

use std::f32::consts::TAU;

use glam::{Quat, Vec3, vec3};

use crate::scene::lights::Light;
use crate::scene::{Material, Part, Placement, mesh::Mesh, turns};

const CRATE: usize = 0;
const PENDULUM: usize = 1;
const CART: usize = 2;
const BALL: usize = 3;
const LAMP: usize = 4;

/// The moving shapes, about their own origins, in the order of the constants above.
pub fn parts() -> Vec<Part> {
    let mut crate_ = Mesh::default();
    crate_.cuboid(Vec3::splat(-0.3), Vec3::splat(0.3), 0.6, 1.0);
    let mut pendulum = Mesh::default();
    pendulum.sphere(Vec3::Y * -1.6, 0.22, 32, 1.0);
    pendulum.column(Vec3::Y * -1.4, 1.4, (0.003, 0.003), 6, 1.0);
    let mut cart = Mesh::default();
    cart.cuboid(vec3(-0.35, 0.12, -0.6), vec3(0.35, 0.55, 0.6), 1.0, 0.9);
    let mut ball = Mesh::default();
    ball.sphere(Vec3::ZERO, 0.16, 32, 1.0);
    let mut lamp = Mesh::default();
    lamp.sphere(Vec3::ZERO, 0.045, 16, 0.0);
    [
        (Material::Wood, crate_),
        (Material::Metal, pendulum),
        (Material::Wood, cart),
        (Material::Tiles, ball),
        (Material::Lamp, lamp),
    ]
    .map(|(material, mesh)| Part::new(material, mesh))
    .into()
}

/// Position of the cart.
pub fn cart_at(time: f64) -> Vec3 {
    vec3(2.5, 0.0, -8.0 + 5.0 * turns(time, 0.05).cos())
}

/// Position of one of the five spheres, and its angle on the circle, radians.
pub fn ball_at(index: usize, time: f64) -> (Vec3, f32) {
    let angle = turns(time, 0.1) + TAU * index as f32 / 5.0;
    let (sin, cos) = angle.sin_cos();
    (vec3(-0.6 + 1.1 * cos, 1.5 + 0.3 * (2.0 * angle).sin(), -7.0 + 1.1 * sin), angle)
}

/// Placements of the moving things; `first` is the index of this module's first part.
pub fn placements(first: usize, time: f64, lights: &[Light]) -> Vec<Placement> {
    let mut placed = Vec::new();
    let mut place = |part, rotation, position, emission| {
        placed.push(Placement::new(first + part, rotation, position).glowing(emission));
    };
    for (index, (x, z)) in [(-1.7, -3.4), (-0.5, -6.2), (1.9, -8.0)].into_iter().enumerate() {
        let spin = Quat::from_rotation_y(turns(time, 0.08 + 0.03 * index as f64));
        place(
            CRATE,
            spin * Quat::from_rotation_x(0.62) * Quat::from_rotation_z(0.79),
            vec3(x, 0.75, z),
            Vec3::ZERO,
        );
    }
    let swing = 0.45 * turns(time, 0.4).sin();
    place(PENDULUM, Quat::from_rotation_z(swing), vec3(0.3, 3.0, -4.2), Vec3::ZERO);
    place(CART, Quat::IDENTITY, cart_at(time), Vec3::ZERO);
    for index in 0..5 {
        let (position, angle) = ball_at(index, time);
        place(BALL, Quat::from_rotation_y(angle * 2.0), position, Vec3::ZERO);
    }
    for light in lights {
        place(LAMP, Quat::IDENTITY, light.position, light.colour * 2.0);
    }
    placed
}
