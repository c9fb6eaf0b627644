use super::*;
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A sine of `hz` in one channel.
fn sine(rate_hz: u32, hz: f64, amplitude: f64, seconds: f64) -> Vec<f32> {
    let step = TAU * hz / f64::from(rate_hz);
    (0..(f64::from(rate_hz) * seconds) as u64).map(|n| (amplitude * (step * n as f64).sin()) as f32).collect()
}

fn all(rate_hz: u32, channels: u32, settings: &AudioSettings, samples: &[f32]) -> Vec<AudioFeatures> {
    let mut features = Vec::new();
    let mut extractor = FeatureExtractor::new(rate_hz, channels, settings).unwrap();
    extractor.push(samples, |set| features.push(set));
    features
}

#[test]
fn a_set_comes_every_hundred_milliseconds() {
    assert_eq!(all(48_000, 2, &AudioSettings::default(), &vec![0.0; 2 * 48_000]).len(), 10);
    assert_eq!(all(11_025, 1, &AudioSettings::default(), &[0.0; 1101]).len(), 0);
    assert_eq!(all(11_025, 1, &AudioSettings::default(), &[0.0; 1102]).len(), 1);
}

#[test]
fn an_unknown_format_is_named() {
    let error = |rate_hz, channels| {
        FeatureExtractor::new(rate_hz, channels, &AudioSettings::default()).err().unwrap().to_string()
    };
    assert_eq!(error(7_999, 2), "a sample rate of 7999 Hz is not within 8000..=192000 Hz");
    assert_eq!(error(0, 2), "a sample rate of 0 Hz is not within 8000..=192000 Hz");
    assert_eq!(error(192_001, 2), "a sample rate of 192001 Hz is not within 8000..=192000 Hz");
    assert_eq!(error(48_000, 0), "0 channels are not within 1..=8");
    assert_eq!(error(48_000, 9), "9 channels are not within 1..=8");
}

#[test]
fn settings_are_limited() {
    let odd =
        AudioSettings { mode: Mode::Paper, window_s: f32::INFINITY, least_lufs: -20.0, greatest_lufs: -40.0 };
    assert_eq!(odd.limited(), AudioSettings { window_s: 120.0, greatest_lufs: -20.0, ..odd });
    let nan = AudioSettings {
        mode: Mode::Default,
        window_s: f32::NAN,
        least_lufs: f32::NAN,
        greatest_lufs: f32::NAN,
    };
    assert_eq!(nan.limited(), AudioSettings::default());
}

#[test]
fn loudness_units_are_limited() {
    let gamma = |lufs| gamma_ld(lufs, &AudioSettings::default());
    for (lufs, expected) in [
        (f32::NEG_INFINITY, 0.0),
        (f32::NAN, 0.0),
        (-35.0, 0.0),
        (-18.54, 16.46),
        (-10.0, 25.0),
        (f32::INFINITY, 25.0),
    ] {
        assert!((gamma(lufs) - expected).abs() < 1e-5, "{lufs} LUFS: {}", gamma(lufs));
    }
}

#[test]
fn mel_frequency_is_limited() {
    assert_eq!(gamma_fq(None), GREATEST_KILOMEL);
    assert_eq!(gamma_fq(Some(f64::NAN)), GREATEST_KILOMEL);
    assert_eq!(gamma_fq(Some(0.0)), LEAST_KILOMEL);
    assert_eq!(gamma_fq(Some(1700.0)), 1.7);
    assert_eq!(gamma_fq(Some(f64::INFINITY)), GREATEST_KILOMEL);
}

#[test]
fn mel_of_known_frequencies() {
    assert!((mel_of_hz(1000.0) - 999.9855).abs() < 1e-4);
    assert!((mel_of_hz(700.0) - 2595.0 * 2f64.log10()).abs() < 1e-9);
    assert!((mel_of_hz(5420.0) - 2443.5905).abs() < 1e-3, "first item of paper A's Table 1");
    assert_eq!(mel_of_hz(f64::NAN), 0.0);
    assert!((f64::from(GREATEST_KILOMEL) - mel_of_hz(6000.0) / 1000.0).abs() < 1e-4);
    for hz in [20.0, 440.0, 20_000.0] {
        assert!((hz_of_mel(mel_of_hz(hz)) - hz).abs() < 1e-9 * hz);
    }
}

#[test]
fn bands_span_what_is_heard() {
    let bank = FilterBank::new(48_000, 2048);
    let centres = bank.centres_mel();
    assert!((centres[0] - mel_of_hz(20.0)).abs() < 1e-9);
    assert!((centres[23] - mel_of_hz(20_000.0)).abs() < 1e-9);
    assert!(
        centres.windows(2).all(|pair| (pair[1] - pair[0] - (centres[23] - centres[0]) / 23.0).abs() < 1e-9)
    );
    assert_eq!(bank.heard_bins(), 1..854);
    assert_eq!(FilterBank::new(8_000, 512).heard_bins(), 2..257, "up to half the sample rate");
}

#[test]
fn a_filter_bank_without_bins_has_no_energy() {
    for (rate_hz, length) in [(0, 0), (0, 2048), (48_000, 0), (30, 64)] {
        let bank = FilterBank::new(rate_hz, length);
        assert!(bank.mean_mel(&bank.energies(&[1.0; 64])).is_none(), "{rate_hz} Hz, {length}");
    }
}

#[test]
fn the_window_begins_with_silence_and_forgets() {
    let settings = AudioSettings::default();
    let mut samples = sine(48_000, 997.0, 1.0, 6.0);
    samples.extend(vec![0.0; 48_000]);
    let features = all(48_000, 1, &settings, &samples);
    // 0.1 of 3 s: 10 lg 30 below.
    assert!((features[0].loudness_lufs - (-3.01 - 14.77)).abs() < 0.05, "{features:?}");
    assert!((features[59].loudness_lufs - -3.01).abs() < 0.01);
    let silent_after = features[60..].iter().position(|set| set.silent).unwrap();
    assert!(silent_after <= 4, "{silent_after} hops");
    assert_eq!(features[69], AudioFeatures::SILENT);
}

#[test]
fn default_mode_follows_a_rise_in_pitch_at_once_and_a_fall_slowly() {
    let settings = AudioSettings::default();
    let mut samples = sine(48_000, 1000.0, 0.5, 3.0);
    samples.extend(sine(48_000, 3000.0, 0.05, 1.0));
    samples.extend(sine(48_000, 1000.0, 0.5, 1.0));
    let gammas: Vec<_> = all(48_000, 1, &settings, &samples).iter().map(|set| set.gamma_fq_kilomel).collect();
    assert!((gammas[29] - 1.0).abs() < 0.01);
    assert!((gammas[35] - mel_of_hz(3000.0) as f32 / 1000.0).abs() < 0.02, "{}", gammas[35]);
    assert!(gammas[49] > gammas[29]);
}

/// One hop of 8 kHz and then some, in pieces, with impossible samples.
fn portions() -> impl Strategy<Value = (u32, Vec<Vec<f32>>)> {
    let sample = prop_oneof![
        40 => -1.0f32..1.0,
        1 => Just(f32::NAN),
        1 => Just(f32::INFINITY),
        1 => Just(f32::MIN_POSITIVE / 8.0),
        1 => Just(f32::MAX),
    ];
    (1u32..=8, prop::collection::vec(prop::collection::vec(sample, 0..1500), 0..12))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any spectrum: bands change nothing about the mean mel, since triangles on any nodes keep straight lines.
    #[test]
    fn bands_keep_the_weighted_mean_mel(
        power in prop::collection::vec(0f32..1.0, 1025),
        exponent in 1i32..12,
        rate_hz in prop_oneof![Just(8_000u32), Just(44_100), Just(48_000), 8_000u32..192_000],
    ) {
        let bank = FilterBank::new(rate_hz, 2048);
        let power: Vec<f32> = power.iter().map(|value| value.powi(exponent)).collect();
        let (mut weighted, mut sum) = (0.0, 0.0);
        for (bin, &power) in power.iter().enumerate() {
            let hz = bin as f64 * f64::from(rate_hz) / 2048.0;
            if (20.0..=20_000.0).contains(&hz) {
                weighted += f64::from(power) * mel_of_hz(hz);
                sum += f64::from(power);
            }
        }
        let mean = bank.mean_mel(&bank.energies(&power)).unwrap();
        prop_assert!((mean - weighted / sum).abs() < 1e-4, "{mean} instead of {}", weighted / sum);
    }

    /// Any samples in any portions: the same features, bit for bit, all finite but the loudness of silence.
    #[test]
    fn portions_do_not_matter((channels, portions) in portions(), paper in any::<bool>()) {
        let mode = if paper { Mode::Paper } else { Mode::Default };
        let settings = AudioSettings { mode, ..AudioSettings::default() };
        let at_once = all(8_000, channels, &settings, &portions.concat());
        let mut in_portions = Vec::new();
        let mut extractor = FeatureExtractor::new(8_000, channels, &settings).unwrap();
        for portion in &portions {
            extractor.push(portion, |set| in_portions.push(set));
        }
        prop_assert_eq!(&at_once, &in_portions);
        for set in at_once {
            prop_assert!((0.0..=25.0).contains(&set.gamma_ld));
            prop_assert!((LEAST_KILOMEL..=GREATEST_KILOMEL).contains(&set.gamma_fq_kilomel));
            prop_assert_eq!(set.silent, set.loudness_lufs == f32::NEG_INFINITY);
            prop_assert!(set.silent || set.loudness_lufs.is_finite());
        }
    }

    /// Louder samples never give a lower loudness.
    #[test]
    fn loudness_follows_level(amplitude in 1e-4f64..1.0, hz in 60f64..3900.0) {
        let settings = AudioSettings::default();
        let last = |amplitude| {
            all(8_000, 1, &settings, &sine(8_000, hz, amplitude, 0.5)).last().unwrap().loudness_lufs
        };
        let (quiet, loud) = (last(amplitude), last(2.0 * amplitude));
        prop_assert!(loud >= quiet);
        prop_assert!(quiet == f32::NEG_INFINITY || (loud - quiet - 6.0206).abs() < 1e-3, "{quiet}, {loud}");
    }
}
