//! Scripts of each scene.

use std::borrow::Cow;

use glam::{Vec3, vec3};

use super::gaze::Target::{self, Moving, Still};
use super::head::HeadKey;
use super::sound::Sound;
use crate::scene::courtyard::motion;
use crate::scene::{SceneName, cockpit, crowd, foliage, generated, interior, library, street};

pub struct Content {
    pub waypoints: &'static [HeadKey],
    pub targets: Cow<'static, [Target]>,
    pub sound: Sound,
    pub seed: u32,
}

/// A waypoint: seconds, place in LOCAL in metres, yaw, pitch and roll in degrees.
const fn at(t: f64, position: [f32; 3], [yaw_deg, pitch_deg, roll_deg]: [f32; 3]) -> HeadKey {
    HeadKey { t, position, yaw_deg, pitch_deg, roll_deg }
}

pub fn content(scene: SceneName) -> Content {
    let (waypoints, targets, sound): (&'static [HeadKey], &'static [Target], Sound) = match scene {
        SceneName::Generated(kind, seed) => {
            let targets = generated::targets(kind, seed).into_iter().map(Still).collect();
            let sound = Sound { scene, loudness_lufs: -22.0 };
            return Content { waypoints: &GENERATED, targets: Cow::Owned(targets), sound, seed };
        }
        SceneName::Courtyard => (&COURTYARD, &COURTYARD_TARGETS, Sound { scene, loudness_lufs: -24.0 }),
        SceneName::Cockpit => (&COCKPIT, &COCKPIT_TARGETS, Sound { scene, loudness_lufs: -12.0 }),
        SceneName::Foliage => (&FOLIAGE, &FOLIAGE_TARGETS, Sound { scene, loudness_lufs: -30.0 }),
        SceneName::Library => (&LIBRARY, &LIBRARY_TARGETS, Sound { scene, loudness_lufs: -35.0 }),
        SceneName::Interior => (&INTERIOR, &INTERIOR_TARGETS, Sound { scene, loudness_lufs: -27.0 }),
        SceneName::Street => (&STREET, &STREET_TARGETS, Sound { scene, loudness_lufs: -18.0 }),
        SceneName::Crowd => (&CROWD, &CROWD_TARGETS, Sound { scene, loudness_lufs: -16.0 }),
    };
    let place = SceneName::ALL.iter().position(|other| *other == scene).unwrap_or_default();
    Content { waypoints, targets: Cow::Borrowed(targets), sound, seed: 1000 + place as u32 }
}

const GENERATED: [HeadKey; 5] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    at(3.0, [0.1, 0.0, -0.1], [15.0, -5.0, 1.0]),
    at(6.0, [0.0, -0.02, -0.2], [-8.0, 5.0, -1.0]),
    at(9.0, [-0.1, 0.0, -0.2], [-20.0, -4.0, 0.0]),
    at(12.0, [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
];

const COURTYARD: [HeadKey; 5] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    at(3.0, [0.1, 0.0, -0.3], [-14.0, -3.0, 1.0]),
    at(6.0, [0.0, -0.02, -0.7], [12.0, 4.0, -1.5]),
    at(9.0, [-0.1, 0.0, -0.9], [24.0, -4.0, 0.0]),
    at(12.0, [0.0, 0.0, -1.1], [-4.0, 0.0, 1.0]),
];
const COURTYARD_TARGETS: [Target; 12] = [
    Still(vec3(0.0, 1.5, -12.0)),
    Still(vec3(1.0, 1.35, -2.6)),
    Still(vec3(1.6, 1.15, -2.5)),
    Still(vec3(-3.0, 2.2, -6.0)),
    Still(vec3(3.4, 2.4, -6.0)),
    Still(vec3(-1.7, 0.75, -3.4)),
    Still(vec3(-0.5, 0.75, -6.2)),
    Still(vec3(0.5, 3.0, -9.0)),
    Still(vec3(-3.0, 1.6, -9.0)),
    Still(vec3(4.8, 0.5, -3.4)),
    Moving(cart),
    Moving(ball),
];

fn cart(t: f64) -> Vec3 {
    motion::cart_at(t) + Vec3::Y * 0.4
}

fn ball(t: f64) -> Vec3 {
    motion::ball_at(0, t).0
}

const COCKPIT: [HeadKey; 6] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, -10.0, 0.0]),
    at(2.5, [0.02, -0.01, -0.05], [8.0, -22.0, 1.0]),
    at(5.0, [-0.02, 0.0, -0.03], [-14.0, -24.0, -1.0]),
    at(7.5, [0.0, 0.01, 0.0], [2.0, -3.0, 0.0]),
    at(10.0, [0.03, 0.0, -0.06], [-22.0, -20.0, -2.0]),
    at(12.0, [0.0, 0.0, 0.0], [0.0, -8.0, 0.0]),
];
const COCKPIT_TARGETS: [Target; 18] = [
    Still(vec3(-0.155, 1.22, -0.69)),
    Still(vec3(-0.045, 1.22, -0.69)),
    Still(vec3(0.065, 1.22, -0.69)),
    Still(vec3(0.175, 1.11, -0.66)),
    Still(vec3(-0.045, 1.11, -0.66)),
    // Lines on the four screens.
    Still(vec3(-0.70, 1.28, -0.70)),
    Still(vec3(-0.62, 1.15, -0.67)),
    Still(vec3(-0.36, 1.22, -0.69)),
    Still(vec3(-0.42, 1.12, -0.66)),
    Still(vec3(0.33, 1.30, -0.71)),
    Still(vec3(0.45, 1.17, -0.67)),
    Still(vec3(0.62, 1.28, -0.70)),
    // The checklist, labels, the glare shield, the runway's end, a hill.
    Still(vec3(0.46, 1.08, -0.38)),
    Still(vec3(0.2, 1.03, -0.63)),
    Still(vec3(-0.05, 1.46, -0.655)),
    Still(vec3(0.0, 0.5, -60.0)),
    Still(vec3(-50.0, 6.0, -130.0)),
    Moving(cockpit::sign_at),
];

const FOLIAGE: [HeadKey; 5] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    at(3.0, [0.15, -0.05, -0.2], [16.0, -8.0, 1.0]),
    at(6.0, [0.0, 0.0, -0.4], [-6.0, 12.0, -1.0]),
    at(9.0, [-0.15, -0.1, -0.5], [-22.0, -10.0, 2.0]),
    at(12.0, [0.0, 0.0, -0.5], [0.0, 2.0, 0.0]),
];
const FOLIAGE_TARGETS: [Target; 12] = [
    Still(vec3(0.7, 1.8, -7.2)),
    Still(vec3(-1.9, 1.4, -3.2)),
    Still(vec3(2.3, 2.2, -3.9)),
    Still(vec3(-2.4, 3.6, -8.6)),
    Still(vec3(1.2, 3.9, -6.4)),
    Still(vec3(0.4, 0.2, -2.4)),
    Still(vec3(-0.8, 0.5, -2.8)),
    Still(vec3(2.0, 0.7, -2.6)),
    Still(vec3(-3.4, 2.4, -4.6)),
    Still(vec3(-0.8, 1.9, -14.0)),
    Still(vec3(3.0, 1.2, -8.0)),
    Moving(foliage::butterfly_at),
];

const LIBRARY: [HeadKey; 6] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, -4.0, 0.0]),
    at(2.5, [-0.1, 0.0, 0.1], [26.0, -2.0, 1.0]),
    at(5.0, [0.0, -0.03, -0.1], [4.0, -16.0, 0.0]),
    at(7.5, [0.1, 0.0, 0.0], [-26.0, 2.0, -1.0]),
    at(10.0, [0.0, 0.0, -0.2], [-6.0, -5.0, 0.0]),
    at(12.0, [0.0, 0.0, -0.2], [0.0, -6.0, 0.0]),
];
const LIBRARY_TARGETS: [Target; 17] = [
    // Spines on the left and on the right.
    Still(vec3(-1.55, 1.38, -2.2)),
    Still(vec3(-1.55, 1.75, -3.1)),
    Still(vec3(-1.55, 1.05, -2.8)),
    Still(vec3(-1.55, 1.40, -4.4)),
    Still(vec3(-1.55, 2.10, -3.6)),
    Still(vec3(1.55, 1.38, -2.3)),
    Still(vec3(1.55, 1.75, -3.0)),
    Still(vec3(1.55, 1.05, -2.7)),
    Still(vec3(1.55, 1.40, -4.6)),
    Still(vec3(1.55, 0.70, -3.4)),
    // Open books, a lamp, the globe, the clock, the end.
    Still(vec3(-0.28, 0.8, -2.0)),
    Still(vec3(0.22, 0.8, -2.5)),
    Still(vec3(0.4, 1.1, -1.95)),
    Still(vec3(0.3, 1.05, -3.25)),
    Still(vec3(0.0, 1.9, -9.2)),
    Still(vec3(-0.6, 1.5, -11.6)),
    Moving(library::lantern_at),
];

const INTERIOR: [HeadKey; 5] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, -2.0, 0.0]),
    at(3.0, [0.3, 0.0, -0.2], [14.0, -8.0, 1.0]),
    at(6.0, [-0.2, -0.05, -0.4], [-12.0, 2.0, -1.0]),
    at(9.0, [-0.4, 0.0, -0.2], [-20.0, -10.0, 0.0]),
    at(12.0, [0.0, 0.0, 0.0], [2.0, -2.0, 0.0]),
];
const INTERIOR_TARGETS: [Target; 14] = [
    Still(vec3(-1.75, 1.1, -2.9)),
    Still(vec3(0.0, 1.7, -5.0)),
    Still(vec3(-0.6, 1.6, -2.2)),
    Still(vec3(1.9, 1.55, -3.1)),
    Still(vec3(2.0, 1.2, -2.6)),
    Still(vec3(3.0, 1.3, -2.0)),
    Still(vec3(0.2, 0.0, -3.0)),
    Still(vec3(-3.2, 1.4, -5.0)),
    Still(vec3(2.6, 1.9, -5.0)),
    Still(vec3(1.0, 3.0, -3.2)),
    Still(vec3(-3.6, 1.4, -3.0)),
    Still(vec3(0.9, 2.4, -5.0)),
    Moving(sphere),
    Moving(sphere_in_the_mirror),
];

fn sphere(t: f64) -> Vec3 {
    interior::ball_at(0, t)
}

fn sphere_in_the_mirror(t: f64) -> Vec3 {
    interior::mirrored(interior::ball_at(2, t))
}

const STREET: [HeadKey; 5] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    at(3.0, [0.05, 0.02, -0.9], [-12.0, 6.0, 1.0]),
    at(6.0, [-0.05, 0.0, -1.8], [10.0, 10.0, -1.0]),
    at(9.0, [0.05, 0.02, -2.7], [18.0, -4.0, 0.0]),
    at(12.0, [0.0, 0.0, -3.6], [-2.0, 0.0, 0.0]),
];
const STREET_TARGETS: [Target; 16] = [
    Still(vec3(0.0, 1.5, -60.0)),
    Still(vec3(-5.4, 3.35, -14.0)),
    Still(vec3(5.4, 3.35, -9.5)),
    Still(vec3(5.4, 3.35, -18.5)),
    Still(vec3(-6.5, 4.6, -11.0)),
    Still(vec3(-6.5, 7.1, -16.0)),
    Still(vec3(6.5, 4.6, -17.0)),
    Still(vec3(6.5, 2.0, -15.0)),
    Still(vec3(-4.1, 1.0, -8.0)),
    Still(vec3(4.1, 1.0, -9.5)),
    Still(vec3(0.3, 0.0, -7.6)),
    Still(vec3(-1.9, 5.4, -18.0)),
    Still(vec3(0.0, 6.0, -15.0)),
    Still(vec3(2.0, 7.2, -20.0)),
    Moving(oncoming_car),
    Moving(car_ahead),
];

fn oncoming_car(t: f64) -> Vec3 {
    street::car_at(0, t) + Vec3::Y * 0.8
}

fn car_ahead(t: f64) -> Vec3 {
    street::car_at(3, t) + Vec3::Y * 0.8
}

const CROWD: [HeadKey; 5] = [
    at(0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    at(3.0, [0.1, 0.0, 0.1], [18.0, -2.0, 1.0]),
    at(6.0, [0.0, 0.02, 0.0], [-4.0, 4.0, 0.0]),
    at(9.0, [-0.1, 0.0, 0.1], [-22.0, -3.0, -1.0]),
    at(12.0, [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
];
const CROWD_TARGETS: [Target; 14] = [
    Still(vec3(0.5, 3.3, -21.9)),
    Still(vec3(-8.0, 3.3, -21.9)),
    Still(vec3(8.0, 3.3, -21.9)),
    Still(vec3(-3.0, 6.0, -22.0)),
    Still(vec3(-2.0, 3.2, -6.0)),
    Still(vec3(2.0, 3.2, -6.0)),
    Still(vec3(0.0, 0.0, -5.0)),
    Moving(|t| crowd::face_at(26, t)),
    Moving(|t| crowd::face_at(112, t)),
    Moving(|t| crowd::face_at(64, t)),
    Moving(|t| crowd::face_at(110, t)),
    Moving(|t| crowd::face_at(77, t)),
    Moving(|t| crowd::face_at(28, t)),
    Moving(|t| crowd::face_at(41, t)),
];
