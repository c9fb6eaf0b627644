//! The feedback loop of the kernels: rates, an image at these rates, its contrast, and rates again.

use super::*;
use crate::kernels::analyze::{Buffers, ContrastSettings, analyze, restore};
use crate::kernels::decide::{TileMemory, decide};

const EXTENT: [u32; 2] = [192, 128];

/// 100 ms.
const LEAST_FRAMES: usize = 10;

/// Far to the side of the gaze, at 9 to 14 pixels per degree: contrast decides, and not all of it the same.
fn eye<'a>(contrast: &'a ContrastMap) -> EyeInput<'a> {
    EyeInput {
        extent: EXTENT,
        fov: Fov { left: 0.2, right: 0.53, up: 0.12, down: -0.11 },
        orientation: Quat::IDENTITY,
        contrast: Some(contrast),
        ..input().eyes[0]
    }
}

/// A scene with its frames.
#[derive(Clone, Copy, Debug)]
struct Scene {
    /// Width of the noise, of its own in each frame, cd/m^2; the picture has 50 in the mean.
    noise: f32,
    /// Contrast of the finest detail, and of coarser.
    fine: f32,
    coarse: f32,
    /// Frames between looks at full rate; 0: none.
    looks: u32,
    /// From this frame on everything is elsewhere.
    cut: u64,
}

const STILL: Scene = Scene { noise: 1.0, fine: 12.0, coarse: 10.0, looks: 0, cut: u64::MAX };

fn hash(x: u32, y: u32, frame: u64) -> f32 {
    let mut hash =
        x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ (frame as u32).wrapping_mul(0x27d4_eb2f);
    hash = (hash ^ hash >> 15).wrapping_mul(0xc2b2_ae35);
    hash = (hash ^ hash >> 13).wrapping_mul(0x2c1b_3c6d);
    (hash >> 8) as f32 / 16_777_216.0
}

impl Scene {
    /// Smooth on the left, detailed on the right, and flat at the bottom.
    fn picture(&self, x: u32, y: u32, frame: u64) -> f32 {
        let noise = self.noise * (hash(x, y, frame) - 0.5);
        let (x, y) = if frame < self.cut { (x, y) } else { (EXTENT[0] - x, EXTENT[1] - y) };
        let (u, v) = (x as f32, y as f32);
        let fine = (u * 2.1 + v * 1.3).sin() * (u / EXTENT[0] as f32) + (u * 0.9 - v * 0.7).sin() * 0.5;
        let coarse = (u * 0.2 + v * 0.11).sin() + (u * 0.05 - v * 0.07).sin();
        let detail = if y < 90 { self.fine * fine + self.coarse * coarse } else { 0.0 };
        50.0 + detail + noise
    }

    /// Luminance of tiles at these rates: each block has that of its middle.
    fn shaded(&self, rates: &Plane<u8>, frame: u64) -> Plane {
        Plane::from_fn(EXTENT[0], EXTENT[1], |x, y| {
            let rate = ShadingRate::from_texel(rates.at(x / 16, y / 16)).unwrap_or(ShadingRate::R1X1);
            let middle = |at: u32, side: u32| at / side * side + side / 2;
            self.picture(middle(x, rate.width()), middle(y, rate.height()), frame)
        })
    }

    /// Rates of each frame.
    fn frames(
        &self,
        count: u64,
        heard: impl Fn(u64) -> AudioFeatures,
        seen: impl Fn(u64) -> GazeState,
    ) -> Vec<Plane<u8>> {
        // At the default these scenes are all coarse.
        let model = AudioVisual { cap: None, greatest_loss: 4.0, ..AudioVisual::default() };
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
                let luminance = self.shaded(&out.rates, frame);
                let previous = map.clone();
                analyze(&luminance, &ContrastSettings::default(), &mut buffers, &mut map);
                restore(&out.rates, &previous, &mut shown, &mut map);
                let (time_ns, eyes) = (frame as i64 * FRAME_NS, [eye(&map); 2]);
                let (audio, gaze) = (Some(heard(frame)), seen(frame));
                let input = PlanInput { frame, time_ns, eyes, audio, gaze, ..input() };
                let params = planner.plan(&input).eyes[0].decision.with_full_rate_period(self.looks, frame);
                let visible = VisibleContrast { map: &map, sensitivity: &sensitivity };
                decide(&params, &mut lattice, &vec![true; tile_count], Some(visible), &mut memory, &mut out);
                out.rates.clone()
            })
            .collect()
    }
}

/// Of one tile, one after the other: frame, and whether it became coarser.
fn changes(frames: &[Plane<u8>], tile: usize) -> Vec<(usize, bool)> {
    let octaves = |frame: usize| ShadingRate::from_texel(frames[frame].texels()[tile]).unwrap().octaves();
    (1..frames.len())
        .filter(|&frame| frames[frame].texels()[tile] != frames[frame - 1].texels()[tile])
        .map(|frame| (frame, octaves(frame) > octaves(frame - 1)))
        .collect()
}

/// The shortest time from a change of a tile to its next one that `counts`, frames.
fn least_between(frames: &[Plane<u8>], counts: impl Fn(bool) -> bool) -> usize {
    let of_tile = |tile: usize| {
        let changes = changes(frames, tile);
        let pairs = changes.windows(2).filter(|pair| counts(pair[1].1));
        pairs.map(|pair| pair[1].0 - pair[0].0).min().unwrap_or(usize::MAX)
    };
    (0..frames[0].texels().len()).map(of_tile).min().unwrap_or(usize::MAX)
}

fn mean(rates: &Plane<u8>) -> f32 {
    let fraction = |texel: &u8| ShadingRate::from_texel(*texel).unwrap_or(ShadingRate::R1X1).fraction();
    rates.texels().iter().map(fraction).sum::<f32>() / rates.texels().len() as f32
}

fn ahead(_: u64) -> GazeState {
    input().gaze
}

/// Noise of up to 8 % to either side, and looks at full rate.
#[test]
fn rates_do_not_oscillate() {
    for (noise, looks) in [(1.0, 0), (1.0, 100), (4.0, 0), (8.0, 100)] {
        for (fine, coarse) in [(12.0, 10.0), (3.0, 3.0)] {
            let scene = Scene { noise, looks, fine, coarse, ..STILL };
            let frames = scene.frames(240, |_| loud(), ahead);
            let least = least_between(&frames, |_| true);
            assert!(least >= LEAST_FRAMES, "{least} frames, {scene:?}");
            let last = mean(&frames[239]);
            assert!((0.065..0.9).contains(&last), "something is coarse, something is not: {last}, {scene:?}");
        }
    }
}

/// Without looks, noise changes hardly anything any more once rates have settled.
#[test]
fn rates_settle() {
    for (noise, most) in [(1.0, 2), (4.0, 6)] {
        let frames = Scene { noise, ..STILL }.frames(240, |_| loud(), ahead);
        let changed: usize = (0..96).map(|tile| changes(&frames[100..], tile).len()).sum();
        assert!(changed <= most, "{changed} changes of 96 tiles in 1.4 s, noise {noise}");
    }
}

#[test]
fn sound_that_stops_refines_at_once_and_what_starts_coarsens_slowly() {
    let quiet = AudioFeatures { loudness_lufs: -34.0, gamma_ld: 1.0, gamma_fq_kilomel: 2.4, silent: false };
    let heard = |frame| if (100..200).contains(&frame) { quiet } else { loud() };
    let scene = Scene { fine: 4.0, coarse: 4.0, ..STILL };
    let frames = scene.frames(300, heard, ahead);
    let [before, stopped, after] = [99, 101, 299].map(|frame| mean(&frames[frame]));
    assert!(stopped > before * 1.3, "{before} {stopped}");
    assert!(mean(&frames[205]) > stopped * 0.9, "slowly");
    assert!((after - before).abs() < 0.1 * before, "{before} {after}");
    assert!(least_between(&frames, |coarser| coarser) >= LEAST_FRAMES);
}

/// A sound that stops and starts every 80 ms.
#[test]
fn sound_that_flutters_makes_nothing_coarser_and_finer_by_turns() {
    let quiet = AudioFeatures { loudness_lufs: -34.0, gamma_ld: 1.0, gamma_fq_kilomel: 2.4, silent: false };
    let heard = |frame: u64| if frame % 16 < 8 { quiet } else { loud() };
    let scene = Scene { fine: 4.0, coarse: 4.0, ..STILL };
    let frames = scene.frames(200, heard, ahead);
    let coarser = |tile| changes(&frames[100..], tile).into_iter().filter(|(_, coarser)| *coarser).count();
    let changed: usize = (0..96).map(coarser).sum();
    assert!(changed <= 3, "{changed} times a tile became coarser within a second");
    assert!(least_between(&frames, |coarser| coarser) >= LEAST_FRAMES);
}

/// The eyes jump every 250 ms, and follow something in between.
#[test]
fn tiles_refined_by_a_moving_gaze_stay_fine_for_a_while() {
    let direction = |frame: u64| {
        let jump = if (frame / 25).is_multiple_of(2) { 0.0 } else { 0.3 };
        Vec3::new(jump + 0.004 * (frame % 25) as f32, 0.0, -1.0).normalize()
    };
    let frames = STILL.frames(250, |_| loud(), |frame| gaze(direction(frame), direction(frame)));
    let all: usize = (0..96).map(|tile| changes(&frames, tile).len()).sum();
    assert!(all > 200, "{all} changes say nothing");
    let least = least_between(&frames, |coarser| coarser);
    assert!(least >= LEAST_FRAMES, "{least}");
}

#[test]
fn a_scene_cut_is_one_change() {
    let cut = 120;
    let scene = Scene { looks: 60, ..STILL };
    let frames = Scene { cut, ..scene }.frames(400, |_| loud(), ahead);
    let least = least_between(&frames, |coarser| coarser);
    assert!(least >= LEAST_FRAMES, "{least}");
    let [before, at] = [119, 122].map(|frame| mean(&frames[frame]));
    assert!(at > before, "what is new is rendered finely: {before} {at}");
    // Each tile was looked at.
    let of_rates = |frames: &[Plane<u8>]| frames.iter().map(mean).sum::<f32>() / frames.len() as f32;
    let fresh = Scene { cut: 0, ..scene }.frames(280, |_| loud(), ahead);
    let (after, fresh) = (of_rates(&frames[280..]), of_rates(&fresh[160..]));
    assert!((after - fresh).abs() < 0.03 * fresh, "{after}, and {fresh} without what was before the cut");
}

/// A look at full rate finds detail just after a tile has become coarser: the tile is refined at once, and stays so.
#[test]
fn a_look_refines_tiles_that_have_just_become_coarser() {
    let scene = Scene { noise: 0.0, fine: 18.918987, coarse: 0.0, looks: 60, cut: u64::MAX };
    let heard = |_| AudioFeatures { gamma_ld: 0.0, ..loud() };
    let frames = scene.frames(160, heard, ahead);
    assert!(least_between(&frames, |coarser| !coarser) < LEAST_FRAMES, "no look comes so soon");
    assert!(least_between(&frames, |coarser| coarser) >= LEAST_FRAMES);
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(16))]

    /// Refinement is immediate; only coarsening waits.
    #[test]
    fn a_tile_becomes_coarser_once_in_100_ms(
        noise in 0.0f32..8.0, fine in 0.0f32..30.0, coarse in 0.0f32..30.0, looks in 60u32..200, gamma_ld in 0.0f32..25.0,
    ) {
        let heard = |_| AudioFeatures { gamma_ld, ..loud() };
        let frames = Scene { noise, fine, coarse, looks, cut: u64::MAX }.frames(160, heard, ahead);
        let least = least_between(&frames, |coarser| coarser);
        proptest::prop_assert!(least >= LEAST_FRAMES, "{least} frames");
    }
}
