//! The pictures that the application draws: exact to the code value, and different in every frame, eye and
//! rectangle.
//!
//! A figure is a set of cells of one colour each, which the application draws with `vkCmdClearAttachments`
//! and a test paints on the CPU. Saturated hues give chroma attenuation something to take, the greys give it
//! something to leave alone, and digits one texel thin are edges as text has them.

use serde::{Deserialize, Serialize};

/// Side of a colour cell, in texels.
const CELL: u32 = 4;

/// Alpha of the cells of [`Alpha::Steps`], along a row: both ends, their neighbours, and the middle.
const ALPHA_STEPS: [u8; 8] = [0, 1, 63, 127, 128, 191, 254, 255];

/// Digits 0 to 9, three texels wide and five high; a row a number, its highest of three bits to the left.
const DIGITS: [[u8; 5]; 10] = [
    [7, 5, 5, 5, 7],
    [2, 6, 2, 2, 7],
    [7, 1, 7, 4, 7],
    [7, 1, 7, 1, 7],
    [5, 5, 7, 1, 1],
    [7, 4, 7, 1, 7],
    [7, 4, 7, 5, 7],
    [7, 1, 1, 1, 1],
    [7, 5, 7, 5, 7],
    [7, 5, 7, 1, 7],
];

/// A rectangle of texels of one array layer of an image; `y` points down, as in an XrRect2Di.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rect {
    /// Leftmost column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Rect {
    /// The rectangle with this corner and size.
    pub const fn new(x: u32, y: u32, width: u32, height: u32) -> Self {
        Self { x, y, width, height }
    }
}

/// Alpha of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Alpha {
    /// 255 everywhere.
    Opaque,
    /// Each column of cells another alpha, from 0 to 255.
    Steps,
}

/// An image: its content, place and opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Figure {
    /// Turns the hues, and is written into the picture.
    pub seed: u32,
    /// Position and size in the image.
    pub rect: Rect,
    /// Its alpha.
    pub alpha: Alpha,
}

/// A rectangle of one colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Position and size in the image.
    pub rect: Rect,
    /// Code values as the image stores them, 0 to 255: red, green, blue, alpha.
    pub rgba: [u8; 4],
}

impl Figure {
    /// The opaque figure of a frame and a stream of figures within it (an eye, a quad).
    pub const fn new(frame: u32, stream: u32, rect: Rect) -> Self {
        Self { seed: frame * 10 + stream, rect, alpha: Alpha::Opaque }
    }

    /// The same figure with the alpha of [`Alpha::Steps`].
    pub const fn translucent(self) -> Self {
        Self { alpha: Alpha::Steps, ..self }
    }

    /// Cells to draw, in order: later cells lie over earlier ones.
    pub fn cells(&self) -> Vec<Cell> {
        let mut cells = self.gradient();
        for (x, y) in [(2, 2), (self.rect.width / 2, self.rect.height / 2)] {
            self.write_seed(x, y, &mut cells);
        }
        cells
    }

    /// The figure as its rectangle's texels, row by row, four bytes each.
    pub fn pixels(&self) -> Vec<u8> {
        let width = self.rect.width as usize;
        let mut pixels = vec![0; width * self.rect.height as usize * 4];
        for cell in self.cells() {
            let left = (cell.rect.x - self.rect.x) as usize;
            let top = (cell.rect.y - self.rect.y) as usize;
            for y in top..top + cell.rect.height as usize {
                for x in left..left + cell.rect.width as usize {
                    pixels[(y * width + x) * 4..][..4].copy_from_slice(&cell.rgba);
                }
            }
        }
        pixels
    }

    /// Hues from left to right, getting darker downwards, over a last row of greys.
    fn gradient(&self) -> Vec<Cell> {
        let Rect { width, height, .. } = self.rect;
        let mut cells = Vec::new();
        for y in (0..height).step_by(CELL as usize) {
            for x in (0..width).step_by(CELL as usize) {
                let [red, green, blue] = if y + CELL >= height {
                    [(255 * x / width) as u8; 3]
                } else {
                    hue(360 * x / width + 53 * self.seed, 255 - 191 * y / height)
                };
                let rect =
                    Rect::new(self.rect.x + x, self.rect.y + y, CELL.min(width - x), CELL.min(height - y));
                let rgba = [red, green, blue, self.alpha_at(x)];
                cells.push(Cell { rect, rgba });
            }
        }
        cells
    }

    /// The seed's digits in white, `x` and `y` from the figure's corner, clipped.
    fn write_seed(&self, x: u32, y: u32, cells: &mut Vec<Cell>) {
        for (place, digit) in self.seed.to_string().bytes().enumerate() {
            let glyph = DIGITS[usize::from(digit - b'0')];
            for (row, bits) in glyph.into_iter().enumerate() {
                for column in (0..3).filter(|column| bits >> (2 - column) & 1 == 1) {
                    let x = x + 4 * place as u32 + column;
                    let y = y + row as u32;
                    if x < self.rect.width && y < self.rect.height {
                        let rect = Rect::new(self.rect.x + x, self.rect.y + y, 1, 1);
                        let rgba = [255, 255, 255, self.alpha_at(x)];
                        cells.push(Cell { rect, rgba });
                    }
                }
            }
        }
    }

    fn alpha_at(&self, x: u32) -> u8 {
        match self.alpha {
            Alpha::Opaque => 255,
            Alpha::Steps => ALPHA_STEPS[(x / CELL) as usize % ALPHA_STEPS.len()],
        }
    }
}

/// A fully saturated colour; `degrees` as in HSV, `value` is its largest channel, 0 to 255.
fn hue(degrees: u32, value: u32) -> [u8; 3] {
    let degrees = degrees % 360;
    let rising = (value * (degrees % 60) / 60) as u8;
    let value = value as u8;
    let falling = value - rising;
    match degrees / 60 {
        0 => [value, rising, 0],
        1 => [falling, value, 0],
        2 => [0, value, rising],
        3 => [0, falling, value],
        4 => [rising, 0, value],
        _ => [value, 0, falling],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_rectangle_and_stay_in_it() {
        let figure = Figure::new(12, 3, Rect::new(5, 7, 30, 21)).translucent();
        let mut covered = vec![false; 30 * 21];
        for cell in figure.cells() {
            for y in cell.rect.y..cell.rect.y + cell.rect.height {
                for x in cell.rect.x..cell.rect.x + cell.rect.width {
                    covered[((y - 7) * 30 + x - 5) as usize] = true;
                }
            }
        }
        assert!(covered.into_iter().all(|covered| covered));
    }

    #[test]
    fn figures_of_different_frames_and_streams_differ() {
        let rect = Rect::new(0, 0, 64, 64);
        let first = Figure::new(3, 0, rect).pixels();
        assert_ne!(first, Figure::new(4, 0, rect).pixels());
        assert_ne!(first, Figure::new(3, 1, rect).pixels());
        assert_eq!(first, Figure::new(3, 0, Rect::new(9, 2, 64, 64)).pixels());
    }

    #[test]
    fn the_last_row_is_grey_and_the_first_saturated() {
        let pixels = Figure::new(0, 0, Rect::new(0, 0, 64, 64)).pixels();
        let last_row = &pixels[63 * 64 * 4..];
        assert!(last_row.chunks(4).all(|p| p[0] == p[1] && p[1] == p[2]));
        assert!(pixels[..64 * 4].chunks(4).all(|p| p[..3].contains(&0)));
    }
}
