//! The notice board: text drawn into a texture.

use super::canvas::Canvas;
use super::texture::Texture;
use noto_sans_mono_bitmap::FontWeight;

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
    let mut canvas = Canvas::new(SIZE, PAPER);
    canvas.frame([0, 0], SIZE, 12, 6, FRAME);
    canvas.line(TITLE, [56, 36], 2, FontWeight::Bold, FRAME);
    let mut y = 132;
    for (index, (text, colour)) in LINES.iter().enumerate() {
        canvas.line(text, [56, y], 1, FontWeight::Regular, *colour);
        // The three colour words stand on one line.
        if !matches!(index, 6 | 7) {
            y += 48;
        }
    }
    canvas.texture()
}

#[cfg(test)]
mod tests {
    use noto_sans_mono_bitmap::{RasterHeight, get_raster_width};

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
