//! Tiles from earlier pictures: the places of a frame's parameters and lists, and the drawn instances.

use super::draws::Draw;
use super::{ComposeParams, MAX_REUSED, PictureDepth};
use crate::gpu::{Gpu, GpuError, ListSet, SlotIndex, UniformRing, Uses, WordRing};
use ash::vk;
use parafovea_core::kernels::compose::ReuseParams;
use parafovea_core::reuse::{MAX_AGES, Reuse, TileLists, TileRects};
use std::ops::Range;
use std::sync::Arc;

/// A rectangle of one array layer that is completed from earlier pictures.
#[derive(Clone, Copy, Debug)]
pub struct ReuseRegion<'a> {
    /// The array layer.
    pub array_layer: u32,
    /// The rectangle, within the image.
    pub rect: vk::Rect2D,
    /// The stale tiles of its picture, and their sources.
    pub reuse: Reuse<'a>,
    /// Lists made of `reuse`.
    pub lists: &'a TileLists,
    /// Locations of the earlier pictures, one for each of [`Reuse::ages`].
    pub earlier: [EarlierImage; MAX_AGES],
    /// Width over which fresh pixels beside stale tiles are blended, pixels; 0: not at all.
    pub border: f32,
    /// The depth of its picture, where [`Reuse::has_moved_since`] any.
    pub depth: Option<PictureDepth<'a>>,
    /// That of the earlier pictures, for each that [`Reuse::has_moved_since`].
    pub earlier_depth: [Option<PictureDepth<'a>>; MAX_AGES],
}

/// Location of an earlier picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EarlierImage {
    /// Index of the application's image; not the newest one.
    pub app_index: u32,
    /// The array layer.
    pub array_layer: u32,
    /// First pixel of its rectangle, whose size is that of the picture.
    pub offset: [u32; 2],
}

impl<'a> ReuseRegion<'a> {
    /// The earlier pictures: their index, and their location.
    pub(super) fn pictures(&'a self) -> impl Iterator<Item = (usize, &'a EarlierImage)> {
        self.earlier.iter().enumerate().take(self.reuse.ages())
    }

    /// The depth of its picture, and of that of an age, from 1 on, where that counts.
    pub(super) fn depth_at_age(&self, age: usize) -> Option<[PictureDepth<'a>; 2]> {
        let earlier = *self.earlier_depth.get(age.checked_sub(1)?)?;
        self.reuse.has_moved_since(age).then_some([self.depth?, earlier?])
    }

    /// Whether parts of tiles are drawn from the picture of this index.
    pub(super) fn has_parts(&self, age: usize) -> bool {
        !self.lists.partial[age].is_empty()
            || (self.border > 0.0 && !self.lists.seam[age].iter().all(TileRects::is_empty))
    }

    fn words(&self) -> usize {
        // Lists begin at an even place.
        let sets = self.reuse.pictures().map(|picture| picture.stale.words().len() + 1);
        sets.sum::<usize>() + self.lists.words()
    }
}

/// Draws of the tiles of one age.
#[derive(Clone, Debug, Default)]
pub(super) struct Age {
    /// Offset of its parameters.
    pub(super) offset: u32,
    /// Whether nothing has moved since.
    pub(super) is_still: bool,
    /// The depth of the newest picture and of that one, where the head has moved.
    pub(super) depth: Option<[vk::DescriptorSet; 2]>,
    /// Instances.
    pub(super) whole: Range<u32>,
    /// Instances.
    pub(super) mixed: Range<u32>,
    /// Instances.
    pub(super) border: Range<u32>,
}

/// Draws of the tiles of one region.
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
        // Were each tile for itself.
        let most = |region: &ReuseRegion| {
            let [columns, rows] = region.reuse.now().stale.tiles();
            region.words() + columns as usize * rows as usize * 2
        };
        let count = regions.map(most).sum::<usize>().next_power_of_two();
        let count = u32::try_from(count).map_err(|_| GpuError::Unsupported("this number of tiles"))?;
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

    /// Writes the tiles that a draw, the `number`th of a submit that needs any, takes from earlier pictures, from place `at` of the
    /// submit's words on, which moves on.
    pub(super) fn place(
        &mut self,
        slot: SlotIndex,
        number: usize,
        (draw, region): (&Draw, &ReuseRegion),
        extent: [u32; 2],
        at: &mut u32,
    ) -> Result<Placed, GpuError> {
        let plain = ReuseParams::new(&region.reuse, region.border);
        let params = |this: &mut Self, age: usize, params: &ReuseParams| {
            this.params.write(slot, (number * (MAX_AGES + 1) + age) as u32, params)
        };
        let mut placed = Placed { offset: params(self, 0, &plain)?, ..Placed::default() };
        if draw.attenuates {
            placed.fresh = self.list(slot, &[&region.lists.fresh], at)?;
        }
        for (index, image) in draw.sampled() {
            let age = index + 1;
            let word = self.stale(slot, region, index, at)?;
            let depth = region.depth_at_age(age);
            let written = plain.at_age(&region.reuse, age, image.offset, extent, word);
            let written = match depth {
                Some([now, then]) => written.with_depth(&region.reuse, age, now.rect, then.rect),
                None => written,
            };
            let lists = region.lists;
            placed.ages[index] = Age {
                offset: params(self, age, &written)?,
                is_still: region.reuse.is_still_since(age),
                depth: depth.and_then(|[now, then]| Some([now.texture()?, then.texture()?])),
                whole: if draw.is_copied(region, index) {
                    0..0
                } else {
                    self.list(slot, &[&lists.full[index]], at)?
                },
                mixed: self.list(slot, &[&lists.partial[index]], at)?,
                border: self.list(slot, &lists.seam[index].each_ref(), at)?,
            };
        }
        Ok(placed)
    }

    /// Writes the stale tiles of the earlier picture of an index, where parts of tiles or borders are taken from it; returns their place.
    fn stale(
        &mut self,
        slot: SlotIndex,
        region: &ReuseRegion,
        index: usize,
        at: &mut u32,
    ) -> Result<u32, GpuError> {
        let picture = region.reuse.pictures().nth(index);
        let lists = region.lists;
        let is_read =
            !lists.partial[index].is_empty() || lists.seam[index].iter().any(|seam| !seam.is_empty());
        match picture.filter(|_| is_read) {
            Some(picture) => self.write(slot, picture.stale.words(), at),
            None => Ok(0),
        }
    }

    /// Writes lists as one; returns its instances.
    fn list(&mut self, slot: SlotIndex, lists: &[&TileRects], at: &mut u32) -> Result<Range<u32>, GpuError> {
        *at = at.next_multiple_of(2);
        let first = self.write(slot, &[], at)?;
        for list in lists {
            self.write(slot, list.words(), at)?;
        }
        let count: usize = lists.iter().map(|list| list.len()).sum();
        Ok(first / 2..first / 2 + count as u32)
    }

    fn write(&mut self, slot: SlotIndex, words: &[u32], at: &mut u32) -> Result<u32, GpuError> {
        let place = self.words.write(slot, *at, words)?;
        *at += words.len() as u32;
        Ok(place)
    }
}
