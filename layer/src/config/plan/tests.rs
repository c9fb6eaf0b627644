use super::*;
use glam::Vec3;
use parafovea_core::chroma::{self, ChromaSettings};
use parafovea_core::fixed_foveation::eccentricities_deg;
use parafovea_core::geometry::Fov;

const GPU: PlannedDevice<'_> =
    PlannedDevice { rates: &VULKAN_RATES, texel: [16, 16], is_cpu: false, has_mask: false };

fn settings(config: &Config) -> PlanSettings {
    plan_settings(config, &GPU)
}

/// Presets with rings, and the share of a PICO 4's pixels that their rings shade, without a mask and with one: the table of manifest/GUIDE.md.
const RINGS: [(Preset, [f32; 2]); 5] = [
    (Preset::Quality, [0.325; 2]),
    (Preset::Balanced, [0.148, 0.206]),
    (Preset::Performance, [0.107; 2]),
    (Preset::Streaming, [0.148, 0.206]),
    (Preset::Fixed, [0.466; 2]),
];

/// 2160 x 2160 pixels at 105 degrees in tiles of 16 x 16, gaze ahead, without safety margins.
#[test]
fn rings_of_presets_shade_the_documented_share() {
    let half = 52.5f32.to_radians();
    let plane = Fov { left: -half, right: half, up: half, down: -half }.tangents().plane([2160; 2]);
    let tiles = eccentricities_deg(&plane, [2160; 2], [16, 16], Vec3::NEG_Z);
    for (preset, shares) in RINGS {
        for (has_mask, share) in [false, true].into_iter().zip(shares) {
            let rings = fixed_foveation(&Config::of_preset(preset), has_mask);
            let found = rings.mean_shading_rate(&tiles, &VULKAN_RATES);
            assert!((found - share).abs() < 6e-4, "{preset:?}, mask {has_mask}: {found}");
        }
    }
}

#[test]
fn a_mask_shades_at_least_an_eighth_unless_configured_otherwise() {
    let peripheral = |config: &Config, has_mask| {
        let device = PlannedDevice { is_cpu: true, has_mask, ..GPU };
        match plan_settings(config, &device).rates {
            RateSettings::Fixed(rings) => rings.peripheral,
            other => panic!("{other:?}"),
        }
    };
    let mut config = Config::default();
    assert_eq!([false, true].map(|mask| peripheral(&config, mask)), [ShadingRate::R4X4, ShadingRate::R4X2]);
    for (option, rate) in
        [(PeripheralRate::R4x4, ShadingRate::R4X4), (PeripheralRate::R2x2, ShadingRate::R2X2)]
    {
        config.rates.peripheral = option;
        assert_eq!([false, true].map(|mask| peripheral(&config, mask)), [rate; 2]);
    }
}

#[test]
fn cheaper_presets_are_nowhere_finer() {
    let [quality, balanced, performance] =
        [Preset::Quality, Preset::Balanced, Preset::Performance].map(Config::of_preset);
    let pairs = [(&quality, &balanced), (&balanced, &performance)];
    for ((finer, coarser), has_mask) in pairs.into_iter().flat_map(|pair| [(pair, false), (pair, true)]) {
        for eccentricity in (0..1800).map(|tenth| tenth as f32 * 0.1) {
            let rate = |config: &Config| {
                fixed_foveation(config, has_mask).shading_rate_of(eccentricity, &VULKAN_RATES).fraction()
            };
            assert!(rate(coarser) <= rate(finer), "at {eccentricity} degrees");
        }
        let [slow, fast] = [coarser, finer].map(|config| config.reuse.periods.of_regions());
        assert!(slow.iter().zip(fast).all(|(slow, fast)| *slow >= fast));
        assert!(coarser.rates.greatest_loss > finer.rates.greatest_loss);
    }
}

/// The fovea of the planner's safety limits, with the tracker's error, lies within the inner ring.
#[test]
fn rings_of_presets_begin_outside_of_the_fovea() {
    let SafetySettings { least_foveal_deg, tracker_error_deg, .. } = SafetySettings::default();
    for (preset, _) in RINGS {
        let rings = fixed_foveation(&Config::of_preset(preset), false);
        assert_eq!(rings.rate_at(least_foveal_deg + tracker_error_deg), 1.0, "{preset:?}");
    }
}

#[test]
fn presets_differ_from_balanced_in_their_own_options_alone() {
    let balanced = settings(&Config::of_preset(Preset::Balanced));
    let strict = BudgetSettings { silence: avpm::SilenceRule::Strict, ..BudgetSettings::default() };
    let model = AudioVisual { budget: strict, ..AudioVisual::default() };
    assert_eq!(balanced.rates, RateSettings::AudioVisual(model));
    let with_rates = |rates| PlanSettings { rates, ..balanced };
    let quality = AudioVisual {
        fixed: FixedFoveation::L1_C1.with_peripheral(ShadingRate::R2X2),
        cap: model.cap.map(|cap| cap.with_peripheral(ShadingRate::R2X2)),
        greatest_loss: 4.0,
        ..model
    };
    let performance = AudioVisual { fixed: FixedFoveation::L1_C3, greatest_loss: 12.0, ..model };
    // Without a tracker the eyes may be anywhere: rings around the centre, at any contrast.
    let fixed = RateSettings::Fixed(FixedFoveation::WITHOUT_TRACKER);
    for (preset, expected) in [
        (Preset::Quality, with_rates(RateSettings::AudioVisual(quality))),
        (Preset::Performance, with_rates(RateSettings::AudioVisual(performance))),
        (Preset::Streaming, PlanSettings { chroma: Some(ChromaSettings::default()), ..balanced }),
        (Preset::Fixed, PlanSettings { contrast_on_gpu: false, ..with_rates(fixed) }),
    ] {
        assert_eq!(settings(&Config::of_preset(preset)), expected, "{preset:?}");
    }
}

#[test]
fn the_paper_preset_has_the_papers_rates_schedule_and_curves_and_no_safety_limits() {
    let found = settings(&Config::of_preset(Preset::Paper));
    let schedule =
        Schedule { configuration: UpdateConfiguration::F11223, phase: Phase::Aligned, ..Schedule::default() };
    let expected = PlanSettings {
        rates: RateSettings::AudioVisual(AudioVisual::PAPER),
        schedule: Some(UpdateSettings {
            schedule,
            faster_in_pursuit: false,
            unit: UpdateUnit::Tiles,
            uncapped: true,
        }),
        chroma: Some(ChromaSettings { mode: chroma::Mode::Paper, ..ChromaSettings::default() }),
        safety: SafetySettings::PAPER,
        device: DeviceRates { available: AvailableRates::new(&PAPER_RATES), texel: [16, 16] },
        contrast_on_gpu: true,
    };
    assert_eq!(found, expected);
}

#[test]
fn reuse_is_one_step_faster_in_pursuit_but_in_the_paper_preset() {
    for (preset, _) in RINGS.into_iter().chain([(Preset::Paper, [0.0; 2])]) {
        let mut config = Config::of_preset(preset);
        config.reuse.mode = ReuseMode::On;
        let updates = settings(&config).schedule.unwrap();
        assert_eq!(updates.faster_in_pursuit, preset != Preset::Paper, "{preset:?}");
        assert!(!updates.uncapped && updates.unit == UpdateUnit::Directions, "{preset:?}");
    }
}

/// On a CPU device contrast costs more than it saves.
#[test]
fn presets_measure_contrast_on_gpus_alone() {
    for preset in [Preset::Quality, Preset::Balanced, Preset::Performance, Preset::Streaming] {
        let config = Config::of_preset(preset);
        let found = [true, false].map(|on_cpu| wants_contrast(&config, on_cpu));
        assert_eq!(found, [false, true], "{preset:?}");
        for has_mask in [false, true] {
            let on_cpu = plan_settings(&config, &PlannedDevice { is_cpu: true, has_mask, ..GPU });
            assert_eq!(on_cpu.rates, RateSettings::Fixed(fixed_foveation(&config, has_mask)), "{preset:?}");
            assert!(!on_cpu.contrast_on_gpu, "{preset:?}");
        }
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
fn disabled_techniques_are_not_planned() {
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
fn unset_options_are_off() {
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

/// Less is known without a gaze.
#[test]
fn without_a_gaze_nothing_is_coarser_than_the_configured_periphery() {
    for peripheral in [PeripheralRate::R2x1, PeripheralRate::R2x2, PeripheralRate::R4x2, PeripheralRate::R4x4]
    {
        let mut config = Config::of_preset(Preset::Balanced);
        (config.rates.peripheral, config.rates.foveal_deg) = (peripheral, 60.0);
        let lost = settings(&config).safety.lost.unwrap();
        let rings = fixed_foveation(&config, false);
        assert!(lost.peripheral.octaves() <= rings.peripheral.octaves(), "{peripheral:?}");
        assert_eq!(lost.foveal_deg, 60.0);
    }
}

/// Contrast is judged by where the eyes look.
#[test]
fn a_gaze_that_is_fixed_has_rings() {
    let mut config = Config::of_preset(Preset::Balanced);
    assert!(matches!(settings(&config).rates, RateSettings::AudioVisual(_)));
    config.gaze.source = GazeSource::Centre;
    assert!(matches!(settings(&config).rates, RateSettings::Fixed(_)));
    assert!(!wants_contrast(&config, false));
    config.rates.mode = RatesMode::AudioVisual;
    assert!(matches!(settings(&config).rates, RateSettings::AudioVisual(_)));
}
