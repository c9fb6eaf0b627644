//! The tiles that are drawn of each region, computed before anything is recorded.

use super::reuse::{EarlierImage, Placed, ReuseRegion};
use super::{ComposeJob, ComposeParams, ComposeRegion, MAX_REGIONS, SwapchainShape};
use crate::gpu::GpuError;
use ash::vk;
use smallvec::SmallVec;
use std::cell::{Cell, RefCell};

/// One region with work, inside its image.
#[derive(Clone, Debug)]
pub(super) struct Draw<'a> {
    /// Index of the job.
    pub(super) job: usize,
    /// Array layer.
    pub(super) layer: u32,
    /// The rectangle of `params`, which is the viewport.
    pub(super) viewport: vk::Rect2D,
    /// The part of it that may be written.
    pub(super) scissor: vk::Rect2D,
    /// Number of tiles of the viewport.
    pub(super) tiles: u32,
    /// The processing.
    pub(super) params: ComposeParams,
    /// Whether `params` attenuates any colour.
    pub(super) attenuates: bool,
    /// Offset of the uniforms written for `params`.
    pub(super) offset: Cell<u32>,
    /// Tiles from earlier pictures.
    pub(super) reuse: Option<&'a ReuseRegion<'a>>,
    /// Places at which those were written.
    pub(super) placed: RefCell<Placed>,
}

/// The draws of all jobs, in order.
pub(super) struct Draws<'a> {
    draws: SmallVec<[Draw<'a>; FEW]>,
}

/// So many draws need no allocation: an application has one for each eye.
const FEW: usize = 4;

impl<'a> Draws<'a> {
    pub(super) fn new(jobs: &[ComposeJob<'a>]) -> Result<Self, GpuError> {
        let mut draws = SmallVec::new();
        let mut add = |draw| match draws.len() {
            MAX_REGIONS => Err(GpuError::Invalid("more regions than fit in one submission")),
            _ => {
                draws.push(draw);
                Ok(())
            }
        };
        for (number, job) in jobs.iter().enumerate() {
            for region in
                job.regions.iter().filter(|region| !job.reuse.iter().any(|reuse| is_same(reuse, region)))
            {
                draw(number, job.app.shape(), region)?.map_or(Ok(()), &mut add)?;
            }
            for reuse in job.reuse {
                add(reuse_draw(number, job, reuse)?)?;
            }
        }
        Ok(Self { draws })
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Draw<'a>> {
        self.draws.iter()
    }

    /// Whether the job of this index draws anything.
    pub(super) fn any_of(&self, job: usize) -> bool {
        self.iter().any(|draw| draw.job == job && draw.draws())
    }

    /// Tiles from earlier pictures.
    pub(super) fn reused(&self) -> impl Iterator<Item = &'a ReuseRegion<'a>> {
        self.iter().filter_map(|draw| draw.reuse)
    }

    /// Images of earlier pictures from which the job of this index copies.
    pub(super) fn copied_of(&self, job: usize) -> EarlierImages {
        let draws = self.iter().filter(|draw| draw.job == job);
        draws.flat_map(Draw::copied).map(|(_, image)| image).collect()
    }

    /// Images of earlier pictures from which the job of this index draws.
    pub(super) fn sampled_of(&self, job: usize) -> EarlierImages {
        let draws = self.iter().filter(|draw| draw.job == job);
        draws.flat_map(Draw::sampled).map(|(_, image)| image).collect()
    }
}

impl<'a> Draw<'a> {
    /// Whether whole regions from the image of index `age` are copied instead of drawn, because nothing has moved and colour stays
    /// unchanged.
    pub(super) fn is_copied(&self, region: &ReuseRegion, age: usize) -> bool {
        !self.attenuates && region.reuse.is_still_since(age + 1)
    }

    /// Earlier pictures from which tiles are copied: their index, and their location.
    pub(super) fn copied(&self) -> impl Iterator<Item = (usize, &'a EarlierImage)> {
        let regions = self.reuse.into_iter();
        regions.flat_map(move |region| {
            let is_copied =
                move |age: usize| !region.lists.full[age].is_empty() && self.is_copied(region, age);
            region.pictures().filter(move |(age, _)| is_copied(*age))
        })
    }

    /// Sources of drawn tiles among the earlier pictures: all of them if any has such tiles, so that the commands of a frame do not depend on
    /// the ages of its tiles. A frame with copied tiles has commands of its own, and draws only from pictures with drawn tiles.
    pub(super) fn sampled(&self) -> impl Iterator<Item = (usize, &'a EarlierImage)> {
        let is_drawn = |region: &ReuseRegion, age: usize| {
            let is_whole = !region.lists.full[age].is_empty() && !self.is_copied(region, age);
            is_whole || region.has_parts(age)
        };
        let has_copies = self.copied().next().is_some();
        let regions = self.reuse.into_iter();
        regions.flat_map(move |region| {
            let has_draws = !has_copies && region.pictures().any(|(age, _)| is_drawn(region, age));
            region.pictures().filter(move |(age, _)| has_draws || is_drawn(region, *age))
        })
    }

    /// Whether anything is drawn.
    pub(super) fn draws(&self) -> bool {
        self.attenuates || self.sampled().next().is_some()
    }
}

/// Indices of images, as bits.
#[derive(Clone, Copy)]
pub(super) struct EarlierImages(u64);

impl EarlierImages {
    /// Largest number of images.
    pub(super) const MOST: usize = u64::BITS as usize;

    pub(super) fn iter(self) -> impl Iterator<Item = usize> {
        (0..Self::MOST).filter(move |index| self.contains(*index))
    }

    pub(super) fn contains(self, index: usize) -> bool {
        self.0 >> index & 1 == 1
    }

    pub(super) fn without(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }
}

impl<'a> FromIterator<&'a EarlierImage> for EarlierImages {
    fn from_iter<T: IntoIterator<Item = &'a EarlierImage>>(images: T) -> Self {
        Self(images.into_iter().fold(0, |bits, image| bits | 1 << image.app_index))
    }
}

fn is_same(reuse: &ReuseRegion, region: &ComposeRegion) -> bool {
    reuse.array_layer == region.array_layer && reuse.rect == region.rect
}

/// The draw of a region that is completed from earlier pictures, with the other processing of the same rectangle.
fn reuse_draw<'a>(job: usize, of: &ComposeJob<'a>, reuse: &'a ReuseRegion<'a>) -> Result<Draw<'a>, GpuError> {
    let vk::Rect2D { offset, extent } = reuse.rect;
    let shape = of.app.shape();
    let fits = |offset: i32, extent: u32, limit: u32| {
        u32::try_from(offset)
            .ok()
            .and_then(|offset| offset.checked_add(extent))
            .is_some_and(|end| end <= limit)
    };
    let is_inside = extent.width > 0
        && extent.height > 0
        && fits(offset.x, extent.width, shape.extent.width)
        && fits(offset.y, extent.height, shape.extent.height);
    if !is_inside
        || reuse.array_layer >= shape.array_layers
        || reuse.reuse.now().extent != [extent.width, extent.height]
    {
        return Err(GpuError::Invalid("a rectangle beyond its image"));
    }
    let offset = [offset.x as u32, offset.y as u32];
    let params = of.regions.iter().find(|region| is_same(reuse, region)).map(|region| region.params);
    let params = params
        .filter(|params| (params.rect_offset, params.rect_extent) == (offset, reuse.reuse.now().extent));
    let params = params.unwrap_or_else(|| ComposeParams::neutral(offset, reuse.reuse.now().extent));
    Ok(Draw {
        job,
        layer: reuse.array_layer,
        viewport: reuse.rect,
        scissor: reuse.rect,
        tiles: 0,
        attenuates: params.has_work(),
        params,
        offset: Cell::new(0),
        reuse: Some(reuse),
        placed: RefCell::default(),
    })
}

/// The draw of one region; none when nothing of it is inside the image, or nothing has work.
fn draw<'a>(
    job: usize,
    shape: &SwapchainShape,
    region: &ComposeRegion,
) -> Result<Option<Draw<'a>>, GpuError> {
    if region.array_layer >= shape.array_layers {
        return Err(GpuError::Invalid("an array layer out of range"));
    }
    let size = [shape.extent.width, shape.extent.height];
    let Some(params) = region.params.clipped(size).filter(ComposeParams::has_work) else { return Ok(None) };
    let viewport = vk::Rect2D {
        offset: vk::Offset2D { x: params.rect_offset[0] as i32, y: params.rect_offset[1] as i32 },
        extent: vk::Extent2D { width: params.rect_extent[0], height: params.rect_extent[1] },
    };
    let Some(scissor) = intersection(viewport, region.rect) else { return Ok(None) };
    let [columns, rows] = params.tile_grid();
    Ok(Some(Draw {
        job,
        layer: region.array_layer,
        viewport,
        scissor,
        tiles: columns * rows,
        params,
        attenuates: true,
        offset: Cell::new(0),
        reuse: None,
        placed: RefCell::default(),
    }))
}

/// The intersection of two rectangles, if there is one; `a` lies within an image.
fn intersection(a: vk::Rect2D, b: vk::Rect2D) -> Option<vk::Rect2D> {
    let axis = |a: (i32, u32), b: (i32, u32)| {
        let start = i64::from(a.0).max(i64::from(b.0));
        let end = (i64::from(a.0) + i64::from(a.1)).min(i64::from(b.0) + i64::from(b.1));
        // Within `a`, hence in range.
        (end > start).then_some((start as i32, (end - start) as u32))
    };
    let (x, width) = axis((a.offset.x, a.extent.width), (b.offset.x, b.extent.width))?;
    let (y, height) = axis((a.offset.y, a.extent.height), (b.offset.y, b.extent.height))?;
    Some(vk::Rect2D { offset: vk::Offset2D { x, y }, extent: vk::Extent2D { width, height } })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_core::chroma::ChromaSettings;
    use parafovea_core::geometry::Fov;

    fn rect(x: i32, y: i32, width: u32, height: u32) -> vk::Rect2D {
        vk::Rect2D { offset: vk::Offset2D { x, y }, extent: vk::Extent2D { width, height } }
    }

    fn region(offset: [u32; 2], extent: [u32; 2], rect: vk::Rect2D) -> ComposeRegion {
        let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
        let ahead = glam::Vec3::NEG_Z;
        let params = ComposeParams::new(offset, extent, fov, ahead, &ChromaSettings::default(), true);
        ComposeRegion { array_layer: 0, rect, params }
    }

    fn shape() -> SwapchainShape {
        SwapchainShape {
            format: vk::Format::R8G8B8A8_SRGB,
            extent: vk::Extent2D { width: 100, height: 80 },
            array_layers: 1,
            usage: vk::ImageUsageFlags::COLOR_ATTACHMENT,
            mutable: false,
            view_formats: vec![],
        }
    }

    #[test]
    fn regions_are_limited_to_the_image_and_the_rectangle() {
        let drawn = |region: &ComposeRegion| draw(0, &shape(), region).unwrap();
        let inside = drawn(&region([0, 0], [100, 80], rect(0, 0, 100, 80))).unwrap();
        assert_eq!((inside.scissor, inside.tiles), (rect(0, 0, 100, 80), 2 * 2));
        let beyond =
            drawn(&region([90, 70], [u32::MAX, u32::MAX], rect(-5, -5, u32::MAX, u32::MAX))).unwrap();
        assert_eq!((beyond.viewport, beyond.scissor), (rect(90, 70, 10, 10), rect(90, 70, 10, 10)));
        let narrow = drawn(&region([10, 10], [50, 50], rect(20, 5, 10, 10))).unwrap();
        assert_eq!((narrow.viewport, narrow.scissor), (rect(10, 10, 50, 50), rect(20, 10, 10, 5)));
        assert!(drawn(&region([100, 0], [10, 10], rect(100, 0, 10, 10))).is_none(), "outside of the image");
        assert!(drawn(&region([0, 0], [10, 10], rect(i32::MIN, 0, 10, 10))).is_none(), "nothing in common");
        assert!(drawn(&region([0, 0], [10, 10], rect(0, 0, 0, 10))).is_none(), "empty rectangle");
    }

    #[test]
    fn layers_out_of_range_are_refused() {
        let mut beyond = region([0, 0], [10, 10], rect(0, 0, 10, 10));
        beyond.array_layer = 1;
        assert!(matches!(draw(0, &shape(), &beyond), Err(GpuError::Invalid(_))));
    }
}
