//! A picture drawn by code: text, frames, discs and strokes.

use glam::{Vec2, vec2};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::texture::{Encoding, Texture};

/// An sRGB picture that is being drawn. Parts outside of it are clipped.
#[derive(Clone, Debug)]
pub struct Canvas {
    size: [u32; 2],
    texels: Vec<u8>,
}

impl Canvas {
    /// An even picture; width and height are powers of two.
    pub fn new(size: [u32; 2], paper: [u8; 3]) -> Self {
        let paper = [paper[0], paper[1], paper[2], 255];
        Self { size, texels: paper.repeat((size[0] * size[1]) as usize) }
    }

    /// The picture with its mip levels.
    pub fn texture(self) -> Texture {
        Texture::new(self.size, Encoding::Srgb, self.texels)
    }

    fn blend(&mut self, x: u32, y: u32, colour: [u8; 3], coverage: u8) {
        if x >= self.size[0] || y >= self.size[1] {
            return;
        }
        let at = ((y * self.size[0] + x) * 4) as usize;
        for (old, new) in self.texels[at..at + 3].iter_mut().zip(colour) {
            let (from, to, t) = (i32::from(*old), i32::from(new), i32::from(coverage));
            *old = (from + (to - from) * t / 255) as u8;
        }
    }

    /// Fills a rectangle.
    pub fn fill(&mut self, at: [u32; 2], size: [u32; 2], colour: [u8; 3]) {
        for y in at[1]..at[1] + size[1] {
            for x in at[0]..at[0] + size[0] {
                self.blend(x, y, colour, 255);
            }
        }
    }

    /// Draws a frame of a width, `inset` inside the edges of a rectangle.
    pub fn frame(&mut self, at: [u32; 2], size: [u32; 2], inset: u32, width: u32, colour: [u8; 3]) {
        for y in inset..size[1] - inset {
            for x in inset..size[0] - inset {
                let edge =
                    (x - inset).min(y - inset).min(size[0] - inset - 1 - x).min(size[1] - inset - 1 - y);
                if edge < width {
                    self.blend(at[0] + x, at[1] + y, colour, 255);
                }
            }
        }
    }

    /// Draws a line of text; `at` is its upper left corner, and each texel of the 32-texel font becomes `scale` x
    /// `scale`.
    pub fn line(&mut self, text: &str, at: [u32; 2], scale: u32, weight: FontWeight, colour: [u8; 3]) {
        glyphs(text, weight, RasterHeight::Size32, |column, row, coverage| {
            for dot in 0..scale * scale {
                let x = at[0] + column * scale + dot % scale;
                let y = at[1] + row * scale + dot / scale;
                self.blend(x, y, colour, coverage);
            }
        });
    }

    /// Draws a line of text in the 16-texel font.
    pub fn small_line(&mut self, text: &str, at: [u32; 2], colour: [u8; 3]) {
        glyphs(text, FontWeight::Regular, RasterHeight::Size16, |column, row, coverage| {
            self.blend(at[0] + column, at[1] + row, colour, coverage);
        });
    }

    /// Draws text that runs downwards, as on the spine of a book, in the 16-texel font; `at` is the upper right
    /// corner of the turned line.
    pub fn spine(&mut self, text: &str, at: [u32; 2], colour: [u8; 3]) {
        glyphs(text, FontWeight::Bold, RasterHeight::Size16, |column, row, coverage| {
            self.blend(at[0].wrapping_sub(row), at[1] + column, colour, coverage);
        });
    }

    /// Draws a filled disc with a smooth edge.
    pub fn disc(&mut self, centre: [f32; 2], radius: f32, colour: [u8; 3]) {
        self.shape(Vec2::from(centre) - radius, Vec2::from(centre) + radius, colour, |point| {
            point.distance(centre.into()) - radius
        });
    }

    /// Draws a straight stroke of a width with smooth edges.
    pub fn stroke(&mut self, from: [f32; 2], to: [f32; 2], width: f32, colour: [u8; 3]) {
        let (from, to) = (Vec2::from(from), Vec2::from(to));
        let along = to - from;
        self.shape(from.min(to) - width, from.max(to) + width, colour, |point| {
            let t = ((point - from).dot(along) / along.length_squared().max(1e-6)).clamp(0.0, 1.0);
            point.distance(from + along * t) - width / 2.0
        });
    }

    /// Draws where a signed distance in texels is negative, inside a box.
    fn shape(&mut self, low: Vec2, high: Vec2, colour: [u8; 3], distance: impl Fn(Vec2) -> f32) {
        let (low, high) = ((low - 1.0).max(Vec2::ZERO).as_uvec2(), (high + 2.0).max(Vec2::ZERO).as_uvec2());
        for y in low.y..high.y {
            for x in low.x..high.x {
                let covered = (0.5 - distance(vec2(x as f32 + 0.5, y as f32 + 0.5))).clamp(0.0, 1.0);
                self.blend(x, y, colour, (covered * 255.0) as u8);
            }
        }
    }
}

/// Calls `dot` with column, row and coverage of every texel of a line of text.
fn glyphs(text: &str, weight: FontWeight, height: RasterHeight, mut dot: impl FnMut(u32, u32, u8)) {
    let advance = get_raster_width(weight, height) as u32;
    for (index, character) in text.chars().enumerate() {
        let Some(glyph) = get_raster(character, weight, height) else { continue };
        for (row, coverages) in glyph.rows().enumerate() {
            for (column, &coverage) in coverages.iter().enumerate() {
                dot(index as u32 * advance + column as u32, row as u32, coverage);
            }
        }
    }
}
