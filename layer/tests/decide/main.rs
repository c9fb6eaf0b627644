//! The pass `decide` on a Vulkan device, under the validation layers where they are installed, compared with its CPU
//! reference. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

#[path = "../compose/allocations.rs"]
mod allocations;
#[path = "../analyze/pictures.rs"]
mod pictures;
#[path = "../compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use glam::{EulerRot, Quat, Vec3};
use parafovea::gpu::AppCommands;
use parafovea::kernels::analyze::{
    Analyze, AnalyzeParams, AnalyzedPicture, Levels, USAGE, ViewTiles, rate_row_bytes,
};
use parafovea::kernels::decide::{Decide, DecideParams};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::avpm::{BudgetSettings, SensitivityUnit};
use parafovea_core::color::Matrix;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::{Fov, View};
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{Buffers, ContrastSettings, analyze};
use parafovea_core::kernels::decide::{TileMemory, decide};
use parafovea_core::perception::ContrastMap;
use parafovea_core::perception::luminance::luminance_plane;
use parafovea_core::plan::{
    AudioVisual, AvailableRates, DeviceRates, EyeInput, EyePlan, LatticeShape, PlanInput, PlanSettings,
    Planner, RateSettings, SafetySettings, Sensitivity, TileLattice, VisibleContrast,
};
use parafovea_core::rate::{PAPER_RATES, VULKAN_RATES};
use std::sync::Arc;
use vulkan::Vulkan;

const FRAME_NS: i64 = 10_000_000;

/// A view in an image, by tiles of a size.
#[derive(Clone, Copy, Debug)]
struct Shape {
    offset: [u32; 2],
    extent: [u32; 2],
    texel: [u32; 2],
}

const USUAL: Shape = Shape { offset: [0; 2], extent: [512, 480], texel: [16; 2] };

impl Shape {
    fn eye<'a>(&self, contrast: &'a ContrastMap) -> EyeInput<'a> {
        EyeInput {
            offset: self.offset,
            extent: self.extent,
            fov: Fov { left: -0.9, right: 0.75, up: 0.8, down: -0.85 },
            orientation: Quat::from_rotation_y(0.05),
            contrast: Some(contrast),
            refresh: false,
        }
    }

    fn contrast(&self, picture: pictures::Picture) -> ContrastMap {
        let mut luminance = Plane::default();
        luminance_plane(&pictures::plane(picture, self.extent), 100.0, Matrix::Bt709, &mut luminance);
        let settings =
            ContrastSettings { texel: self.texel, overhang: self.offset, ..ContrastSettings::default() };
        let mut map = ContrastMap::default();
        analyze(&luminance, &settings, &mut Buffers::default(), &mut map);
        map
    }
}

/// Eyes that rest, jump, and are lost for a while; nearer than the horizon, so that they look apart.
fn gaze(frame: u64) -> GazeState {
    let at =
        [Vec3::NEG_Z, Vec3::new(0.31, 0.13, -1.0), Vec3::new(-0.2, -0.4, -1.0)][(frame / 8) as usize % 3];
    let apart = Vec3::new(0.03, 0.0, 0.0);
    let directions = [(at + apart).normalize(), (at - apart).normalize()];
    let phase = if frame % 24 == 20 { GazePhase::Lost } else { GazePhase::Fixation };
    GazeState { directions, phase, trust: if frame % 24 == 20 { 0.0 } else { 1.0 }, ..GazeState::LOST }
}

fn settings(unit: SensitivityUnit, safety: bool, texel: [u32; 2]) -> PlanSettings {
    // Both ways to spend a budget: the paper's is for each tile.
    let usual = if unit == SensitivityUnit::Tursun { AudioVisual::PAPER } else { AudioVisual::default() };
    let model = AudioVisual {
        budget: BudgetSettings { unit, ..BudgetSettings::default() },
        cap: safety.then_some(FixedFoveation::L1_C3),
        greatest_loss: 2.0,
        ..usual
    };
    let offered: &[_] = if safety { &VULKAN_RATES } else { &PAPER_RATES };
    PlanSettings {
        rates: RateSettings::AudioVisual(model),
        safety: if safety {
            SafetySettings { contrast_octaves_per_s: 8.0, ..SafetySettings::default() }
        } else {
            SafetySettings::PAPER
        },
        device: DeviceRates { available: AvailableRates::new(offered), texel },
        ..PlanSettings::default()
    }
}

/// A frame in which something is heard.
fn input<'a>(shape: &Shape, contrast: &'a ContrastMap, frame: u64) -> PlanInput<'a> {
    PlanInput {
        time_ns: frame as i64 * FRAME_NS,
        frame,
        frame_rate_hz: 100.0,
        eyes: [shape.eye(contrast); 2],
        head: Quat::IDENTITY,
        gaze: gaze(frame),
        audio: Some(AudioFeatures {
            loudness_lufs: -32.0 + frame as f32,
            gamma_ld: 3.0 + frame as f32 % 20.0,
            gamma_fq_kilomel: 1.4,
            silent: false,
        }),
    }
}

/// Both sides of one view.
struct Both {
    decide: Decide,
    vulkan: Vulkan,
}

/// Numbers of tiles: all, with a coarse rate, and different from the reference.
#[derive(Debug, Default)]
struct Counts {
    tiles: usize,
    coarse: usize,
    differ: usize,
}

impl Both {
    fn new() -> Self {
        let vulkan = Vulkan::at(vk::API_VERSION_1_1);
        Self { decide: Decide::new(&vulkan.gpu).unwrap(), vulkan }
    }

    /// Decides `frames` frames one after the other, on both sides.
    fn compare(&self, shape: &Shape, settings: PlanSettings, contrast: &ContrastMap, frames: u64) -> Counts {
        self.compare_turned(shape, settings, contrast, frames, |_| Quat::IDENTITY)
    }

    /// As [`Self::compare`], with a head that has turned since contrast was measured.
    fn compare_turned(
        &self,
        shape: &Shape,
        settings: PlanSettings,
        contrast: &ContrastMap,
        frames: u64,
        turn: impl Fn(u64) -> Quat,
    ) -> Counts {
        let plane = shape.eye(contrast).fov.tangents().plane(shape.extent);
        let measured = View { orientation: Quat::IDENTITY, plane };
        let gpu = &self.vulkan.gpu;
        let mut planner = Planner::new(settings);
        let grid = [contrast.tiles.width(), contrast.tiles.height()];
        let tiles = Arc::new(ViewTiles::new(gpu, grid).unwrap());
        let bytes: &[u8] = bytemuck::cast_slice(contrast.tiles.texels());
        self.vulkan.copy(self.vulkan.staging(bytes), tiles.contrast(), bytes.len());
        let target = self.decide.target(&tiles).unwrap();
        let mut reference = Reference::new(shape, contrast, &settings);
        let mut counts = Counts::default();
        for frame in 0..frames {
            let params = planner.plan(&input(shape, contrast, frame)).eyes[0]
                .decision
                .with_full_rate_period(30, frame);
            let params = params.measured_in(&measured, turn(frame));
            assert_eq!(params.tiles, grid);
            self.vulkan.run(|commands| {
                // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                let commands = unsafe { AppCommands::new(gpu, commands) };
                let variant = self.decide.write(&commands, &target, &params, &[]).unwrap();
                self.decide.record(&commands, &target, variant);
            });
            let row_bytes = rate_row_bytes(grid[0]);
            let got = self.vulkan.read(tiles.rates(), (row_bytes * grid[1]) as usize);
            let expected = reference.decided(&params);
            for (index, expected) in (0..).zip(expected.texels()) {
                let (x, y) = (index % grid[0], index / grid[0]);
                counts.tiles += 1;
                counts.coarse += usize::from(*expected != 0);
                counts.differ += usize::from(got[(y * row_bytes + x) as usize] != *expected);
            }
        }
        counts
    }
}

/// The reference, with the same parameters.
struct Reference<'a> {
    lattice: TileLattice,
    memory: TileMemory,
    out: EyePlan,
    due: Vec<bool>,
    contrast: &'a ContrastMap,
    sensitivity: Sensitivity,
}

impl<'a> Reference<'a> {
    fn new(shape: &Shape, contrast: &'a ContrastMap, settings: &PlanSettings) -> Self {
        let RateSettings::AudioVisual(model) = settings.rates else { panic!("contrast is judged") };
        let fov = shape.eye(contrast).fov;
        let mut lattice = TileLattice::default();
        let Shape { offset, extent, texel } = *shape;
        lattice.set(&LatticeShape { offset, extent, fov, texel });
        let [columns, rows] = lattice.tiles();
        let mut memory = TileMemory::default();
        memory.reset((columns * rows) as usize);
        let rates = Plane::filled(columns, rows, 0);
        let out = EyePlan { ages: rates.clone(), rates, ..EyePlan::default() };
        let due = vec![true; (columns * rows) as usize];
        Self { lattice, memory, out, due, contrast, sensitivity: Sensitivity::new(model.budget.unit) }
    }

    fn decided(&mut self, params: &DecideParams) -> &Plane<u8> {
        let judged = VisibleContrast { map: self.contrast, sensitivity: &self.sensitivity };
        let judged = (params.sensitivity != 0).then_some(judged);
        decide(params, &mut self.lattice, &self.due, judged, &mut self.memory, &mut self.out);
        &self.out.rates
    }
}

/// Only ties may differ: at most one tile in a thousand. The test is meaningful only if some tiles are coarse.
fn assert_same(case: &str, counts: &Counts) {
    assert!(counts.differ * 1000 <= counts.tiles, "{case}: {counts:?}");
}

#[test]
fn pictures_are_decided_as_in_the_reference() {
    let both = Both::new();
    let mut all = Counts::default();
    for picture in pictures::ALL {
        let contrast = USUAL.contrast(picture);
        for unit in [SensitivityUnit::CastleCsf, SensitivityUnit::Tursun] {
            for safety in [true, false] {
                let counts = both.compare(&USUAL, settings(unit, safety, USUAL.texel), &contrast, 16);
                assert_same(&format!("{}, {unit:?}, safety limits: {safety}", picture.0), &counts);
                all.tiles += counts.tiles;
                all.coarse += counts.coarse;
                all.differ += counts.differ;
            }
        }
    }
    println!("{all:?}");
    assert!(all.coarse * 10 > all.tiles && all.coarse * 10 < all.tiles * 9, "{all:?}");
    both.vulkan.assert_valid();
}

#[test]
fn tiles_of_any_size_and_place_are_decided_as_in_the_reference() {
    let both = Both::new();
    for texel in [[8, 8], [16, 8], [32, 32], [64, 64]] {
        for (offset, extent) in [([0, 0], [1, 1]), ([89, 13], [301, 270]), ([0, 0], [300, 411])] {
            let shape = Shape { offset, extent, texel };
            let contrast = shape.contrast(pictures::ALL[0]);
            let settings = settings(SensitivityUnit::CastleCsf, true, texel);
            let counts = both.compare(&shape, settings, &contrast, 26);
            assert_same(&format!("{shape:?}"), &counts);
        }
    }
    both.vulkan.assert_valid();
}

/// Slowly, far, and to where nothing was seen.
#[test]
fn contrast_of_a_turned_head_is_found_as_in_the_reference() {
    let both = Both::new();
    let mut all = Counts::default();
    for unit in [SensitivityUnit::CastleCsf, SensitivityUnit::Tursun] {
        for step in [0.003, 0.05, 0.3] {
            let contrast = USUAL.contrast(pictures::ALL[0]);
            let turn = |frame: u64| Quat::from_euler(EulerRot::YXZ, step * frame as f32, -0.01, 0.02 * step);
            let counts = both.compare_turned(&USUAL, settings(unit, true, USUAL.texel), &contrast, 16, turn);
            assert_same(&format!("{unit:?}, {step} a frame"), &counts);
            all.tiles += counts.tiles;
            all.coarse += counts.coarse;
        }
    }
    assert!(all.coarse * 20 > all.tiles && all.coarse * 10 < all.tiles * 9, "{all:?}");
    both.vulkan.assert_valid();
}

/// Neither the kernel that measures contrast nor the one that decides by it.
#[test]
fn recording_asks_for_no_memory() {
    let both = Both::new();
    let vulkan = &both.vulkan;
    let extent = vk::Extent2D { width: 512, height: 480 };
    let format = vk::Format::R8G8B8A8_UNORM;
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST | USAGE;
    let image = vulkan.image(vk::ImageCreateFlags::empty(), format, extent, 1, usage);
    let bytes = vec![0; 4 * 512 * 480];
    vulkan.upload(transfer::Layer { image, layer: 0, extent }, &bytes);
    let analyze = Analyze::new(&vulkan.gpu).unwrap();
    let settings = ContrastSettings { texel: USUAL.texel, ..ContrastSettings::default() };
    let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, settings.tiles(USUAL.extent)).unwrap());
    let params = AnalyzeParams::new([0; 2], USUAL.extent, &settings, 100.0, Matrix::Bt709);
    let levels = Arc::new(Levels::new(&vulkan.gpu, USUAL.extent).unwrap());
    let analyzed = analyze.target((image, format, 0), &params, (&tiles, &levels)).unwrap();
    let decided = both.decide.target(&tiles).unwrap();
    let contrast = USUAL.contrast(pictures::ALL[0]);
    let mut planner = Planner::new(self::settings(SensitivityUnit::CastleCsf, true, USUAL.texel));
    let input = input(&USUAL, &contrast, 0);
    let params = planner.plan(&input).eyes[0].decision;
    assert_eq!(params.sensitivity, 1, "contrast counts");
    let stale = vec![1; 960_usize.div_ceil(32)];
    vulkan.run(|commands| {
        let count = allocations::count(|| {
            // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
            let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
            for same_view in 0..3 {
                let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
                let picture = AnalyzedPicture { target: &analyzed, layout, comparison: same_view };
                analyze.record(&commands, &[picture]);
            }
            let variant = both.decide.write(&commands, &decided, &params, &stale).unwrap();
            both.decide.record(&commands, &decided, variant);
        });
        assert_eq!(count, 0);
    });
    vulkan.idle();
    vulkan.assert_valid();
}

#[test]
fn other_tiles_are_refused() {
    let both = Both::new();
    let tiles = Arc::new(ViewTiles::new(&both.vulkan.gpu, [3, 2]).unwrap());
    let target = both.decide.target(&tiles).unwrap();
    let params: DecideParams = bytemuck::Zeroable::zeroed();
    both.vulkan.run(|commands| {
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        let commands = unsafe { AppCommands::new(&both.vulkan.gpu, commands) };
        assert!(both.decide.write(&commands, &target, &params, &[]).is_err());
    });
    both.vulkan.idle();
    both.vulkan.assert_valid();
}
