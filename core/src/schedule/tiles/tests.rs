use super::*;
use crate::geometry::Fov;
use crate::schedule::{CellAges, Phase, Schedule, UpdateConfiguration};
use glam::Quat;
use proptest::prelude::*;

fn cells_of(touched: &Touched) -> Vec<Cell> {
    let mut cells = Vec::new();
    touched.for_each(|cell| cells.push(cell));
    cells
}

/// A view with the orientation of any quaternion.
fn views() -> impl Strategy<Value = (View, [u32; 2], u32)> {
    let angle = -1.5f32..1.5;
    (
        [angle.clone(), angle.clone(), angle.clone(), angle],
        proptest::array::uniform4(-1f32..1.0),
        prop_oneof![Just([1, 1]), [1u32..200, 1u32..200]],
        prop_oneof![Just(16u32), 0u32..300],
    )
        .prop_map(|([left, right, up, down], orientation, extent, tile_size)| {
            let plane = Fov { left, right, up, down }.tangents().plane(extent);
            (View { orientation: Quat::from_array(orientation), plane }, extent, tile_size)
        })
}

proptest! {
    #[test]
    fn no_cell_of_a_tile_is_missed(
        (view, extent, tile_size) in views(),
        points in proptest::collection::vec((0f32..1.0, 0f32..1.0), 50),
    ) {
        let mut tiles = TileCells::default();
        tiles.update(&view, extent, tile_size);
        let turn = Quat::from_vec4(glam::Vec4::from(view.orientation).normalize());
        for (x, y) in points {
            let pixel = Vec2::new(x * extent[0] as f32, y * extent[1] as f32);
            let tile = (pixel / tile_size.max(1) as f32).as_uvec2();
            let cell = Cell::of(turn * view.plane.direction(pixel)).unwrap();
            let touched = cells_of(&tiles.touched(tile.x, tile.y));
            prop_assert!(touched.contains(&cell), "{pixel} of tile {tile}: {cell:?} not in {touched:?}");
        }
    }

    #[test]
    fn a_tile_is_due_when_a_cell_of_it_is((view, extent, tile_size) in views(), frame in 0u64..100, eye in 0usize..2) {
        prop_assume!(tile_size > 3);
        let mut tiles = TileCells::default();
        tiles.update(&view, extent, tile_size);
        let mut ages = CellAges::new();
        let configuration = UpdateConfiguration::F12345;
        ages.advance(&Schedule { configuration, phase: Phase::AlternateEye, ..Schedule::default() }, frame, [Vec3::X; 2]);
        ages.advance(&Schedule { configuration, ..Schedule::default() }, frame + 1, [Vec3::X; 2]);
        ages.finish(0);
        let [columns, rows] = tiles.tiles();
        let mut due = vec![false; (columns * rows) as usize];
        ages.due_tiles(&tiles, eye, &mut due);
        for (index, due) in due.into_iter().enumerate() {
            let touched = tiles.touched(index as u32 % columns, index as u32 / columns);
            let expected = cells_of(&touched).into_iter().any(|cell| ages.is_due(cell, eye));
            prop_assert_eq!(due, expected, "tile {}", index);
            prop_assert_eq!(ages.any_due(&touched, eye), expected);
        }
    }
}

#[test]
fn small_tiles_touch_few_cells() {
    let plane = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 }.tangents().plane([2160, 2160]);
    let mut tiles = TileCells::default();
    let orientation = Quat::from_rotation_y(0.3) * Quat::from_rotation_x(0.4);
    tiles.update(&View { orientation, plane }, [2160, 2160], 16);
    let mut most = 0;
    for row in 0..135 {
        for column in 0..135 {
            most = most.max(cells_of(&tiles.touched(column, row)).len());
        }
    }
    assert!((4..=6).contains(&most), "{most}");
    assert!(cells_of(&tiles.touched(135, 0)).is_empty() && cells_of(&tiles.touched(0, u32::MAX)).is_empty());
}

#[test]
fn an_image_without_pixels_has_no_tiles() {
    let mut tiles = TileCells::default();
    let mut update = |extent| {
        let plane = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 }.tangents().plane(extent);
        tiles.update(&View { orientation: Quat::IDENTITY, plane }, extent, 16);
        tiles.clone()
    };
    for extent in [[0, 0], [0, 5], [5, 0]] {
        assert!(update([32, 32]).large().count() > 0);
        let tiles = update(extent);
        assert!(cells_of(&tiles.touched(0, 0)).is_empty());
        CellAges::new().due_tiles(&tiles, 0, &mut [false; 9]);
    }
}
