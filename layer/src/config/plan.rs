//! Settings of the planner, from the configuration.

use super::{
    Config, GazeSource, PeripheralRate, Preset, RatesBackend, RatesGate, RatesMode, ReuseMode, ReusePhase,
    SilenceRule, chroma_settings,
};
use parafovea_core::avpm::{self, BudgetSettings};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gate::{GateMode, Techniques};
use parafovea_core::gaze::GazeSettings;
use parafovea_core::plan::{AudioVisual, PlanSettings, RateSettings, Turns, UpdateSettings};
use parafovea_core::presets;
use parafovea_core::rate::ShadingRate;
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
            RatesMode::Auto if on_cpu => Self::Rings,
            RatesMode::Fixed => Self::Rings,
            RatesMode::Auto | RatesMode::AudioVisual => Self::Contrast,
            RatesMode::Paper => Self::Paper,
        }
    }

    fn has_contrast(self) -> bool {
        matches!(self, Self::Contrast | Self::Paper)
    }
}

/// The settings of the planner, on a device that offers these rates, in any order, for tiles of `texel` pixels; `on_cpu` if a CPU renders.
pub fn plan_settings(
    config: &Config,
    offered: &[ShadingRate],
    texel: [u32; 2],
    on_cpu: bool,
) -> PlanSettings {
    let fixed = fixed_foveation(config);
    let rates = match RatesSource::of(config, on_cpu) {
        RatesSource::Nothing => RateSettings::Off,
        RatesSource::Rings => RateSettings::Fixed(fixed),
        RatesSource::Contrast => RateSettings::AudioVisual(audio_visual(config)),
        RatesSource::Paper => RateSettings::AudioVisual(AudioVisual { fixed, ..AudioVisual::PAPER }),
    };
    let preset = preset(config.preset);
    PlanSettings {
        rates,
        schedule: update_settings(config, preset.settings().faster_in_pursuit),
        chroma: chroma_settings(config),
        contrast_on_gpu: wants_contrast(config, on_cpu),
        ..PlanSettings::of(preset, false, offered, texel)
    }
}

/// Whether the configuration asks for rates by the contrast of pictures, on a device that is a CPU or not.
pub fn wants_contrast(config: &Config, on_cpu: bool) -> bool {
    wants_maps(config) && RatesSource::of(config, on_cpu).has_contrast()
}

/// How sound and contrast lead to rates: by castleCSF, within the configured limits.
fn audio_visual(config: &Config) -> AudioVisual {
    let fixed = fixed_foveation(config);
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

/// Whether the configuration asks for pictures that are not rendered anew in each frame.
pub fn wants_reuse(config: &Config) -> bool {
    wants_maps(config) && config.reuse.mode != ReuseMode::Off
}

/// In how many frames the outermost region is rendered once.
pub fn longest_period(config: &Config) -> u32 {
    config.reuse.periods.of_regions().into_iter().max().unwrap_or(1).into()
}

/// How many images the application needs so that pictures of a whole period stay while it draws one or two more. Where a few more
/// are a whole number of all periods, so many: an image then has the same turn again and again, and what leaves tiles out of it
/// stays as it is while nothing moves.
pub fn images_for_reuse(config: &Config) -> u32 {
    const FEW: u32 = 2;
    let least = longest_period(config) + 2;
    let periods = config.reuse.periods.of_regions();
    let is_round = |count: &u32| periods.iter().all(|period| count.is_multiple_of(u32::from(*period).max(1)));
    (least..=least + FEW).find(is_round).unwrap_or(least)
}

/// How the gaze is judged. One from a file may rest for ever.
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

/// The preset of the models for values without an option: the rates to choose from and the safety rails.
fn preset(preset: Preset) -> presets::Preset {
    match preset {
        Preset::None | Preset::Balanced => presets::Preset::Balanced,
        Preset::Quality => presets::Preset::Quality,
        Preset::Performance => presets::Preset::Performance,
        Preset::Streaming => presets::Preset::Streaming,
        Preset::Fixed => presets::Preset::Fixed,
        Preset::Paper => presets::Preset::Paper,
    }
}

/// How often the periphery is rendered; nothing where every frame renders everything.
fn update_settings(config: &Config, faster_in_pursuit: bool) -> Option<UpdateSettings> {
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
    // What the options accept, the models do.
    let configuration = UpdateConfiguration::new(config.reuse.periods.of_regions()).unwrap_or_default();
    let schedule = Schedule { configuration, phase, ..Schedule::default() };
    Some(UpdateSettings {
        schedule,
        faster_in_pursuit: faster_in_pursuit && !is_paper,
        turns: if is_paper { Turns::Tiles } else { Turns::Directions },
        uncapped: is_paper || config.reuse.below_30_hz,
    })
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
        plan_settings(config, &VULKAN_RATES, [16, 16], false)
    }

    #[test]
    fn a_preset_of_the_configuration_is_that_of_the_models() {
        for (ours, theirs) in [
            (Preset::Quality, presets::Preset::Quality),
            (Preset::Balanced, presets::Preset::Balanced),
            (Preset::Performance, presets::Preset::Performance),
            (Preset::Streaming, presets::Preset::Streaming),
            (Preset::Fixed, presets::Preset::Fixed),
            (Preset::Paper, presets::Preset::Paper),
        ] {
            let is_paper = ours == Preset::Paper;
            // Without a tracker the eyes may be anywhere: rings around the centre, at any contrast.
            let by_contrast = ours != Preset::Fixed;
            let mut expected = PlanSettings {
                contrast_on_gpu: by_contrast,
                ..PlanSettings::of(theirs, by_contrast, &VULKAN_RATES, [16, 16])
            };
            if let RateSettings::AudioVisual(model) = &mut expected.rates {
                model.budget.silence = avpm::SilenceRule::Strict;
            }
            let mut config = Config::of_preset(ours);
            assert_eq!(config.reuse.mode != ReuseMode::Off, is_paper, "{theirs}");
            config.reuse.mode = ReuseMode::Off;
            assert_eq!(settings(&config), PlanSettings { schedule: None, ..expected }, "{theirs}");
            config.reuse.mode = if is_paper { ReuseMode::Paper } else { ReuseMode::On };
            let schedule = expected.schedule.map(|updates| match ours {
                Preset::Paper => UpdateSettings { turns: Turns::Tiles, uncapped: true, ..updates },
                _ => updates,
            });
            assert_eq!(settings(&config), PlanSettings { schedule, ..expected }, "{theirs}");
        }
    }

    /// On a CPU device contrast costs more than it saves, and each preset has the rings of the models.
    #[test]
    fn presets_measure_contrast_on_gpus_alone() {
        for (ours, theirs) in [
            (Preset::Quality, presets::Preset::Quality),
            (Preset::Balanced, presets::Preset::Balanced),
            (Preset::Performance, presets::Preset::Performance),
            (Preset::Streaming, presets::Preset::Streaming),
        ] {
            let config = Config::of_preset(ours);
            assert_eq!(
                [true, false].map(|on_cpu| wants_contrast(&config, on_cpu)),
                [false, true],
                "{theirs}"
            );
            let expected = PlanSettings::of(theirs, false, &VULKAN_RATES, [16, 16]);
            let found = plan_settings(&config, &VULKAN_RATES, [16, 16], true);
            assert_eq!(found, PlanSettings { schedule: None, ..expected }, "{theirs}");
        }
        let mut config = Config::of_preset(Preset::Fixed);
        assert_eq!([true, false].map(|on_cpu| wants_contrast(&config, on_cpu)), [false; 2]);
        config.rates.mode = RatesMode::AudioVisual;
        assert_eq!([true, false].map(|on_cpu| wants_contrast(&config, on_cpu)), [true; 2], "as asked for");
        config.enabled = false;
        assert_eq!([true, false].map(|on_cpu| wants_contrast(&config, on_cpu)), [false; 2]);
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
        disabled.reuse.mode = ReuseMode::On;
        for config in [disabled, Config::of_preset(Preset::None)] {
            let settings = settings(&config);
            assert_eq!((settings.rates, settings.schedule, settings.chroma), (RateSettings::Off, None, None));
        }
    }

    #[test]
    fn sound_hides_what_is_configured_and_in_the_paper_all_that_it_can() {
        let model = |config: &Config| match settings(config) {
            PlanSettings { rates: RateSettings::AudioVisual(model), contrast_on_gpu: true, .. } => model,
            other => panic!("{other:?}"),
        };
        let mut config = Config::default();
        config.rates.mode = RatesMode::AudioVisual;
        let strict = BudgetSettings { silence: avpm::SilenceRule::Strict, ..BudgetSettings::default() };
        assert_eq!(model(&config), AudioVisual { budget: strict, ..AudioVisual::default() });
        config.rates.greatest_loss = 1.5;
        config.rates.silence = SilenceRule::Fixed;
        config.rates.peripheral = PeripheralRate::R2x2;
        let edited = model(&config);
        assert_eq!((edited.greatest_loss, edited.budget.silence), (1.5, avpm::SilenceRule::FixedFoveation));
        assert_eq!(edited.cap.unwrap().peripheral, ShadingRate::R2X2, "no coarser than configured");
        config.rates.peripheral = PeripheralRate::R4x4;
        config.rates.mode = RatesMode::Paper;
        assert_eq!(model(&config), AudioVisual::PAPER);
    }

    #[test]
    fn what_is_not_configured_is_off() {
        let modes = |rates, reuse| Techniques { rates, reuse };
        let mut config = Config::default();
        assert_eq!(gate_modes(&config), modes(GateMode::Auto, GateMode::Off));
        config.reuse.mode = ReuseMode::On;
        config.rates.gate = RatesGate::On;
        assert_eq!(gate_modes(&config), modes(GateMode::On, GateMode::On));
        config.rates.mode = RatesMode::Off;
        assert_eq!(gate_modes(&config), modes(GateMode::Off, GateMode::On));
        config.rates.backend = RatesBackend::Off;
        assert_eq!(gate_modes(&config), modes(GateMode::Off, GateMode::Off));
    }

    #[test]
    fn periods_and_phase_are_as_configured() {
        let mut config = Config::default();
        config.reuse.mode = ReuseMode::On;
        config.reuse.phase = ReusePhase::AlternateEye;
        let updates = settings(&config).schedule.unwrap();
        assert_eq!(updates.schedule.configuration, UpdateConfiguration::F11223);
        assert_eq!(updates.schedule.phase, Phase::AlternateEye);
        assert!(!updates.uncapped && updates.faster_in_pursuit);
        config.reuse.below_30_hz = true;
        assert!(settings(&config).schedule.unwrap().uncapped);
        config.rates.backend = RatesBackend::Off;
        assert_eq!(settings(&config).schedule, None, "nothing could be left out");
    }
}
