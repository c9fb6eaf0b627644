//! The map that the layer gave to a pass.

use parafovea_core::rate::ShadingRate;
use parafovea_tests::HarnessError;
use parafovea_tests::picture::Picture;
use parafovea_tests::run::Run;
use serde::Deserialize;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// The variable with the file to which the layer writes maps.
const VARIABLE: &str = "PARAFOVEA_PASSES_FILE";

/// Colours of 1, 1/2, 1/4, 1/8 and 1/16 invocations per pixel: light to dark, safe for the colour-blind.
const COLOURS: [[u8; 4]; 5] =
    [[250, 231, 85, 255], [122, 209, 81, 255], [34, 168, 132, 255], [42, 120, 142, 255], [65, 68, 135, 255]];

/// A file that the layer writes maps to.
pub struct File(tempfile::NamedTempFile);

#[derive(Deserialize)]
struct Line {
    frame: u64,
    eyes: String,
    map: Option<Map>,
}

#[derive(Deserialize)]
struct Map {
    tiles: [u32; 3],
    rates: String,
}

impl File {
    pub fn new() -> Result<Self, HarnessError> {
        let folder = std::env::temp_dir();
        tempfile::NamedTempFile::new().map(Self).map_err(|source| HarnessError::File { path: folder, source })
    }

    /// A run that writes it.
    pub fn asked_for(&self, run: Run) -> Run {
        run.env(VARIABLE, self.0.path())
    }

    /// The map of the left eye buffer in a frame, a pixel a tile; none where there was none.
    pub fn read(&self, frame: u64) -> Result<Option<Picture>, HarnessError> {
        let path = self.0.path();
        let failed = |source| HarnessError::File { path: path.to_owned(), source };
        let mut found = None;
        for line in BufReader::new(self.0.reopen().map_err(failed)?).lines() {
            found = map_of(&line.map_err(failed)?, frame, path)?.or(found);
        }
        Ok(found)
    }
}

fn map_of(line: &str, frame: u64, path: &Path) -> Result<Option<Picture>, HarnessError> {
    let wrong = |reason: &str| HarnessError::Format { path: path.to_owned(), reason: reason.to_owned() };
    // Most lines are of other frames, and long.
    if !line.contains(&format!("\"frame\":{frame},")) {
        return Ok(None);
    }
    let line: Line = serde_json::from_str(line).map_err(|error| wrong(&error.to_string()))?;
    let Some(map) =
        line.map.filter(|_| line.frame == frame && ["left", "both"].contains(&line.eyes.as_str()))
    else {
        return Ok(None);
    };
    let [columns, rows, _] = map.tiles;
    let colour = |x: u32, y: u32| {
        let at = (y * columns + x) as usize * 2;
        let texel = map.rates.get(at..at + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        let rate = texel.and_then(ShadingRate::from_texel).unwrap_or(ShadingRate::R1X1);
        COLOURS[((rate.octaves() * 2.0) as usize).min(COLOURS.len() - 1)]
    };
    Ok(Some(Picture::from_fn(columns, rows, colour)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_of_the_left_eye_becomes_a_picture() {
        let line = |frame: u64, eyes: &str| {
            format!(
                "{{\"frame\":{frame},\"index\":0,\"eyes\":\"{eyes}\",\"map\":{{\"texel\":[8,8],\"tiles\":[2,1,1],\"rates\":\"000a\"}}}}"
            )
        };
        let read = |line: &str| map_of(line, 7, Path::new("maps")).unwrap();
        let map = read(&line(7, "left")).unwrap();
        assert_eq!((map.width, map.height), (2, 1));
        assert_eq!([map.at(0, 0), map.at(1, 0)], [COLOURS[0], COLOURS[4]]);
        assert!(read(&line(7, "right")).is_none() && read(&line(77, "left")).is_none());
        assert!(read("{\"frame\":7,\"eyes\":\"left\"}").is_none());
        assert!(map_of("{\"frame\":7,", 7, Path::new("maps")).is_err());
    }
}
