//! Tiles from earlier pictures: the places of a frame's parameters and lists. The numbers of instances are in memory, too, so that a frame
//! with other tiles repeats the commands of an earlier one.

use super::draws::Draw;
use super::{ComposeParams, MAX_REUSED, PictureDepth};
use crate::gpu::{
    Gpu, GpuError, IndirectRing, IndirectSize, ListSet, SlotIndex, UniformRing, Uses, WordRing, serial,
};
use ash::vk;
use parafovea_core::kernels::compose::ReuseParams;
use parafovea_core::reuse::{MAX_AGES, Reuse, TileLists, TileRects};
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
    /// Number of rectangles of whole tiles; `None` if they are copied.
    pub(super) whole: Option<IndirectSize>,
    /// Number of rectangles of partial tiles.
    pub(super) mixed: Option<IndirectSize>,
    /// Number of rectangles of blended edges; `None` without borders.
    pub(super) border: Option<IndirectSize>,
}

/// Draws of the tiles of one region.
#[derive(Clone, Debug, Default)]
pub(super) struct Placed {
    /// Offset of the parameters of no age.
    pub(super) offset: u32,
    /// Number of rectangles of fresh tiles; `None` if their colour stays unchanged.
    pub(super) fresh: Option<IndirectSize>,
    /// By age, from 1 on.
    pub(super) ages: [Age; MAX_AGES],
}

/// Sizes of one age: of whole tiles, parts and borders.
const SIZES_OF_AGE: usize = 3;

/// Sizes of one region: of fresh tiles, and of the ages.
const SIZES: usize = 1 + SIZES_OF_AGE * MAX_AGES;

/// Room for parameters and lists.
pub(super) struct ReuseBuffers {
    // First: waits before the rest is destroyed.
    uses: Uses,
    set: ListSet,
    params: UniformRing<ReuseParams>,
    words: WordRing,
    sizes: IndirectRing,
    /// Of the objects above.
    serial: u64,
}

/// The lists of a region under way to memory.
struct Lists<'a> {
    words: &'a mut WordRing,
    sizes: &'a mut IndirectRing,
    slot: SlotIndex,
    /// Index of the region's first size.
    first_size: usize,
    /// The next place among the submit's words.
    at: &'a mut u32,
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
        let sizes = IndirectRing::new(gpu, (MAX_REUSED * SIZES) as u32)?;
        Ok(Self { uses: Uses::new(gpu), set, params, words, sizes, serial: serial() })
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

    /// No other buffers have it.
    pub(super) fn serial(&self) -> u64 {
        self.serial
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
        let Self { params, words, sizes, .. } = self;
        let mut write = |age: usize, of_age: &ReuseParams| {
            params.write(slot, (number * (MAX_AGES + 1) + age) as u32, of_age)
        };
        let mut lists = Lists { words, sizes, slot, first_size: number * SIZES, at };
        let mut placed = Placed::default();
        let (fresh, size) = match draw.attenuates {
            true => lists.place(0, &[&region.lists.fresh])?,
            false => (0, None),
        };
        placed.fresh = size;
        placed.offset = write(0, &ReuseParams { whole_first: fresh, ..plain })?;
        for (index, image) in draw.sampled() {
            let age = index + 1;
            let word = lists.stale(region, index)?;
            let depth = region.depth_at_age(age);
            let of_age = plain.at_age(&region.reuse, age, image.offset, extent, word);
            let of_age = match depth {
                Some([now, then]) => of_age.with_depth(&region.reuse, age, now.rect, then.rect),
                None => of_age,
            };
            let TileLists { full, partial, seam, .. } = region.lists;
            let first_size = 1 + SIZES_OF_AGE * index;
            let (whole_first, whole) = match draw.is_copied(region, index) {
                true => (0, None),
                false => lists.place(first_size, &[&full[index]])?,
            };
            let (mixed_first, mixed) = lists.place(first_size + 1, &[&partial[index]])?;
            let (border_first, border) = match region.border > 0.0 {
                true => lists.place(first_size + 2, &seam[index].each_ref())?,
                false => (0, None),
            };
            placed.ages[index] = Age {
                offset: write(age, &ReuseParams { whole_first, mixed_first, border_first, ..of_age })?,
                is_still: region.reuse.is_still_since(age),
                depth: depth.and_then(|[now, then]| Some([now.texture()?, then.texture()?])),
                whole,
                mixed,
                border,
            };
        }
        Ok(placed)
    }
}

impl Lists<'_> {
    /// Writes the stale tiles of the earlier picture of an index, where parts of tiles or borders are taken from it; returns their place.
    fn stale(&mut self, region: &ReuseRegion, index: usize) -> Result<u32, GpuError> {
        let picture = region.reuse.pictures().nth(index);
        match picture.filter(|_| region.has_parts(index)) {
            Some(picture) => self.write(picture.stale.words()),
            None => Ok(0),
        }
    }

    /// Writes lists as one, and its size, of the given index in the region; returns its first rectangle, and the size.
    fn place(&mut self, size: usize, lists: &[&TileRects]) -> Result<(u32, Option<IndirectSize>), GpuError> {
        *self.at = self.at.next_multiple_of(2);
        let first = self.write(&[])?;
        for list in lists {
            self.write(list.words())?;
        }
        let count: usize = lists.iter().map(|list| list.len()).sum();
        let size = self.sizes.write_strips(self.slot, (self.first_size + size) as u32, count as u32)?;
        Ok((first / 2, Some(size)))
    }

    fn write(&mut self, words: &[u32]) -> Result<u32, GpuError> {
        let place = self.words.write(self.slot, *self.at, words)?;
        *self.at += words.len() as u32;
        Ok(place)
    }
}
