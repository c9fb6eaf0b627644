//! The key of a frame's commands. A frame that only copies and attenuates pictures repeats the commands of an earlier frame with the same
//! images and rectangles: the gaze is in memory that the commands read.

use super::ComposeJob;
use super::draws::Draws;
use crate::gpu::RecordingKey;
use ash::vk;

/// The key of these jobs' commands; `None` where tiles come from earlier pictures or are compared with them, which gives other commands in
/// every frame. `serial` is that of the pass.
pub(super) fn key(serial: u64, jobs: &[ComposeJob], draws: &Draws) -> Option<RecordingKey> {
    if jobs.iter().any(|job| !job.reuse.is_empty() || !job.changes.is_empty()) {
        return None;
    }
    let mut key = RecordingKey::new();
    key.extend([serial, jobs.len() as u64]);
    for job in jobs {
        let layout = job.app.layout(job.app_index as usize);
        key.push(job.app.serial());
        key.push(pair(job.app_index, layout.as_raw() as u32));
        key.push(job.runtime.serial());
        key.push(job.runtime_index.into());
    }
    for draw in draws.iter() {
        key.push(pair(draw.job as u32, draw.layer));
        key.push(pair(draw.offset.get(), draw.tiles));
        key.extend(rect(draw.viewport));
        key.extend(rect(draw.scissor));
    }
    Some(key)
}

fn pair(high: u32, low: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

fn rect(vk::Rect2D { offset, extent }: vk::Rect2D) -> [u64; 2] {
    [pair(offset.x as u32, offset.y as u32), pair(extent.width, extent.height)]
}
