//! Paper A on images: fragments saved by sound, by loudness and pitch, against fixed foveation.
//!
//! The gaze of one eye of paper A's headset is at the centre of the view. *Paper*: Tursun's sensitivity, the mean contrast of a tile and no safety
//! limit. *castleCSF*: its sensitivity in place of Tursun's, the greatest contrast of a tile, no safety limit. *Default*: that, within the safety
//! limits.

mod report;

pub use report::{LOUDNESS_LUFS, PITCH_KHZ, Row, rows, table};

use glam::{Quat, Vec3};
use parafovea_core::audio::{AudioFeatures, mel_of_hz};
use parafovea_core::avpm::{BudgetSettings, Coefficients, PAPER, SensitivityUnit, SilenceRule};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::frco::{Block, visual_loss};
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{Aggregation, Buffers, ContrastSettings, analyze};
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{
    AudioVisual, EyeInput, EyePlan, LatticeShape, PlanInput, PlanSettings, Planner, RateSettings,
    SafetySettings, Sensitivity, TileLattice,
};
use parafovea_core::rate::ShadingRate;

/// Side of the view, pixels, and half of its field of view, degrees: paper A's headset, to the nearest degree.
pub const SIDE: u32 = 2160;
/// See [`SIDE`].
pub const EDGE_DEG: f32 = 52.0;

/// Tiles along a side.
const TILES: usize = (SIDE / 16) as usize;

/// A picture, ready to be judged.
#[derive(Debug)]
pub struct Scene {
    name: String,
    /// Contrast of each tile, by mean and by peak.
    mean: ContrastMap,
    peak: ContrastMap,
}

impl Scene {
    /// From the luminance of a picture of [`SIDE`] pixels a side, cd/m^2.
    pub fn new(name: &str, luminance: &Plane) -> Self {
        assert_eq!([luminance.width(), luminance.height()], [SIDE; 2], "a picture of another size");
        let map = |aggregation| {
            let settings = ContrastSettings { aggregation, ..ContrastSettings::default() };
            let mut map = ContrastMap::default();
            analyze(luminance, &settings, &mut Buffers::default(), &mut map);
            map
        };
        Self { name: name.to_owned(), mean: map(Aggregation::Mean), peak: map(Aggregation::Peak) }
    }
}

/// By which constants rates are decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constants {
    /// To the letter of the paper.
    Paper,
    /// castleCSF instead, without safety limits.
    Castle,
    /// The layer's defaults.
    Default,
}

/// The sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sound {
    /// Nothing.
    Silence,
    /// Loudness, LUFS, and a pitch, kHz.
    Heard {
        /// Loudness, LUFS.
        lufs: f32,
        /// Pitch, kHz.
        khz: f32,
    },
}

impl Sound {
    fn features(self) -> AudioFeatures {
        match self {
            Self::Silence => AudioFeatures::SILENT,
            Self::Heard { lufs, khz } => AudioFeatures {
                loudness_lufs: lufs,
                gamma_ld: (lufs + 35.0).clamp(0.0, 25.0),
                gamma_fq_kilomel: (mel_of_hz(f64::from(khz) * 1000.0) / 1000.0) as f32,
                silent: false,
            },
        }
    }
}

/// The rates of a view.
#[derive(Clone, Debug)]
pub struct Map {
    rates: Vec<ShadingRate>,
    /// Invocations for each pixel.
    pub mean_rate: f64,
}

impl Map {
    fn of(plan: &EyePlan) -> Self {
        let rate = |index: usize| plan.rate((index % TILES) as u32, (index / TILES) as u32);
        Self {
            rates: (0..TILES * TILES).map(rate).collect(),
            mean_rate: f64::from(plan.statistics().mean_rate),
        }
    }

    /// Share of the tiles that have another rate in `other`.
    fn differing(&self, other: &Self) -> f64 {
        let differ = self.rates.iter().zip(&other.rates).filter(|(a, b)| a != b).count();
        differ as f64 / self.rates.len() as f64
    }
}

const FOV: Fov = {
    let edge = EDGE_DEG * std::f32::consts::PI / 180.0;
    Fov { left: -edge, right: edge, up: edge, down: -edge }
};

/// The map that settings lead to once nothing moves any more.
fn planned(settings: PlanSettings, contrast: Option<&ContrastMap>, audio: Option<AudioFeatures>) -> Map {
    let eye = |extent| EyeInput {
        offset: [0; 2],
        extent,
        fov: FOV,
        orientation: Quat::IDENTITY,
        contrast,
        refresh: false,
    };
    let input = PlanInput {
        time_ns: 0,
        frame: 0,
        frame_rate_hz: 90.0,
        eyes: [eye([SIDE; 2]), eye([0; 2])],
        head: Quat::IDENTITY,
        gaze: GazeState {
            directions: [Vec3::NEG_Z; 2],
            phase: GazePhase::Fixation,
            trust: 1.0,
            ..GazeState::LOST
        },
        audio,
    };
    let mut planner = Planner::new(settings);
    // Nothing limits how fast tiles become coarser.
    Map::of(&planner.plan(&input).eyes[0])
}

/// Fixed foveation as the paper compares with.
pub fn fixed(map: FixedFoveation) -> Map {
    let rates = RateSettings::Fixed(map);
    planned(PlanSettings { rates, safety: SafetySettings::PAPER, ..PlanSettings::default() }, None, None)
}

/// Everything at full rate.
pub fn full() -> Map {
    planned(PlanSettings::default(), None, None)
}

/// Paper A's baseline with a peripheral rate.
pub fn baseline(peripheral: ShadingRate) -> FixedFoveation {
    FixedFoveation::L1_C1.with_peripheral(peripheral)
}

/// Result of sound and image.
pub fn audio_visual(scene: &Scene, constants: Constants, sound: Sound) -> Map {
    by_coefficients(scene, constants, sound, PAPER)
}

fn by_coefficients(scene: &Scene, constants: Constants, sound: Sound, coefficients: Coefficients) -> Map {
    let contrast = if constants == Constants::Paper { &scene.mean } else { &scene.peak };
    planned(settings(constants, coefficients), Some(contrast), Some(sound.features()))
}

fn settings(constants: Constants, coefficients: Coefficients) -> PlanSettings {
    let at_once = SafetySettings { contrast_octaves_per_s: f32::INFINITY, ..SafetySettings::default() };
    let (model, safety) = match constants {
        Constants::Paper => (AudioVisual::PAPER, SafetySettings::PAPER),
        Constants::Castle => {
            let unit = SensitivityUnit::CastleCsf;
            let budget = BudgetSettings { unit, silence: SilenceRule::Strict, ..BudgetSettings::default() };
            (AudioVisual { budget, ..AudioVisual::PAPER }, SafetySettings::PAPER)
        }
        Constants::Default => (AudioVisual::default(), at_once),
    };
    let model = AudioVisual { budget: BudgetSettings { coefficients, ..model.budget }, ..model };
    PlanSettings { rates: RateSettings::AudioVisual(model), safety, ..PlanSettings::default() }
}

/// The map of the safety limits alone: that of an image without any contrast.
fn safety_limits_alone(constants: Constants) -> Map {
    let level = TileContrast { bands: [0.0; 4], adaptation_cd_m2: 100.0 };
    let flat = ContrastMap { tiles: Plane::filled(TILES as u32, TILES as u32, level) };
    let loud = Sound::Heard { lufs: -10.0, khz: 1.0 };
    planned(settings(constants, PAPER), Some(&flat), Some(loud.features()))
}

/// Share of the tiles that contrast and sound decide: they are finer than the safety limits alone would have them.
pub fn decided_by_model(map: &Map, constants: Constants) -> f64 {
    map.differing(&safety_limits_alone(constants))
}

/// Loss of visible contrast, gamma_vis of paper A Eq. 11, in the units of one sensitivity function.
pub fn loss(scene: &Scene, map: &Map, unit: SensitivityUnit) -> f32 {
    let contrast = if unit == SensitivityUnit::Tursun { &scene.mean } else { &scene.peak };
    let mut lattice = TileLattice::default();
    lattice.set(&LatticeShape { offset: [0; 2], extent: [SIDE; 2], fov: FOV, texel: [16; 2] });
    let mut chords = vec![0.0; TILES * TILES];
    lattice.nearest([Vec3::NEG_Z; 2], &mut chords);
    let sensitivity = Sensitivity::new(unit);
    let tiles = contrast.tiles.texels().iter().zip(lattice.resolution()).zip(&chords).zip(&map.rates);
    visual_loss(tiles.map(|(((tile, resolution), chord), rate)| {
        let eccentricity_deg = (2.0 * (chord.sqrt() / 2.0).min(1.0).asin()).to_degrees();
        let seen = sensitivity.bands(*resolution, eccentricity_deg, tile.adaptation_cd_m2);
        Block {
            band_sensitivity: [0, 1, 2, 3].map(|band: usize| tile.bands[band] * seen[band]),
            rate: *rate,
            pixels: 256,
        }
    }))
}

/// The score that paper A's Eq. 14 predicts for a map.
pub fn score(scene: &Scene, map: &Map, sound: Sound) -> f32 {
    let AudioFeatures { gamma_ld, gamma_fq_kilomel, silent, .. } = sound.features();
    let loss = loss(scene, map, SensitivityUnit::Tursun);
    // Both features of sound vanish in silence.
    let heard = if silent { PAPER.d } else { PAPER.score(gamma_ld, gamma_fq_kilomel, 0.0) };
    heard - PAPER.c * loss / parafovea_core::avpm::VISUAL_LOSS_SCALE
}

/// FR': the paper's control. Its baseline with both radii scaled so that it shades as many fragments as `map`; nothing
/// where that is less than its peripheral rate everywhere.
pub fn of_equal_cost(map: &Map, peripheral: ShadingRate) -> Option<Map> {
    let scaled = |factor: f32| {
        let base = baseline(peripheral);
        fixed(FixedFoveation {
            foveal_deg: base.foveal_deg * factor,
            transitional_deg: base.transitional_deg * factor,
            ..base
        })
    };
    let (mut low, mut high) = (0.0, 6.0);
    if scaled(low).mean_rate > map.mean_rate {
        return None;
    }
    for _ in 0..18 {
        let middle = (low + high) / 2.0;
        // The rate rises with the radii.
        (low, high) = if scaled(middle).mean_rate < map.mean_rate { (middle, high) } else { (low, middle) };
    }
    Some(scaled(high))
}

/// The ablation of the paper's Table 1 (supplement): which features of the model count. Before them all comes [`full`].
pub const ABLATION: [(&str, Coefficients); 4] = [
    ("visual only", Coefficients { a: 0.0, b: 0.0, ..PAPER }),
    ("and frequency", Coefficients { a: 0.0, ..PAPER }),
    ("and loudness", Coefficients { b: 0.0, ..PAPER }),
    ("all", PAPER),
];
