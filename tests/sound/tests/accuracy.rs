//! Sounds of known loudness, played into the server: the features in the plans of hello_xr equal the samples'.

use parafovea_core::audio::{AudioFeatures, AudioSettings, Mode};
use parafovea_sound::feature_lines::Line;
use parafovea_sound::signals::{CHANNELS, Kind, features, sound};
use parafovea_sound::stage::{SAMPLE_RATE_HZ, Stage};
use std::time::Duration;

/// Loudness, LUFS: the range of paper A's study.
const LEVELS: [f32; 3] = [-35.0, -22.0, -10.0];

/// Period of a sound, seconds: T_a is three times that.
const PERIOD_S: f64 = 1.0;

/// Times at which features are compared, seconds after the first sample went to the server.
const COMPARED: std::ops::Range<f64> = 3.35..3.75;

/// Step of the first search for the sample with which the application began to count, frames: 2 ms.
const STEP: usize = SAMPLE_RATE_HZ as usize / 500;

/// Step of the second search, around the best of these, frames.
const FINE_STEP: usize = 8;

/// Frames between two sets of features.
const HOP: usize = SAMPLE_RATE_HZ as usize / 10;

/// Times that a sound is played at most, until its features are right: a busy machine loses samples.
const TRIES: usize = 3;

/// Loudness in LUFS and pitch in kilo-mel.
type Set = [f32; 2];

/// The features of a sound, once it is all that was heard in T_a, in their order.
fn heard(stage: &Stage, samples: Vec<f32>) -> Vec<Set> {
    stage.player.play(samples, true);
    let began = loop {
        std::thread::sleep(Duration::from_millis(10));
        match stage.player.began() {
            Some(began) if began.elapsed().is_ok_and(|since| since.as_secs_f64() > COMPARED.end) => {
                break began;
            }
            _ => {}
        }
    };
    let is_compared = |line: &Line| COMPARED.contains(&line.seconds_after(began));
    let set = |line: &Line| Some([line.loudness_lufs?, line.gamma_fq_kilomel?]);
    stage.features().iter().filter(|line| is_compared(line)).filter_map(set).collect()
}

/// Largest differences of the sets from the samples' sets, LU and share, if both began with the same sample: the power
/// spectra of noise depend on the start of their frames. That sample is searched in steps, then around the best of them.
fn differences(heard: &[Set], samples: &[f32], mode: Mode) -> Set {
    let settings = AudioSettings { mode, ..AudioSettings::default() };
    let repeated = samples.repeat(6);
    let of = |first: usize| {
        let offline = features(&repeated[first * CHANNELS as usize..], SAMPLE_RATE_HZ, &settings);
        let most = |expected: &[AudioFeatures]| {
            heard.iter().zip(expected).fold([0f32; 2], |[lu, share], ([lufs, kilomel], expected)| {
                let louder = (lufs - expected.loudness_lufs).abs();
                [lu.max(louder), share.max((kilomel / expected.gamma_fq_kilomel - 1.0).abs())]
            })
        };
        let windows = offline[30..].windows(heard.len()).map(most);
        windows.min_by(|a, b| a[1].total_cmp(&b[1])).unwrap()
    };
    let nearest = |firsts: &mut dyn Iterator<Item = usize>| {
        firsts.map(|first| (first, of(first))).min_by(|(_, a), (_, b)| a[1].total_cmp(&b[1])).unwrap()
    };
    let (first, _) = nearest(&mut (0..HOP).step_by(STEP));
    let around = first.saturating_sub(STEP)..first + STEP;
    let (first, _) = nearest(&mut around.step_by(FINE_STEP));
    let around = first.saturating_sub(FINE_STEP)..first + FINE_STEP;
    nearest(&mut around.into_iter()).1
}

/// Plays a sound. `None` if the captured features agree with its samples.
fn mismatch(stage: &Stage, kind: Kind, level: f32, mode: Mode) -> Option<String> {
    let samples = sound(kind, level, SAMPLE_RATE_HZ, PERIOD_S);
    let heard = heard(stage, samples.clone());
    let [lufs, share] = differences(&heard, &samples, mode);
    let text = format!(
        "{kind:?} at {level} LUFS: {heard:.4?}, at most {lufs:.3} LU and {:.3} % beside the samples'",
        100.0 * share
    );
    println!("{text}");
    let is_as_loud = heard.iter().all(|[lufs, _]| (lufs - level).abs() <= 0.5);
    (heard.len() < 2 || !is_as_loud || lufs > 0.5 || share > 0.01).then_some(text)
}

#[test]
fn captured_features_are_those_of_the_played_sound() {
    expect_the_samples_features(Mode::Paper, &LEVELS);
}

#[test]
fn captured_features_are_those_of_the_last_moment() {
    expect_the_samples_features(Mode::Default, &LEVELS[1..2]);
}

fn expect_the_samples_features(mode: Mode, levels: &[f32]) {
    let name = match mode {
        Mode::Default => "default",
        Mode::Paper => "paper",
    };
    let stage = Stage::new(&format!("mode = \"{name}\"")).unwrap();
    let mut failures = Vec::new();
    for kind in Kind::ALL {
        for &level in levels {
            let wrong = (0..TRIES).map_while(|_| mismatch(&stage, kind, level, mode));
            let wrong: Vec<String> = wrong.collect();
            if wrong.len() == TRIES {
                failures.extend(wrong);
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
    let log = stage.finish().unwrap().log;
    let lines: Vec<&str> = log.lines().filter(|line| line.contains("sound: ")).collect();
    assert!(lines[0].contains("capturing the output") && lines[0].contains("out.monitor"), "{lines:#?}");
}
