use super::restore::restored;
use super::*;
use crate::perception::TileContrast;
use crate::perception::extrapolate::{extrapolate, survivor};
use crate::rate::{ShadingRate, VULKAN_RATES};
use proptest::prelude::*;

fn analyzed(picture: &Plane, settings: &ContrastSettings) -> ContrastMap {
    let mut map = ContrastMap::default();
    analyze(picture, settings, &mut Buffers::default(), &mut map);
    map
}

fn usual(picture: &Plane) -> ContrastMap {
    analyzed(picture, &ContrastSettings::default())
}

fn noise(width: u32, height: u32, seed: u32) -> Plane {
    Plane::from_fn(width, height, |x, y| {
        let hash =
            (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed).wrapping_mul(0xc2b2_ae35);
        (hash >> 16) as f32 / 655.36
    })
}

#[test]
fn one_tile_for_every_started_one() {
    for (size, tile_size, grid) in [
        ((1, 1), 16, (1, 1)),
        ((16, 17), 16, (1, 2)),
        ((65, 64), 64, (2, 1)),
        ((65, 64), 8, (9, 8)),
        ((65, 64), 0, (9, 8)),
        ((65, 64), 24, (3, 3)),
        ((65, 64), u32::MAX, (2, 1)),
        ((0, 5), 16, (0, 1)),
        ((0, 0), 16, (0, 0)),
    ] {
        let settings = ContrastSettings { texel: [tile_size; 2], ..ContrastSettings::default() };
        let tiles = analyzed(&Plane::filled(size.0, size.1, 1.0), &settings).tiles;
        assert_eq!((tiles.width(), tiles.height()), grid, "{size:?} by {tile_size}");
    }
}

#[test]
fn a_grating_is_in_the_band_of_its_frequency() {
    // Periods of 4, 8, 16 and 32 pixels: Nyquist * 2^-(i + 1), as `BandFrequencies::Response` defines.
    for (expected, period) in [4, 8, 16, 32].into_iter().enumerate() {
        let picture = Plane::from_fn(512, 256, |x, _| {
            50.0 + 10.0 * (x as f32 * std::f32::consts::TAU / period as f32 + 0.5).sin()
        });
        for aggregation in [Aggregation::Mean, Aggregation::Peak] {
            let settings = ContrastSettings { aggregation, texel: [32; 2], ..ContrastSettings::default() };
            let TileContrast { bands, adaptation_cd_m2 } = analyzed(&picture, &settings).tiles.at(8, 4);
            let strongest = (0..BANDS).max_by(|a, b| bands[*a].total_cmp(&bands[*b])).unwrap();
            assert_eq!(strongest, expected, "{period} {aggregation:?}: {bands:?}");
            assert!((adaptation_cd_m2 - 50.0).abs() < 5e-3);
        }
    }
}

#[test]
fn a_checkerboard_at_nyquist_is_all_in_the_finest_band() {
    let picture = Plane::from_fn(256, 256, |x, y| if (x + y) % 2 == 0 { 60.0 } else { 40.0 });
    let bands = usual(&picture).tiles.at(8, 8).bands;
    assert!((bands[0] - 10.0 / 50.1).abs() < 1e-5, "{bands:?}");
    assert!(bands[1..].iter().all(|band| *band < 1e-5), "{bands:?}");
}

#[test]
fn a_thin_line_counts_by_its_peak_more_than_by_its_mean() {
    let picture = Plane::from_fn(64, 64, |x, _| if x == 24 { 60.0 } else { 50.0 });
    let finest = |aggregation| {
        let settings = ContrastSettings { aggregation, ..ContrastSettings::default() };
        analyzed(&picture, &settings).tiles.at(1, 1).bands[0]
    };
    assert!(finest(Aggregation::Peak) > 0.1);
    assert!(finest(Aggregation::Mean) < finest(Aggregation::Peak) / 4.0);
}

/// The same in numbers of 24 bits.
fn unrounded(picture: &Plane, settings: &ContrastSettings) -> ContrastMap {
    let (mut buffers, mut map) = (Buffers::default(), ContrastMap::default());
    buffers.pyramid.build(picture);
    tiles(picture, settings, &mut buffers, &mut map);
    map
}

/// Largest error of half floats in each band of any tile, over 1 + its contrast.
fn error(picture: &Plane, settings: &ContrastSettings) -> [f32; BANDS] {
    let (kept, exact) = (analyzed(picture, settings), unrounded(picture, settings));
    let tiles = || kept.tiles.texels().iter().zip(exact.tiles.texels());
    std::array::from_fn(|band| {
        let error = |(kept, exact): (&TileContrast, &TileContrast)| {
            (kept.bands[band] - exact.bands[band]).abs() / (1.0 + exact.bands[band])
        };
        tiles().map(error).fold(0.0, f32::max)
    })
}

/// Error bound, as in the documentation of [`analyze`].
const BOUND: f32 = 0.002;

#[test]
fn half_floats_are_as_exact_as_they_are_said_to_be() {
    let line =
        |light: f32, dark: f32| Plane::from_fn(131, 67, move |x, _| if x == 40 { light } else { dark });
    let ramp = |most: f32| Plane::from_fn(131, 67, move |x, y| most * (x as f32 + 0.37 * y as f32) / 160.0);
    let scaled = |by: f32| {
        let noise = noise(131, 67, 9);
        Plane::from_fn(131, 67, move |x, y| noise.at(x, y) * by)
    };
    let cases = [
        ("dark", scaled(1e-3)),
        ("darker than half floats", scaled(1e-6)),
        ("usual", scaled(1.0)),
        ("bright", scaled(100.0)),
        ("a ramp", ramp(100.0)),
        ("a dark ramp", ramp(0.1)),
        ("a bright ramp", ramp(1e4)),
        ("a line", line(100.0, 50.0)),
        ("a faint line", line(50.5, 50.0)),
        ("a line in the dark", line(1e4, 0.0)),
        ("a dark line", line(0.0, 1e4)),
    ];
    for (name, picture) in cases {
        let errors = error(&picture, &ContrastSettings::default());
        assert!(errors.iter().all(|error| *error <= BOUND), "{name}: {errors:?}");
    }
}

#[test]
fn buffers_serve_pictures_of_any_size_in_any_order() {
    let (mut buffers, mut map) = (Buffers::default(), ContrastMap::default());
    for (width, height) in [(100, 60), (3, 200), (1, 1), (64, 64), (100, 60)] {
        let picture = noise(width, height, 7);
        analyze(&picture, &ContrastSettings::default(), &mut buffers, &mut map);
        assert_eq!(map, usual(&picture));
    }
}

#[test]
fn the_same_size_again_needs_no_memory() {
    let (mut buffers, mut map) = (Buffers::default(), ContrastMap::default());
    let mut places = |picture: &Plane| {
        analyze(picture, &ContrastSettings::default(), &mut buffers, &mut map);
        let levels = (1..=LEVELS).map(|level| buffers.pyramid.level(level).texels().as_ptr());
        let rows =
            [&buffers.rows.fine, &buffers.rows.predicted, &buffers.rows.around].map(|row| row.as_ptr());
        let tiles = map.tiles.texels().as_ptr();
        (
            levels.collect::<Vec<_>>(),
            rows,
            buffers.rows.columns.capacity(),
            buffers.rows.light.capacity(),
            tiles,
        )
    };
    let first = places(&noise(100, 60, 1));
    assert_eq!(places(&noise(100, 60, 2)), first);
    assert_eq!(places(&noise(40, 20, 3)), first);
    assert_eq!(places(&noise(100, 60, 4)), first);
}

#[test]
fn an_unusable_pixel_is_as_a_black_or_bright_one() {
    let picture = noise(80, 48, 1);
    for (bad, like) in
        [(f32::NAN, 0.0), (-f32::NAN, 0.0), (f32::NEG_INFINITY, 0.0), (f32::INFINITY, 1e4), (-3.0, 0.0)]
    {
        let with = |value| {
            let mut picture = picture.clone();
            picture.row_mut(20)[33] = value;
            usual(&picture)
        };
        assert_eq!(with(bad), with(like));
        let (clean, map) = (usual(&picture), with(bad));
        assert_ne!(map.tiles.at(2, 1), clean.tiles.at(2, 1));
        // Beyond the reach of the coarsest filter, nothing differs: the picture's left edge is 33 pixels away.
        let far = analyzed(&noise(400, 48, 1), &ContrastSettings::default());
        let mut picture = noise(400, 48, 1);
        picture.row_mut(20)[33] = bad;
        let near = usual(&picture);
        for x in 10..25 {
            assert_eq!(near.tiles.at(x, 1), far.tiles.at(x, 1));
        }
    }
}

#[test]
fn unusable_settings_are_replaced() {
    let picture = noise(40, 40, 3);
    for dark_cd_m2 in [f32::NAN, -1.0, 0.0, f32::INFINITY] {
        let settings = ContrastSettings { dark_cd_m2, ..ContrastSettings::default() };
        let tiles = analyzed(&picture, &settings).tiles;
        assert!(
            tiles.texels().iter().flat_map(|tile| tile.bands).all(|band| band.is_finite() && band >= 0.0)
        );
    }
}

fn any_picture() -> impl Strategy<Value = Plane> {
    let texel = prop_oneof![4 => 0.0..1e4f32, 1 => any::<f32>(), 1 => Just(f32::NAN), 1 => Just(1e-41)];
    (1u32..50, prop::collection::vec(texel, 50..2000)).prop_map(|(width, texels)| {
        let height = texels.len() as u32 / width;
        Plane::from_fn(width, height, |x, y| texels[(y * width + x) as usize])
    })
}

fn any_settings() -> impl Strategy<Value = ContrastSettings> {
    let aggregation = prop_oneof![Just(Aggregation::Peak), Just(Aggregation::Mean)];
    (0u32..8, aggregation).prop_map(|(log2, aggregation)| ContrastSettings {
        texel: [1 << log2, 8 << (log2 % 4)],
        aggregation,
        ..ContrastSettings::default()
    })
}

proptest! {
    #[test]
    fn finite_whatever_comes_in(picture in any_picture(), settings in any_settings()) {
        for tile in analyzed(&picture, &settings).tiles.texels() {
            prop_assert!(tile.bands.iter().all(|band| band.is_finite() && *band >= 0.0));
            prop_assert!((0.0..=10_001.0).contains(&tile.adaptation_cd_m2));
        }
    }

    #[test]
    fn half_floats_are_exact_enough(picture in any_picture(), settings in any_settings()) {
        let errors = error(&picture, &settings);
        prop_assert!(errors.iter().all(|error| *error <= BOUND), "{:?}", errors);
    }

    #[test]
    fn level_pictures_have_no_contrast(
        width in 1u32..90, height in 1u32..90, value in 0.0..1e4f32, settings in any_settings(),
    ) {
        for tile in analyzed(&Plane::filled(width, height, value), &settings).tiles.texels() {
            prop_assert_eq!(tile.bands, [0.0; BANDS]);
            prop_assert!((tile.adaptation_cd_m2 - half(value)).abs() <= half(value) * 1e-5);
        }
    }

    /// Exactly so where the light of black scales along.
    #[test]
    fn brighter_pictures_have_the_same_contrast(seed in any::<u32>(), factor in 0.01..50.0f32, settings in any_settings()) {
        let picture = noise(45, 31, seed);
        let brighter = Plane::from_fn(45, 31, |x, y| picture.at(x, y) * factor);
        let lit = ContrastSettings { dark_cd_m2: settings.dark_cd_m2 * factor, ..settings };
        let (one, other) = (analyzed(&picture, &settings), analyzed(&brighter, &lit));
        for (one, other) in one.tiles.texels().iter().zip(other.tiles.texels()) {
            for (a, b) in one.bands.iter().zip(other.bands) {
                prop_assert!((a - b).abs() <= 1e-2 * a.max(1.0), "{} {}", a, b);
            }
            prop_assert!((one.adaptation_cd_m2 * factor - other.adaptation_cd_m2).abs() <= 1e-3 * other.adaptation_cd_m2 + 1e-3);
        }
    }

    #[test]
    fn the_mean_is_never_above_the_peak(picture in any_picture()) {
        let of = |aggregation| analyzed(&picture, &ContrastSettings { aggregation, ..ContrastSettings::default() });
        for (mean, peak) in of(Aggregation::Mean).tiles.texels().iter().zip(of(Aggregation::Peak).tiles.texels()) {
            for band in 0..BANDS {
                prop_assert!(mean.bands[band] <= peak.bands[band] * 1.0001);
            }
        }
    }
}

#[test]
fn levels_lie_beside_each_other() {
    for extent in [[1, 1], [100, 60], [257, 3], [3, 1000], [2160, 2160], [37, 38]] {
        let mut buffers = Buffers::default();
        buffers.pyramid.build(&Plane::filled(extent[0], extent[1], 1.0));
        for level in 1..=LEVELS {
            let plane = buffers.pyramid.level(level);
            assert_eq!(level_size(extent, level), [plane.width(), plane.height()]);
        }
        let [width, height] = levels_extent(extent);
        let mut taken = Plane::filled(width, height, false);
        for level in 0..=LEVELS {
            let ([left, top], [columns, rows]) = (level_place(extent, level), level_blocks(extent, level));
            for (x, y) in (top..top + rows).flat_map(|y| (left..left + columns).map(move |x| (x, y))) {
                assert!(
                    !std::mem::replace(&mut taken.row_mut(y)[x as usize], true),
                    "{extent:?}: level {level} at {x}, {y}"
                );
            }
        }
    }
}

/// The picture as a part of a larger image, whose tiles it begins in the middle of.
#[test]
fn tiles_begin_where_those_of_the_image_do() {
    let (offset, extent) = ([24, 40], [100, 60]);
    let image = noise(256, 256, 5);
    let picture = Plane::from_fn(extent[0], extent[1], |x, y| image.at(x + offset[0], y + offset[1]));
    for texel in [[16, 16], [8, 8], [32, 16]] {
        let settings = ContrastSettings { texel, overhang: offset, ..ContrastSettings::default() };
        let (inner, outer) = (
            analyzed(&picture, &settings),
            analyzed(&image, &ContrastSettings { texel, ..ContrastSettings::default() }),
        );
        let first = [offset[0] / texel[0], offset[1] / texel[1]];
        let tiles = settings.tiles(extent);
        assert_eq!([inner.tiles.width(), inner.tiles.height()], tiles);
        // The finest band of a tile that the border and its repetition do not reach; bands begin on multiples of 8.
        for (x, y) in (2..tiles[0] - 2).flat_map(|x| (2..tiles[1] - 2).map(move |y| (x, y))) {
            let (inner, outer) = (inner.tiles.at(x, y), outer.tiles.at(first[0] + x, first[1] + y));
            assert!(
                (inner.bands[0] - outer.bands[0]).abs() < 1e-5,
                "{texel:?} ({x}, {y}): {inner:?} {outer:?}"
            );
            assert!((inner.adaptation_cd_m2 - outer.adaptation_cd_m2).abs() < 1e-3);
        }
    }
}

fn tile(bands: [f32; BANDS]) -> TileContrast {
    TileContrast { bands, adaptation_cd_m2: 50.0 }
}

#[test]
fn known_contrast_is_kept_while_a_tile_is_coarse() {
    let (known, guessed) = (
        |fine, shown, measured, rate| restored(measured, fine, shown, rate).0,
        |measured| extrapolate(measured, ShadingRate::R4X4),
    );
    let at = |contrast, rate: ShadingRate| Shown { contrast, rate: rate.texel().into() };
    // A smooth picture: the guess would be far too high, and refine the tile again. Blocks fold some of it up.
    let fine = tile([0.01, 0.05, 0.3, 0.3]);
    let measured = tile([0.4, 0.2, 0.5, 0.3]);
    let coarse = ShadingRate::R4X4;
    let (held, shown) = restored(measured, fine, at(0.01, ShadingRate::R1X1), coarse);
    assert_eq!(held.bands, [0.01, 0.05, 0.3, 0.3]);
    assert_eq!(shown, at(0.5, coarse));
    // Higher contrast within the limit of noise changes nothing.
    assert_eq!(restored(tile([0.4, 0.2, 0.6, 0.3]), held, shown, coarse), (held, shown));
    // A greater change at this rate comes from another picture: the lost octaves approach their estimates, frame by frame.
    let other = tile([0.4, 0.2, 0.755, 0.3]);
    let (more, follows) = restored(other, held, shown, coarse);
    assert!((more.bands[0] - 0.3225).abs() < 1e-4 && (more.bands[1] - 0.2429).abs() < 1e-4, "{more:?}");
    let (mut followed, mut at_last) = (more, follows);
    for _ in 0..100 {
        let before = followed;
        (followed, at_last) = restored(other, followed, at_last, coarse);
        assert!((before.bands[0]..=guessed(other).bands[0]).contains(&followed.bands[0]), "{followed:?}");
    }
    assert_eq!(restored(other, followed, at_last, coarse), (followed, at_last));
    // Something else: guessed.
    let other = tile([0.4, 0.2, 1.6, 0.3]);
    assert_eq!(known(held, shown, other, coarse), guessed(other));
    assert_eq!(known(TileContrast::default(), Shown::default(), measured, coarse), guessed(measured));
}

/// While a head turns, the picture of each tile becomes another one little by little: a curtain was known, and foliage of the same coarse
/// contrast comes.
#[test]
fn detail_that_drifts_into_coarse_tiles_is_expected() {
    const EXTENT: [u32; 2] = [256, 64];
    // Curtains and foliage by turns, 64 pixels each, which move by a pixel a frame; blocks of 4x4 show their middle.
    let picture = |rate: ShadingRate, frame: u32| {
        Plane::from_fn(EXTENT[0], EXTENT[1], |x, y| {
            let middle = |at: u32, side: u32| at / side * side + side / 2;
            let (x, y) = (middle(x, rate.width()) + frame, middle(y, rate.height()));
            let octave = |side: u32| {
                let cell = (x / side).wrapping_mul(0x9e37_79b1) ^ (y / side).wrapping_mul(0x85eb_ca77) ^ side;
                cell.wrapping_mul(0xc2b2_ae35) >> 24
            };
            let detail: u32 = [1, 2, 4, 8].map(octave).iter().sum();
            let fold = 15.0 * (0.3 * x as f32).sin();
            50.0 + if (x / 64).is_multiple_of(2) { fold } else { 0.06 * detail as f32 - 30.0 }
        })
    };
    let measured = |rate, frame| {
        let mut map = ContrastMap::default();
        analyze(&picture(rate, frame), &ContrastSettings::default(), &mut Buffers::default(), &mut map);
        map
    };
    let mut known = measured(ShadingRate::R1X1, 0);
    let mut shown = Plane::filled(known.tiles.width(), known.tiles.height(), Shown::default());
    let rates = Plane::filled(known.tiles.width(), known.tiles.height(), ShadingRate::R4X4.texel());
    let (mut detailed, mut missed) = (0, 0);
    for frame in 1..200 {
        let mut map = measured(ShadingRate::R4X4, frame);
        restore(&rates, &known, &mut shown, &mut map);
        known = map;
        let full = measured(ShadingRate::R1X1, frame);
        for (known, full) in known.tiles.texels().iter().zip(full.tiles.texels()) {
            let [known, full] = [known, full].map(|tile| tile.bands[0] + tile.bands[1]);
            detailed += usize::from(full > 0.2);
            missed += usize::from(full > 0.2 && known < full / 3.0);
        }
    }
    assert!(detailed > 5000, "{detailed}");
    assert!(missed * 20 < detailed, "{missed} of {detailed} tiles with detail");
}

/// Known contrast of a tile with the contrast `fine` after frames at `rate`, each with its factor of `noise`.
fn known_after(fine: [f32; BANDS], noise: &[f32], rate: ShadingRate) -> TileContrast {
    let (mut known, mut shown) = (tile(fine), Shown::default());
    for factor in noise {
        let mut measured = fine.map(|band| band * factor);
        measured[..survivor(rate)].fill(0.0);
        (known, shown) = restored(tile(measured), known, shown, rate);
    }
    known
}

proptest! {
    #[test]
    fn tiles_at_full_rate_have_the_measured_contrast(
        now in prop::array::uniform4(0.0..9.0f32), before in prop::array::uniform4(0.0..9.0f32), contrast in 0.0..9.0f32,
        rate in 0u32..16,
    ) {
        let shown = Shown { contrast, rate };
        prop_assert_eq!(restored(tile(now), tile(before), shown, ShadingRate::R1X1).0, tile(now));
    }

    /// No walk away from the measurement, however long the tile stays coarse.
    #[test]
    fn a_coarse_tile_remembers(fine in prop::array::uniform4(0.2..2.0f32), noise in prop::collection::vec(0.9..1.1f32, 1..200), rate in 0usize..6) {
        let rate = VULKAN_RATES[rate];
        let (known, survivor) = (known_after(fine, &noise, rate), survivor(rate));
        if survivor > 0 {
            prop_assert_eq!(&known.bands[..=survivor], &fine[..=survivor]);
        }
    }

    /// Nor beyond the estimate from the octaves that survive, with noise that could as well be another picture.
    #[test]
    fn a_coarse_tile_stays_between_its_past_and_its_estimate(fine in prop::array::uniform4(0.2..2.0f32), noise in prop::collection::vec(0.8..1.25f32, 1..200), rate in 0usize..6) {
        let rate = VULKAN_RATES[rate];
        let (known, survivor) = (known_after(fine, &noise, rate), survivor(rate));
        let mut survived = fine;
        survived[..survivor].fill(0.0);
        let estimated = extrapolate(tile(survived), rate).bands;
        for ((known, fine), estimated) in known.bands[..=survivor].iter().zip(fine).zip(estimated) {
            // Noise is at most 1.5625 from one frame to another, and 1.3 with the floor that is added before the comparison.
            let (least, most) = (fine.min(estimated) / 1.5625, fine.max(estimated) * 1.5625);
            prop_assert!((least..most).contains(known), "{known} {fine} {estimated}");
        }
    }

    #[test]
    fn a_tile_that_stays_is_settled(
        measured in prop::array::uniform4(0.0..9.0f32), before in prop::array::uniform4(0.0..9.0f32), contrast in 0.0..9.0f32,
        rate in 0usize..7, at in 0usize..7,
    ) {
        let (rate, measured) = (VULKAN_RATES[rate], tile(measured));
        let (mut known, mut shown) = (tile(before), Shown { contrast, rate: VULKAN_RATES[at].texel().into() });
        for _ in 0..SETTLED {
            (known, shown) = restored(measured, known, shown, rate);
        }
        prop_assert_eq!(restored(measured, known, shown, rate), (known, shown));
    }

    #[test]
    fn restored_contrast_is_finite(
        now in prop::array::uniform4(0.0..1e6f32), before in prop::array::uniform4(0.0..1e6f32), contrast in 0.0..1e6f32,
        rate in 0usize..7, at in 0u32..16,
    ) {
        for band in restored(tile(now), tile(before), Shown { contrast, rate: at }, VULKAN_RATES[rate]).0.bands {
            prop_assert!(band.is_finite() && band >= 0.0);
        }
    }
}
