//! Coarse shading as it looks, on devices without shading rates: shaders of some styles know the map of their pass, and shade as if a
//! fragment were a block of pixels (`shaders/foliage.wgsl`).

use clap::ValueEnum;

/// Coarsest rate of a kind of draw.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, ValueEnum)]
pub enum Coarsest {
    /// As the map has it.
    #[default]
    #[value(name = "4x4")]
    Four,
    /// No side longer than two pixels.
    #[value(name = "2x2")]
    Two,
    /// Each pixel is shaded.
    #[value(name = "1x1")]
    One,
}

impl Coarsest {
    /// The logarithm to base 2 of the longest side.
    pub fn log2(self) -> u32 {
        match self {
            Self::Four => 2,
            Self::Two => 1,
            Self::One => 0,
        }
    }
}

/// Rules of coarseness, beside the map.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Look {
    /// Draws whose shaders discard.
    pub discarding: Coarsest,
    /// Full-screen passes that blend a history.
    pub history: Coarsest,
    /// Whether an earlier pass at 1x1 draws the depth of discarding draws, as pre-passes do.
    pub prepass: bool,
    /// Whether shaders filter by the width of a pixel, not of a fragment.
    pub pixel_filter: bool,
}
