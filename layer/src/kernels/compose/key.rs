//! The key of a frame's commands. A frame repeats the commands of an earlier one with the same images, rectangles and kinds of draws: the
//! gaze, the tiles and their number are in memory that the commands read.

use super::ComposeJob;
use super::draws::{Draw, Draws};
use super::reuse::ReuseRegion;
use crate::gpu::RecordingKey;
use ash::vk;

/// The key of these jobs' commands, without comparisons; `None` for copies of tiles: their rectangles are in the commands. `serials`: of the
/// pass, and of its lists.
pub(super) fn key(serials: [u64; 2], jobs: &[ComposeJob], draws: &Draws) -> Option<RecordingKey> {
    if draws.iter().any(|draw| draw.copied().next().is_some()) {
        return None;
    }
    let mut key = RecordingKey::new();
    key.extend(serials);
    key.push(jobs.len() as u64);
    for job in jobs {
        key.push(job.app.serial());
        key.push(image(job, job.app_index));
        key.push(job.runtime.serial());
        key.push(job.runtime_index.into());
    }
    for draw in draws.iter() {
        key.push(pair(draw.job as u32, draw.layer));
        key.push(pair(draw.offset.get(), draw.tiles));
        key.extend(rect(draw.viewport));
        key.extend(rect(draw.scissor));
        if let (Some(reuse), Some(job)) = (draw.reuse, jobs.get(draw.job)) {
            push_reuse(&mut key, job, draw, reuse);
        }
    }
    Some(key)
}

/// Adds the images of a region's earlier pictures, and the kinds of draws from each.
fn push_reuse(key: &mut RecordingKey, job: &ComposeJob, draw: &Draw, region: &ReuseRegion) {
    let has_border = region.border > 0.0;
    key.push(pair(draw.attenuates.into(), has_border.into()));
    for (index, earlier) in draw.sampled() {
        let depth = region.depth_at_age(index + 1);
        let is_still = region.reuse.is_still_since(index + 1);
        key.push(pair(index as u32, u32::from(is_still) | u32::from(depth.is_some()) << 1));
        key.push(image(job, earlier.app_index));
        key.push(earlier.array_layer.into());
        key.extend(depth.into_iter().flatten().flat_map(|depth| depth.key()));
    }
}

/// One of the application's images, and its layout.
pub(in crate::kernels) fn image(job: &ComposeJob, index: u32) -> u64 {
    pair(index, job.app.layout(index as usize).as_raw() as u32)
}

pub(in crate::kernels) fn pair(high: u32, low: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

fn rect(vk::Rect2D { offset, extent }: vk::Rect2D) -> [u64; 2] {
    [pair(offset.x as u32, offset.y as u32), pair(extent.width, extent.height)]
}
