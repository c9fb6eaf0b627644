//! Pictures that are hard to analyse: `error` is the greatest difference in contrast from double precision.

use super::Case;
use crate::reference::perception::contrast as reference;
use glam::Vec3;
use parafovea_core::color::Matrix;
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{Buffers, ContrastSettings, analyze};
use parafovea_core::perception::luminance::luminance_plane;
use parafovea_core::perception::{BANDS, ContrastMap, TileContrast};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = colors();
    cases.extend(pictures());
    cases.extend(sizes());
    cases
}

/// Every pixel of one colour, but for the one in the middle.
fn with_one(background: f32, middle: f32) -> Plane<Vec3> {
    Plane::from_fn(160, 96, |x, y| Vec3::splat(if (x, y) == (85, 42) { middle } else { background }))
}

/// From linear RGB to tiles.
fn colors() -> Vec<Case> {
    let level = "no contrast, and its luminance";
    let point = "contrast around the pixel only";
    [
        ("black", with_one(0.0, 0.0), level),
        ("white", with_one(1.0, 1.0), level),
        ("white of 10,000 cd/m2", with_one(100.0, 100.0), level),
        ("denormal", with_one(1e-40, 1e-40), level),
        ("NaN everywhere, as black", with_one(f32::NAN, f32::NAN), level),
        ("infinite everywhere, as 10,000 cd/m2", with_one(f32::INFINITY, f32::INFINITY), level),
        ("one bright pixel, 10,000 cd/m2 on black", with_one(0.0, 100.0), point),
        ("one NaN pixel in grey", with_one(0.5, f32::NAN), point),
        ("one infinite pixel in grey", with_one(0.5, f32::INFINITY), point),
        ("one negative infinite pixel in grey", with_one(0.5, f32::NEG_INFINITY), point),
    ]
    .into_iter()
    .map(|(case, colors, expected)| {
        let mut luminance = Plane::default();
        luminance_plane(&colors, 100.0, Matrix::Bt709, &mut luminance);
        let is_level = expected == level;
        judge(case, expected, &luminance, |map| {
            let (at_pixel, far) = (map.tiles.at(5, 2).bands, map.tiles.at(0, 2).bands);
            // The left edge is out of reach of the finest band.
            far[0] == 0.0 && if is_level { at_pixel == [0.0; BANDS] } else { at_pixel[0] > 0.5 }
        })
    })
    .collect()
}

/// From luminance, of which every pixel may be anything, to tiles.
fn pictures() -> Vec<Case> {
    let checkerboard = Plane::from_fn(256, 256, |x, y| if (x + y) % 2 == 0 { 100.0 } else { 0.0 });
    let anything = Plane::from_fn(75, 43, |x, y| {
        f32::from_bits(x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77))
    });
    let darkness = Plane::from_fn(64, 64, |x, y| ((x * 7 + y * 5) % 11) as f32 * 1e-41);
    vec![
        judge("checkerboard at Nyquist", "all of it in the finest band", &checkerboard, |map| {
            let bands = map.tiles.at(8, 8).bands;
            (bands[0] - 50.0 / 50.1).abs() < 1e-5 && bands[1..].iter().all(|band| *band < 1e-4)
        }),
        judge("luminance of any bits", "finite", &anything, |_| true),
        judge("luminance of denormals", "none to be seen", &darkness, |map| {
            map.tiles.texels().iter().flat_map(|tile| tile.bands).all(|band| band < 1e-30)
        }),
    ]
}

/// Levels are half floats.
const MOST_ERROR: f64 = 2e-3;

fn judge(
    case: &str,
    expected: &str,
    luminance: &Plane,
    as_expected: impl FnOnce(&ContrastMap) -> bool,
) -> Case {
    let map = analyzed(luminance);
    let exact = reference::tiles(luminance, 16, 0.1f32.into());
    let error =
        exact.iter().zip(map.tiles.texels()).map(|(exact, tile)| difference(exact, tile)).fold(0.0, f64::max);
    let light = exact.iter().zip(map.tiles.texels()).all(|(exact, tile)| {
        (exact.adaptation - f64::from(tile.adaptation_cd_m2)).abs() <= 5e-4 * exact.adaptation + 1e-4
    });
    let strongest = map.tiles.texels().iter().flat_map(|tile| tile.bands).fold(0.0, f32::max);
    let finite = map.tiles.texels().iter().all(is_finite);
    Case {
        model: "contrast",
        case: case.to_owned(),
        expected: expected.to_owned(),
        got: format!("contrast up to {strongest:.4}"),
        error: Some(error),
        passed: finite && light && error < MOST_ERROR && as_expected(&map),
    }
}

fn analyzed(luminance: &Plane) -> ContrastMap {
    let mut map = ContrastMap::default();
    analyze(luminance, &ContrastSettings::default(), &mut Buffers::default(), &mut map);
    map
}

/// The greatest difference of a band, by its size where it is above 1.
fn difference(exact: &reference::Tile, tile: &TileContrast) -> f64 {
    let bands = exact.peak.iter().zip(tile.bands);
    bands.map(|(exact, band)| (exact - f64::from(band)).abs() / exact.max(1.0)).fold(0.0, f64::max)
}

fn is_finite(tile: &TileContrast) -> bool {
    tile.adaptation_cd_m2.is_finite() && tile.bands.iter().all(|band| band.is_finite() && *band >= 0.0)
}

/// Extreme sizes with one bright pixel: its tile is as in a small picture, tiles out of its reach are level.
fn sizes() -> Vec<Case> {
    let mut cases: Vec<Case> = [(1, 1), (1, 77), (77, 1), (37, 53)]
        .into_iter()
        .map(|(width, height)| {
            let picture = Plane::from_fn(width, height, |x, y| ((x * 31 + y * 17) % 23) as f32 * 4.0);
            judge(&format!("{width} x {height}"), "as in double precision", &picture, |_| true)
        })
        .collect();
    for (width, height) in [(8192, 16), (16, 8192), (8192, 8192)] {
        let mut picture = Plane::filled(width, height, 20.0);
        // At the same place within a texel of the coarsest level, out of reach of the edges where that can be.
        let (x, y) = (width.min(4096) - 16 + 5, height.min(4096) - 16 + 5);
        picture.row_mut(y)[x as usize] = 90.0;
        let map = analyzed(&picture);
        let mut small = Plane::filled(width.min(512), height.min(512), 20.0);
        let (small_x, small_y) = (width.min(256) - 16 + 5, height.min(256) - 16 + 5);
        small.row_mut(small_y)[small_x as usize] = 90.0;
        let like = analyzed(&small).tiles.at(small_x / 16, small_y / 16);
        let tile = map.tiles.at(x / 16, y / 16);
        let corner = map.tiles.at(map.tiles.width() - 1, map.tiles.height() - 1);
        cases.push(Case {
            model: "contrast",
            case: format!("{width} x {height}, one bright pixel"),
            expected: "as in a small picture".to_owned(),
            got: format!("contrast up to {:.4}", tile.bands[0]),
            error: None,
            passed: tile == like && corner.bands == [0.0; BANDS],
        });
    }
    cases
}
