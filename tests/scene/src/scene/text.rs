//! The notice board: text drawn into a texture.

use super::texture::{Encoding, Texture};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Size of the notice board's texture in texels.
pub const SIZE: [u32; 2] = [1024, 512];

const TITLE: &str = "THE COURTYARD";
const LINES: [(&str, [u8; 3]); 9] = [
    ("Two arcades, one open and one under a roof.", INK),
    ("Cables of 4, 6 and 10 mm hang between the", INK),
    ("columns; every lamp on them is a light.", INK),
    ("", INK),
    ("abcdefghijklmnopqrstuvwxyz 0123456789", [150, 200, 255]),
    ("The quick brown fox jumps over the lazy dog", [255, 210, 120]),
    ("RED", [255, 80, 70]),
    ("      GREEN", [90, 220, 110]),
    ("              BLUE   (o) [#] {%} <=> $ & @", [90, 140, 255]),
];
const INK: [u8; 3] = [232, 232, 224];
const PAPER: [u8; 3] = [18, 24, 34];
const FRAME: [u8; 3] = [200, 160, 80];

/// Draws the board, with its mip levels.
pub fn board() -> Texture {
    let mut canvas = Canvas::new();
    canvas.frame(12, 6);
    canvas.line(TITLE, [56, 36], 2, FontWeight::Bold, FRAME);
    let mut y = 132;
    for (index, (text, colour)) in LINES.iter().enumerate() {
        canvas.line(text, [56, y], 1, FontWeight::Regular, *colour);
        // The three colour words stand on one line.
        if !matches!(index, 6 | 7) {
            y += 48;
        }
    }
    Texture::new(SIZE, Encoding::Srgb, canvas.texels)
}

struct Canvas {
    texels: Vec<u8>,
}

impl Canvas {
    fn new() -> Self {
        let paper = [PAPER[0], PAPER[1], PAPER[2], 255];
        Self { texels: paper.repeat((SIZE[0] * SIZE[1]) as usize) }
    }

    fn blend(&mut self, x: u32, y: u32, colour: [u8; 3], coverage: u8) {
        if x >= SIZE[0] || y >= SIZE[1] {
            return;
        }
        let at = ((y * SIZE[0] + x) * 4) as usize;
        for (old, new) in self.texels[at..at + 3].iter_mut().zip(colour) {
            let (from, to, t) = (i32::from(*old), i32::from(new), i32::from(coverage));
            *old = (from + (to - from) * t / 255) as u8;
        }
    }

    fn frame(&mut self, inset: u32, width: u32) {
        for y in inset..SIZE[1] - inset {
            for x in inset..SIZE[0] - inset {
                let edge =
                    (x - inset).min(y - inset).min(SIZE[0] - inset - 1 - x).min(SIZE[1] - inset - 1 - y);
                if edge < width {
                    self.blend(x, y, FRAME, 255);
                }
            }
        }
    }

    fn line(&mut self, text: &str, at: [u32; 2], scale: u32, weight: FontWeight, colour: [u8; 3]) {
        let advance = get_raster_width(weight, RasterHeight::Size32) as u32 * scale;
        for (index, character) in text.chars().enumerate() {
            let Some(glyph) = get_raster(character, weight, RasterHeight::Size32) else { continue };
            let left = at[0] + index as u32 * advance;
            for (row, coverages) in glyph.rows().enumerate() {
                for (column, &coverage) in coverages.iter().enumerate() {
                    for dot in 0..scale * scale {
                        let x = left + column as u32 * scale + dot % scale;
                        let y = at[1] + row as u32 * scale + dot / scale;
                        self.blend(x, y, colour, coverage);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line that is too long would be cut off at the frame without a word.
    #[test]
    fn every_line_fits_the_board() {
        let width = get_raster_width(FontWeight::Regular, RasterHeight::Size32);
        for (text, _) in LINES {
            assert!(56 + text.len() * width < SIZE[0] as usize - 20, "too long: {text}");
        }
    }
}
