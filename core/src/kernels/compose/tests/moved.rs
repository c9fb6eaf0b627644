//! A head that moves: visible points are found again by depth, and hidden ones stay as they are.

use super::super::{ComposeParams, DepthPixels, DepthRect, EarlierPixels, PixelFormat, reuse_image};
use crate::geometry::{DepthRange, Fov, Nearness, View};
use crate::reuse::{Picture, Reuse, STALE, StaleTiles, TileLists, Viewpoint};
use glam::{Quat, Vec2, Vec3};

const EXTENT: [u32; 2] = [96, 80];
const TILES: usize = 6 * 5;
const FOV: Fov = Fov { left: -0.7, right: 0.7, up: 0.6, down: -0.6 };
const RANGE: DepthRange = DepthRange { min_depth: 0.0, max_depth: 1.0, near_z: f32::INFINITY, far_z: 0.1 };
const GREY: [u8; 4] = [128; 4];

/// Image of a board at 0.8 m before a wall at 3 m.
struct Seen {
    pixels: Vec<u8>,
    depth: Vec<f32>,
    view: View,
    position: Vec3,
}

impl Seen {
    fn new(position: Vec3, yaw_deg: f32) -> Self {
        let orientation = Quat::from_rotation_y(yaw_deg.to_radians());
        let view = View { orientation, plane: FOV.tangents().plane(EXTENT) };
        let (mut pixels, mut depth) = (Vec::new(), Vec::new());
        for (y, x) in (0..EXTENT[1]).flat_map(|y| (0..EXTENT[0]).map(move |x| (y, x))) {
            // As long as the view is ahead: times the distance along -z.
            let ray = orientation * view.plane.direction(Vec2::new(x as f32, y as f32) + 0.5);
            let hit = |z: f32| ((z - position.z) / ray.z, position + ray * ((z - position.z) / ray.z));
            let (wall, board) = (hit(-3.0), hit(-0.8));
            let is_board = board.1.x.abs() < 0.25 && board.1.y.abs() < 0.2;
            let (distance, at) = if is_board { board } else { wall };
            let shade = |value: f32| value.round() as u8;
            let wave = 40.0 * (3.0 * at.x).sin();
            let color = if is_board {
                [220, shade(60.0 + wave), 20]
            } else {
                [20, shade(100.0 + wave), shade(140.0 + 40.0 * (2.0 * at.y).cos())]
            };
            pixels.extend(color.into_iter().chain([255]));
            depth.push(0.1 / distance);
        }
        Self { pixels, depth, view, position }
    }

    fn picture<'a>(&self, stale: &'a StaleTiles, has_depth: bool) -> Picture<'a> {
        let nearness = Nearness::new(&RANGE).unwrap();
        let viewpoint = has_depth.then_some(Viewpoint { position_m: self.position, nearness });
        Picture { view: self.view, extent: EXTENT, stale, viewpoint }
    }

    fn depth(&self) -> DepthPixels<'_> {
        let rect = DepthRect { offset: [0; 2], extent: EXTENT };
        DepthPixels { values: &self.depth, width: EXTENT[0], rect }
    }
}

/// Counts the pixels that stay grey, and the pixels that are neither grey nor right.
fn completed(now: &Seen, before: &Seen, has_depth: bool) -> [usize; 2] {
    let mut stale = StaleTiles::default();
    stale.set(EXTENT, [16; 2], &[STALE; TILES]);
    let mut fresh = StaleTiles::default();
    fresh.set(EXTENT, [16; 2], &[0; TILES]);
    let reuse = Reuse::new(now.picture(&stale, has_depth), [before.picture(&fresh, has_depth)], true);
    let mut lists = TileLists::default();
    lists.update(&reuse, 0.0, 1);
    let earlier = EarlierPixels {
        pixels: &before.pixels,
        width: EXTENT[0],
        offset: [0; 2],
        depth: Some(before.depth()),
    };
    let mut pixels = GREY.repeat(now.depth.len());
    let params = ComposeParams::neutral([0; 2], EXTENT);
    let how = (&reuse, &lists, 0.0);
    reuse_image(
        &mut pixels,
        EXTENT[0],
        PixelFormat::Rgba8Unorm,
        &params,
        how,
        (Some(now.depth()), &[earlier]),
    );
    let mut counts = [0; 2];
    for (found, expected) in pixels.chunks(4).zip(now.pixels.chunks(4)) {
        // Beside an edge, of the same thing a pixel away.
        let is_right = found.iter().zip(expected).all(|(a, b)| a.abs_diff(*b) <= 8);
        counts[0] += usize::from(found == GREY);
        counts[1] += usize::from(found != GREY && !is_right);
    }
    counts
}

#[test]
fn near_content_is_found_by_depth_and_disoccluded_content_is_not() {
    for (moved, yaw_deg, uncovers) in [
        (Vec3::new(0.03, 0.0, 0.0), 0.0, true),
        (Vec3::new(-0.02, 0.015, 0.0), 1.0, true),
        // Who comes nearer sees nothing new.
        (Vec3::new(0.0, 0.0, -0.05), 0.0, false),
        (Vec3::new(0.0, 0.0, 0.05), 0.0, true),
    ] {
        let (before, now) = (Seen::new(Vec3::ZERO, 0.0), Seen::new(moved, yaw_deg));
        let all = now.depth.len();
        let [left, wrong] = completed(&now, &before, true);
        assert_eq!((left > 20, wrong), (uncovers, 0), "{left} left and {wrong} wrong of {all}, {moved}");
        assert!(left < all / 12, "{left} left of {all}, {moved}");
        let [_, by_turn] = completed(&now, &before, false);
        assert!(by_turn > 100, "{by_turn} wrong without depth, {moved}");
    }
}

#[test]
fn a_head_at_rest_needs_no_depth() {
    let (before, now) = (Seen::new(Vec3::ZERO, 0.0), Seen::new(Vec3::new(0.0005, 0.0, 0.0), 0.0));
    let fresh = StaleTiles::default();
    let reuse = |now: &Seen| {
        Reuse::new(now.picture(&fresh, true), [before.picture(&fresh, true)], true).has_moved_since(1)
    };
    assert!(!reuse(&before) && !reuse(&now), "half a millimetre is a tenth of a pixel at 0.4 m");
    let elsewhere = Seen::new(Vec3::new(0.003, 0.0, 0.0), 0.0);
    assert!(reuse(&elsewhere));
    let blind = Reuse::new(elsewhere.picture(&fresh, true), [before.picture(&fresh, false)], true);
    assert!(!blind.has_moved_since(1), "the earlier one has no depth");
    let still = Reuse::new(elsewhere.picture(&fresh, true), [before.picture(&fresh, true)], false);
    assert!(!still.has_moved_since(1), "paper B");
}
