//! Contrast that was measured while the head was turned elsewhere.

use super::*;
use crate::geometry::Fov;
use crate::image::Plane;
use crate::plan::TEXEL_SIDES;
use glam::EulerRot;
use proptest::prelude::*;

const FOV: Fov = Fov { left: -0.8, right: 0.7, up: 0.75, down: -0.7 };

fn params(extent: [u32; 2], overhang: [u32; 2], texel: [u32; 2]) -> DecideParams {
    let plane = FOV.tangents().plane(extent);
    DecideParams {
        plane_origin: plane.origin.into(),
        plane_step: plane.step.into(),
        extent,
        overhang,
        texel,
        tiles: [0, 1].map(|axis| (extent[axis] + overhang[axis]).div_ceil(texel[axis])),
        ..bytemuck::Zeroable::zeroed()
    }
}

fn view(orientation: Quat, extent: [u32; 2]) -> View {
    View { orientation, plane: FOV.tangents().plane(extent) }
}

/// A map whose contrast identifies the tile.
fn numbered(params: &DecideParams) -> ContrastMap {
    let [columns, rows] = params.tiles;
    let tile = |x: u32, y: u32| TileContrast {
        bands: [(y * columns + x) as f32, x as f32, y as f32, 1.0],
        adaptation_cd_m2: x as f32,
    };
    ContrastMap { tiles: Plane::from_fn(columns, rows, tile) }
}

#[test]
fn a_head_at_rest_leaves_tiles_where_they_were() {
    let params = params([500, 333], [9, 3], [16, 16]);
    let map = numbered(&params);
    for tremor in [0.0, 5e-4] {
        let turned = params.measured_in(&view(Quat::IDENTITY, params.extent), Quat::from_rotation_y(tremor));
        assert_eq!(turned.is_turned, 0);
        for (index, tile) in (0..).zip(map.tiles.texels()) {
            assert_eq!(turned.contrast(&map, index), *tile);
        }
    }
    let nonsense = params.measured_in(&view(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), [1, 1]), Quat::IDENTITY);
    assert_eq!(nonsense.is_turned, 0, "no orientation");
}

/// To the left by as much as two tiles are wide in the middle.
#[test]
fn a_head_that_turned_finds_tiles_beside() {
    let params = params([512, 512], [0; 2], [16, 16]);
    let map = numbered(&params);
    let two_tiles = 32.0 * params.plane_step[0];
    let turned =
        params.measured_in(&view(Quat::IDENTITY, params.extent), Quat::from_rotation_y(two_tiles.atan()));
    assert_eq!(turned.is_turned, 1);
    let [columns, _] = params.tiles;
    // The centre of the view is in tile 17; there a current tile lies on one or two earlier tiles.
    let ahead = turned.contrast(&map, 16 * columns + 17);
    assert!((14.0..=16.0).contains(&ahead.bands[1]), "{ahead:?}");
    let edge = turned.contrast(&map, 16 * columns);
    assert_eq!(edge.bands[1], 0.0, "what was not in the picture shows what its border did");
    let behind = params.measured_in(&view(Quat::IDENTITY, params.extent), Quat::from_rotation_y(3.0));
    assert!(behind.contrast(&map, 16 * columns + 17).bands[0].is_nan());
}

proptest! {
    /// The middle of a tile was in one of the tiles whose contrast it gets.
    #[test]
    fn the_tile_that_showed_it_counts(
        turn in prop::array::uniform3(-0.3f32..0.3), extent in prop::array::uniform2(40u32..400),
        side in TEXEL_SIDES, x in 0.0f32..1.0, y in 0.0f32..1.0,
    ) {
        let params = params(extent, [0; 2], [side; 2]);
        let now = Quat::from_euler(EulerRot::YXZ, turn[0], turn[1], turn[2]);
        let measured = view(Quat::IDENTITY, extent);
        let turned = params.measured_in(&measured, now);
        let [columns, rows] = params.tiles;
        let tile = [(x * columns as f32) as u32, (y * rows as f32) as u32];
        let middle = (UVec2::from(tile).as_vec2() + 0.5) * side as f32;
        let shown = Reprojection::between(&view(now, extent), &measured).unwrap().pixel(middle);
        let Some(pixel) = shown.filter(|at| at.cmpgt(Vec2::ZERO).all() && at.cmplt(UVec2::from(extent).as_vec2()).all()) else {
            return Ok(());
        };
        let was = (pixel / side as f32).as_uvec2();
        let marked = |x: u32, y: u32| TileContrast {
            bands: [f32::from([x, y] == [was.x, was.y]); BANDS],
            ..TileContrast::default()
        };
        let map = ContrastMap { tiles: Plane::from_fn(columns, rows, marked) };
        prop_assert_eq!(turned.contrast(&map, tile[1] * columns + tile[0]).bands, [1.0; BANDS]);
    }
}

/// One eye with a sharp tile and the other with a coarse one rival.
#[test]
fn a_direction_is_at_full_rate_in_both_eyes_at_once() {
    let (outward, inward) = (54.0f32.to_radians(), 40.0f32.to_radians());
    let (extent, texel, period) = ([1152, 1152], [16, 16], 360);
    let views = [[-outward, inward], [-inward, outward]].map(|[left, right]| {
        let plane = Fov { left, right, up: 0.8, down: -0.9 }.tangents().plane(extent);
        let (plane_origin, plane_step) = (plane.origin.into(), plane.step.into());
        DecideParams { plane_origin, plane_step, ..params(extent, [0; 2], texel) }
    });
    let mut in_frames = Vec::new();
    for frame in 0..period {
        let [left, right] = views.map(|view| view.with_full_rate_period(period, frame.into()));
        let looks = |view: &DecideParams, [column, row]: [u32; 2]| {
            view.is_full_rate_frame(row * view.tiles[0] + column)
        };
        let all = (0..left.tiles[1]).flat_map(|row| (0..left.tiles[0]).map(move |column| [column, row]));
        let seen: Vec<[u32; 2]> = all.filter(|tile| looks(&left, *tile)).collect();
        in_frames.push(seen.len());
        for [column, row] in seen {
            // The same direction in the other eye, in tiles.
            let tangent = left.plane_origin[0] + left.plane_step[0] * 16.0 * (column as f32 + 0.5);
            let other = (tangent - right.plane_origin[0]) / right.plane_step[0] / 16.0;
            let inside = (1.0..right.tiles[0] as f32 - 1.0).contains(&other);
            let near = [-1.0, 0.0, 1.0].map(|beside| looks(&right, [(other + beside) as u32, row]));
            assert!(!inside || near.contains(&true), "tile {column}, {row} in frame {frame}");
        }
    }
    let mean = 72.0 * 72.0 / f64::from(period);
    let most = in_frames.iter().copied().max().unwrap_or_default() as f64;
    assert!(in_frames.iter().sum::<usize>() == 72 * 72 && most < 3.0 * mean, "{most} of {mean} in a frame");
}
