//! The loop that the kernels close: rates, what is left of a picture at these rates, its contrast, and rates again.

use super::*;
use crate::kernels::analyze::{Buffers, ContrastSettings, restore, tiles};
use crate::kernels::decide::{TileMemory, decide};

const EXTENT: [u32; 2] = [320, 256];

/// Far to the side of the gaze, at 9 to 14 pixels per degree: contrast decides, and not all of it the same.
fn eye<'a>(contrast: &'a ContrastMap) -> EyeInput<'a> {
    EyeInput {
        extent: EXTENT,
        fov: Fov { left: 0.2, right: 0.75, up: 0.2, down: -0.25 },
        orientation: Quat::IDENTITY,
        contrast: Some(contrast),
        ..input().eyes[0]
    }
}

/// Smooth on the left, detailed on the right, and flat at the bottom; each frame with noise of its own.
fn picture(x: u32, y: u32, frame: u64) -> f32 {
    let hash =
        x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ (frame as u32).wrapping_mul(0x27d4_eb2f);
    let noise = ((hash ^ hash >> 15).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / 16_777_216.0 - 0.5;
    let (u, v) = (x as f32, y as f32);
    let fine = (u * 2.1 + v * 1.3).sin() * (u / 320.0) + (u * 0.9 - v * 0.7).sin() * 0.5;
    let coarse = (u * 0.2 + v * 0.11).sin() + (u * 0.05 - v * 0.07).sin();
    let detail = if y < 180 { 12.0 * fine + 10.0 * coarse } else { 0.0 };
    50.0 + detail + noise
}

/// What the tiles show at these rates: each block what its middle would.
fn shaded(rates: &Plane<u8>, frame: u64) -> Plane {
    Plane::from_fn(EXTENT[0], EXTENT[1], |x, y| {
        let rate = ShadingRate::from_texel(rates.at(x / 16, y / 16)).unwrap_or(ShadingRate::R1X1);
        let middle = |at: u32, side: u32| at / side * side + side / 2;
        picture(middle(x, rate.width()), middle(y, rate.height()), frame)
    })
}

/// Rates of each frame, with `looks` frames between looks at full rate.
fn frames(count: u64, looks: u32, heard: impl Fn(u64) -> AudioFeatures) -> Vec<Plane<u8>> {
    let model = AudioVisual { cap: None, ..AudioVisual::default() };
    let device = DeviceRates { available: AvailableRates::new(&VULKAN_RATES), texel: [16, 16] };
    let rates = RateSettings::AudioVisual(model);
    let mut planner = Planner::new(PlanSettings { rates, device, ..PlanSettings::default() });
    let mut lattice = TileLattice::default();
    lattice.set(&eye(&ContrastMap::default()).shape([16, 16]));
    let [columns, rows] = lattice.tiles();
    let tile_count = (columns * rows) as usize;
    let mut memory = TileMemory::default();
    memory.reset(tile_count);
    let empty = Plane::filled(columns, rows, 0);
    let mut out = EyePlan { rates: empty.clone(), ages: empty.clone(), ..EyePlan::default() };
    let sensitivity = Sensitivity::new(model.budget.unit);
    let (mut map, mut buffers) = (ContrastMap::default(), Buffers::default());
    let mut shown = Plane::default();
    (0..count)
        .map(|frame| {
            let luminance = shaded(&out.rates, frame);
            let previous = map.clone();
            buffers.pyramid.build(&luminance);
            tiles(&luminance, &ContrastSettings::default(), &mut buffers, &mut map);
            restore(&out.rates, &previous, &mut shown, &mut map);
            let audio = Some(heard(frame));
            let input =
                PlanInput { frame, time_ns: frame as i64 * FRAME_NS, eyes: [eye(&map); 2], audio, ..input() };
            let params = planner.plan(&input).eyes[0].decision.looking(looks, frame);
            let visible = VisibleContrast { map: &map, sensitivity: &sensitivity };
            decide(&params, &mut lattice, &vec![true; tile_count], Some(visible), &mut memory, &mut out);
            out.rates.clone()
        })
        .collect()
}

/// The shortest time between two changes of one tile, frames.
fn least_between_changes(frames: &[Plane<u8>]) -> usize {
    let tiles = frames[0].texels().len();
    let of_tile = |tile: usize| {
        let changes = (1..frames.len()).filter(|&f| frames[f].texels()[tile] != frames[f - 1].texels()[tile]);
        let changes: Vec<usize> = changes.collect();
        changes.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap_or(usize::MAX)
    };
    (0..tiles).map(of_tile).min().unwrap_or(usize::MAX)
}

fn mean(rates: &Plane<u8>) -> f32 {
    let fraction = |texel: &u8| ShadingRate::from_texel(*texel).unwrap_or(ShadingRate::R1X1).fraction();
    rates.texels().iter().map(fraction).sum::<f32>() / rates.texels().len() as f32
}

#[test]
fn rates_do_not_oscillate() {
    for looks in [0, 150] {
        let frames = frames(450, looks, |_| loud());
        // 100 ms. While tiles first become coarse, their turn to be looked at may come at any time.
        let least = least_between_changes(&frames[if looks > 0 { 100 } else { 0 }..]);
        assert!(least >= 10, "{least} frames, looks {looks}");
        let last = mean(&frames[449]);
        assert!((0.1..0.9).contains(&last), "something is coarse, something is not: {last}");
        // Once settled, and without looks, noise changes hardly anything in a second and a half.
        if looks == 0 {
            let tiles = frames[449].texels().iter().zip(frames[300].texels());
            let changed = tiles.filter(|(a, b)| a != b).count();
            assert!(changed <= 3, "{changed} of 320 tiles");
        }
    }
}

#[test]
fn sound_that_stops_refines_at_once_and_what_starts_coarsens_slowly() {
    let quiet = AudioFeatures { loudness_lufs: -34.0, gamma_ld: 1.0, gamma_fq_kilomel: 2.4, silent: false };
    let frames = frames(450, 0, |frame| if (150..300).contains(&frame) { quiet } else { loud() });
    let [before, stopped, after] = [149, 151, 449].map(|frame| mean(&frames[frame]));
    assert!(stopped > before * 1.3, "{before} {stopped}");
    assert!(mean(&frames[305]) > stopped * 0.9, "slowly");
    assert!((after - before).abs() < 0.05 * before, "{before} {after}");
    let [first, second] = [&frames[155..300], &frames[300..450]];
    assert!(least_between_changes(first) >= 10 && least_between_changes(second) >= 10);
}
