//! For tests, in builds with debug assertions alone: a file of the sound features that plans used. It reveals the sound.
//!
//! `PARAFOVEA_FEATURES_FILE` names it; it is only looked at where a session is active and the configuration asks for sound, so
//! not in processes with elevated rights. A line is added for each set of features, and when plans take other things of it, a JSON object:
//!
//! `{"unix_ns":0,"gamma_ld":0.0,"gamma_fq_kilomel":1.0,"silent":false,"loudness_lufs":-20.0,"age_ms":0.0,"confidence":1.0}`
//!
//! Without `gamma_ld`, `gamma_fq_kilomel` and `silent`: plans took nothing. `loudness_lufs`, `age_ms` and `confidence` are those
//! of the newest features, and not there before the first; loudness is null in silence.

use parafovea_core::audio::AudioFeatures;
use parafovea_manifest::audio_library::FeaturesRecord;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

const VARIABLE: &str = "PARAFOVEA_FEATURES_FILE";

static FILE: LazyLock<Option<Mutex<File>>> = LazyLock::new(|| {
    let path = std::env::var_os(VARIABLE)?;
    match File::create(&path) {
        Ok(file) => Some(Mutex::new(file)),
        Err(error) => {
            tracing::error!("{VARIABLE}: {}: {error}", path.display());
            None
        }
    }
});

/// Whether a file was asked for.
pub fn is_wanted() -> bool {
    FILE.is_some()
}

/// Writes the features of a plan, and their source.
pub fn write(taken: Option<&AudioFeatures>, record: Option<&FeaturesRecord>) {
    let Some(file) = &*FILE else { return };
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Writing to a string cannot fail; a line that the file does not take is missed by the test that waits for it.
    let mut line = format!("{{\"unix_ns\":{}", now.as_nanos());
    if let Some(taken) = taken {
        let AudioFeatures { gamma_ld, gamma_fq_kilomel, silent, .. } = taken;
        let _ = write!(
            line,
            ",\"gamma_ld\":{gamma_ld},\"gamma_fq_kilomel\":{gamma_fq_kilomel},\"silent\":{silent}"
        );
    }
    if let Some(record) = record {
        let loudness = match record.loudness_lufs {
            lufs if lufs.is_finite() => lufs.to_string(),
            _ => "null".to_owned(),
        };
        let (age_ms, confidence) = (record.age_ns as f64 / 1e6, record.confidence);
        let _ = write!(line, ",\"loudness_lufs\":{loudness},\"age_ms\":{age_ms},\"confidence\":{confidence}");
    }
    line.push_str("}\n");
    let _ = file.lock().unwrap_or_else(PoisonError::into_inner).write_all(line.as_bytes());
}
