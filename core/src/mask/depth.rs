//! The depth template: values in a depth buffer ahead of the application's draws, with which fragments in skipped blocks fail the depth
//! test.
//!
//! Shaded blocks hold the value that the application clears to; skipped ones the value that is nearest to the viewer.
//! Fragments that pass nonetheless are drawn and then replaced by the fill: they cost time, but never show. Pipelines save:
//! - LESS, GREATER: always, also with depth clamp, which brings a fragment onto the near value at most;
//! - LESS_OR_EQUAL, GREATER_OR_EQUAL: except for fragments exactly on the near plane, such as clamped ones;
//! - EQUAL: after a depth pre-pass that the template kept out of the skipped blocks;
//! - NEVER: nothing to save. ALWAYS, NOT_EQUAL and no depth test: nothing is skipped, and where they write depth, nothing
//!   that comes after them either.

use super::{BLOCK, Mask};
use thiserror::Error;

/// Layout of a template in a buffer: as depth that is copied to or from the depth aspect of an image (Vulkan specification,
/// "Buffer and Image Addressing"), or by blocks, for shaders alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DepthFormat {
    /// 16 bits, UNORM.
    Unorm16,
    /// 24 bits, UNORM, in the lower bits of a word.
    Unorm24,
    /// 32 bits, floating point.
    Float32,
    /// No depth: a word for each block, incomplete ones too, of the whole number that the "depth" is.
    Blocks,
}

/// Layout of the words of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TemplateWords {
    /// Words of a row.
    pub row: u32,
    /// Words of an array layer.
    pub layer: u32,
    /// Words of a block in each of its rows.
    pub block: u32,
    /// Rows of a block.
    pub block_rows: u32,
}

impl DepthFormat {
    /// Bytes of a texel in the buffer.
    pub const fn texel_size(self) -> usize {
        match self {
            Self::Unorm16 => 2,
            Self::Unorm24 | Self::Float32 | Self::Blocks => 4,
        }
    }

    /// Layout of the words of a template for pictures of this width and height; `None` if its rows do not begin with words.
    pub fn words(self, [width, height]: [u32; 2]) -> Option<TemplateWords> {
        if self == Self::Blocks {
            let (row, rows) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
            return Some(TemplateWords { row, layer: row.checked_mul(rows)?, block: 1, block_rows: 1 });
        }
        let in_word = 4 / self.texel_size() as u32;
        let row = width / in_word;
        let words =
            TemplateWords { row, layer: row.checked_mul(height)?, block: BLOCK / in_word, block_rows: BLOCK };
        width.is_multiple_of(in_word).then_some(words)
    }

    /// A word of the buffer in which every texel has this depth.
    pub(crate) fn word(self, depth: f32) -> u32 {
        let [a, b, c, d] = self.encode(depth);
        // The GPU's words have the order of the CPU's.
        u32::from_ne_bytes(if self.texel_size() == 2 { [a, b, a, b] } else { [a, b, c, d] })
    }

    /// The bytes of a depth, 0..=1, of which [`Self::texel_size`] count.
    fn encode(self, depth: f32) -> [u8; 4] {
        // In double precision: 24 bits do not fit beside a half.
        let unorm = |steps: u32| (f64::from(depth.clamp(0.0, 1.0)) * f64::from(steps)).round() as u32;
        match self {
            Self::Unorm16 => unorm(0xffff),
            Self::Unorm24 => unorm(0xff_ffff),
            Self::Float32 => depth.to_bits(),
            Self::Blocks => depth as u32,
        }
        .to_le_bytes()
    }
}

/// Direction of depth tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// LESS, LESS_OR_EQUAL: nearer is smaller.
    Less,
    /// GREATER, GREATER_OR_EQUAL: nearer is larger, as with reversed Z.
    Greater,
}

/// Content of a template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemplateDepths {
    /// In shaded blocks: the application's clear value.
    pub shaded: f32,
    /// In skipped blocks.
    pub skipped: f32,
}

/// Reason why there is no value that is surely nearest.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoNearValue {
    /// Beyond the range of every depth format, or not a number.
    #[error("depth is cleared to {0}, outside 0..1")]
    Clear(f32),
    /// No direction is known, or both are used, and the clear value is neither the farthest of one nor of the other.
    #[error("depth is cleared to {0}, and the direction of its depth tests is uncertain")]
    Direction(f32),
    /// Depth is cleared to the near value itself: nothing passes anywhere.
    #[error("depth is cleared to {0}, the nearest possible value")]
    Nearest(f32),
}

/// The near value that keeps fragments out, in a pass that clears depth to `clear`: by the directions of the depth tests that
/// were `seen` in it, and if they differ or are missing, by the clear value, which is the farthest one.
///
/// # Errors
/// The near value is uncertain.
pub fn near_value(
    seen: impl IntoIterator<Item = Direction>,
    clear: f32,
) -> Result<TemplateDepths, NoNearValue> {
    if !(0.0..=1.0).contains(&clear) {
        return Err(NoNearValue::Clear(clear));
    }
    let by_clear = match clear {
        1.0 => Some(Direction::Less),
        0.0 => Some(Direction::Greater),
        _ => None,
    };
    let mut seen = seen.into_iter();
    let first = seen.next();
    let alike = seen.all(|direction| Some(direction) == first);
    let direction = first.filter(|_| alike).or(by_clear).ok_or(NoNearValue::Direction(clear))?;
    let skipped = match direction {
        Direction::Less => 0.0,
        Direction::Greater => 1.0,
    };
    if clear == skipped {
        Err(NoNearValue::Nearest(clear))
    } else {
        Ok(TemplateDepths { shaded: clear, skipped })
    }
}

/// Writes one array layer of the template of `mask` to `out`, row by row without gaps. Of an `out` that is too short the
/// rows that fit are written; a layer that the mask has not is shaded throughout.
pub fn write_template(mask: &Mask, layer: u32, format: DepthFormat, depths: TemplateDepths, out: &mut [u8]) {
    let [shaded, skipped] = [depths.shaded, depths.skipped].map(|depth| format.encode(depth));
    if format == DepthFormat::Blocks {
        return write_blocks([shaded, skipped], mask, layer, out.as_chunks_mut().0);
    }
    match format.texel_size() {
        2 => write_texels([shaded, skipped].map(|[a, b, ..]| [a, b]), mask, layer, out.as_chunks_mut().0),
        _ => write_texels([shaded, skipped], mask, layer, out.as_chunks_mut().0),
    }
}

/// The words of a layer's blocks, of a shaded and of a skipped block's value.
fn write_blocks([shaded, skipped]: [[u8; 4]; 2], mask: &Mask, layer: u32, out: &mut [[u8; 4]]) {
    out.fill(shaded);
    let columns = mask.extent()[0].div_ceil(BLOCK) as usize;
    let Some(blocks) = mask.skipped(layer).filter(|_| columns > 0) else { return };
    for (index, row) in (0..blocks.height()).zip(out.chunks_mut(columns)) {
        for (word, skip) in row.iter_mut().zip(blocks.row(index)) {
            *word = if *skip { skipped } else { shaded };
        }
    }
}

/// The texels of a layer, of a shaded and of a skipped block's value.
fn write_texels<const SIZE: usize>(
    [shaded, skipped]: [[u8; SIZE]; 2],
    mask: &Mask,
    layer: u32,
    out: &mut [[u8; SIZE]],
) {
    let width = mask.extent()[0] as usize;
    let Some(blocks) = mask.skipped(layer).filter(|_| width > 0) else {
        out.fill(shaded);
        return;
    };
    for (index, rows) in (0..blocks.height()).zip(out.chunks_mut(width * BLOCK as usize)) {
        let (first, others) = rows.split_at_mut(width.min(rows.len()));
        for (texels, skip) in first.chunks_mut(BLOCK as usize).zip(blocks.row(index)) {
            texels.fill(if *skip { skipped } else { shaded });
        }
        for row in others.chunks_exact_mut(width) {
            row.copy_from_slice(first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rates, view};
    use super::*;
    use crate::rate::ShadingRate;
    use Direction::{Greater, Less};

    #[test]
    fn the_near_value_follows_the_tests() {
        let of =
            |seen: &[Direction], clear| near_value(seen.iter().copied(), clear).map(|depths| depths.skipped);
        assert_eq!(of(&[Less, Less], 1.0), Ok(0.0));
        assert_eq!(of(&[Greater], 0.0), Ok(1.0));
        // Seen beats guessed; guessed where nothing, or both, was seen.
        assert_eq!(of(&[Less], 0.5), Ok(0.0));
        assert_eq!(of(&[Greater], 0.5), Ok(1.0));
        assert_eq!((of(&[], 1.0), of(&[], 0.0)), (Ok(0.0), Ok(1.0)));
        assert_eq!((of(&[Less, Greater], 1.0), of(&[Less, Greater], 0.0)), (Ok(0.0), Ok(1.0)));
        assert_eq!(of(&[], 0.5), Err(NoNearValue::Direction(0.5)));
        assert_eq!(of(&[Greater, Less], 0.25), Err(NoNearValue::Direction(0.25)));
        assert_eq!(of(&[Less], 0.0), Err(NoNearValue::Nearest(0.0)));
        assert_eq!(of(&[Greater], 1.0), Err(NoNearValue::Nearest(1.0)));
        assert_eq!(of(&[Less], 1.5), Err(NoNearValue::Clear(1.5)));
        assert!(matches!(of(&[Less], f32::NAN), Err(NoNearValue::Clear(_))));
    }

    #[test]
    fn depths_are_laid_out_as_copies_want_them() {
        assert_eq!(DepthFormat::Unorm16.encode(1.0)[..2], [0xff, 0xff]);
        assert_eq!(DepthFormat::Unorm24.encode(1.0), [0xff, 0xff, 0xff, 0]);
        assert_eq!(DepthFormat::Unorm24.encode(0.5), 0x80_0000u32.to_le_bytes());
        assert_eq!(DepthFormat::Float32.encode(0.25), 0.25f32.to_le_bytes());
    }

    #[test]
    fn templates_hold_the_near_value_in_skipped_blocks() {
        let coarse = rates([8; 2], ShadingRate::R2X2);
        let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
        for (format, extent) in [
            (DepthFormat::Unorm16, [61, 42]),
            (DepthFormat::Unorm24, [64, 64]),
            (DepthFormat::Float32, [37, 3]),
        ] {
            let mut mask = Mask::new(extent, 1);
            mask.resolve(&[view(&coarse, [0; 2], extent, 8)]);
            let size = format.texel_size();
            let mut out = vec![0xaa; (extent[0] * extent[1]) as usize * size];
            write_template(&mask, 0, format, depths, &mut out);
            for (index, texel) in (0u32..).zip(out.chunks_exact(size)) {
                let skips = mask.skips(0, [index % extent[0], index / extent[0]]);
                let depth = if skips { depths.skipped } else { depths.shaded };
                assert_eq!(texel, &format.encode(depth)[..size], "{format:?} {index}");
            }
            write_template(&mask, 7, format, depths, &mut out);
            assert!(out.chunks_exact(size).all(|texel| texel == &format.encode(1.0)[..size]));
        }
    }
}
