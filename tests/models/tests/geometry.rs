//! Geometry against rays and angles in double precision.

use glam::{DQuat, DVec2, Quat, Vec2, Vec3};
use parafovea_core::geometry::{
    DepthRange, Fov, Reprojection, View, eccentricity, pixels_per_degree, view_distance,
};
use parafovea_models::reference::geometry::{self as reference, Image};
use proptest::prelude::*;

const EXTENT: [u32; 2] = [1440, 1600];

/// A view whose edges are at these angles, in both precisions.
fn image([left, right, up, down]: [f32; 4]) -> (Fov, Image) {
    let wide = [left, right, up, down].map(f64::from);
    (Fov { left, right, up, down }, Image::new(wide, EXTENT.map(f64::from)))
}

fn angles() -> impl Strategy<Value = [f32; 4]> {
    let edges = (-1.1f32..-0.2, 0.2f32..1.1, 0.2f32..1.1, -1.1f32..-0.2);
    (edges, any::<bool>()).prop_map(
        |((left, right, up, down), mirrored)| {
            if mirrored { [right, left, up, down] } else { [left, right, up, down] }
        },
    )
}

fn turned() -> impl Strategy<Value = Quat> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, -0.8f32..0.8).prop_filter_map("no axis", |(x, y, z, angle)| {
        Some(Quat::from_axis_angle(Vec3::new(x, y, z).try_normalize()?, angle))
    })
}

fn pixel() -> impl Strategy<Value = Vec2> {
    (0.0f32..1440.0, 0.0f32..1600.0).prop_map(|(x, y)| Vec2::new(x, y))
}

/// The paper B headset: a focal length of 555 pixels gives 9.69 pixels per degree ahead.
#[test]
fn pixels_per_degree_of_a_headset() {
    let (half_width, half_height) = ((720.0f32 / 555.0).atan(), (800.0f32 / 555.0).atan());
    let plane = Fov { left: -half_width, right: half_width, up: half_height, down: -half_height };
    let found = pixels_per_degree(&plane.tangents().plane(EXTENT), Vec2::new(720.0, 800.0));
    assert!((found - 9.69).abs() < 0.005, "{found}");
    assert!((half_width.to_degrees() * 2.0 - 104.8).abs() < 0.1);
}

proptest! {
    #[test]
    fn angles_to_1e_6(x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0, u in -1.0f32..1.0, v in -1.0f32..1.0) {
        let (a, b) = (Vec3::new(x, y, z), Vec3::new(u, v, -1.0));
        prop_assume!(a.length() > 1e-3);
        let difference = f64::from(eccentricity(a, b)) - reference::eccentricity(a.as_dvec3(), b.as_dvec3());
        prop_assert!(difference.abs() < 1e-6, "{difference}");
    }

    #[test]
    fn pixels_per_degree_to_1e_5(angles in angles(), pixel in pixel()) {
        let (fov, image) = image(angles);
        let found = f64::from(pixels_per_degree(&fov.tangents().plane(EXTENT), pixel));
        let expected = image.pixels_per_degree(pixel.as_dvec2());
        prop_assert!((found / expected - 1.0).abs() < 1e-5, "{found}, not {expected}");
    }

    #[test]
    fn reprojection_to_a_fiftieth_of_a_pixel(a in angles(), b in angles(), from in turned(), to in turned(), at in pixel()) {
        let ((from_fov, from_image), (to_fov, to_image)) = (image(a), image(b));
        let view = |fov: Fov, orientation| View { orientation, plane: fov.tangents().plane(EXTENT) };
        let map = Reprojection::between(&view(from_fov, from), &view(to_fov, to)).unwrap();
        let wide = |q: Quat| DQuat::from_array(q.to_array().map(f64::from)).normalize();
        let expected = reference::reprojected(at.as_dvec2(), &from_image, &to_image, wide(from), wide(to));
        // Within the image and somewhat beyond; farther out a pixel is less and less of an angle.
        let near = |pixel: &DVec2| pixel.abs().max_element() < 4000.0;
        if let Some(expected) = expected.filter(near) {
            let found = map.pixel(at).unwrap().as_dvec2();
            prop_assert!(found.distance(expected) < 0.02, "{found}, not {expected}");
        }
    }

    #[test]
    fn distances_by_depth(depth in 0.0f32..0.99, near in 0.01f32..1.0, far in 10.0f32..1000.0, reversed: bool) {
        let (near_z, far_z) = if reversed { (far, near) } else { (near, far) };
        let range = DepthRange { min_depth: 0.0, max_depth: 1.0, near_z, far_z };
        let found = f64::from(view_distance(depth, &range));
        let expected = reference::view_distance(depth.into(), [0.0, 1.0], near_z.into(), far_z.into());
        prop_assert!((found / expected - 1.0).abs() < 1e-5, "{found}, not {expected}");
    }
}
