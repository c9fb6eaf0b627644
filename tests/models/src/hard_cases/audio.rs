//! Hard cases of `audio`: loudness in LUFS and gamma_fq in kilo-mel, each against the reference in double precision.

mod session;
mod signal;

use super::Case;
use crate::reference::audio::{Energies, mean_mel};
use parafovea_core::audio::{AudioFeatures, AudioSettings, FeatureExtractor, Mode, gamma_fq};
use signal::Signal;

/// Greatest difference from the reference: loudness units, and kilo-mel.
const TOLERANCE: f64 = 1e-4;

/// T_a here, in hops of 100 ms: as long as the signals.
const HOPS: usize = 5;

pub(super) fn cases() -> Vec<Case> {
    // Ten hours of sound take two seconds, as long as all the rest.
    std::thread::scope(|scope| {
        let session = scope.spawn(session::cases);
        let mut cases: Vec<Case> = signal::all().iter().flat_map(against_reference).collect();
        cases.extend(session.join().expect("the cases of a session do not panic"));
        cases
    })
}

/// Of the last 500 ms of `samples`, in both modes: default, paper.
fn features(rate_hz: u32, channels: u32, samples: &[f32]) -> [AudioFeatures; 2] {
    [Mode::Default, Mode::Paper].map(|mode| {
        let settings = AudioSettings { mode, window_s: HOPS as f32 / 10.0, ..AudioSettings::default() };
        let mut extractor = FeatureExtractor::new(rate_hz, channels, &settings).expect("a known format");
        let mut last = AudioFeatures::SILENT;
        extractor.push(samples, |features| last = features);
        last
    })
}

/// Loudness of both modes and the frequency, of a signal and of its equivalent.
fn against_reference(signal: &Signal) -> Vec<Case> {
    let [default, paper] = features(signal.rate_hz, signal.channels, &signal.interleaved());
    let channels = signal.heard();
    let energies = Energies::new(signal.rate_hz, &channels);
    let length = (f64::from(signal.rate_hz) * 2048.0 / 48_000.0).log2().ceil().exp2() as usize;
    let quieter = energies.ungated_lufs(4).min(energies.ungated_lufs(HOPS));
    vec![
        loudness(signal, "", default, if quieter < -70.0 { f64::NEG_INFINITY } else { quieter }),
        loudness(signal, ", paper", paper, energies.gated_lufs(HOPS)),
        frequency(signal, paper, mean_mel(signal.rate_hz, length, &channels)),
    ]
}

fn loudness(signal: &Signal, mode: &str, got: AudioFeatures, expected: f64) -> Case {
    let lufs = f64::from(got.loudness_lufs);
    let error = if lufs == expected { 0.0 } else { (lufs - expected).abs() };
    Case {
        model: "loudness",
        case: format!("{}{mode}", signal.name),
        expected: format!("{expected:.3} LUFS"),
        got: format!("{lufs:.3} LUFS, gamma_ld {:.3}", got.gamma_ld),
        error: Some(error),
        passed: error <= TOLERANCE
            && got.silent == (expected == f64::NEG_INFINITY)
            && (0.0..=25.0).contains(&got.gamma_ld),
    }
}

fn frequency(signal: &Signal, got: AudioFeatures, mel: Option<f64>) -> Case {
    let expected = if got.silent { gamma_fq(None) } else { gamma_fq(mel) };
    let error = f64::from(got.gamma_fq_kilomel - expected).abs();
    Case {
        model: "mel",
        case: signal.name.to_owned(),
        expected: format!("{expected:.4} kilo-mel"),
        got: format!("{:.4} kilo-mel", got.gamma_fq_kilomel),
        error: Some(error),
        passed: error <= TOLERANCE,
    }
}
