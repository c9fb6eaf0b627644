//! Reference of the kernel `debug_view`: the layer's decisions, drawn over an eye's finished picture, for people to look at.
//!
//! It reads a map of bytes, one for each tile, row by row; each row begins with a whole word ([`map_row_bytes`]).

use super::compose::PixelFormat;
use crate::geometry::{Fov, ImagePlane, eccentricity, unit_direction};
use crate::layout::uniform;
use crate::rate::ShadingRate;
use glam::{UVec2, Vec2, Vec3};

/// The subject of the drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DebugView {
    /// The rate of each tile: a colour for each share of the pixels that is shaded, none where all are.
    Rates,
    /// The angle from the gaze: from green to red, with a line every 10 degrees.
    Eccentricity,
    /// Age of each tile, frames: from yellow to red, no colour for new tiles.
    Age,
    /// A dot at the gaze.
    Gaze,
    /// A dot in the head's forward direction, at infinity.
    Ahead,
}

impl DebugView {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Rates, Self::Eccentricity, Self::Age, Self::Gaze, Self::Ahead];

    /// Its number in [`DebugViewParams::view`].
    pub const fn number(self) -> u32 {
        match self {
            Self::Rates => 0,
            Self::Eccentricity => 1,
            Self::Age => 2,
            Self::Gaze => 3,
            Self::Ahead => 4,
        }
    }

    /// Whether it needs a map of the tiles.
    pub const fn shows_tiles(self) -> bool {
        matches!(self, Self::Rates | Self::Age)
    }

    /// The view of a number.
    pub fn of_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|view| view.number() == number)
    }
}

uniform! {
    /// Parameters of one eye buffer, the shader's uniform of the same name.
    pub struct DebugViewParams {
        /// First pixel of the picture in its image.
        pub rect_offset: [u32; 2],
        /// Size of the picture, pixels, at least 1.
        pub rect_extent: [u32; 2],
        /// [`ImagePlane::origin`] of the picture.
        pub plane_origin: [f32; 2],
        /// [`ImagePlane::step`] of the picture.
        pub plane_step: [f32; 2],
        /// Direction of the gaze, or the head's forward direction for [`DebugView::Ahead`]: unit vector in the view's space; all
        /// 0 if unknown.
        pub gaze: [f32; 3],
        /// [`DebugView::number`].
        pub view: u32,
        /// Size of the picture that the map was made for, pixels: it is scaled to others.
        pub map_extent: [u32; 2],
        /// Size of a tile in that, pixels.
        pub texel: [u32; 2],
        /// Columns and rows of tiles; 0 where there is no map.
        pub tiles: [u32; 2],
        /// Word of the buffer at which the map begins.
        pub first_word: u32,
        /// 1 where the picture's first row is the bottom; the map's is the top.
        pub is_upside_down: u32,
    }
}

/// The map of a view's tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapShape {
    /// Size of the picture that it was made for, pixels.
    pub extent: [u32; 2],
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
    /// Columns and rows.
    pub tiles: [u32; 2],
}

impl MapShape {
    /// Bytes of the map.
    pub fn bytes(&self) -> u32 {
        map_row_bytes(self.tiles[0]).saturating_mul(self.tiles[1])
    }
}

/// Bytes from one row of a map of so many columns to the next: whole words.
pub const fn map_row_bytes(columns: u32) -> u32 {
    columns.next_multiple_of(4)
}

/// Opacity of the tints of tiles and of angles: the scene stays to be seen.
const TINT: f32 = 0.4;
const FAINT: f32 = 0.25;
/// Opacity of lines and dots.
const LINE: f32 = 0.85;

/// Colours of 1/2, 1/4, 1/8 and 1/16 invocations per pixel, linear: the colours of a plan's picture.
const RATES: [[f32; 3]; 4] =
    [[0.1946, 0.6376, 0.0823], [0.0160, 0.3916, 0.2307], [0.0232, 0.1878, 0.2705], [0.0529, 0.0578, 0.2423]];

/// Frames after which an age is drawn no redder.
const OLDEST: u32 = 6;
/// From one line to the next, and half its width, degrees.
const RING_DEG: f32 = 10.0;
const RING_HALF_DEG: f32 = 0.2;
/// The angle at which the tint is red, degrees.
const FAR_DEG: f32 = 60.0;
/// Radius of the dot, and of the white line around it, degrees.
const DOT_DEG: f32 = 1.0;
const DOT_LINE_DEG: f32 = 1.3;

impl DebugViewParams {
    /// Parameters of the rectangle of `rect_extent` pixels at `rect_offset`, which shows `fov` as seen with `gaze`, a direction in
    /// the view's space (+x right, +y up, -z forward). The map begins at word 0.
    pub fn new(
        view: DebugView,
        rect_offset: [u32; 2],
        rect_extent: [u32; 2],
        fov: Fov,
        gaze: Vec3,
        map: &MapShape,
    ) -> Self {
        let tangents = fov.tangents();
        let plane = tangents.plane(rect_extent);
        Self {
            rect_offset,
            rect_extent,
            plane_origin: plane.origin.into(),
            plane_step: plane.step.into(),
            gaze: unit_direction(gaze).unwrap_or(Vec3::ZERO).into(),
            view: view.number(),
            map_extent: map.extent,
            texel: map.texel,
            tiles: map.tiles,
            first_word: 0,
            is_upside_down: u32::from(tangents.up < tangents.down),
        }
    }

    /// The view, where anything can be drawn: there are tiles, or a gaze, as it needs them, and a picture.
    pub fn drawn(&self) -> Option<DebugView> {
        let view = DebugView::of_number(self.view)?;
        let has_tiles = !self.tiles.contains(&0) && !self.texel.contains(&0);
        let has_gaze = self.gaze != [0.0; 3];
        let is_shown = if view.shows_tiles() { has_tiles } else { has_gaze };
        (is_shown && !self.rect_extent.contains(&0)).then_some(view)
    }

    /// Colour in linear light, and opacity, of the overlay on the pixel at (`x`, `y`) of the rectangle; `None` for an unchanged
    /// pixel. `map` is read from its first byte on.
    pub fn pixel(&self, x: u32, y: u32, map: &[u8]) -> Option<(Vec3, f32)> {
        match self.drawn()? {
            DebugView::Rates => of_rate(self.tile(x, y, map)?),
            DebugView::Age => of_age(self.tile(x, y, map)?),
            DebugView::Eccentricity => Some(of_angle(self.degrees(x, y)?)),
            DebugView::Gaze | DebugView::Ahead => of_dot(self.degrees(x, y)?),
        }
    }

    /// Degrees from the gaze.
    pub fn degrees(&self, x: u32, y: u32) -> Option<f32> {
        let plane = ImagePlane { origin: self.plane_origin.into(), step: self.plane_step.into() };
        let direction = plane.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        self.drawn().map(|_| eccentricity(direction, self.gaze.into()).to_degrees())
    }

    /// The byte of the tile that shows a pixel.
    fn tile(&self, x: u32, y: u32, map: &[u8]) -> Option<u8> {
        let extent = UVec2::from(self.rect_extent);
        let y = if self.is_upside_down == 1 { extent.y - 1 - y } else { y };
        let tile = UVec2::new(x, y) * UVec2::from(self.map_extent) / extent / UVec2::from(self.texel);
        let tile = tile.min(UVec2::from(self.tiles) - 1);
        map.get((tile.y * map_row_bytes(self.tiles[0]) + tile.x) as usize).copied()
    }
}

/// Colour and opacity of a texel of a rate image, regardless of its other bits.
fn of_rate(texel: u8) -> Option<(Vec3, f32)> {
    let rate = ShadingRate::from_texel(texel & 0x0f)?;
    let halvings = (rate.octaves() * 2.0) as usize;
    Some((Vec3::from(*RATES.get(halvings.checked_sub(1)?)?), TINT))
}

fn of_age(frames: u8) -> Option<(Vec3, f32)> {
    let age = u32::from(frames).min(OLDEST).checked_sub(1)?;
    Some((Vec3::new(1.0, 0.8 * (1.0 - age as f32 / (OLDEST - 1) as f32), 0.0), TINT))
}

fn of_angle(degrees: f32) -> (Vec3, f32) {
    let ring = (degrees / RING_DEG + 0.5).floor();
    if ring >= 1.0 && (degrees - ring * RING_DEG).abs() < RING_HALF_DEG {
        return (Vec3::ONE, LINE);
    }
    let far = (degrees / FAR_DEG).min(1.0);
    (Vec3::new(far, 1.0 - far, 0.0), FAINT)
}

fn of_dot(degrees: f32) -> Option<(Vec3, f32)> {
    match degrees {
        _ if degrees < DOT_DEG => Some((Vec3::X, LINE)),
        _ if degrees < DOT_LINE_DEG => Some((Vec3::ONE, LINE)),
        _ => None,
    }
}

/// Draws over an image in place: `pixels` holds rows of `width` texels of four bytes. Parts outside of the image are ignored.
pub fn debug_view_image(
    pixels: &mut [u8],
    width: u32,
    format: PixelFormat,
    params: &DebugViewParams,
    map: &[u8],
) {
    let [left, top] = params.rect_offset;
    for y in 0..params.rect_extent[1] {
        for x in 0..params.rect_extent[0].min(width.saturating_sub(left)) {
            let index = (top + y) as usize * width as usize + (left + x) as usize;
            let Some(texel) = pixels.get_mut(index * 4..index * 4 + 4) else { return };
            if let Some((colour, opacity)) = params.pixel(x, y, map) {
                let under = format.decode(texel);
                format.encode(under.lerp(colour, opacity), &mut texel[..3]);
            }
        }
    }
}

#[cfg(test)]
mod tests;
