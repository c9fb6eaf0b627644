use super::*;
use crate::geometry::{PixelRect, tile_eccentricity};
use proptest::prelude::*;

fn lattice(shape: &LatticeShape) -> (TileLattice, Vec<f32>) {
    let mut lattice = TileLattice::default();
    lattice.set(shape);
    let [columns, rows] = lattice.tiles();
    (lattice, vec![0.0; columns as usize * rows as usize])
}

/// Fields of view of headsets, and beyond: asymmetric, narrow, flipped.
fn fov() -> impl Strategy<Value = Fov> {
    (-1.2f32..-0.1, 0.1f32..1.2, 0.1f32..1.2, -1.2f32..-0.1, any::<bool>()).prop_map(
        |(left, right, up, down, flipped)| {
            if flipped {
                Fov { left: right, right: left, up: down, down: up }
            } else {
                Fov { left, right, up, down }
            }
        },
    )
}

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_filter_map("too short", |(x, y, z)| Vec3::new(x, y, z).try_normalize())
}

/// Into the view, mostly.
fn ahead() -> impl Strategy<Value = Vec3> {
    (-1.5f32..1.5, -1.5f32..1.5).prop_map(|(x, y)| Vec3::new(x, y, -1.0).normalize())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The claim of this module: the nearest point is that of `tile_eccentricity`. Each of the two is within 1e-3 degrees of the exact angle:
    /// for one found tile, a calculation in double precision gave 89.3378, `tile_eccentricity` 89.3387, and the lattice 89.3375.
    #[test]
    fn nearest_is_exact(
        fov in fov(), gazes in [prop_oneof![direction(), ahead()], prop_oneof![direction(), ahead()]],
        offset in [0u32..40, 0u32..40], extent in [1u32..400, 1u32..400],
        texel in [8u32..=32, 8u32..=32],
    ) {
        let (mut lattice, mut chords) = lattice(&LatticeShape { offset, extent, fov, texel });
        lattice.nearest(gazes, &mut chords);
        let plane = fov.tangents().plane(extent);
        let [columns, rows] = lattice.tiles();
        for y in 0..rows {
            for x in 0..columns {
                let at = UVec2::new(x, y);
                let rect = PixelRect { min: lattice.corner_pixel(at), max: lattice.corner_pixel(at + 1) };
                let exact = gazes.map(|gaze| tile_eccentricity(&plane, rect, gaze).min);
                let exact = exact[0].min(exact[1]).to_degrees();
                let found = deg_of_chord(chords[(y * columns + x) as usize]);
                // Beyond 175 degrees, where the chord is flat, rounding is worth more than that; no map has a
                // border there.
                let allowed = if exact > 175.0 { 0.1 } else { 2e-3 };
                prop_assert!((found - exact).abs() < allowed, "tile {at}: {found} is {exact}");
            }
        }
    }

    #[test]
    fn tiles_cover_the_view(
        offset in [0u32..5000, 0u32..5000], extent in [0u32..3000, 0u32..3000], texel in [1u32..100, 1u32..100],
    ) {
        let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
        let (lattice, _) = lattice(&LatticeShape { offset, extent, fov, texel });
        let tiles = lattice.tiles();
        for axis in 0..2 {
            let covered: u32 = (0..tiles[axis]).map(|index| lattice.covered(axis, index)).sum();
            prop_assert_eq!(covered, if extent.contains(&0) { 0 } else { extent[axis] });
        }
    }
}

#[test]
fn tiles_start_at_the_image_not_at_the_view() {
    let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
    let (lattice, _) = lattice(&LatticeShape { offset: [20, 32], extent: [40, 16], fov, texel: [16, 16] });
    // Pixels 20..60 of the image meet tiles 16..32, 32..48 and 48..64.
    assert_eq!(lattice.tiles(), [3, 1]);
    assert_eq!([0, 1, 2].map(|column| lattice.covered(0, column)), [12, 16, 12]);
}

#[test]
fn views_without_pixels_or_beyond_every_device_have_few_tiles() {
    let fov = Fov { left: f32::NAN, right: f32::INFINITY, up: 0.0, down: 0.0 };
    let (mut empty, mut chords) =
        lattice(&LatticeShape { offset: [3, 3], extent: [0, 100], fov, texel: [16, 16] });
    assert_eq!(empty.tiles(), [0, 0]);
    empty.nearest([Vec3::NEG_Z; 2], &mut chords);
    let wide = LatticeShape { offset: [u32::MAX; 2], extent: [u32::MAX, 1], fov, texel: [0, 0] };
    let (mut wide, mut chords) = lattice(&wide);
    assert_eq!(wide.tiles(), [MAX_SIDE / 8 + 1, 1]);
    wide.nearest([Vec3::NEG_Z; 2], &mut chords);
    assert!(chords.iter().all(|chord| (0.0..=4.001).contains(chord)));
}

#[test]
fn chords_are_angles() {
    for angle in [0.0, 1e-3, 0.5, 5.0, 60.0, 90.0, 179.0] {
        assert!((deg_of_chord(chord_of_deg(angle)) - angle).abs() < 1e-3, "{angle}");
    }
}

#[test]
fn tiles_of_a_plan_follow_the_picture_and_not_the_texel() {
    for (texel, extent, expected) in [
        ([8, 8], [2160, 2160], [32, 32]),
        ([16, 16], [2160, 2160], [32, 32]),
        ([8, 8], [1024, 1024], [16, 16]),
        ([16, 16], [1024, 1024], [16, 16]),
        ([8, 8], [256, 256], [8, 8]),
        ([8, 16], [576, 2160], [8, 32]),
        ([16, 16], [4096, 4000], [64, 64]),
        ([64, 64], [16_384, 16_384], [64, 64]),
        ([8, 8], [0, 0], [8, 8]),
        ([0, 24], [100, 8000], [2, 48]),
    ] {
        assert_eq!(tile_of(texel, extent), expected, "{texel:?} {extent:?}");
    }
}
