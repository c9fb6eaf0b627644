//! The texels of a rate image against a look at every pixel.

use super::rates::{RateSet, UsedRates, clean, unary, unary_of};
use super::*;
use parafovea_core::image::Plane;
use parafovea_core::kernels::resolve as kernel;
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use proptest::prelude::*;

fn map(extent: [u32; 2], texel: [u32; 2], mut rate: impl FnMut(u32, u32) -> ShadingRate) -> EyeMap {
    let tiles = [0, 1].map(|axis| extent[axis].div_ceil(texel[axis]));
    let places = (0..tiles[1]).flat_map(|y| (0..tiles[0]).map(move |x| (x, y)));
    let texels: Vec<u8> = places.map(|(x, y)| rate(x, y).texel()).collect();
    let mut map = EyeMap::default();
    map.set(extent, texel, tiles, &texels);
    map
}

fn whole(eyes: Eyes, orientation: Orientation) -> Part {
    Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation }
}

fn image(area: [u32; 4], texel: [u32; 2], layers: u32) -> RateImage {
    let tiles = [0, 1].map(|axis| (area[axis] + area[axis + 2]).div_ceil(texel[axis]));
    RateImage { area, texel, tiles, layers }
}

fn resolved(eyes: [&EyeMap; 2], parts: &[Part], image: &RateImage, rates: &DeviceRates) -> Vec<u8> {
    let mut out = vec![0xff; image.len()];
    resolve(eyes, parts, image, rates, &mut Scratch::default(), &mut out);
    out
}

fn all_rates() -> DeviceRates {
    DeviceRates::new(VULKAN_RATES.into_iter())
}

/// The finest that a pixel of a layer asks for.
fn at_pixel(
    eyes: [&EyeMap; 2],
    parts: &[Part],
    image: &RateImage,
    layer: u32,
    pixel: [u32; 2],
) -> ShadingRate {
    let mut finest = None;
    for part in parts.iter().filter(|part| image.layers == 1 || part.layer == layer) {
        let axes = PartRect::new(part, image).axes;
        if (0..2).any(|axis| !(axes[axis].0..axes[axis].1).contains(&i64::from(pixel[axis]))) {
            continue;
        }
        let maps = match part.eyes {
            Eyes::Left => vec![eyes[0]],
            Eyes::Right => vec![eyes[1]],
            Eyes::Finer => eyes.to_vec(),
        };
        for map in maps {
            let flips: &[bool] = match part.orientation {
                Orientation::Upright => &[false],
                Orientation::UpsideDown => &[true],
                Orientation::Unknown => &[false, true],
            };
            for flipped in flips {
                // Both ends of the pixel in the plan, in 1 / size of its place.
                let ends = [0, 1].map(|axis| {
                    let (first, end) = axes[axis];
                    let at = i64::from(pixel[axis]);
                    let (from, to) = if axis == 1 && *flipped {
                        (end - at - 1, end - at)
                    } else {
                        (at - first, at + 1 - first)
                    };
                    let extent = i64::from(map.extent()[axis]);
                    (from * extent, to * extent, (end - first) * i64::from(map.texel()[axis]))
                });
                for y in ends[1].0 / ends[1].2..=(ends[1].1 - 1) / ends[1].2 {
                    for x in ends[0].0 / ends[0].2..=(ends[0].1 - 1) / ends[0].2 {
                        let texel = map.texels()[(y * i64::from(map.tiles()[0]) + x) as usize];
                        let rate = ShadingRate::from_texel(texel).unwrap();
                        finest = Some(finest.map_or(rate, |finest: ShadingRate| finest.finer(rate)));
                    }
                }
            }
        }
    }
    finest.unwrap_or(ShadingRate::R1X1)
}

/// The expected texels: each the finest of its pixels within the area.
fn expected(eyes: [&EyeMap; 2], parts: &[Part], image: &RateImage) -> Vec<u8> {
    let [x, y, width, height] = image.area;
    let mut texels = Vec::new();
    for layer in 0..image.layers {
        for row in 0..image.tiles[1] {
            for column in 0..image.tiles[0] {
                let mut finest = None;
                for pixel_y in (row * image.texel[1]).max(y)..((row + 1) * image.texel[1]).min(y + height) {
                    for pixel_x in
                        (column * image.texel[0]).max(x)..((column + 1) * image.texel[0]).min(x + width)
                    {
                        let rate = at_pixel(eyes, parts, image, layer, [pixel_x, pixel_y]);
                        finest = Some(finest.map_or(rate, |finest: ShadingRate| finest.finer(rate)));
                    }
                }
                texels.push(finest.unwrap_or(ShadingRate::R1X1).texel());
            }
        }
    }
    texels
}

fn any_map() -> impl Strategy<Value = EyeMap> {
    let sizes = (1..70u32, 1..70u32, 3..20u32, 3..20u32);
    (sizes, prop::collection::vec(0..7usize, 600)).prop_map(|((width, height, texel_x, texel_y), rates)| {
        let mut rates = rates.into_iter().cycle();
        map([width, height], [texel_x, texel_y], |_, _| VULKAN_RATES[rates.next().unwrap()])
    })
}

fn any_part() -> impl Strategy<Value = Part> {
    let eyes = prop_oneof![Just(Eyes::Left), Just(Eyes::Right), Just(Eyes::Finer)];
    let ways = [Orientation::Upright, Orientation::UpsideDown, Orientation::Unknown];
    let rect = prop_oneof![
        3 => Just([0.0, 0.0, 1.0, 1.0]),
        1 => Just([0.0, 0.0, 0.5, 1.0]),
        1 => Just([0.5, 0.0, 0.5, 1.0]),
        2 => prop::array::uniform4(-0.5..1.5f32),
    ];
    (eyes, 0..3u32, rect, prop::sample::select(ways.to_vec()))
        .prop_map(|(eyes, layer, rect, orientation)| Part { eyes, layer, rect, orientation })
}

fn any_image() -> impl Strategy<Value = RateImage> {
    let area = (0..20u32, 0..20u32, 1..80u32, 1..80u32).prop_map(|(x, y, w, h)| [x, y, w, h]);
    (area, 3..20u32, 3..20u32, 1..3u32).prop_map(|(area, x, y, layers)| image(area, [x, y], layers))
}

proptest! {
    /// Never coarser than the plan at a pixel, and no finer than its pixels need.
    #[test]
    fn each_texel_is_as_fine_as_its_finest_pixel(
        left in any_map(), right in any_map(), parts in prop::collection::vec(any_part(), 0..4),
        image in any_image(),
    ) {
        let eyes = [&left, &right];
        prop_assert_eq!(resolved(eyes, &parts, &image, &all_rates()), expected(eyes, &parts, &image));
    }

    /// With the rates that there are: never coarser, and 1x1 where that is asked for.
    #[test]
    fn only_rates_of_the_device_are_used(
        left in any_map(), right in any_map(), part in any_part(), image in any_image(),
        offered in prop::sample::subsequence(VULKAN_RATES.to_vec(), 0..7),
    ) {
        let eyes = [&left, &right];
        let rates = DeviceRates::new(offered.iter().copied());
        let permitted = expected(eyes, &[part], &image);
        for (texel, permitted) in resolved(eyes, &[part], &image, &rates).into_iter().zip(permitted) {
            let rate = ShadingRate::from_texel(texel).unwrap();
            let permitted = ShadingRate::from_texel(permitted).unwrap();
            prop_assert!(rate == ShadingRate::R1X1 || offered.contains(&rate));
            prop_assert_eq!(rate.finer(permitted), rate);
            if offered.contains(&permitted) {
                prop_assert_eq!(rate, permitted);
            }
        }
    }

    /// A texel is stale where all its pixels are, and its rate is the same as without.
    #[test]
    fn staleness_is_combined_like_the_coarsest_rate(
        maps in prop::array::uniform2(any_map()), stale in prop::collection::vec(any::<bool>(), 600),
        parts in prop::collection::vec(any_part(), 0..4), image in any_image(),
    ) {
        let mut stale = stale.into_iter().cycle();
        let [mut with_stale, mut only_stale] = [0, 1].map(|_| [0, 1].map(|_| EyeMap::default()));
        for ((map, with), only) in maps.iter().zip(&mut with_stale).zip(&mut only_stale) {
            let (mut texels, mut others) = (map.texels().to_vec(), Vec::new());
            for texel in &mut texels {
                let is_stale = stale.next() == Some(true);
                *texel |= if is_stale { STALE } else { 0 };
                others.push(if is_stale { ShadingRate::R4X4.texel() } else { 0 });
            }
            with.set(map.extent(), map.texel(), map.tiles(), &texels);
            only.set(map.extent(), map.texel(), map.tiles(), &others);
        }
        let of = |maps: &[EyeMap; 2]| resolved(maps.each_ref(), &parts, &image, &all_rates());
        let (with, plain, only) = (of(&with_stale), of(&maps), of(&only_stale));
        for ((with, plain), only) in with.iter().zip(plain).zip(only) {
            let stale = if only == ShadingRate::R4X4.texel() { STALE } else { 0 };
            prop_assert_eq!(*with, plain | stale);
        }
    }

    /// The GPU's table leads to the same texels.
    #[test]
    fn tables_lead_to_the_same_texels(
        maps in prop::array::uniform2(any_map()), stale in prop::collection::vec(any::<bool>(), 600),
        parts in prop::collection::vec(any_part(), 0..4), image in any_image(), leaves_out in any::<bool>(),
        offered in prop::sample::subsequence(VULKAN_RATES.to_vec(), 0..7),
    ) {
        let mut stale = stale.into_iter().cycle();
        let maps = maps.map(|map| {
            let texels = map.texels().iter().map(|texel| match stale.next() {
                Some(true) => texel | STALE,
                _ => *texel,
            });
            let (texels, mut marked) = (texels.collect::<Vec<_>>(), EyeMap::default());
            marked.set(map.extent(), map.texel(), map.tiles(), &texels);
            marked
        });
        let rates = DeviceRates::new(offered.iter().copied());
        let mut expected = resolved(maps.each_ref(), &parts, &image, &rates);
        if !leaves_out {
            rates.coarsen_stale(&mut expected);
        }
        let table = rate_map_table(maps.each_ref(), &parts, &image).unwrap();
        let columns = maps.each_ref().map(|map| map.tiles()[0]);
        let params = table.params(columns, rates.available(), leaves_out);
        let eyes = maps.each_ref().map(|map| {
            let [width, height] = map.tiles();
            Plane::from_fn(width, height, |x, y| map.texels()[(y * width + x) as usize])
        });
        prop_assert_eq!(kernel::resolve(&params, &table, eyes.each_ref()), expected);
    }

    /// Tiles of the plan that cover whole texels: the row is spread over them.
    #[test]
    fn tiles_over_several_texels_are_spread(
        extent in prop::array::uniform2(1..90u32), side in 3..9u32, times in prop::array::uniform2(1..5u32),
        bytes in prop::collection::vec((0..7usize, any::<bool>()), 900), is_flipped in any::<bool>(),
        offered in prop::sample::subsequence(VULKAN_RATES.to_vec(), 0..8),
    ) {
        let tile = times.map(|times| times * side);
        let tiles = [0, 1].map(|axis| extent[axis].div_ceil(tile[axis]));
        let byte = |(rate, stale): (usize, bool)| VULKAN_RATES[rate].texel() | if stale { STALE } else { 0 };
        let texels: Vec<u8> = bytes.into_iter().cycle().map(byte).take((tiles[0] * tiles[1]) as usize).collect();
        let mut map = EyeMap::default();
        map.set(extent, tile, tiles, &texels);
        let image = image([0, 0, extent[0], extent[1]], [side; 2], 1);
        let orientation = if is_flipped { Orientation::UpsideDown } else { Orientation::Upright };
        let rates = DeviceRates::new(offered.iter().copied());
        let out = resolved([&map, &EyeMap::default()], &[whole(Eyes::Left, orientation)], &image, &rates);
        for (index, texel) in (0..).zip(&out) {
            let [column, row] = [index % image.tiles[0], index / image.tiles[0]];
            let flipped = |y: u32| if is_flipped { extent[1] - 1 - y } else { y };
            // All tiles below the texel's rows; its columns are in one.
            let rows = row * side..((row + 1) * side).min(extent[1]);
            let below = rows.map(|y| (flipped(y) / tile[1] * tiles[0] + column / times[0]) as usize);
            let unary = below.map(|tile| unary_of(texels[tile]));
            let finest = unary.fold(COARSEST, |finest, unary| finest & unary);
            prop_assert_eq!(*texel, rates.of_unary(finest), "texel {}, {}", column, row);
        }
    }

    /// No input of the link or of an application makes it panic.
    #[test]
    fn anything_can_be_resolved(
        extent in prop::array::uniform2(any::<u32>()), texel in prop::array::uniform2(any::<u32>()),
        area in prop::array::uniform4(any::<u32>()), image_texel in prop::array::uniform2(0..64u32),
        tiles in prop::array::uniform2(0..9u32), rect in prop::array::uniform4(any::<f32>()), len in 0..200usize,
    ) {
        let mut map = EyeMap::default();
        map.set(extent, texel, tiles, &vec![10; (tiles[0] * tiles[1]) as usize]);
        let part = Part { rect, ..whole(Eyes::Finer, Orientation::Unknown) };
        let image = RateImage { area, texel: image_texel, tiles, layers: 2 };
        let mut out = vec![0xff; len];
        resolve([&map, &map], &[part, part], &image, &all_rates(), &mut Scratch::default(), &mut out);
        prop_assert!(out.iter().all(|texel| ShadingRate::from_texel(*texel).is_some()));
    }
}

#[test]
fn a_plan_of_the_same_size_is_copied() {
    let mut rates = VULKAN_RATES.into_iter().cycle();
    let map = map([100, 70], [16, 16], |_, _| rates.next().unwrap());
    let image = image([0, 0, 100, 70], [16, 16], 1);
    let part = whole(Eyes::Right, Orientation::Upright);
    assert_eq!(resolved([&EyeMap::default(), &map], &[part], &image, &all_rates()), map.texels());
}

/// A plan of 300 columns; a part shows the first 20 alone, two texels per tile.
#[test]
fn a_wide_plan_is_spread_over_the_texels_that_show_it() {
    let map = map([4800, 16], [16, 16], |x, _| VULKAN_RATES[x as usize % 7]);
    let image = image([0, 0, 320, 16], [8, 8], 1);
    let part = Part { rect: [0.0, 0.0, 15.0, 1.0], ..whole(Eyes::Left, Orientation::Upright) };
    for rates in [all_rates(), DeviceRates::new([ShadingRate::R2X2].into_iter())] {
        let out = resolved([&map, &EyeMap::default()], &[part], &image, &rates);
        let tile = |index: usize| unary_of(map.texels()[index % 40 / 2]);
        let expected = (0..80).map(|index| rates.of_unary(tile(index)));
        assert_eq!(out, expected.collect::<Vec<_>>());
    }
}

/// The left part of a picture, whose last texel is half of a tile in the plan's middle.
#[test]
fn the_last_texel_has_the_rate_of_its_own_tile() {
    let map = map([96, 16], [16, 16], |x, _| VULKAN_RATES[x as usize]);
    let image = image([0, 0, 40, 16], [8, 8], 1);
    let part = Part { rect: [0.0, 0.0, 2.4, 1.0], ..whole(Eyes::Left, Orientation::Upright) };
    let out = resolved([&map, &EyeMap::default()], &[part], &image, &all_rates());
    let tile = |index: usize| unary_of(map.texels()[index % 5 / 2]);
    assert_eq!(out, (0..10).map(|index| all_rates().of_unary(tile(index))).collect::<Vec<_>>());
}

#[test]
fn each_byte_has_its_rate() {
    for byte in 0..=u8::MAX {
        let (rate, stale) = (ShadingRate::from_texel(byte & !STALE), byte & STALE);
        let rate = rate.unwrap_or(ShadingRate::R1X1);
        assert_eq!(clean(byte), rate.texel() | stale, "{byte:#b}");
        assert_eq!(unary_of(clean(byte)), unary(rate) | stale, "{byte:#b}");
        let used = UsedRates::of(&[clean(byte)]);
        let mut expected = RateSet::default();
        expected.insert(rate);
        assert_eq!((used.rates(), used.coarsens()), (expected, stale == 0 && rate != ShadingRate::R1X1));
    }
    let used = UsedRates::of(&[ShadingRate::R2X2.texel() | STALE, ShadingRate::R2X1.texel()]);
    let mut expected = RateSet::default();
    [ShadingRate::R2X1, ShadingRate::R2X2].into_iter().for_each(|rate| expected.insert(rate));
    assert_eq!((used.rates(), used.coarsens()), (expected, true));
}

#[test]
fn stale_tiles_can_have_the_coarsest_rate() {
    let rates = DeviceRates::new([ShadingRate::R2X2, ShadingRate::R2X1].into_iter());
    let mut texels = [0, STALE, ShadingRate::R2X1.texel(), ShadingRate::R2X1.texel() | STALE];
    rates.coarsen_stale(&mut texels);
    assert_eq!(texels, [0, ShadingRate::R2X2.texel(), ShadingRate::R2X1.texel(), ShadingRate::R2X2.texel()]);
}

#[test]
fn an_eye_without_a_plan_is_at_full_rate() {
    let coarse = map([64, 64], [16, 16], |_, _| ShadingRate::R4X4);
    let image = image([0, 0, 64, 64], [16, 16], 1);
    let part = whole(Eyes::Finer, Orientation::Upright);
    assert_eq!(resolved([&coarse, &EyeMap::default()], &[part], &image, &all_rates()), [0; 16]);
    let right = whole(Eyes::Right, Orientation::Upright);
    assert_eq!(resolved([&coarse, &EyeMap::default()], &[right], &image, &all_rates()), [0; 16]);
    assert_eq!(resolved([&coarse, &coarse], &[part], &image, &all_rates()), [10; 16]);
    assert_eq!(resolved([&coarse, &coarse], &[], &image, &all_rates()), [0; 16]);
    assert_eq!(rate_map_table([&coarse, &EyeMap::default()], &[part], &image), None, "nothing to look up");
}

#[test]
fn a_layer_each_or_the_finer_of_both() {
    let left = map([32, 16], [16, 16], |x, _| [ShadingRate::R4X4, ShadingRate::R1X1][x as usize]);
    let right = map([32, 16], [16, 16], |x, _| [ShadingRate::R2X4, ShadingRate::R2X2][x as usize]);
    let parts = [
        whole(Eyes::Left, Orientation::Upright),
        Part { layer: 1, ..whole(Eyes::Right, Orientation::Upright) },
    ];
    let two = image([0, 0, 32, 16], [16, 16], 2);
    assert_eq!(resolved([&left, &right], &parts, &two, &all_rates()), [10, 0, 6, 5]);
    let one = RateImage { layers: 1, ..two };
    assert_eq!(resolved([&left, &right], &parts, &one, &all_rates()), [6, 0]);
}

/// Two eyes side by side whose border cuts a column of texels: that column is the finer of both.
#[test]
fn texels_on_the_border_of_two_eyes_are_the_finer_of_both() {
    let left = map([24, 16], [16, 16], |_, _| ShadingRate::R4X4);
    let right = map([24, 16], [16, 16], |_, _| ShadingRate::R2X2);
    let half = |eyes, x| Part { rect: [x, 0.0, 0.5, 1.0], ..whole(eyes, Orientation::Upright) };
    let parts = [half(Eyes::Left, 0.0), half(Eyes::Right, 0.5)];
    let image = image([0, 0, 48, 16], [16, 16], 1);
    assert_eq!(resolved([&left, &right], &parts, &image, &all_rates()), [10, 5, 5]);
}

#[test]
fn rendered_tiles_can_be_kept_fine() {
    let [full, coarse] = [ShadingRate::R1X1.texel(), ShadingRate::R4X4.texel()];
    let mut texels = [full, coarse, coarse | STALE, full | STALE];
    refine_fresh(&mut texels);
    assert_eq!(texels, [full, full, coarse | STALE, full | STALE]);
    let mut map = EyeMap::default();
    for (texels, coarsens) in
        [([full, coarse | STALE], false), ([coarse, full | STALE], true), ([full, full], false)]
    {
        map.set([32, 16], [16, 16], [2, 1], &texels);
        assert_eq!(map.coarsens(), coarsens, "{texels:?}");
    }
}
