//! The maps.

use super::stills::{FOV, Still};
use glam::{Quat, Vec3};
use parafovea_core::audio::{AudioFeatures, mel_of_hz};
use parafovea_core::avpm::{BudgetSettings, SilenceRule};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::frco::Allocation;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::plan::{
    AudioVisual, AvailableRates, DeviceRates, EyeInput, PlanInput, PlanSettings, Planner, RateSettings,
    SafetySettings,
};
use parafovea_core::rate::{PAPER_RATES, ShadingRate, VULKAN_RATES};

/// Side of the pictures, pixels.
pub const SIDE: u32 = 1024;

/// Tiles along it.
pub const TILES: u32 = SIDE / 16;

/// The rates of the tiles.
pub struct Map(Vec<ShadingRate>);

impl Map {
    /// Of a pixel.
    pub fn at(&self, x: u32, y: u32) -> ShadingRate {
        self.0[(y / 16 * TILES + x / 16) as usize]
    }

    /// Samples for each pixel.
    pub fn share(&self) -> f64 {
        self.0.iter().map(|rate| f64::from(rate.fraction())).sum::<f64>() / self.0.len() as f64
    }
}

/// A way of choosing rates.
pub struct Way {
    pub name: String,
    settings: PlanSettings,
    audio: Option<AudioFeatures>,
    /// The budget is lowered or raised in each still until so many samples are left, in place of the settings'.
    shades: Option<f64>,
    /// The price of a sample for losses as judged, in place of the settings.
    judged: Option<f32>,
}

impl Way {
    fn new(name: &str, rates: RateSettings, is_paper: bool) -> Self {
        let at_once = f32::INFINITY;
        let safety = SafetySettings {
            coarsening_octaves_per_s: at_once,
            contrast_octaves_per_s: at_once,
            ..SafetySettings::default()
        };
        let offered: &[_] = if is_paper { &PAPER_RATES } else { &VULKAN_RATES };
        let settings = PlanSettings {
            rates,
            safety: if is_paper { SafetySettings::PAPER } else { safety },
            device: DeviceRates { available: AvailableRates::new(offered), texel: [16; 2] },
            ..PlanSettings::default()
        };
        Self { name: name.to_owned(), settings, audio: None, shades: None, judged: None }
    }

    /// By contrast, with this budget in silence.
    fn of_contrast(name: &str, allocation: Allocation, cap: Option<FixedFoveation>, budget: f32) -> Self {
        Self::new(name, RateSettings::AudioVisual(of_budget(allocation, cap, budget)), false)
    }

    pub fn map(&self, still: &Still) -> Map {
        if let Some(price) = self.judged {
            return by_the_judge(still, price);
        }
        let Some(shades) = self.shades else { return self.planned(still, &self.settings) };
        let with = |budget: f32| {
            let model = of_budget(Allocation::EqualMarginalLoss, None, budget);
            PlanSettings { rates: RateSettings::AudioVisual(model), ..self.settings }
        };
        let (mut low, mut high) = (0.0f32, 64.0f32);
        for _ in 0..16 {
            let middle = low.midpoint(high);
            let map = self.planned(still, &with(middle));
            (low, high) = if map.share() > shades { (middle, high) } else { (low, middle) };
        }
        self.planned(still, &with(high))
    }

    fn planned(&self, still: &Still, settings: &PlanSettings) -> Map {
        let eye = |extent| EyeInput {
            offset: [0; 2],
            extent,
            fov: FOV,
            orientation: Quat::IDENTITY,
            contrast: Some(&still.contrast),
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
            audio: self.audio,
        };
        // Nothing limits how fast tiles become coarser.
        let mut planner = Planner::new(*settings);
        let plan = &planner.plan(&input).eyes[0];
        Map((0..TILES * TILES).map(|index| plan.rate(index % TILES, index / TILES)).collect())
    }
}

/// Equal marginal loss as judged, outside of the fovea that the safety limits keep.
fn by_the_judge(still: &Still, price: f32) -> Map {
    const STEPS: [ShadingRate; 4] =
        [ShadingRate::R2X1, ShadingRate::R2X2, ShadingRate::R4X2, ShadingRate::R4X4];
    let judged = still.judged(&STEPS);
    let way = Way::of_contrast("", Allocation::PerTile, None, 1e6);
    let Map(outside) = way.planned(still, &way.settings);
    let best = |tile: usize| {
        let each = STEPS.iter().zip(&judged).map(|(rate, losses)| (*rate, losses[tile]));
        let all = std::iter::once((ShadingRate::R1X1, 0.0)).chain(each);
        let cost = |(rate, loss): &(ShadingRate, f32)| loss + price * rate.fraction();
        all.min_by(|one, other| cost(one).total_cmp(&cost(other))).map_or(ShadingRate::R1X1, |(rate, _)| rate)
    };
    let chosen = outside.iter().enumerate();
    Map(chosen.map(|(tile, rate)| if *rate == ShadingRate::R1X1 { *rate } else { best(tile) }).collect())
}

/// A model that may lose so much without sound.
fn of_budget(allocation: Allocation, cap: Option<FixedFoveation>, budget: f32) -> AudioVisual {
    let (alpha, greatest_loss) = match allocation {
        Allocation::PerTile => (budget, f32::INFINITY),
        Allocation::EqualMarginalLoss => (0.0, budget + BudgetSettings::default().greatest()),
    };
    let budget = BudgetSettings { silence: SilenceRule::Alpha(alpha), ..BudgetSettings::default() };
    AudioVisual { budget, allocation, cap, greatest_loss, ..AudioVisual::default() }
}

/// A sound.
fn heard(lufs: f32, khz: f32) -> AudioFeatures {
    AudioFeatures {
        loudness_lufs: lufs,
        gamma_ld: (lufs + 35.0).clamp(0.0, 25.0),
        gamma_fq_kilomel: (mel_of_hz(f64::from(khz) * 1000.0) / 1000.0) as f32,
        silent: false,
    }
}

/// All ways.
pub fn ways(stills: &[Still]) -> Vec<Way> {
    let mut ways = Vec::new();
    for (name, map) in [
        ("FR L1-C1 of the paper", FixedFoveation::L1_C1),
        ("FR L1-C3 of the paper", FixedFoveation::L1_C3),
        ("FR L3-C3 of the paper", FixedFoveation::L3_C3),
    ] {
        ways.push(Way::new(name, RateSettings::Fixed(map), true));
    }
    ways.push(Way::new(
        "rings of L1-C1, with safety limits",
        RateSettings::Fixed(FixedFoveation::L1_C1),
        false,
    ));
    ways.push(Way::new(
        "rings of L1-C3, with safety limits",
        RateSettings::Fixed(FixedFoveation::L1_C3),
        false,
    ));
    let capped = Some(FixedFoveation::L1_C3);
    ways.push(Way::of_contrast("1.0 for each tile, within rings", Allocation::PerTile, capped, 1.0));
    for budget in [1.0, 1.8, 3.0, 5.0] {
        let name = format!("{budget:.1} for each tile");
        ways.push(Way::of_contrast(&name, Allocation::PerTile, None, budget));
    }
    let mut of_price = Vec::new();
    for price in [1.0, 2.0, 4.0, 8.0, 12.0] {
        let name = format!("equal marginal loss, {price:.1}");
        of_price.push(Way::of_contrast(&name, Allocation::EqualMarginalLoss, None, price));
    }
    // The same samples in each view as one price has in the mean of all.
    let alike: Vec<Way> = [1, 2]
        .into_iter()
        .map(|index: usize| {
            let shares = stills.iter().map(|still| of_price[index].map(still).share());
            let shades = shares.sum::<f64>() / stills.len().max(1) as f64;
            let name = format!("equal marginal loss, {shades:.3} of each view");
            Way { shades: Some(shades), ..Way::of_contrast(&name, Allocation::EqualMarginalLoss, None, 1.0) }
        })
        .collect();
    ways.extend(of_price);
    ways.extend(alike);
    for price in [0.25, 0.5, 1.0] {
        let name = format!("equal marginal loss as judged, {price:.1}");
        let way = Way::of_contrast(&name, Allocation::PerTile, None, 0.0);
        ways.push(Way { judged: Some(price), ..way });
    }
    let budget = BudgetSettings { silence: SilenceRule::Strict, ..BudgetSettings::default() };
    for greatest_loss in [4.0, 8.0, 12.0] {
        let model = AudioVisual { budget, greatest_loss, ..AudioVisual::default() };
        let rates = RateSettings::AudioVisual(model);
        let name = format!("greatest_loss = {greatest_loss:.1}, without sound");
        ways.push(Way::new(&name, rates, false));
        for (lufs, khz) in [(-35.0, 6.0), (-20.0, 2.0), (-10.0, 1.0)] {
            let name = format!("greatest_loss = {greatest_loss:.1}, {lufs} LUFS, {khz} kHz");
            ways.push(Way { audio: Some(heard(lufs, khz)), ..Way::new(&name, rates, false) });
        }
    }
    ways
}
