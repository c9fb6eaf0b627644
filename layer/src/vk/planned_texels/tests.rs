use super::*;
use crate::pass_detection::{Eyes, Orientation, Part};
use crate::vk::frame::plan_of_two_tiles;
use parafovea_core::rate::ShadingRate;
use parafovea_core::reuse::STALE;

const R2: u8 = ShadingRate::R2X2.texel();
const R4: u8 = ShadingRate::R4X4.texel();

fn rates() -> DeviceRates {
    DeviceRates::new([ShadingRate::R2X2, ShadingRate::R4X4].into_iter())
}

/// A plan of two tiles for each eye.
fn take(frame: &Frame, serial: u64, left: [u8; 2], right: [u8; 2]) {
    frame.set_plan(&plan_of_two_tiles(serial), [&left, &right]);
}

/// An image of so many texels a tile and axis, of the whole picture of an eye.
fn shape(eyes: Eyes, texels: u32) -> MapShape {
    let part = Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation: Orientation::Upright };
    MapShape {
        image: RateImage {
            area: [0, 0, 32, 16],
            texel: [16 / texels; 2],
            tiles: [2 * texels, texels],
            layers: 1,
        },
        parts: [part].into_iter().collect(),
        skips_stale_tiles: true,
        is_unfilled: false,
    }
}

fn of(planned: &PlannedTexels, frame: &Frame, shape: &MapShape) -> Texels {
    planned.of(shape, &mut frame.plan(), &rates())
}

/// Numbers of the resolved plans by shape, the last use last.
fn plans(planned: &PlannedTexels) -> Vec<Option<u64>> {
    planned.lock().shapes.iter().map(|known| known.plan).collect()
}

#[test]
fn texels_that_do_not_change_stay_the_same_object() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    let [left, right] = [Eyes::Left, Eyes::Right].map(|eyes| shape(eyes, 1));
    take(&frame, 1, [R2, R4], [R4, R4]);
    let first = of(&planned, &frame, &left);
    assert_eq!(*first, [R2, R4]);
    assert_eq!(*of(&planned, &frame, &right), [R4, R4]);
    take(&frame, 2, [R2, R4], [R4, R2]);
    assert!(Arc::ptr_eq(&first, &of(&planned, &frame, &left)));
    assert_eq!(*of(&planned, &frame, &right), [R4, R2]);
    take(&frame, 3, [R4, R4], [R4, R2]);
    assert_eq!(*of(&planned, &frame, &left), [R4, R4]);
    assert_eq!(*first, [R2, R4], "a map still holds them");
}

/// Three images of a swapchain, by turns: each holds the texels of its last upload.
#[test]
fn texels_that_maps_hold_are_not_written_and_others_are_used_again() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    let shape = shape(Eyes::Left, 2);
    let mut held: [(u8, Texels); 3] = Default::default();
    let mut seen = std::collections::HashSet::new();
    for serial in 1..50 {
        let rate = [R2, R4, 0, R2 | STALE][serial as usize % 4];
        take(&frame, serial, [rate; 2], [0; 2]);
        planned.resolve_ahead(&frame, &rates());
        let texels = of(&planned, &frame, &shape);
        seen.insert(Arc::as_ptr(&texels));
        held[serial as usize % 3] = (rate, texels);
        assert!(held.iter().all(|(rate, texels)| texels.iter().all(|texel| texel == rate)), "{serial}");
    }
    assert!(seen.len() <= 6, "{} objects", seen.len());
}

#[test]
fn shapes_that_return_are_resolved_ahead_until_they_are_left() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    let [left, right] = [Eyes::Left, Eyes::Right].map(|eyes| shape(eyes, 1));
    let mut serial = 0;
    let mut next = || {
        serial += 1;
        take(&frame, serial, [[R2, R4], [R4, R2]][serial as usize % 2], [R4; 2]);
        planned.resolve_ahead(&frame, &rates());
        Some(serial)
    };
    for _ in 0..3 {
        let newest = next();
        assert_ne!(plans(&planned).last(), Some(&newest), "a shape that was used too few times");
        of(&planned, &frame, &left);
    }
    of(&planned, &frame, &right);
    let newest = next();
    assert_eq!(plans(&planned), [newest, newest.map(|newest| newest - 1)]);
    assert_eq!(*of(&planned, &frame, &left), [R2, R4]);
    let [last, _, _] = [next(), next(), next()];
    assert_eq!(plans(&planned)[1], last.map(|last| last + 1), "after two plans without a use it is left");
    assert_eq!(*of(&planned, &frame, &left), [R4, R2], "and resolved when it is used");
}

/// As five targets of one size, whose area changes with each frame.
#[test]
fn many_uses_of_one_plan_are_one() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    take(&frame, 1, [R2; 2], [R4; 2]);
    planned.resolve_ahead(&frame, &rates());
    for _ in 0..5 {
        of(&planned, &frame, &shape(Eyes::Left, 1));
    }
    take(&frame, 2, [R4; 2], [R4; 2]);
    planned.resolve_ahead(&frame, &rates());
    assert_eq!(plans(&planned), [Some(1)]);
}

#[test]
fn stale_and_unfilled_tiles_are_those_of_the_shape() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    take(&frame, 1, [R2, R2 | STALE], [0; 2]);
    let with =
        |skips_stale_tiles, is_unfilled| MapShape { skips_stale_tiles, is_unfilled, ..shape(Eyes::Left, 1) };
    for (shape, expected) in [
        (with(true, false), [R2, R2 | STALE]),
        (with(true, true), [0, R2 | STALE]),
        (with(false, false), [R2, R4]),
        (with(false, true), [0, 0]),
    ] {
        assert_eq!(*of(&planned, &frame, &shape), expected, "{shape:?}");
    }
}

/// Shadow maps and textures, as an application loads.
#[test]
fn maps_of_unknown_pictures_leave_the_others_in_place() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    take(&frame, 1, [R2; 2], [R4; 2]);
    let scene = of(&planned, &frame, &shape(Eyes::Left, 1));
    for width in 1..40 {
        let mut unknown = MapShape { parts: Parts::new(), ..shape(Eyes::Left, 1) };
        unknown.image.tiles[0] = width;
        assert_eq!(*of(&planned, &frame, &unknown), vec![0; width as usize]);
    }
    assert!(Arc::ptr_eq(&scene, &of(&planned, &frame, &shape(Eyes::Left, 1))));
    assert_eq!(plans(&planned).len(), 1);
}

/// As an application that resizes its pictures with each frame.
#[test]
fn few_shapes_are_kept() {
    let (planned, frame) = (PlannedTexels::default(), Frame::default());
    take(&frame, 1, [R2; 2], [R4; 2]);
    for width in 1..40 {
        let mut shape = shape(Eyes::Left, 1);
        shape.image.area[2] = width;
        of(&planned, &frame, &shape);
    }
    let state = planned.lock();
    assert_eq!(state.shapes.len(), MOST_SHAPES);
    assert!(state.former.len() <= MOST_FORMER);
}
