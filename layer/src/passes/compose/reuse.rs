//! What is taken from earlier pictures: where a frame's parameters and lists are written, and which instances are drawn.

use super::{ComposeParams, MAX_REUSED};
use crate::gpu::{Gpu, GpuError, ListSet, Recorder, UniformRing, Uses, WordRing};
use ash::vk;
use parafovea_core::kernels::compose::{ReuseParams, set_words};
use parafovea_core::reuse::{MAX_AGES, Reuse, TileLists};
use std::ops::Range;
use std::sync::Arc;

/// A rectangle of one array layer that is completed from earlier pictures.
#[derive(Clone, Copy, Debug)]
pub struct ReuseRegion<'a> {
    /// The array layer.
    pub array_layer: u32,
    /// The rectangle, within the image.
    pub rect: vk::Rect2D,
    /// What is stale in its picture, and what there is instead.
    pub reuse: Reuse<'a>,
    /// Lists made of `reuse`.
    pub lists: &'a TileLists,
    /// Where the earlier pictures are, for each of [`Reuse::ages`].
    pub earlier: [EarlierImage; MAX_AGES],
    /// Width over which fresh pixels beside stale tiles are blended, pixels; 0: not at all.
    pub border: f32,
}

/// Where an earlier picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EarlierImage {
    /// Which of the application's images; not the newest one.
    pub app_index: u32,
    /// The array layer.
    pub array_layer: u32,
    /// First pixel of its rectangle, whose size is that of the picture.
    pub offset: [u32; 2],
}

impl ReuseRegion<'_> {
    /// Of the ages from which something is taken: the index, and where the picture is.
    pub(super) fn used(&self) -> impl Iterator<Item = (usize, &EarlierImage)> {
        let TileLists { whole, mixed, border, .. } = self.lists;
        let is_used = move |age: usize| {
            !whole[age].is_empty() || !mixed[age].is_empty() || (self.border > 0.0 && !border[age].is_empty())
        };
        self.earlier.iter().enumerate().take(self.reuse.ages()).filter(move |(age, _)| is_used(*age))
    }

    fn words(&self) -> usize {
        set_words(&self.reuse).map(<[u32]>::len).sum::<usize>() + self.lists.len()
    }
}

/// How the tiles of one age are drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Age {
    /// Where its parameters are.
    pub(super) offset: u32,
    /// Whether nothing has moved since.
    pub(super) is_still: bool,
    /// Instances.
    pub(super) whole: Range<u32>,
    /// Instances.
    pub(super) mixed: Range<u32>,
    /// Instances.
    pub(super) border: Range<u32>,
}

/// How the tiles of one region are drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Placed {
    /// Any parameters of the region, where it has none of an age.
    pub(super) offset: u32,
    /// Instances.
    pub(super) fresh: Range<u32>,
    /// By age, from 1 on.
    pub(super) ages: [Age; MAX_AGES],
}

/// Room for parameters and lists.
pub(super) struct ReuseBuffers {
    // First: waits before the rest is destroyed.
    uses: Uses,
    set: ListSet,
    params: UniformRing<ReuseParams>,
    words: WordRing,
}

impl ReuseBuffers {
    /// With room for as many words as the regions need, and more, so that frames alike never need more.
    pub(super) fn new<'a>(
        gpu: &Arc<Gpu>,
        uniforms: &UniformRing<ComposeParams>,
        regions: impl Iterator<Item = &'a ReuseRegion<'a>>,
    ) -> Result<Self, GpuError> {
        // Of most tiles at most two parts are in the lists of an age.
        let most = |region: &ReuseRegion| {
            let [columns, rows] = region.reuse.now().stale.tiles();
            region.words() + columns as usize * rows as usize * (2 * region.reuse.ages() + 1)
        };
        let count = regions.map(most).sum::<usize>().next_power_of_two();
        let count = u32::try_from(count).map_err(|_| GpuError::Unsupported("so many tiles"))?;
        let params = UniformRing::new(gpu, (MAX_REUSED * (MAX_AGES + 1)) as u32)?;
        let words = WordRing::new(gpu, count)?;
        let set = ListSet::new(uniforms, &params, &words)?;
        Ok(Self { uses: Uses::new(gpu), set, params, words })
    }

    /// Whether there is room for these regions.
    pub(super) fn fits<'a>(&self, regions: impl Iterator<Item = &'a ReuseRegion<'a>>) -> bool {
        regions.map(ReuseRegion::words).sum::<usize>() <= self.words.per_submit() as usize
    }

    pub(super) fn uses(&self) -> &Uses {
        &self.uses
    }

    pub(super) fn set(&self) -> &ListSet {
        &self.set
    }

    /// Writes what region `number` of a submit needs, from place `at` of its words on, which moves on.
    pub(super) fn place(
        &mut self,
        recorder: &Recorder,
        number: usize,
        region: &ReuseRegion,
        at: &mut u32,
    ) -> Result<Placed, GpuError> {
        let first_word = self.words.write(recorder, *at, &[])?;
        for words in set_words(&region.reuse) {
            self.list(recorder, words, at)?;
        }
        let mut placed = Placed { fresh: self.list(recorder, &region.lists.fresh, at)?, ..Placed::default() };
        let mut params = |age: usize, image: &EarlierImage| {
            let params = ReuseParams::new(&region.reuse, age, image.offset, region.border, first_word);
            let index = (number * (MAX_AGES + 1) + age) as u32;
            let offset = self.params.write(recorder, index, &params)?;
            Ok((offset, params.is_still()))
        };
        placed.offset = params(0, &EarlierImage::default())?.0;
        for (index, image) in region.used() {
            let (offset, is_still) = params(index + 1, image)?;
            placed.ages[index] = Age { offset, is_still, ..Age::default() };
        }
        for (index, _) in region.used() {
            let (lists, age) = (region.lists, &mut placed.ages[index]);
            age.whole = self.list(recorder, &lists.whole[index], at)?;
            age.mixed = self.list(recorder, &lists.mixed[index], at)?;
            if region.border > 0.0 {
                age.border = self.list(recorder, &lists.border[index], at)?;
            }
        }
        Ok(placed)
    }

    fn list(&mut self, recorder: &Recorder, words: &[u32], at: &mut u32) -> Result<Range<u32>, GpuError> {
        let first = self.words.write(recorder, *at, words)?;
        *at += words.len() as u32;
        Ok(first..first + words.len() as u32)
    }
}
