//! What may be planned, as the configuration asks for it.

use super::{Config, GazeSource, PeripheralRate, Preset, RatesGate, RatesMode, chroma_settings};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gate::GateMode;
use parafovea_core::gaze::GazeSettings;
use parafovea_core::plan::{PlanSettings, RateSettings};
use parafovea_core::presets;
use parafovea_core::rate::ShadingRate;

/// The settings of the planner, on a device that offers these rates, in any order, for tiles of `texel` pixels.
///
/// No schedule: nothing here renders tiles less often than each frame.
pub fn plan_settings(config: &Config, offered: &[ShadingRate], texel: [u32; 2]) -> PlanSettings {
    let rates = match config.rates.mode {
        _ if !config.enabled => RateSettings::Off,
        RatesMode::Off => RateSettings::Off,
        RatesMode::Fixed => RateSettings::Fixed(fixed_foveation(config)),
    };
    let preset = preset(config.preset);
    PlanSettings {
        rates,
        schedule: None,
        chroma: chroma_settings(config),
        ..PlanSettings::of(preset, false, offered, texel)
    }
}

/// How the gaze is judged. One from a file may rest for ever.
pub fn gaze_settings(config: &Config) -> GazeSettings {
    let settings = GazeSettings { hold_ms: config.gaze.hold_ms as f32, ..GazeSettings::default() };
    match config.gaze.source {
        GazeSource::Eyes | GazeSource::Centre => settings,
        GazeSource::File => GazeSettings { frozen_ms: f32::INFINITY, ..settings },
    }
}

/// Who decides whether rates pay.
pub fn gate_mode(config: &Config) -> GateMode {
    match config.rates.gate {
        RatesGate::Auto => GateMode::Auto,
        RatesGate::On => GateMode::On,
        RatesGate::Off => GateMode::Off,
    }
}

/// The preset of the models that has what the options do not say: the rates to choose from and the safety rails.
fn preset(preset: Preset) -> presets::Preset {
    match preset {
        Preset::None | Preset::Balanced => presets::Preset::Balanced,
        Preset::Quality => presets::Preset::Quality,
        Preset::Performance => presets::Preset::Performance,
        Preset::Streaming => presets::Preset::Streaming,
        Preset::Paper => presets::Preset::Paper,
    }
}

fn fixed_foveation(config: &Config) -> FixedFoveation {
    FixedFoveation {
        foveal_deg: config.rates.foveal_deg,
        transitional_deg: config.rates.transitional_deg,
        peripheral: match config.rates.peripheral {
            PeripheralRate::R2x1 => ShadingRate::R2X1,
            PeripheralRate::R2x2 => ShadingRate::R2X2,
            PeripheralRate::R4x2 => ShadingRate::R4X2,
            PeripheralRate::R4x4 => ShadingRate::R4X4,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_core::rate::VULKAN_RATES;

    fn settings(config: &Config) -> PlanSettings {
        plan_settings(config, &VULKAN_RATES, [16, 16])
    }

    #[test]
    fn a_preset_of_the_configuration_is_that_of_the_models() {
        for (ours, theirs) in [
            (Preset::Quality, presets::Preset::Quality),
            (Preset::Balanced, presets::Preset::Balanced),
            (Preset::Performance, presets::Preset::Performance),
            (Preset::Streaming, presets::Preset::Streaming),
            (Preset::Paper, presets::Preset::Paper),
        ] {
            let expected = PlanSettings::of(theirs, false, &VULKAN_RATES, [16, 16]);
            let expected = PlanSettings { schedule: None, ..expected };
            assert_eq!(settings(&Config::of_preset(ours)), expected, "{theirs}");
        }
    }

    #[test]
    fn a_configuration_without_any_file_is_balanced() {
        assert_eq!(Config::default(), Config::of_preset(Preset::Balanced));
        assert_eq!(gaze_settings(&Config::default()), GazeSettings::default());
    }

    #[test]
    fn what_is_off_is_not_planned() {
        let mut disabled = Config::of_preset(Preset::Streaming);
        disabled.enabled = false;
        for config in [disabled, Config::of_preset(Preset::None)] {
            let settings = settings(&config);
            assert_eq!((settings.rates, settings.chroma), (RateSettings::Off, None));
        }
    }
}
