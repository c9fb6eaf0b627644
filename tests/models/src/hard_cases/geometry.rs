//! Hard cases of `geometry`.

use super::Case;
use crate::reference::geometry as reference;
use glam::{DVec3, Quat, Vec2, Vec3, Vec4};
use parafovea_core::geometry::{
    DepthRange, Fov, MAX_VIEW_DISTANCE_M, PixelRect, Reprojection, View, eccentricity, pixels_per_degree,
    tile_eccentricity, view_distance,
};
use std::f32::consts::{FRAC_PI_4, PI};
use std::f64::consts::PI as WIDE_PI;

const MODEL: &str = "geometry";
const EXTENT: [u32; 2] = [2160, 2160];
const STRAIGHT: Fov = Fov { left: -0.9, right: 0.9, up: 0.9, down: -0.9 };

pub(super) fn cases() -> Vec<Case> {
    [angles(), gazes(), rotations(), fields_of_view(), depths()].concat()
}

fn case(case: impl Into<String>, expected: impl Into<String>, got: impl Into<String>, passed: bool) -> Case {
    Case { model: MODEL, case: case.into(), expected: expected.into(), got: got.into(), error: None, passed }
}

/// Tiny angles and those near 180 degrees, of which acos would know nothing.
fn angles() -> Vec<Case> {
    let tiny = [0.0, 1e-9, 1e-8, 1e-7, 1e-6];
    let of = |angle: f64| {
        let towards = DVec3::new(angle.sin(), 0.0, -angle.cos()).as_vec3();
        let found = eccentricity(Vec3::NEG_Z, towards);
        let expected = reference::eccentricity(DVec3::NEG_Z, towards.as_dvec3());
        let error = (f64::from(found) - expected).abs();
        // Relative below a radian; near pi the direction itself is rounded.
        let passed = error <= 1e-6 * expected.min(1.0) && found.is_finite();
        Case {
            error: Some(error),
            ..case(format!("{angle:e} rad"), format!("{expected:e} rad"), format!("{found:e}"), passed)
        }
    };
    let straight = tiny.into_iter().map(of);
    let opposite = tiny.into_iter().map(|angle| {
        let made = of(WIDE_PI - angle);
        Case { case: format!("180 degrees - {angle:e} rad"), ..made }
    });
    let huge_and_small = {
        let found = eccentricity(Vec3::new(3e38, 3e38, 0.0), Vec3::new(0.0, 1e-38, 0.0));
        let error = (f64::from(found) - WIDE_PI / 4.0).abs();
        let made = case("lengths of 4e38 and 1e-38", "pi/4 rad", format!("{found}"), error < 1e-6);
        Case { error: Some(error), ..made }
    };
    straight.chain(opposite).chain([huge_and_small]).collect()
}

/// A gaze off the screen, beside, behind, or none: range of a tile's eccentricity.
fn gazes() -> Vec<Case> {
    let plane = STRAIGHT.tangents().plane(EXTENT);
    let tile = PixelRect { min: Vec2::splat(1072.0), max: Vec2::splat(1088.0) };
    // By points of the tile, including its middle and points on its edges.
    let range = |gaze: Vec3| {
        let at = |index: u32| 1072.0 + index as f32 * 0.25;
        let points = (0..=64).flat_map(|y| (0..=64).map(move |x| Vec2::new(at(x), at(y))));
        points
            .map(|point| reference::eccentricity(gaze.as_dvec3(), plane.direction(point).as_dvec3()))
            .fold((WIDE_PI, 0.0f64), |(low, high), angle| (low.min(angle), high.max(angle)))
    };
    let known = [
        ("off the screen", Vec3::new(3.0, 0.0, -1.0)),
        ("at 90 degrees", Vec3::X),
        ("behind", Vec3::new(0.3, 0.0, 1.0)),
        ("straight behind", Vec3::Z),
        ("off the screen, of length 1e38", Vec3::new(3e38, 0.0, -1e38)),
        ("off the screen, of length 1e-38", Vec3::new(3e-38, 0.0, -1e-38)),
    ];
    let known = known.into_iter().map(|(name, gaze)| {
        let found = tile_eccentricity(&plane, tile, gaze);
        let (low, high) = range(gaze);
        let error = (f64::from(found.min) - low).abs().max((f64::from(found.max) - high).abs());
        let made = case(
            format!("gaze {name}, tile ahead"),
            format!("{low:.6} to {high:.6} rad"),
            format!("{:.6} to {:.6}", found.min, found.max),
            error < 2e-6,
        );
        Case { error: Some(error), ..made }
    });
    let lost = [("zero", Vec3::ZERO), ("NaN", Vec3::NAN), ("infinite", Vec3::INFINITY)];
    let lost = lost.into_iter().map(|(name, gaze)| {
        let found = tile_eccentricity(&plane, tile, gaze);
        let pixel = eccentricity(gaze, plane.direction(Vec2::splat(100.5)));
        let got = format!("{} to {}, pixel {pixel}", found.min, found.max);
        case(
            format!("gaze {name}"),
            "0 everywhere",
            got,
            found.min == 0.0 && found.max == 0.0 && pixel == 0.0,
        )
    });
    known.chain(lost).collect()
}

fn view(orientation: Quat) -> View {
    View { orientation, plane: STRAIGHT.tangents().plane(EXTENT) }
}

fn rotations() -> Vec<Case> {
    let turned = Quat::from_rotation_y(0.2);
    let at = Vec2::new(700.0, 1500.0);
    let map = |to: Quat| Reprojection::between(&view(Quat::IDENTITY), &view(to));
    let plain = map(turned).and_then(|map| map.pixel(at));
    let scaled = |factor: f32| Quat::from_vec4(Vec4::from(turned) * factor);
    let same =
        [("-q", -1.0f32), ("1e30 q", 1e30), ("1e-30 q", 1e-30), ("0.5 q", 0.5)].map(|(name, factor)| {
            let found = map(scaled(factor)).and_then(|map| map.pixel(at));
            let apart = plain.zip(found).map(|(a, b)| f64::from(a.distance(b)));
            let made = case(
                format!("quaternion {name}"),
                "the same pixel as with q",
                found.map_or("none".to_owned(), |found| found.to_string()),
                apart.is_some_and(|apart| apart < 5e-3),
            );
            Case { error: apart, ..made }
        });
    let none = [
        ("zero", Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        ("NaN", Quat::NAN),
        ("infinite", Quat::from_xyzw(0.0, f32::INFINITY, 0.0, 1.0)),
    ]
    .map(|(name, wrong)| {
        let found = map(wrong);
        case(
            format!("quaternion {name}"),
            "no map",
            if found.is_none() { "none" } else { "some" },
            found.is_none(),
        )
    });
    let beside = [("w = 0, at 90 degrees", PI / 2.0), ("w < 0, behind", PI)].map(|(name, angle)| {
        let ahead = Vec2::splat(1080.0);
        let found = map(Quat::from_rotation_y(angle)).and_then(|map| map.pixel(ahead));
        // At exactly 90 degrees rounding may leave it a hair ahead: then it is far outside.
        let passed = found.is_none_or(|found| found.is_finite() && found.abs().max_element() > 1e6);
        case(format!("pixel ahead, {name}"), "nowhere, or far outside", format!("{found:?}"), passed)
    });
    [same.to_vec(), none.to_vec(), beside.to_vec()].concat()
}

fn fields_of_view() -> Vec<Case> {
    let flipped = Fov { left: 0.9, right: -0.9, up: -0.9, down: 0.9 };
    let zero = Fov { left: 0.4, right: 0.4, up: 0.4, down: 0.4 };
    let wide = Fov { left: -PI, right: f32::INFINITY, up: f32::NAN, down: -2.0 };
    let flips = {
        let (straight, flipped) = (STRAIGHT.tangents().plane(EXTENT), flipped.tangents().plane(EXTENT));
        let at = Vec2::new(300.0, 500.0);
        let (a, b) = (straight.direction(at), flipped.direction(Vec2::splat(2160.0) - at));
        let density =
            [pixels_per_degree(&straight, at), pixels_per_degree(&flipped, Vec2::splat(2160.0) - at)];
        case(
            "fov flipped both ways",
            "the opposite pixel looks the same way",
            format!("{:.1e} apart, {density:.2?} ppd", a.distance(b)),
            a.distance(b) < 1e-6 && (density[0] - density[1]).abs() < 1e-4,
        )
    };
    let zero = {
        let plane = zero.tangents().plane(EXTENT);
        let (ray, density) =
            (plane.direction(Vec2::splat(1000.0)), pixels_per_degree(&plane, Vec2::splat(1000.0)));
        let map = Reprojection::between(&view(Quat::IDENTITY), &View { orientation: Quat::IDENTITY, plane });
        case(
            "fov of zero",
            "one direction, 0 ppd, no map to it",
            format!("{ray}, {density} ppd"),
            ray.is_finite() && density == 0.0 && map.is_none(),
        )
    };
    let wide = {
        let plane = wide.tangents().plane([0, u32::MAX]);
        let ray = plane.direction(Vec2::new(1.0, 4e9));
        case("fov beyond 180 degrees, infinite and NaN", "finite", format!("{ray}"), ray.is_finite())
    };
    let canted = {
        // One direction seen from two displays that are turned by 10 degrees each way.
        let world = Vec3::new(0.1, 0.2, -1.0);
        let gaze = Vec3::new(-0.2, 0.0, -1.0);
        let eye = |cant: f32| {
            let back = Quat::from_rotation_y(cant).inverse();
            eccentricity(back * gaze, back * world)
        };
        let cant = 10f32.to_radians();
        let (left, right) = (eye(cant), eye(-cant));
        let error = (f64::from(left) - reference::eccentricity(gaze.as_dvec3(), world.as_dvec3())).abs();
        let made = case(
            "canted by 10 degrees",
            "both eyes the same",
            format!("{left}, {right}"),
            (left - right).abs() < 1e-6,
        );
        Case { error: Some(error), ..made }
    };
    let sideways = {
        let quarter = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };
        let plane = quarter.tangents().plane([8192, 8192]);
        let density = f64::from(pixels_per_degree(&plane, Vec2::new(8192.0, 4096.0)));
        let expected = 4096.0 * 2f64.sqrt() * (WIDE_PI / 180.0);
        let error = (density - expected).abs();
        let made = case(
            "8192 pixels, at the edge of 90 degrees",
            format!("{expected:.4} ppd"),
            format!("{density:.4}"),
            error < 1e-3,
        );
        Case { error: Some(error), ..made }
    };
    vec![flips, zero, wide, canted, sideways]
}

fn depths() -> Vec<Case> {
    let usual = DepthRange { min_depth: 0.0, max_depth: 1.0, near_z: 0.1, far_z: 100.0 };
    let endless = DepthRange { far_z: f32::INFINITY, ..usual };
    let reversed = DepthRange { near_z: f32::INFINITY, far_z: 0.1, ..usual };
    let known = [
        ("infinite far plane, depth .99", 0.99f32, endless),
        ("reversed and infinite, depth .01", 0.01, reversed),
        ("reversed, depth .5", 0.5, DepthRange { near_z: 100.0, far_z: 0.1, ..usual }),
        ("depth within .25 to .75", 0.6, DepthRange { min_depth: 0.25, max_depth: 0.75, ..usual }),
    ]
    .map(|(name, depth, range)| {
        let found = f64::from(view_distance(depth, &range));
        let bounds = [range.min_depth, range.max_depth].map(f64::from);
        let expected =
            reference::view_distance(depth.into(), bounds, range.near_z.into(), range.far_z.into());
        let error = (found - expected).abs();
        let made = case(name, format!("{expected:.6} m"), format!("{found:.6}"), error < 1e-5 * expected);
        Case { error: Some(error), ..made }
    });
    let far = [
        ("depth of the infinite plane", 1.0f32, endless),
        ("depth of the infinite plane, reversed", 0.0, reversed),
        ("depth NaN", f32::NAN, usual),
        ("plane at 0", 0.5, DepthRange { near_z: 0.0, ..usual }),
        ("equal bounds of depth", 0.5, DepthRange { min_depth: 0.5, max_depth: 0.5, ..usual }),
    ]
    .map(|(name, depth, range)| {
        let found = view_distance(depth, &range);
        case(name, format!("{MAX_VIEW_DISTANCE_M} m"), format!("{found}"), found == MAX_VIEW_DISTANCE_M)
    });
    [known.to_vec(), far.to_vec()].concat()
}
