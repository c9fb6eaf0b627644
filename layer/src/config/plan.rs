//! Settings of the planner, from the configuration.

use super::{
    Config, GazeSource, PeripheralRate, Preset, RatesBackend, RatesGate, RatesMode, ReuseMode, ReusePhase,
    SilenceRule, chroma_settings,
};
use parafovea_core::avpm::{self, BudgetSettings};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gate::{GateMode, Techniques};
use parafovea_core::gaze::GazeSettings;
use parafovea_core::plan::{
    AudioVisual, AvailableRates, DeviceRates, PlanSettings, RateSettings, SafetySettings, UpdateSettings,
    UpdateUnit,
};
use parafovea_core::rate::{PAPER_RATES, ShadingRate, VULKAN_RATES};
use parafovea_core::schedule::{Phase, Schedule, UpdateConfiguration};

/// The source of rates on a device: `rates.mode`, with "auto" decided. On a CPU device the kernels that measure contrast take as long
/// as the shading that they save (`cargo dev report`: contrast against rings).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RatesSource {
    Nothing,
    Rings,
    Contrast,
    Paper,
}

impl RatesSource {
    fn of(config: &Config, on_cpu: bool) -> Self {
        match config.rates.mode {
            _ if !config.enabled => Self::Nothing,
            RatesMode::Off => Self::Nothing,
            // Contrast is judged by where the eyes look, which a fixed gaze does not know.
            RatesMode::Auto if on_cpu || config.gaze.source == GazeSource::Centre => Self::Rings,
            RatesMode::Fixed => Self::Rings,
            RatesMode::Auto | RatesMode::AudioVisual => Self::Contrast,
            RatesMode::Paper => Self::Paper,
        }
    }

    fn has_contrast(self) -> bool {
        matches!(self, Self::Contrast | Self::Paper)
    }
}

/// A device, as far as settings depend on it.
#[derive(Clone, Copy, Debug)]
pub struct PlannedDevice<'a> {
    /// Its rates besides 1x1, in any order.
    pub rates: &'a [ShadingRate],
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
    /// Whether it is a CPU.
    pub is_cpu: bool,
    /// Whether its rates come from a mask.
    pub has_mask: bool,
}

/// The settings of the planner, on a device.
pub fn plan_settings(config: &Config, device: &PlannedDevice<'_>) -> PlanSettings {
    let fixed = fixed_foveation(config, device.has_mask);
    let rates = match RatesSource::of(config, device.is_cpu) {
        RatesSource::Nothing => RateSettings::Off,
        RatesSource::Rings => RateSettings::Fixed(fixed),
        RatesSource::Contrast => RateSettings::AudioVisual(audio_visual(config, fixed)),
        RatesSource::Paper => RateSettings::AudioVisual(AudioVisual { fixed, ..AudioVisual::PAPER }),
    };
    // All seven rates of Vulkan follow the radii more closely than the paper's four, and never shade more.
    let is_paper = config.preset == Preset::Paper;
    let safety = if is_paper { SafetySettings::PAPER } else { SafetySettings::default() };
    let wanted: &[ShadingRate] = if is_paper { &PAPER_RATES } else { &VULKAN_RATES };
    PlanSettings {
        rates,
        schedule: update_settings(config),
        chroma: chroma_settings(config),
        safety: SafetySettings { lost: safety.lost.map(|lost| lost.limited_by(&fixed)), ..safety },
        device: DeviceRates { available: AvailableRates::among(wanted, device.rates), texel: device.texel },
        contrast_on_gpu: wants_contrast(config, device.is_cpu),
    }
}

/// Whether the configuration asks for rates by the contrast of pictures, on a device that is a CPU or not.
pub fn wants_contrast(config: &Config, on_cpu: bool) -> bool {
    wants_maps(config) && RatesSource::of(config, on_cpu).has_contrast()
}

/// Settings for shading rates by sound and contrast: by castleCSF, within the configured limits.
fn audio_visual(config: &Config, fixed: FixedFoveation) -> AudioVisual {
    let usual = AudioVisual::default();
    let silence = match config.rates.silence {
        SilenceRule::Fixed => avpm::SilenceRule::FixedFoveation,
        SilenceRule::Contrast => avpm::SilenceRule::Strict,
    };
    AudioVisual {
        budget: BudgetSettings { silence, ..usual.budget },
        fixed,
        cap: usual.cap.map(|cap| cap.with_peripheral(fixed.peripheral)),
        greatest_loss: config.rates.greatest_loss,
        ..usual
    }
}

/// Whether the configuration asks for passes to shade less: coarsely, or not in each frame.
pub fn wants_maps(config: &Config) -> bool {
    let has_technique = config.rates.mode != RatesMode::Off || config.reuse.mode != ReuseMode::Off;
    config.enabled && config.rates.backend != RatesBackend::Off && has_technique
}

/// Whether the configuration asks for passes to re-use earlier frames' pictures.
pub fn wants_reuse(config: &Config) -> bool {
    wants_maps(config) && config.reuse.mode != ReuseMode::Off
}

/// Number of frames in which the outermost region is rendered once.
pub fn longest_period(config: &Config) -> u32 {
    config.reuse.periods.of_regions().into_iter().max().unwrap_or(1).into()
}

/// Number of images that the application needs so that pictures of a whole period stay while it draws one or two more. If a slightly
/// larger number is a multiple of all periods, that number: an image then always has the same turn, and the tiles left out of it stay
/// the same while nothing moves.
pub fn images_for_reuse(config: &Config) -> u32 {
    const FEW: u32 = 2;
    let least = longest_period(config) + 2;
    let periods = config.reuse.periods.of_regions();
    let is_round = |count: &u32| periods.iter().all(|period| count.is_multiple_of(u32::from(*period).max(1)));
    (least..=least + FEW).find(is_round).unwrap_or(least)
}

/// Settings of the gaze tracking. A gaze from a file may rest for ever.
pub fn gaze_settings(config: &Config) -> GazeSettings {
    let settings = GazeSettings { hold_ms: config.gaze.hold_ms as f32, ..GazeSettings::default() };
    match config.gaze.source {
        GazeSource::Auto | GazeSource::Eyes | GazeSource::Osc | GazeSource::Centre => settings,
        GazeSource::File => GazeSettings { frozen_ms: f32::INFINITY, ..settings },
    }
}

/// Modes of the gates of rates and re-use; off for a technique that is not configured.
pub fn gate_modes(config: &Config) -> Techniques<GateMode> {
    let mode = match config.rates.gate {
        RatesGate::Auto => GateMode::Auto,
        RatesGate::On => GateMode::On,
        RatesGate::Off => GateMode::Off,
    };
    let of = |is_configured| if is_configured { mode } else { GateMode::Off };
    let has_rates = wants_maps(config) && config.rates.mode != RatesMode::Off;
    Techniques { rates: of(has_rates), reuse: of(wants_reuse(config)) }
}

/// Whether an edit of the configuration changes the cost of a frame with shading rates or re-use, or of one without them: earlier decisions of
/// the gates do not hold any more.
pub fn changes_costs(before: &Config, now: &Config) -> bool {
    let costs = |config: &Config| {
        (
            config.enabled,
            config.rates,
            config.reuse,
            config.chroma.mode,
            config.gaze.source,
            config.audio.source,
        )
    };
    costs(before) != costs(now)
}

/// The update schedule; `None` if every frame renders everything.
fn update_settings(config: &Config) -> Option<UpdateSettings> {
    if !wants_reuse(config) {
        return None;
    }
    let is_paper = config.reuse.mode == ReuseMode::Paper;
    let phase = match config.reuse.phase {
        _ if is_paper => Phase::Aligned,
        ReusePhase::Staggered => Phase::Staggered,
        ReusePhase::Aligned => Phase::Aligned,
        ReusePhase::AlternateEye => Phase::AlternateEye,
    };
    // The models accept all values that the options accept.
    let configuration = UpdateConfiguration::new(config.reuse.periods.of_regions()).unwrap_or_default();
    let schedule = Schedule { configuration, phase, ..Schedule::default() };
    Some(UpdateSettings {
        schedule,
        faster_in_pursuit: config.preset != Preset::Paper && !is_paper,
        unit: if is_paper { UpdateUnit::Tiles } else { UpdateUnit::Directions },
        uncapped: is_paper || config.reuse.below_30_hz,
    })
}

fn fixed_foveation(config: &Config, has_mask: bool) -> FixedFoveation {
    FixedFoveation {
        foveal_deg: config.rates.foveal_deg,
        transitional_deg: config.rates.transitional_deg,
        peripheral: match config.rates.peripheral {
            // Blocks of a sixteenth are 16 pixels apart, and lose twice the contrast of the rate 4x4; an eighth costs 0.05 of the pixels and
            // takes a quarter of that loss away (tests/baselines/fill.md, "Visible loss").
            PeripheralRate::Auto if has_mask => ShadingRate::R4X2,
            PeripheralRate::Auto => ShadingRate::R4X4,
            PeripheralRate::R2x1 => ShadingRate::R2X1,
            PeripheralRate::R2x2 => ShadingRate::R2X2,
            PeripheralRate::R4x2 => ShadingRate::R4X2,
            PeripheralRate::R4x4 => ShadingRate::R4X4,
        },
    }
}

#[cfg(test)]
mod tests;
