//! The maps of `--native-map`.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::Path;

/// Maps of shading rates, a byte a texel, layer by layer, row by row: `log2(width) << 2 | log2(height)`.
#[derive(Debug, PartialEq, Eq)]
pub struct RatesFile {
    /// Width and height of a texel, pixels.
    pub texel: [u32; 2],
    /// By number of the frame, and of the pass in it.
    pub maps: HashMap<(u64, usize), Map>,
}

/// The map of a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Map {
    /// Columns, rows and layers.
    pub tiles: [u32; 3],
    /// Texels, as many as tiles.
    pub texels: Vec<u8>,
}

/// A line, of which other fields are of no interest.
#[derive(Deserialize)]
struct Line {
    frame: u64,
    index: usize,
    map: Option<LineMap>,
}

#[derive(Deserialize)]
struct LineMap {
    texel: [u32; 2],
    tiles: [u32; 3],
    /// Two hexadecimal digits a texel.
    rates: String,
}

impl RatesFile {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, or a line that makes no sense.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::read(&text).with_context(|| path.display().to_string())
    }

    fn read(text: &str) -> Result<Self> {
        let mut file = Self { texel: [0; 2], maps: HashMap::new() };
        for (number, line) in (1..).zip(text.lines()) {
            file.take(serde_json::from_str(line)?).with_context(|| format!("line {number}"))?;
        }
        ensure!(file.texel != [0; 2], "no map in it");
        Ok(file)
    }

    fn take(&mut self, line: Line) -> Result<()> {
        let Some(map) = line.map else { return Ok(()) };
        ensure!(!map.texel.contains(&0) && [[0; 2], map.texel].contains(&self.texel), "texels of two sizes");
        self.texel = map.texel;
        let texels = bytes(&map.rates).context("rates are not hexadecimal")?;
        let count = map.tiles.iter().try_fold(1_usize, |all, &side| all.checked_mul(side as usize));
        ensure!(count == Some(texels.len()), "{} rates for {:?} tiles", texels.len(), map.tiles);
        self.maps.insert((line.frame, line.index), Map { tiles: map.tiles, texels });
        Ok(())
    }
}

fn bytes(digits: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> =
        digits.chars().map(|digit| Some(digit.to_digit(16)? as u8)).collect::<Option<_>>()?;
    digits.len().is_multiple_of(2).then(|| digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str =
        r#"{"frame":4,"index":1,"eyes":"left","map":{"texel":[16,8],"tiles":[2,1,1],"rates":"0005"}}"#;

    #[test]
    fn lines_with_maps_are_read() {
        let file = RatesFile::read(&format!("{{\"frame\":0,\"index\":0}}\n{MAP}\n")).unwrap();
        assert_eq!(file.texel, [16, 8]);
        assert_eq!(file.maps, [((4, 1), Map { tiles: [2, 1, 1], texels: vec![0, 5] })].into());
    }

    #[test]
    fn invalid_lines_are_named() {
        let error = |text: &str| format!("{:#}", RatesFile::read(text).unwrap_err());
        assert_eq!(error(""), "no map in it");
        assert_eq!(error(&MAP.replace("0005", "00")), "line 1: 1 rates for [2, 1, 1] tiles");
        assert_eq!(error(&MAP.replace("0005", "000x")), "line 1: rates are not hexadecimal");
        let other = MAP.replace("[16,8]", "[8,8]");
        assert_eq!(error(&format!("{MAP}\n{other}")), "line 2: texels of two sizes");
    }
}
