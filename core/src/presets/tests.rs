use super::*;
use crate::fixed_foveation::eccentricities_deg;
use crate::geometry::Fov;
use glam::Vec3;

/// The fovea that the plan's rails keep at full rate, with the tracker's error: `RailSettings::default`.
const LEAST_FOVEA_DEG: f32 = 5.0 + 1.1;

/// Mean rate on a PICO 4 with the preset's rates.
fn shades(settings: &PresetSettings) -> f32 {
    let half = 52.5f32.to_radians();
    let plane = Fov { left: -half, right: half, up: half, down: -half }.tangents().plane([2160; 2]);
    let tiles = eccentricities_deg(&plane, [2160; 2], [16, 16], Vec3::NEG_Z);
    settings.fixed_foveation.mean_shading_rate(&tiles, settings.rates)
}

#[test]
fn presets_have_names() {
    for preset in Preset::ALL {
        assert_eq!(preset.to_string().parse(), Ok(preset));
    }
    let error = "Quality".parse::<Preset>().unwrap_err().to_string();
    assert!(Preset::ALL.iter().all(|preset| error.contains(preset.name())), "{error}");
}

#[test]
fn presets_shade_what_their_table_says() {
    for (preset, share) in [
        (Preset::Quality, 0.325),
        (Preset::Balanced, 0.148),
        (Preset::Performance, 0.107),
        (Preset::Streaming, 0.148),
        (Preset::Fixed, 0.466),
        (Preset::Paper, 0.162),
    ] {
        let found = shades(&preset.settings());
        assert!((found - share).abs() < 6e-4, "{preset}: {found}");
    }
}

#[test]
fn what_costs_less_is_nowhere_finer() {
    let [quality, balanced, performance] =
        [Preset::Quality, Preset::Balanced, Preset::Performance].map(Preset::settings);
    for (finer, coarser) in [(&quality, &balanced), (&balanced, &performance)] {
        for eccentricity in (0..1800).map(|tenth| tenth as f32 * 0.1) {
            let rate = |settings: &PresetSettings| {
                settings.fixed_foveation.shading_rate_of(eccentricity, settings.rates).fraction()
            };
            assert!(rate(coarser) <= rate(finer), "at {eccentricity} degrees");
        }
        let factors = |settings: &PresetSettings| settings.update.factors();
        assert!(factors(coarser).iter().zip(factors(finer)).all(|(slow, fast)| *slow >= fast));
    }
}

#[test]
fn every_fovea_is_wide_enough_and_rates_are_coarsest_first() {
    for preset in Preset::ALL {
        let settings = preset.settings();
        assert_eq!(settings.fixed_foveation.rate_at(LEAST_FOVEA_DEG), 1.0, "{preset}");
        assert!(settings.rates.is_sorted_by(|a, b| a.fraction() <= b.fraction()));
        assert!(settings.rates.contains(&settings.fixed_foveation.peripheral));
        assert_eq!(settings.chroma.is_some(), [Preset::Streaming, Preset::Paper].contains(&preset));
    }
}
