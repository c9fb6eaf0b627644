//! The layer's notes of an application's passes.

use serde::Deserialize;
use std::path::Path;

/// A line of the file that `PARAFOVEA_PASSES_FILE` names.
#[derive(Deserialize, Debug)]
#[allow(dead_code, reason = "each test looks at a part of it")]
pub struct Noted {
    pub frame: u64,
    pub extent: [u32; 2],
    pub area: [u32; 2],
    pub layers: u32,
    pub samples: u32,
    pub format: String,
    pub eyes: String,
    pub why: String,
    pub unmasked: Option<String>,
}

impl Noted {
    /// All of a file, in the order of the submits.
    pub fn read(file: &Path) -> Result<Vec<Self>, Box<dyn std::error::Error>> {
        let text = std::fs::read_to_string(file)?;
        Ok(text.lines().map(serde_json::from_str).collect::<Result<_, _>>()?)
    }
}
