//! Copies to the runtime's image before all draws over it: the application's newest image, and in its place, where nothing has moved and
//! colour stays as it is, the tiles of earlier ones.

use super::ComposeJob;
use super::draws::{Draw, Draws};
use crate::gpu::Recorder;
use ash::vk;
use parafovea_core::reuse::{Reuse, TileRects};
use smallvec::SmallVec;

/// So many rectangles are copied at once.
const BATCH: usize = 64;

/// Records the copies of the job of this index. No pixel is written twice.
pub(super) fn copy(recorder: &Recorder, number: usize, job: &ComposeJob, draws: &Draws) {
    let extent = job.app.shape().extent;
    let of_job = || draws.iter().filter(|draw| draw.job == number && draw.copied().next().is_some());
    if of_job().next().is_none() {
        recorder.copy_image(job.app_image(), job.runtime_image(), extent, job.layers());
        return;
    }
    for layer in 0..job.layers() {
        let of_layer = || of_job().filter(|draw| draw.layer == layer);
        let rects: SmallVec<[vk::Rect2D; 4]> = of_layer().map(|draw| draw.viewport).collect();
        let mut newest = Copies::new(recorder, job.app_image(), job.runtime_image());
        let whole = vk::Rect2D { offset: vk::Offset2D::default(), extent };
        each_outside(whole, &rects, &mut |rect| newest.add([layer, layer], rect.offset, rect));
        for (draw, region) in of_layer().filter_map(|draw| Some((draw, draw.reuse?))) {
            newest.add_tiles(draw, &region.reuse, &region.lists.fresh, layer, None);
        }
        newest.flush();
        for (draw, region) in of_layer().filter_map(|draw| Some((draw, draw.reuse?))) {
            for (index, image) in draw.copied() {
                let from = job.app.images()[image.app_index as usize];
                let mut earlier = Copies::new(recorder, from, job.runtime_image());
                let tiles = &region.lists.full[index];
                earlier.add_tiles(draw, &region.reuse, tiles, image.array_layer, Some(image.offset));
                earlier.flush();
            }
        }
    }
}

/// Copies from one image to another.
struct Copies<'a> {
    recorder: &'a Recorder<'a>,
    from: vk::Image,
    to: vk::Image,
    regions: SmallVec<[vk::ImageCopy; BATCH]>,
}

impl<'a> Copies<'a> {
    fn new(recorder: &'a Recorder<'a>, from: vk::Image, to: vk::Image) -> Self {
        Self { recorder, from, to, regions: SmallVec::new() }
    }

    /// Tiles of a region, from a layer of the other image in which the region begins at `offset`, if not where it does here.
    fn add_tiles(
        &mut self,
        draw: &Draw,
        reuse: &Reuse,
        tiles: &TileRects,
        layer: u32,
        offset: Option<[u32; 2]>,
    ) {
        let vk::Offset2D { x, y } = draw.viewport.offset;
        let from = offset.map_or(draw.viewport.offset, |[x, y]| vk::Offset2D { x: x as i32, y: y as i32 });
        for tiles in tiles.iter() {
            let [first, end] = reuse.pixels(&reuse.tiles(tiles.first(), tiles.size()));
            let extent = vk::Extent2D {
                width: end[0].saturating_sub(first[0]),
                height: end[1].saturating_sub(first[1]),
            };
            let [across, down] = first.map(|side| side as i32);
            let from = vk::Offset2D { x: from.x + across, y: from.y + down };
            let to = vk::Rect2D { offset: vk::Offset2D { x: x + across, y: y + down }, extent };
            self.add([layer, draw.layer], from, to);
        }
    }

    /// Adds a rectangle, with its source and destination layers.
    fn add(&mut self, [from_layer, to_layer]: [u32; 2], from: vk::Offset2D, to: vk::Rect2D) {
        if to.extent.width == 0 || to.extent.height == 0 {
            return;
        }
        let layer = |layer: u32| vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            mip_level: 0,
            base_array_layer: layer,
            layer_count: 1,
        };
        let offset = |vk::Offset2D { x, y }: vk::Offset2D| vk::Offset3D { x, y, z: 0 };
        self.regions.push(vk::ImageCopy {
            src_subresource: layer(from_layer),
            src_offset: offset(from),
            dst_subresource: layer(to_layer),
            dst_offset: offset(to.offset),
            extent: to.extent.into(),
        });
        if self.regions.len() == BATCH {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if !self.regions.is_empty() {
            self.recorder.copy_regions(self.from, self.to, &self.regions);
            self.regions.clear();
        }
    }
}

/// Calls `act` with rectangles that together are one rectangle without others.
fn each_outside(rect: vk::Rect2D, others: &[vk::Rect2D], act: &mut impl FnMut(vk::Rect2D)) {
    if rect.extent.width == 0 || rect.extent.height == 0 {
        return;
    }
    let Some((other, others)) = others.split_first() else { return act(rect) };
    let axis = |offset: i32, length: u32, other: i32, other_length: u32| {
        let end = offset + length as i32;
        [offset, other.clamp(offset, end), (other + other_length as i32).clamp(offset, end), end]
    };
    let x = axis(rect.offset.x, rect.extent.width, other.offset.x, other.extent.width);
    let y = axis(rect.offset.y, rect.extent.height, other.offset.y, other.extent.height);
    if x[1] >= x[2] || y[1] >= y[2] {
        return each_outside(rect, others, act);
    }
    for ([left, right], [top, bottom]) in [
        ([x[0], x[3]], [y[0], y[1]]),
        ([x[0], x[1]], [y[1], y[2]]),
        ([x[2], x[3]], [y[1], y[2]]),
        ([x[0], x[3]], [y[2], y[3]]),
    ] {
        let part = vk::Rect2D {
            offset: vk::Offset2D { x: left, y: top },
            extent: vk::Extent2D { width: (right - left) as u32, height: (bottom - top) as u32 },
        };
        each_outside(part, others, act);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rect(of: [u32; 4]) -> vk::Rect2D {
        let [x, y, width, height] = of;
        vk::Rect2D {
            offset: vk::Offset2D { x: x as i32, y: y as i32 },
            extent: vk::Extent2D { width, height },
        }
    }

    fn has(rect: &vk::Rect2D, x: i32, y: i32) -> bool {
        let inside = |at: i32, offset: i32, length: u32| (offset..offset + length as i32).contains(&at);
        inside(x, rect.offset.x, rect.extent.width) && inside(y, rect.offset.y, rect.extent.height)
    }

    proptest! {
        #[test]
        fn each_remaining_tile_is_copied_once(others in prop::collection::vec(prop::array::uniform4(0u32..9), 0..4)) {
            let (whole, others) = (rect([1, 2, 9, 8]), others.into_iter().map(rect).collect::<Vec<_>>());
            let mut parts = Vec::new();
            each_outside(whole, &others, &mut |part| parts.push(part));
            for (x, y) in (0..20).flat_map(|y| (0..20).map(move |x| (x, y))) {
                let is_left = has(&whole, x, y) && !others.iter().any(|other| has(other, x, y));
                prop_assert_eq!(parts.iter().filter(|part| has(part, x, y)).count(), usize::from(is_left));
            }
        }
    }
}
