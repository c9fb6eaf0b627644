use super::*;
use crate::geometry::eccentricity;
use crate::schedule::ages::CELL_RADIUS_DEG;

fn all() -> impl Iterator<Item = Cell> {
    (0..CELLS).map(Cell::from_index)
}

#[test]
fn a_cell_holds_its_points() {
    for cell in all() {
        for within in [[0.5, 0.5], [0.02, 0.02], [0.98, 0.02], [0.02, 0.98], [0.98, 0.98]] {
            assert_eq!(Cell::of(point(cell, within) * 1e20), Some(cell), "at {within:?}");
            assert_eq!(Cell::of(point(cell, within) * 1e-40).map(|found| found.index() / (SIDE * SIDE)), {
                Some(cell.index() / (SIDE * SIDE))
            });
        }
    }
}

#[test]
fn no_point_of_a_cell_is_farther_from_its_centre_than_stated() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let radius = |cell| {
        corners.map(|within| eccentricity(centre(cell), point(cell, within))).into_iter().fold(0.0, f32::max)
    };
    let largest_deg = all().map(radius).fold(0.0, f32::max).to_degrees();
    // Rounding can add two units of FINE.
    assert!(largest_deg + 0.02 <= CELL_RADIUS_DEG, "{largest_deg}");
    assert!(largest_deg > 0.95 * CELL_RADIUS_DEG, "{largest_deg}");
}

#[test]
fn patches_are_shared_out_evenly_over_the_phases() {
    for period in 2..=MAX_FACTOR {
        let mut counts = vec![0; usize::from(period)];
        for face_patch in 0..PATCHES * PATCHES {
            counts[usize::from(patch_phase(face_patch, period))] += 1;
        }
        let (least, most) = (counts.iter().min(), counts.iter().max());
        assert!(most <= least.map(|least| least + PATCHES.div_ceil(2)).as_ref(), "{period}: {counts:?}");
        // Neighbours never share a phase.
        for patch in (0..PATCHES * PATCHES).filter(|patch| patch % PATCHES > 0) {
            assert_ne!(patch_phase(patch, period), patch_phase(patch - 1, period));
        }
        for patch in PATCHES..PATCHES * PATCHES {
            assert_ne!(patch_phase(patch, period), patch_phase(patch - PATCHES, period));
        }
    }
}

#[test]
fn directions_without_a_meaning_have_no_cell() {
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(Cell::of(direction), None);
    }
}

#[test]
fn cells_are_nearly_as_wide_as_each_other() {
    for step in -100..=100 {
        let t = step as f32 / 100.0;
        let error = part_of_angle(t) - t.atan() / std::f32::consts::FRAC_PI_4;
        assert!(error.abs() < 0.005, "at {t}: {error}");
        assert!((tangent(part_of_angle(t)) - t).abs() < 1e-5, "at {t}");
    }
}
