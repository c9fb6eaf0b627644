use super::*;
use crate::errors::clip::Picture;
use parafovea_core::geometry::Fov;
use std::f32::consts::FRAC_PI_4;

fn eye(gaze: Vec3) -> Eye {
    let fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };
    Eye { picture: Picture::from_linear(64, 64, |_, _| [0.5; 3]), fov, gaze, age: None }
}

fn texture(moved: f32) -> Plane {
    Plane::from_fn(64, 64, |x, y| {
        let x = x as f32 - moved;
        50.0 + 20.0 * (0.5 * x + 0.1 * y as f32).sin() + 10.0 * (0.83 * x - 0.2 * y as f32).cos()
    })
}

#[test]
fn shifts_are_found_within_a_twentieth_of_a_pixel() {
    let reference = texture(0.0);
    for moved in [-5.0, -1.7, -0.25, 0.1, 0.5, 1.0, 3.3, 7.4] {
        let test = texture(moved);
        let shift = Window { reference: &reference, test: &test, origin: [16, 16] }.shift().unwrap();
        assert!((shift - moved).abs() < 0.05, "{moved}: {shift}");
    }
}

#[test]
fn other_changes_are_no_shift() {
    let reference = texture(0.0);
    let mut dimmed = reference.clone();
    dimmed.texels_mut().iter_mut().for_each(|value| *value = 0.8 * *value + 10.0);
    let window = |test: &Plane| Window { reference: &reference, test, origin: [32, 0] }.shift();
    assert_eq!((window(&reference), window(&dimmed)), (Some(0.0), Some(0.0)));
    let flat = Plane::filled(64, 64, 3.0);
    assert_eq!(Window { reference: &flat, test: &reference, origin: [0, 0] }.shift(), None);
}

#[test]
fn partners_lie_at_the_same_angle_from_the_gaze() {
    // The right eye looks 10 degrees farther to the left: the point at the left eye's gaze has its partner there.
    let left = Vec3::new(0.2, 0.1, -1.0);
    let right = Quat::from_rotation_y(0.17) * left;
    let field = Field::new(&eye(right));
    let found = pixel(&field, turn(left, right) * left).unwrap();
    let expected = (right.truncate() / -right.z - field.plane.origin) / field.plane.step;
    assert!((found - expected).length() < 1e-3, "{found} {expected}");
    assert_eq!(pixel(&field, Vec3::X), None);
}

#[test]
fn ages_are_compared_between_partners() {
    let mut eyes = [eye(Vec3::NEG_Z), eye(Vec3::NEG_Z)];
    let fields = [Field::new(&eyes[0]), Field::new(&eyes[1])];
    assert_eq!(age([&eyes[0], &eyes[1]], [&fields[0], &fields[1]]), [None; 16]);
    eyes[0].age = Some(Plane::from_fn(4, 4, |x, _| x as f32));
    eyes[1].age = Some(Plane::filled(1, 1, 1.0));
    let found = age([&eyes[0], &eyes[1]], [&fields[0], &fields[1]]);
    assert_eq!(found[4..8], [Some(1.0), Some(0.0), Some(1.0), Some(2.0)]);
}

#[test]
fn partners_follow_each_eyes_gaze() {
    // Each eye looks at the middle of one tile, which is 7 frames old: they agree there.
    let looking = |x: f32, tile: u32| {
        let mut eye = eye(Vec3::new(x, 0.25, -1.0));
        eye.age = Some(Plane::from_fn(4, 4, |x, y| if (x, y) == (tile, 1) { 7.0 } else { 0.0 }));
        eye
    };
    let eyes = [looking(-0.25, 1), looking(0.25, 2)];
    let fields = [Field::new(&eyes[0]), Field::new(&eyes[1])];
    assert_eq!(age([&eyes[0], &eyes[1]], [&fields[0], &fields[1]])[5], Some(0.0));
}
