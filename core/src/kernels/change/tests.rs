//! Definition of a change.

use super::{ChangeParams, DARK};
use crate::geometry::{Fov, View};
use crate::reuse::{Picture, Reuse, StaleTiles};
use glam::{Quat, Vec2, Vec3};
use proptest::prelude::*;

const EXTENT: [u32; 2] = [256, 192];
const FOV: Fov = Fov { left: -0.7, right: 0.7, up: 0.6, down: -0.6 };

fn tiles() -> StaleTiles {
    let mut tiles = StaleTiles::default();
    tiles.set(EXTENT, [16; 2], &[0; 16 * 12]);
    tiles
}

fn view(yaw_deg: f32) -> View {
    View { orientation: Quat::from_rotation_y(yaw_deg.to_radians()), plane: FOV.tangents().plane(EXTENT) }
}

fn params(now_deg: f32, before_deg: f32) -> ChangeParams {
    let stale = tiles();
    let [now, before] = [now_deg, before_deg].map(|yaw| Picture {
        view: view(yaw),
        extent: EXTENT,
        stale: &stale,
        viewpoint: None,
    });
    ChangeParams::new(&Reuse::new(now, [before], true), 1, [0; 2], [0; 2], EXTENT).unwrap()
}

/// The world in a direction, seen at a point of the texture of a picture that is turned so.
fn seen(yaw_deg: f32, world: impl Fn(Vec3) -> f32) -> impl Fn(Vec2) -> Vec3 {
    let view = view(yaw_deg);
    move |at| {
        let pixel = at * Vec2::new(EXTENT[0] as f32, EXTENT[1] as f32);
        Vec3::splat(world((view.orientation * view.plane.direction(pixel)).normalize()))
    }
}

fn stripes(direction: Vec3) -> f32 {
    0.5 + 0.4 * (40.0 * direction.x).sin() * (31.0 * direction.y).cos()
}

#[test]
fn a_world_that_stands_still_has_not_changed_however_the_head_turns() {
    for (now, before) in [(0.0, 0.0), (3.0, 1.0), (-2.0, 4.0)] {
        let params = params(now, before);
        for tile in [[2, 3], [7, 5], [9, 8]] {
            let change = params.change(tile, seen(now, stripes), seen(before, stripes));
            assert!(change < 1e-4, "{change} in {tile:?} from {before} to {now} degrees");
        }
    }
}

#[test]
fn a_tenth_more_luminance_is_a_change_of_a_tenth() {
    for level in [0.01, 0.3, 1.0] {
        let change = params(0.0, 0.0).change([4, 4], |_| Vec3::splat(level * 1.1), |_| Vec3::splat(level));
        let expected = 0.1 * level / (1.05 * level + DARK);
        assert!((change - expected).abs() < 1e-4, "{change}, not {expected}");
    }
}

#[test]
fn something_small_in_a_quarter_of_a_tile_is_enough() {
    // 6 x 6 pixels of a part of 8 x 8: a sample of four.
    let object = |at: Vec2| {
        let pixel = at * Vec2::new(256.0, 192.0) - Vec2::new(64.0, 64.0);
        let is_there = pixel.cmpge(Vec2::ZERO).all() && pixel.cmplt(Vec2::splat(4.0)).all();
        Vec3::splat(if is_there { 0.8 } else { 0.2 })
    };
    let change = params(0.0, 0.0).change([4, 4], object, |_| Vec3::splat(0.2));
    assert!(change > 0.5, "{change}");
    assert_eq!(params(0.0, 0.0).change([5, 4], object, |_| Vec3::splat(0.2)), 0.0);
}

proptest! {
    #[test]
    fn is_never_negative_nor_without_a_meaning(
        new in prop::array::uniform3(prop::num::f32::ANY),
        old in prop::array::uniform3(prop::num::f32::ANY),
        turn in -5.0f32..5.0,
        tile in prop::array::uniform2(0u32..20),
    ) {
        let change = params(turn, 0.0).change(tile, |_| Vec3::from(new), |_| Vec3::from(old));
        prop_assert!(change.is_finite() && change >= 0.0);
    }

    #[test]
    fn is_the_same_from_either_picture(a in 0.0f32..1.0, b in 0.0f32..1.0) {
        let params = params(0.0, 0.0);
        let [there, back] = [[a, b], [b, a]]
            .map(|[new, old]| params.change([1, 1], |_| Vec3::splat(new), |_| Vec3::splat(old)));
        prop_assert!((there - back).abs() < 1e-5);
    }
}
